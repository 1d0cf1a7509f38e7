#include "metric_input.h"

#include <igeo/io/point_list.h>

#include <map>
#include <sstream>

#include "guarded_read.h"
#include "usage_error.h"

namespace {

using igeo::Vec3d;

/// `count` numbers of an option.
std::vector<double> numbersOf(const char* option, const std::string& given, std::size_t count,
                              const char* shape) {
    std::vector<double> v = igeo::parseNumbers(given);
    if (v.size() != count)
        usageError(std::string(option) + ": '" + given + "' is not " + shape,
                   "write " + std::to_string(count) + " finite numbers with commas between them");
    return v;
}

}  // namespace

MetricInput::CurvatureWeight MetricInput::parseCurvature(const std::string& given) {
    using Kind = igeo::CurvatureKind;
    static const std::map<std::string, Kind> kinds{{"valley", Kind::Valley},
                                                   {"crest", Kind::Crest},
                                                   {"mean", Kind::Mean},
                                                   {"gaussian", Kind::Gaussian},
                                                   {"principal", Kind::Principal}};
    CurvatureWeight weight;
    std::stringstream parts(given);
    std::string part;
    std::getline(parts, part, ',');
    const auto kind = kinds.find(part);
    if (kind == kinds.end())
        usageError("--weight-curvature: '" + part + "' is no kind of curvature",
                   "use valley, crest, mean, gaussian or principal");
    weight.kind = kind->second;
    while (std::getline(parts, part, ',')) {
        const auto equals = part.find('=');
        const std::string key = part.substr(0, equals);
        double* const value = key == "eps" ? &weight.epsilon : key == "p" ? &weight.power : nullptr;
        const std::vector<double> number = equals == std::string::npos
                                               ? std::vector<double>()
                                               : igeo::parseNumbers(part.substr(equals + 1));
        if (!value || number.size() != 1 || !(number[0] > 0))
            usageError("--weight-curvature: '" + part + "' is neither eps=E nor p=P, both above 0",
                       "write for instance valley,eps=100,p=3");
        *value = number[0];
    }
    return weight;
}

MetricInput::BendingCost MetricInput::parseBending(const std::string& given, double dx) {
    const auto comma = given.find(',');
    const std::string kind = given.substr(0, comma);
    BendingCost cost{igeo::Bending::Avoid, igeo::kCurvatureUnit};
    if (kind == "prefer") cost.bending = igeo::Bending::Prefer;
    std::vector<double> length{cost.length * dx};
    if (comma != std::string::npos)
        length = given.compare(comma + 1, 7, "length=") == 0
                     ? igeo::parseNumbers(given.substr(comma + 8))
                     : std::vector<double>();
    if ((kind != "avoid" && kind != "prefer") || length.size() != 1 || !(length[0] > 0))
        usageError("--metric-curvature: '" + given +
                       "' is neither avoid nor prefer, with or "
                       "without a length above 0",
                   "write for instance avoid,length=0.5");
    cost.length = length[0] / dx;
    return cost;
}

void MetricInput::readObstacles(const igeo::Similarity& transform) {
    if (options_.obstacles.empty() && options_.obstacleSpheres.empty() &&
        options_.obstacleBoxes.empty())
        return;
    obstacles_ = std::make_shared<igeo::ObstacleSet>(transform);
    for (const std::string& given : options_.obstacleSpheres) {
        const auto v = numbersOf("--obstacle-sphere", given, 4, "x,y,z,r");
        if (!(v[3] > 0))
            usageError("--obstacle-sphere " + given + ": the radius is not above 0",
                       "give a larger radius");
        obstacles_->addSphere({v[0], v[1], v[2]}, v[3]);
        obstacleNames_.push_back("sphere " + given);
    }
    for (const std::string& given : options_.obstacleBoxes) {
        const auto v = numbersOf("--obstacle-box", given, 6, "two corners x,y,z,x,y,z");
        Vec3d low, high;
        for (int a = 0; a < 3; ++a) {
            const auto k = std::size_t(a);
            low[a] = std::min(v[k], v[k + 3]), high[a] = std::max(v[k], v[k + 3]);
        }
        obstacles_->addBox(low, high);
        obstacleNames_.push_back("box " + given);
    }
    for (const std::string& given : options_.obstacles) {
        const igeo::GridSource source = igeo::parseGridSource(given);
        const igeo::ObstacleGrid grid =
            guardedRead(source.file, [&] { return igeo::readObstacleGrid(source); });
        obstacles_->addGrid(grid);
        warn(grid.warnings);
        obstacleNames_.push_back(given);
    }
}

void MetricInput::read(const igeo::Similarity& transform) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (isRead_) return;
    readAll(transform);
    isRead_ = true;
}

void MetricInput::readAll(const igeo::Similarity& transform) {
    if (options_.curvatureScale > 0) curvatureScale_ = options_.curvatureScale;
    for (const std::string& given : options_.weights) {
        const igeo::GridSource source = igeo::parseGridSource(given);
        weights_.push_back(guardedRead(source.file, [&] { return igeo::readScalarGrid(source); }));
        leastWeight_ *= igeo::leastWeight(weights_.back());
        warn(weights_.back().warnings);
        weightNames_.push_back(given);
    }
    if (!options_.weightCurvature.empty()) {
        curvature_ = parseCurvature(options_.weightCurvature);
        leastWeight_ *= curvature_->epsilon;
        weightNames_.push_back("curvature " + options_.weightCurvature);
    }
    if (!options_.metricCurvature.empty()) {
        bending_ = parseBending(options_.metricCurvature, transform.dx);
        weightNames_.push_back("bending " + options_.metricCurvature);
    }
    if (!options_.metric.empty()) {
        const igeo::GridSource source = igeo::parseGridSource(options_.metric);
        tensor_ = guardedRead(source.file, [&] { return igeo::readTensorGrids(source); });
        warn(tensor_->warnings);
        weightNames_.push_back("tensor " + options_.metric);
    }
    readObstacles(transform);
}

igeo::MetricPtr MetricInput::on(const igeo::Band& band, igeo::Progress& progress) const {
    if (weights_.empty() && !curvature_ && !tensor_ && !bending_ && !obstacles_) return nullptr;
    auto metric = std::make_shared<igeo::Metric>();
    if (tensor_) metric->tensor = igeo::sampleTensor(*tensor_, band, progress);
    if (bending_)
        metric->tensor = igeo::curvatureTensor(band, curvatureOf(band, progress), bending_->bending,
                                               bending_->length);
    for (const igeo::LoadedGrid& grid : weights_)
        metric->multiply(igeo::sampleWeight(grid, band, progress));
    if (curvature_)
        metric->multiply(igeo::curvatureWeights(curvatureOf(band, progress), curvature_->kind,
                                                curvature_->epsilon, curvature_->power));
    metric->setObstacles(band, obstacles_);
    return metric;
}

igeo::MetricPtr MetricInput::onWhole(const igeo::Band& band, igeo::Progress& progress) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!onWhole_) onWhole_ = on(band, progress);
    return *onWhole_;
}
