#include "options/surface_options.h"

#include <igeo/io/mesh_file.h>
#include <igeo/io/point_cloud_file.h>
#include <igeo/io/volume_file.h>

#include "options/command.h"

namespace {

const Names<igeo::Scheme> kSchemes{{"jet", igeo::Scheme::Jet}, {"godunov", igeo::Scheme::Godunov}};

Reader volume(SurfaceOptions& options) {
    return {.read = [&options](const std::string& word) {
        options.kind = SurfaceKind::Volume;
        options.source = igeo::parseGridSource(word);
    }};
}

Reader file(SurfaceOptions& options, SurfaceKind kind) {
    return {.read = [&options, kind](const std::string& word) {
        options.kind = kind;
        options.source = {word, ""};
    }};
}

}  // namespace

SurfaceKind kindByName(const std::string& file) {
    if (igeo::isVolumeFile(file)) return SurfaceKind::VoxelVolume;
    if (igeo::isMeshFile(file)) return SurfaceKind::Mesh;
    return igeo::isPointFile(file) ? SurfaceKind::Points : SurfaceKind::Volume;
}

std::string optionFor(SurfaceKind kind) {
    switch (kind) {
        case SurfaceKind::Mesh:
            return "--mesh";
        case SurfaceKind::Points:
            return "--points";
        case SurfaceKind::VoxelVolume:
            return "--volume";
        case SurfaceKind::None:
        case SurfaceKind::Volume:
            break;
    }
    return "--sdf";
}

void addSurfaceArgument(Command& command, SurfaceOptions& o) {
    auto read = [&o](const std::string& word) {
        o.kind = kindByName(word);
        o.source = o.kind == SurfaceKind::Volume ? igeo::parseGridSource(word)
                                                 : igeo::GridSource{word, ""};
    };
    command.arguments.push_back(
        {.names = {"FILE"},
         .value = "[:GRID]",
         .text = "The surface, as --sdf, --mesh, --points or --volume by its ending: .vdb; .obj "
                 ".ply .stl .off .gltf .glb .gii .mz3; .xyz .csv .txt .pwn; .nii .mgz .nrrd",
         .reads = {.read = read},
         .excludes = {"--sdf", "--mesh", "--points", "--volume"},
         .brief = "the surface: .vdb, a mesh, points, .nii, .mgz, .nrrd"});
}

void addVoxelSizeOptions(Command& command, double& voxelSize, int& resolution) {
    command.add(
        "Surface",
        {{.names = {"--voxel-size"},
          .value = "S",
          .text = "Of a mesh or points, world units [longest side / 256; points: half their "
                  "spacing; --volume: its finest]",
          .reads = numberAboveZero(voxelSize)},
         {.names = {"--resolution"},
          .value = "N",
          .text = "The same as voxels along the longest side",
          .reads = wholeNumber(resolution, 8, 1 << 20),
          .excludes = {"--voxel-size"}}});
}

void addSurfaceOptions(Command& command, SurfaceOptions& o) {
    command.add(
        "Surface",
        {{.names = {"--sdf"},
          .value = "FILE[:GRID]",
          .text = "Level set: a .vdb file, and its grid if it holds several; - reads stdin",
          .reads = volume(o)},
         {.names = {"--mesh"},
          .value = "FILE",
          .text = "Instead: triangles or polygons, open or closed; .obj .ply .stl .off .gltf "
                  ".glb .gii .mz3, FreeSurfer",
          .reads = file(o, SurfaceKind::Mesh),
          .excludes = {"--sdf"}},
         {.names = {"--points"},
          .value = "FILE",
          .text = "Instead: points on a surface, with or without normals; .ply .xyz .csv .txt .pwn "
                  ".obj or points in a .vdb",
          .reads = file(o, SurfaceKind::Points),
          .excludes = {"--sdf", "--mesh"}},
         {.names = {"--volume"},
          .value = "FILE",
          .text = "Instead: where a volume of voxels has the value --iso; .nii .nii.gz .hdr .mgz "
                  ".mgh .nrrd .nhdr",
          .reads = file(o, SurfaceKind::VoxelVolume),
          .excludes = {"--sdf", "--mesh", "--points"}}});
    addVoxelSizeOptions(command, o.voxelSize, o.resolution);
    command.add("Surface",
                {{.names = {"--join-gaps"},
                  .value = "D",
                  .text = "Paths may cross gaps up to this wide between pieces of a mesh, or "
                          "between its rims, world units",
                  .reads = numberAboveZero(o.joinGaps)},
                 {.names = {"--rebuild"},
                  .text = "Make a signed distance of a volume that is none: a fog volume, another "
                          "function, an unsigned distance",
                  .reads = flag(o.rebuild)},
                 {.names = {"--iso"},
                  .value = "V",
                  .text = "The value at the surface, for --volume [masks: halfway] and "
                          "--rebuild [0; fog: 0.5]",
                  .reads = number(o.iso)}});
}

void addBandOptions(Command& command, SurfaceOptions& o) {
    command.add(
        "Band",
        {{.names = {"--band"},
          .value = "H",
          .text = "Half-width h of the band |psi| < h, world units; at least sqrt(3) voxels, less "
                  "than the smallest radius of curvature [jet: sqrt(3) voxels, godunov: from "
                  "curvature]",
          .reads = numberAboveZero(o.band)},
         {.names = {"--band-voxels"},
          .value = "N",
          .text = "The same in voxels",
          .reads = numberAboveZero(o.bandVoxels),
          .excludes = {"--band"}}});
}

void addSchemeOptions(Command& command, SurfaceOptions& o) {
    command.add("Scheme", {{.names = {"--scheme"},
                            .value = "NAME",
                            .text = "How to solve: jet (value and gradient on foot points) or "
                                    "godunov (Memoli & Sapiro 2001) [jet]",
                            .reads = choice(o.scheme, kSchemes)},
                           {.names = {"--order"},
                            .value = "N",
                            .text = "Order of godunov's differences, 1 or 2 [2]",
                            .reads = wholeNumber(o.order, 1, 2)}});
}
