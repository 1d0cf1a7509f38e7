#include "options/info_options.h"

#include "options/command.h"
#include "options/surface_options.h"

Command infoCommand(InfoOptions& o) {
    Command command{
        .name = "implicit-geodesic info",
        .about = "What a file holds, whether it is usable as a surface, and what a run costs",
        .arguments =
            {{.names = {"FILE"},
              .value = "[:GRID]",
              .text = "A volume and a grid of it, a mesh, points or voxels: .vdb .obj "
                      ".ply .stl .off .gltf .glb .gii .mz3 .xyz .csv .txt .pwn .nii .mgz .nrrd",
              .reads = parsed(o.source, igeo::parseGridSource),
              .required = true}},
        .exitCodes = {{0, "usable"},
                      {1, "failed"},
                      {2, "wrong usage"},
                      {3, "not usable"},
                      {130, "interrupted"}},
        .examples = {{"implicit-geodesic info data/torus.vdb", "whether the torus is usable"},
                     {"implicit-geodesic info data/box.vdb --unreliable unreliable.vdb",
                      "where results on a box are unreliable: along its edges"},
                     {"implicit-geodesic info model.obj --resolution 400",
                      "whether voxels of 1/400 of a mesh's longest side show all of it"}}};
    addVoxelSizeOptions(command, o.voxelSize, o.resolution);
    command.add("Surface", {{.names = {"--iso"},
                             .value = "V",
                             .text = "Of a volume of voxels, the value at the surface "
                                     "[masks: halfway]",
                             .reads = number(o.iso)}});
    command.add(
        "Results",
        {{.names = {"--json"}, .text = "Print JSON (docs/info.schema.json)", .reads = flag(o.json)},
         {.names = {"--unreliable"},
          .value = "FILE",
          .text = "Where results are unreliable: 1 where a bound is just met, larger is worse; a "
                  "grid (.vdb), or a page for a browser (.html)",
          .reads = text(o.unreliable)}});
    addProcessOptions(command, o);
    command.add("Run", {helpOption()});
    command.check = [&o] {
        if (o.unreliable == "-")
            usageError("--unreliable -: stdout is for the survey", "give a file");
    };
    return command;
}
