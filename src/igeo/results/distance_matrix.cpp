#include <igeo/results/distance_matrix.h>

#include <fmt/core.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/jet.h>
#include <igeo/results/detail/column_name.h>
#include <igeo/results/detail/npy.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <limits>
#include <span>

namespace igeo {

void makeSymmetric(DistanceMatrix& m) {
    const std::size_t n = m.seeds.size();
    m.asymmetry = 0;
    m.oneWay = 0;
    for (std::size_t i = 0; i < n; ++i) {
        m.distance[i * n + i] = 0;
        for (std::size_t j = 0; j < i; ++j) {
            double &a = m.distance[i * n + j], &b = m.distance[j * n + i];
            if (a < kInfinity && b < kInfinity) {
                const double mean = (a + b) / 2;
                if (mean > 0) m.asymmetry = std::max(m.asymmetry, std::abs(a - b) / mean);
                a = b = mean;
            } else {
                m.oneWay += (a < kInfinity && b == kInfinity) || (b < kInfinity && a == kInfinity);
                a = b = std::min(a, b);
            }
        }
    }
}

std::string oneWayWarning(const DistanceMatrix& m) {
    if (m.oneWay == 0) return "";
    const std::size_t n = m.seeds.size();
    return fmt::format(
        "{} of {} pairs of seeds have a path in one direction only, and the matrix has its length: "
        "something between them is about as narrow as voxels; use smaller voxels",
        m.oneWay, n * (n - 1) / 2);
}

namespace {

using Group = std::vector<SurfacePoint>;

std::vector<Group> groupsOf(const std::vector<SurfacePoint>& points) {
    std::vector<Group> groups;
    for (const SurfacePoint& p : points) {
        if (!p.joined || groups.empty()) groups.emplace_back();
        groups.back().push_back(p);
    }
    return groups;
}

std::vector<MatrixPlace> placesOf(const std::vector<Group>& groups, const Similarity& transform) {
    std::vector<MatrixPlace> places;
    for (const Group& group : groups)
        places.push_back({"", inWorld(group.front(), transform), group.size()});
    return places;
}

std::vector<SurfacePoint> onSurface(const std::vector<Group>& groups) {
    std::vector<SurfacePoint> points;
    for (const Group& group : groups)
        std::copy_if(group.begin(), group.end(), std::back_inserter(points),
                     [](const SurfacePoint& p) { return !p.offSurface; });
    return points;
}

/// Where rows are read: the points of all groups that are on the surface.
class RowReader {
public:
    RowReader(const Band& band, const std::vector<Group>& groups)
        : points_(band, onSurface(groups)) {
        for (const Group& group : groups)
            first_.push_back(first_.back() + onSurface({group}).size());
    }

    /// The distance to the point of each group that the front reaches first; NaN where the group is
    /// off the surface.
    void read(const Field& field, std::span<double> to) const {
        const std::vector<Arrival> arrival = points_.read(field);
        for (std::size_t t = 0; t < to.size(); ++t) {
            to[t] =
                first_[t] == first_[t + 1] ? std::numeric_limits<double>::quiet_NaN() : kInfinity;
            for (std::size_t k = first_[t]; k < first_[t + 1]; ++k)
                to[t] = std::min(to[t], arrival[k].distance);
        }
    }

private:
    SharedPoints points_;
    std::vector<std::size_t> first_{0};  ///< per group, its first point; one entry more
};

}  // namespace

DistanceMatrix distanceRows(const Band& band, const MetricPtr& metric,
                            const std::vector<SurfacePoint>& seeds,
                            const std::vector<SurfacePoint>& targets, std::size_t firstRow,
                            std::size_t endRow, Progress& progress) {
    if (seeds.empty())
        throw Error(Error::Kind::InvalidArgument, "a distance matrix needs at least one seed");
    const std::vector<SurfacePoint>& ends = targets.empty() ? seeds : targets;
    const std::vector<Group> from = groupsOf(seeds), to = groupsOf(ends);
    DistanceMatrix m{placesOf(from, band.transform), placesOf(to, band.transform), firstRow, {}, 0};
    if (targets.empty()) m.asymmetry = std::numeric_limits<double>::quiet_NaN();
    const std::size_t rows = endRow - firstRow, columns = to.size();
    m.distance.resize(rows * columns);
    // Stopping early at many targets takes longer than marching past them.
    constexpr std::size_t kNodesPerTarget = 16;
    JetOptions options;
    if (ends.size() * kNodesPerTarget < band.coreSize())
        options.stopAt = coreAround(band, onSurface(to));
    options.extend = false;
    const RowReader reader(band, to);
    const JetCorePtr core = jetCore(band, metric);
    CancelOnly quiet(progress);
    Steps steps(progress, "matrix", rows);
    parallelFor(rows, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            Group group = from[firstRow + k];
            for (SurfacePoint& seed : group) seed.start = 0;
            const Field field = marchJet(core, group, options, quiet);
            const std::span row(&m.distance[k * columns], columns);
            reader.read(field, row);
            // Converted here, so that rows read back from files have the same bits.
            for (double& d : row) d *= band.transform.dx;
            steps.add(1);
        }
    });
    return m;
}

DistanceMatrix distances(const Band& band, const MetricPtr& metric,
                         const std::vector<SurfacePoint>& seeds,
                         const std::vector<SurfacePoint>& targets, Progress& progress) {
    const std::size_t rows = sourcesOf(seeds).empty() ? 0 : sourcesOf(seeds).back() + 1;
    DistanceMatrix m = distanceRows(band, metric, seeds, targets, 0, rows, progress);
    if (targets.empty()) makeSymmetric(m);
    return m;
}

std::string skippedReason(const SnappedPoint& point) {
    if (!point.offSurface) return "";
    return point.distance < kInfinity ? fmt::format("{:.6g} from the surface", point.distance)
                                      : "off the surface";
}

std::string matrixCsv(const DistanceMatrix& m) {
    std::string text = "target,x,y,z";
    const std::size_t endRow = m.firstRow + m.rows();
    std::vector<std::string> names;
    for (const MatrixPlace& seed : m.seeds) names.push_back(seed.name);
    names = distanceColumns(names);
    for (std::size_t s = m.firstRow; s < endRow; ++s) text += "," + names[s];
    text += m.withReasons ? ",reason\n" : "\n";
    for (std::size_t t = 0; t < m.targets.size(); ++t) {
        const MatrixPlace& target = m.targets[t];
        text += target.name.empty() ? std::to_string(t) : plainName(target.name);
        if (target.point.offSurface) {
            text += std::string(3 + m.rows(), ',') + "," + skippedReason(target.point) + "\n";
            continue;
        }
        const Vec3d& p = target.point.position;
        text += target.isGroup() ? ",nan,nan,nan" : fmt::format(",{},{},{}", p.x, p.y, p.z);
        for (std::size_t s = m.firstRow; s < endRow; ++s) text += fmt::format(",{}", m.at(s, t));
        text += m.withReasons ? ",\n" : "\n";
    }
    return text;
}

std::string matrixNpy(const DistanceMatrix& m) {
    return npy(m.distance, fmt::format("({}, {})", m.rows(), m.targets.size()));
}

}  // namespace igeo
