#include "options/metric_options.h"

#include <igeo/io/point_list.h>

#include <algorithm>
#include <numbers>
#include <sstream>

#include "options/command.h"

namespace {

const Names<igeo::CurvatureKind> kCurvatureKinds{{"valley", igeo::CurvatureKind::Valley},
                                                 {"crest", igeo::CurvatureKind::Crest},
                                                 {"mean", igeo::CurvatureKind::Mean},
                                                 {"gaussian", igeo::CurvatureKind::Gaussian},
                                                 {"principal", igeo::CurvatureKind::Principal}};
const Names<igeo::Bending> kBendings{{"avoid", igeo::Bending::Avoid},
                                     {"prefer", igeo::Bending::Prefer}};

/// The positive number after "key=" in a word.
std::optional<double> valueOf(const std::string& key, const std::string& word) {
    if (word.rfind(key + "=", 0) != 0) return std::nullopt;
    const std::vector<double> number = igeo::parseNumbers(word.substr(key.size() + 1));
    if (number.size() != 1 || !(number[0] > 0)) return std::nullopt;
    return number[0];
}

Given<igeo::CurvatureWeight> curvatureWeightOf(const std::string& word) {
    std::stringstream parts(word);
    std::string part;
    std::getline(parts, part, ',');
    igeo::CurvatureWeight weight;
    weight.kind = valueNamed(part, kCurvatureKinds);
    while (std::getline(parts, part, ',')) {
        if (const auto epsilon = valueOf("eps", part))
            weight.epsilon = *epsilon;
        else if (const auto power = valueOf("p", part))
            weight.power = *power;
        else
            usageError("'" + part + "' is neither eps=E nor p=P, both above 0",
                       "write for instance valley,eps=100,p=3");
    }
    return {weight, word};
}

Given<igeo::BendingCost> bendingCostOf(const std::string& word) {
    const auto comma = word.find(',');
    igeo::BendingCost cost{valueNamed(word.substr(0, comma), kBendings)};
    if (comma == std::string::npos) return {cost, word};
    const auto length = valueOf("length", word.substr(comma + 1));
    if (!length)
        usageError("'" + word + "' has no length=L above 0 behind its comma",
                   "write for instance avoid,length=0.5");
    cost.length = *length;
    return {cost, word};
}

/// 30deg in radians.
double angleOf(const std::string& text, const std::string& word) {
    const bool hasUnit = text.ends_with("deg");
    const auto degrees = numberOf(hasUnit ? text.substr(0, text.size() - 3) : text);
    if (!degrees || !(*degrees > 0 && *degrees < 90))
        usageError("'" + word + "' has an angle that is not above 0 and below 90 degrees",
                   "write for instance max=30deg");
    return *degrees * std::numbers::pi / 180;
}

Given<igeo::SlopeWeight> slopeWeightOf(const std::string& word) {
    static const Names<igeo::Vec3d> kAxes{{"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"z", {0, 0, 1}}};
    igeo::SlopeWeight slope;
    bool hasMost = false;
    std::stringstream parts(word);
    for (std::string part; std::getline(parts, part, ',');) {
        if (part.starts_with("up="))
            slope.up = valueNamed(part.substr(3), kAxes);
        else if (part.starts_with("max="))
            slope.steepest = angleOf(part.substr(4), word), hasMost = true;
        else if (const auto power = valueOf("power", part))
            slope.power = *power;
        else
            usageError("'" + part + "' is none of up=AXIS, max=ANGLE and power=P above 0",
                       "write for instance up=z,max=30deg,power=2");
    }
    if (!hasMost)
        usageError("'" + word + "' does not say which slopes are too steep",
                   "write for instance up=z,max=30deg,power=2");
    return {slope, word};
}

/// Parses `count` numbers.
std::vector<double> numbersOf(const std::string& word, std::size_t count, const char* shape) {
    std::vector<double> v = igeo::parseNumbers(word);
    if (v.size() != count)
        usageError("'" + word + "' is not " + shape,
                   "write " + std::to_string(count) + " finite numbers with commas between them");
    return v;
}

ObstacleSphere sphereOf(const std::string& word) {
    const std::vector<double> v = numbersOf(word, 4, "x,y,z,r");
    if (!(v[3] > 0)) usageError("the radius of '" + word + "' is not above 0", "give a larger one");
    return {{v[0], v[1], v[2]}, v[3], word};
}

ObstacleBox boxOf(const std::string& word) {
    const std::vector<double> v = numbersOf(word, 6, "two corners x,y,z,x,y,z");
    return {{std::min(v[0], v[3]), std::min(v[1], v[4]), std::min(v[2], v[5])},
            {std::max(v[0], v[3]), std::max(v[1], v[4]), std::max(v[2], v[5])},
            word};
}

Reader curvatureWeight(std::optional<Given<igeo::CurvatureWeight>>& field) {
    Reader reader = parsed(field, curvatureWeightOf);
    reader.choices = namesIn(kCurvatureKinds);
    return reader;
}

Reader bendingCost(std::optional<Given<igeo::BendingCost>>& field) {
    Reader reader = parsed(field, bendingCostOf);
    reader.choices = namesIn(kBendings);
    return reader;
}

std::vector<Option> costOptions(MetricOptions& o) {
    return {{.names = {"--weight"},
             .value = "FILE[:GRID]",
             .text = "Cost per unit length: a positive float grid of its own resolution, sampled "
                     "on the surface; or values at the vertices of --mesh (.gii .csv .txt .npy, "
                     "FreeSurfer); several multiply",
             .reads = parsedEach(o.weights, igeo::parseGridSource)},
            {.names = {"--weight-curvature"},
             .value = "KIND[,eps=E][,p=P]",
             .text = "Cost from curvature: cheap in a valley, along a crest, or where mean, "
                     "gaussian or principal curvature is small [eps=100,p=3]",
             .reads = curvatureWeight(o.weightCurvature)},
            {.names = {"--weight-slope"},
             .value = "[up=AXIS,]max=ANGLE[,power=P]",
             .text = "Cost of slopes, for terrain: 1 on the flat, 2 at an angle of max degrees, "
                     "an obstacle where it is steeper [up=z,power=2]",
             .reads = parsed(o.weightSlope, slopeWeightOf)},
            {.names = {"--curvature-scale"},
             .value = "N",
             .text = "Radius over which curvature is averaged, voxels, 1 to 16 [2]",
             .reads = numberAboveZero(o.curvatureScale)},
            {.names = {"--metric-curvature"},
             .value = "avoid|prefer[,length=L]",
             .text = "Cost by direction: avoid bending with the surface, or prefer it; L is the "
                     "radius where the cost is sqrt(2), world units [length: 10 voxels]",
             .reads = bendingCost(o.metricCurvature)},
            {.names = {"--metric"},
             .value = "FILE[:PREFIX]",
             .text = "A tensor G, cost sqrt(G[v, v]) of a step v, in world axes: vector grids "
                     "PREFIXdiagonal (xx, yy, zz) and PREFIXoffdiagonal (xy, xz, yz)",
             .reads = parsed(o.metric, igeo::parseGridSource),
             .excludes = {"--metric-curvature"}}};
}

std::vector<Option> obstacleOptions(MetricOptions& o) {
    return {
        {.names = {"--obstacle"},
         .value = "FILE[:GRID]",
         .text = "What blocks paths: a mask (active voxels), a level set (inside) or a fog volume "
                 "(above 0.5); or vertices of --mesh, whose value in FILE (.gii .csv .txt .npy "
                 ".label, FreeSurfer) is not 0, or is V in FILE:V",
         .reads = parsedEach(o.obstacles, igeo::parseGridSource)},
        {.names = {"--obstacle-sphere"},
         .value = "X,Y,Z,R",
         .text = "A ball that blocks paths; repeatable",
         .reads = parsedEach(o.obstacleSpheres, sphereOf)},
        {.names = {"--obstacle-box"},
         .value = "X,Y,Z,X,Y,Z",
         .text = "A box that blocks paths, given by two opposite corners; repeatable",
         .reads = parsedEach(o.obstacleBoxes, boxOf)}};
}

}  // namespace

void addMetricOptions(Command& command, MetricOptions& o) {
    command.add("Metric", costOptions(o));
    command.add("Metric", obstacleOptions(o));
}
