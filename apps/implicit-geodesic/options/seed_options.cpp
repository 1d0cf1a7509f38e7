#include "options/seed_options.h"

#include "options/command.h"

namespace {

const Names<igeo::Space> kSpaces{{"world", igeo::Space::World}, {"index", igeo::Space::Index}};

Shot shotOf(const std::string& word) {
    const std::vector<double> v = igeo::parseNumbers(word);
    if (v.size() != 7 || !(v[6] >= 0))
        usageError("'" + word + "' is not x,y,z,dx,dy,dz,length with a length of at least 0",
                   "give a point, a direction and how far to go");
    const Shot shot{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, v[6], word};
    if (shot.direction == igeo::Vec3d{})
        usageError("'" + word + "' goes in no direction", "give a direction other than 0,0,0");
    return shot;
}

Via viaOf(const std::string& word) {
    const Via via{igeo::parseCurve(word), word};
    if (via.curve.points.size() == 1)
        usageError("'" + word + "' is one point",
                   "give two or more with blanks between, as in \"0,0,1 1,0,0\", or a file");
    return via;
}

std::vector<Option> seedOptions(SeedOptions& o) {
    return {{.names = {"--seed"},
             .value = "X,Y,Z",
             .text = "Where the distance is 0; repeat for several. Of a mesh or points also "
                     "vertex:123 (numbered from 0), +x, -x, +y, -y, +z, -z or center",
             .reads = parsedEach(o.seeds, igeo::parsePoint)},
            {.names = {"--seeds"},
             .value = "FILE",
             .text = "Seeds from a .json or .csv file: x,y,z and, if given, a start distance; "
                     "numbers of vertices; or in .json groups of them, each one seed, as regions "
                     "of a .annot file are",
             .reads = text(o.seedFile)},
            {.names = {"--seed-curve"},
             .value = "FILE",
             .text = "Distance 0 along polylines on the surface: .json (also --isolines and "
                     "--paths of another run) or .csv; repeatable",
             .reads = texts(o.seedCurves)},
            {.names = {"--seed-mask"},
             .value = "FILE[:GRID]",
             .text = "Distance 0 on the part of the surface inside a mask, level set or fog "
                     "volume; repeatable",
             .reads = parsedEach(o.seedMasks, igeo::parseGridSource)},
            {.names = {"--signed"},
             .text = "Negative distances inside masks, and on the smaller side of closed curves",
             .reads = flag(o.withSign)}};
}

std::vector<Option> targetOptions(SeedOptions& o) {
    return {{.names = {"--target"},
             .value = "X,Y,Z",
             .text = "Where a geodesic to the nearest seed starts; repeatable",
             .reads = parsedEach(o.targets, igeo::parsePoint)},
            {.names = {"--targets"},
             .value = "FILE",
             .text = "Targets from a .json or .csv file",
             .reads = text(o.targetFile)},
            {.names = {"--space"},
             .value = "SPACE",
             .text = "Space of seeds and targets: world or index [world]",
             .reads = choice(o.space, kSpaces)},
            {.names = {"--snap"},
             .value = "D",
             .text = "How far a seed or target may be from the surface, world units [the "
                     "half-width of the level set; mesh and points: 3 voxels]",
             .reads = numberFromZero(o.snap)},
            {.names = {"--skip-off-surface"},
             .text = "Targets and pairs farther from the surface than --snap have no distance and "
                     "a reason in tables, in place of ending the run",
             .reads = flag(o.skipOffSurface)},
            {.names = {"--sample"},
             .value = "K",
             .text = "Add K seeds, each as far from all others as possible",
             .reads = wholeNumber(o.sample, 1, 1000000)},
            {.names = {"--stop-at-targets"},
             .text = "Stop once all targets are reached",
             .reads = flag(o.stopAtTargets)},
            {.names = {"--max-distance"},
             .value = "D",
             .text = "Stop beyond this distance, world units times weight",
             .reads = numberAboveZero(o.maxDistance)}};
}

std::vector<Option> pairAndShotOptions(SeedOptions& o) {
    return {{.names = {"--pairs"},
             .value = "FILE",
             .text = "Distances between pairs of points; from a .json or .csv "
                     "file of x,y,z,x,y,z; needs no seed",
             .reads = text(o.pairs)},
            {.names = {"--shoot"},
             .value = "X,Y,Z,DX,DY,DZ,L",
             .text = "A geodesic from a point in a direction for a length, world "
                     "units or, with --space index, voxels; for "
                     "--paths and --image; needs no seed; repeatable",
             .reads = parsedEach(o.shots, shotOf)},
            {.names = {"--via"},
             .value = "POINTS|FILE",
             .text = "A geodesic through points in order: \"X,Y,Z X,Y,Z ...\" or a .json or .csv "
                     "file; the first point again at the end closes it; it turns at the points, "
                     "but with --straighten; for --paths and --image; needs no seed; repeatable",
             .reads = parsedEach(o.vias, viaOf)}};
}

}  // namespace

void addSeedOptions(Command& command, SeedOptions& o) {
    const char* const group = "Seeds and targets";
    command.add(group, seedOptions(o));
    command.add(group, targetOptions(o));
    command.add(group, pairAndShotOptions(o));
}
