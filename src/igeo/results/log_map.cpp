#include <igeo/results/log_map.h>

#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_neighbors.h>

#include <algorithm>
#include <array>
#include <optional>

namespace igeo {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

float cross(Vec2f a, Vec2f b) { return a.x * b.y - a.y * b.x; }
Vec2f normalized(Vec2f v) {
    const float len = length(v);
    return len > 0 ? (1 / len) * v : v;
}
Vec2f turned(Vec2f v, float angle) {
    if (angle == 0) return v;
    const float c = std::cos(angle), s = std::sin(angle);
    return {c * v.x - s * v.y, s * v.x + c * v.y};
}

/// A frame that is parallel along the geodesic to a node; stores its first axis.
struct Carried {
    Vec3f axis;  ///< 0: not known
    /// Rotation of the frames, counterclockwise, per length (times weight) along the front to the
    /// left
    float turn = 0;
    Vec3f logGradient;  ///< of the weight
    bool known() const { return !(axis == Vec3f{}); }
};

/// The direction at the seed of the geodesic to a node.
struct Departure {
    Vec2f direction;  ///< unit; 0: unknown
    float slope = 0;  ///< of its angle, per length as above
};

/// A node's tangent plane, the direction of its geodesic there, and the weight's slope.
struct Chart {
    TangentFrame frame;
    Vec2f direction;
    Vec3f logGradient;
};

/// A neighbor in that chart, and the chord from it to the node.
struct FrontNeighbor {
    NodeIndex core;
    float weight;  ///< for fits: larger for nearer neighbors
    Vec2f vector;  ///< the chord in the chart, times the weight
    float along;   ///< its component along the neighbor's geodesic
    float left;    ///< its component to the left
    Vec3f chord;   ///< in space, voxels
};

/// The neighbors that one front reached.
class FrontNeighbors {
public:
    void add(const FrontNeighbor& n) {
        if (count_ < int(all_.size())) all_[std::size_t(count_++)] = n;
    }
    const FrontNeighbor* begin() const { return all_.data(); }
    const FrontNeighbor* end() const { return all_.data() + count_; }

private:
    std::array<FrontNeighbor, 27> all_;
    int count_ = 0;
};

/// Least squares for y = at + slope x.
struct LineFit {
    float s0 = 0, sx = 0, sxx = 0, b0 = 0, bx = 0;
    void add(float w, float x, float y) {
        s0 += w, sx += w * x, sxx += w * x * x;
        b0 += w * y, bx += w * x * y;
    }
    /// @param pull toward slopeGuess, as a weight relative to the sum of all others
    void solve(float pull, float slopeGuess, float& at, float& slope) const {
        const float xx = sxx + pull * s0, x = bx + pull * s0 * slopeGuess;
        const float det = s0 * xx - sx * sx;
        at = (xx * b0 - sx * x) / det;
        slope = (s0 * x - sx * b0) / det;
    }
};

class LogMapper {
public:
    LogMapper(const Field& field, const std::vector<LogMap::Frame>& frames)
        : band_(*field.band), field_(field), frames_(frames), carried_(band_.coreSize()) {
        for (std::size_t k = 0; k < band_.size(); ++k)
            if (band_.inCore(NodeIndex(k))) nodes_.push_back(NodeIndex(k));
    }
    std::vector<Vec2f> map(Progress& progress);

private:
    std::uint32_t label(NodeIndex i) const { return field_.label.empty() ? 0 : field_.label[i]; }
    double distance(NodeIndex i) const { return field_.distance[i] - field_.seeds[label(i)].start; }
    Vec3f logGradient(NodeIndex i) const;
    Chart chart(NodeIndex i) const {
        const TangentFrame frame(band_.normal[i], band_.faceted);
        return {frame, frame.flat(normalized(field_.gradient[i])), logGradient(i)};
    }

    bool carryFromSeed(NodeIndex i, const Chart& here, Carried& out) const;
    void addNeighbor(NodeIndex i, const Chart& here, NodeIndex core, FrontNeighbors& all) const;
    FrontNeighbors neighbors(NodeIndex i, const Chart& here) const;
    void carry(NodeIndex i);
    Departure measure(NodeIndex i, const Carried& frame) const;
    Departure smooth(NodeIndex i) const;
    Vec2f interpolate(NodeIndex i) const;
    Vec2f position(NodeIndex i) const;

    const Band& band_;
    const Field& field_;
    const std::vector<LogMap::Frame>& frames_;
    // By core number:
    std::vector<NodeIndex> nodes_;  ///< the band's number
    std::vector<Carried> carried_;
    std::vector<Departure> measured_, departures_;
};

Vec3f LogMapper::logGradient(NodeIndex i) const {
    const Metric& metric = *field_.metric;
    if (!metric.weighted()) return {};
    const TangentFrame frame(band_.normal[i], band_.faceted);
    float xx = 1e-6f, xy = 0, yy = 1e-6f;
    Vec2f right;
    band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        if (dot(band_.normal[i], band_.normal[j]) < 0.5f) return;
        const Vec2f a = frame.flat(Vec3f(band_.footPoint(j) - band_.footPoint(i)));
        const auto rise = float(std::log(metric.at(j) / metric.at(i)));
        xx += a.x * a.x, xy += a.x * a.y, yy += a.y * a.y;
        right = right + rise * a;
    });
    const float det = xx * yy - xy * xy;
    return frame.lift((1 / det) * Vec2f{yy * right.x - xy * right.y, xx * right.y - xy * right.x});
}

/// The axis of a frame at the other end of a chord, transported along it.
Vec2f carriedAxis(const Chart& here, const Vec3f& chord, const Vec3f& normal,
                  const Carried& there) {
    const float cosine = igeo::dot(here.frame.normal(), normal);
    const JetNeighbor n = flattened(here.frame, chord, normal, cosine, there.axis, 0);
    const Vec2f slope = here.frame.flat(here.logGradient + there.logGradient);
    return turned(n.g, cross(n.a, slope) / 2);
}

/// Near the seed: the seed's frame, transported along the chord.
bool LogMapper::carryFromSeed(NodeIndex i, const Chart& here, Carried& out) const {
    const std::uint32_t k = label(i);
    const SurfacePoint& seed = field_.seeds[k];
    const Vec3f chord(band_.footPoint(i) - seed.pIndex);
    const Vec3f normal(igeo::cross(frames_[k].u, frames_[k].v));
    // The distance separates the seed's sheet from one close to it.
    if (length(chord) > float(field_.startRadius) ||
        distance(i) > 1.5 * field_.startRadius * seed.weight ||
        igeo::dot(normal, here.frame.normal()) < 0)
        return false;
    Carried there;
    there.axis = Vec3f(frames_[k].u);
    there.logGradient = here.logGradient;
    out.axis = here.frame.lift(carriedAxis(here, chord, normal, there));
    return true;
}

void LogMapper::addNeighbor(NodeIndex i, const Chart& here, NodeIndex core,
                            FrontNeighbors& all) const {
    const Carried& there = carried_[core];
    const NodeIndex j = nodes_[core];
    const Vec3f normal = band_.normal[j];
    const float cosine = igeo::dot(here.frame.normal(), normal);
    if (!there.known() || label(j) != label(i) || cosine < Band::kOtherSheet || !band_.joined(i, j))
        return;
    const Vec3f chord(band_.footPoint(i) - band_.footPoint(j));
    const JetNeighbor n =
        flattened(here.frame, chord, normal, cosine, normalized(field_.gradient[j]), 0);
    // Geodesics of another front have frames of their own.
    if (igeo::dot(n.g, here.direction) < jet::kSameFront) return;
    const Metric& metric = *field_.metric;
    const Vec2f v = float((metric.at(i) + metric.at(j)) / 2) * n.a;
    all.add({core, 1 / (dot(n.a, n.a) + 0.1f), v, dot(n.g, v), cross(n.g, v), chord});
}

FrontNeighbors LogMapper::neighbors(NodeIndex i, const Chart& here) const {
    FrontNeighbors all;
    band_.forNeighbors(&BandLeaf::core, i,
                       [&](NodeIndex core, int, int, int) { addNeighbor(i, here, core, all); });
    return all;
}

/// The frame at a core node, from those of nodes with smaller distances.
void LogMapper::carry(NodeIndex i) {
    constexpr float kPull = 0.005f;
    const Chart here = chart(i);
    Carried& out = carried_[band_.coreNode(i)];
    Carried result;
    if (!carryFromSeed(i, here, result)) {
        // Angles are relative to the axis of one of them.
        Vec2f from;
        LineFit fit;
        float turn = 0;
        for (const FrontNeighbor& n : neighbors(i, here)) {
            const float along = dot(here.direction, n.vector);
            if (!(along > 0)) continue;
            const Carried& there = carried_[n.core];
            const Vec2f axis = carriedAxis(here, n.chord, band_.normal[nodes_[n.core]], there);
            if (fit.s0 == 0) from = axis;
            const float w = along * along / dot(n.vector, n.vector) * n.weight;
            const float angle = std::atan2(cross(from, axis), dot(from, axis));
            fit.add(w, -cross(here.direction, n.vector) / 2, angle + there.turn * n.left / 2);
            turn += w * there.turn;
        }
        if (!(fit.s0 > 0)) return;
        float angle;
        fit.solve(kPull, turn / fit.s0, angle, result.turn);
        result.axis = here.frame.lift(normalized(turned(from, angle)));
    }
    out = result;
    out.logGradient = here.logGradient;
}

/// The angle between geodesic and frame, which is constant along the geodesic.
Departure LogMapper::measure(NodeIndex i, const Carried& frame) const {
    const Vec3f g = normalized(field_.gradient[i]), n = band_.normal[i];
    const Vec2f direction{dot(frame.axis, g), igeo::dot(n, igeo::cross(frame.axis, g))};
    return {normalized(direction), float(1 / distance(i))};
}

/// Fits a line along the front to the angles of a core node and its neighbors; outliers get small
/// weights.
Departure LogMapper::smooth(NodeIndex i) const {
    constexpr int kRounds = 3;
    constexpr float kScatter = 0.002f, kPull = 0.01f;
    const NodeIndex core = band_.coreNode(i);
    const Departure own = measured_[core];
    const Chart here = chart(i);
    Carried carried;
    if (carryFromSeed(i, here, carried)) return own;
    struct Estimate {
        float weight, left, angle;
    };
    std::array<Estimate, 28> estimates;
    std::size_t count = 0;
    estimates[count++] = {1, 0, 0};
    for (const FrontNeighbor& n : neighbors(i, here)) {
        const Departure& there = measured_[n.core];
        const auto d = float(distance(nodes_[n.core]));
        // Laid flat around the seed, where geodesics are straight lines.
        const Vec2f at =
            (d + n.along) * there.direction + n.left * Vec2f{-there.direction.y, there.direction.x};
        estimates[count++] = {n.weight, -n.left,
                              std::atan2(cross(own.direction, at), dot(own.direction, at))};
    }
    float angle = 0, slope = 0;
    for (int round = 0; round < kRounds; ++round) {
        LineFit fit;
        for (std::size_t k = 0; k < count; ++k) {
            const float r = round == 0 ? 0 : estimates[k].angle - angle - slope * estimates[k].left;
            fit.add(estimates[k].weight / std::sqrt(kScatter * kScatter + r * r), estimates[k].left,
                    estimates[k].angle);
        }
        fit.solve(kPull, 0, angle, slope);
    }
    return {turned(own.direction, angle), float(1 / distance(i)) + slope};
}

/// Between core nodes: the mean of the nearest and of all that agree with it.
Vec2f LogMapper::interpolate(NodeIndex i) const {
    constexpr float kAgree = 0.98f;
    const Chart here = chart(i);
    if (Carried carried; carryFromSeed(i, here, carried)) return measure(i, carried).direction;
    FrontNeighbors all;
    const Vec3f f = band_.footOf(i);
    const Ijk low{floorToInt(f.x), floorToInt(f.y), floorToInt(f.z)};
    band_.forCorners(&BandLeaf::core, i, low,
                     [&](NodeIndex k, unsigned) { addNeighbor(i, here, k, all); });
    if (all.begin() == all.end()) all = neighbors(i, here);
    if (all.begin() == all.end()) return {};
    auto estimate = [&](const FrontNeighbor& n) {
        const Departure& there = departures_[n.core];
        const auto r = float(distance(nodes_[n.core]));
        return normalized((r + n.along) * there.direction +
                          r * there.slope * n.left * Vec2f{-there.direction.y, there.direction.x});
    };
    const Vec2f lead = estimate(*std::max_element(
        all.begin(), all.end(),
        [](const FrontNeighbor& a, const FrontNeighbor& b) { return a.weight < b.weight; }));
    Vec2f sum;
    for (const FrontNeighbor& n : all)
        if (const Vec2f v = estimate(n); dot(v, lead) > kAgree) sum = sum + n.weight * v;
    return normalized(sum);
}

Vec2f LogMapper::position(NodeIndex i) const {
    const double d = distance(i);
    if (!(d < kInfinity)) return {kUnknown, kUnknown};
    const NodeIndex core = band_.coreNode(i);
    const Vec2f v = core != kNoNode ? departures_[core].direction : interpolate(i);
    // At the seed itself there is no direction.
    if (d > 1e-6 && v.x == 0 && v.y == 0) return {kUnknown, kUnknown};
    return float(d) * v;
}

std::vector<Vec2f> LogMapper::map(Progress& progress) {
    progress.update("logmap", 0);
    std::vector<NodeIndex> order;
    for (const NodeIndex i : nodes_)
        if (field_.distance[i] < kInfinity) order.push_back(i);
    std::sort(order.begin(), order.end(), [&](NodeIndex a, NodeIndex b) {
        return std::pair(field_.distance[a], a) < std::pair(field_.distance[b], b);
    });
    constexpr std::size_t kAtOnce = 4096;
    Steps carrying(progress, "logmap", order.size(), 0.05, 0.6);
    for (std::size_t k = 0; k < order.size(); k += kAtOnce) {
        const std::size_t end = std::min(k + kAtOnce, order.size());
        for (std::size_t n = k; n < end; ++n) carry(order[n]);
        carrying.add(end - k);
        progress.throwIfCancelled();
    }
    auto forAll = [&](auto& out, double from, double to, const auto& value) {
        Steps steps(progress, "logmap", out.size(), from, to);
        parallelFor(out.size(), 1024, [&](std::size_t begin, std::size_t end) {
            if (steps.cancelled()) return;
            for (std::size_t k = begin; k < end; ++k) out[k] = value(NodeIndex(k));
            steps.add(end - begin);
        });
        progress.throwIfCancelled();
    };
    measured_.resize(nodes_.size());
    departures_.resize(nodes_.size());
    forAll(measured_, 0.6, 0.62, [&](NodeIndex k) {
        return carried_[k].known() ? measure(nodes_[k], carried_[k]) : Departure{};
    });
    forAll(departures_, 0.62, 0.85,
           [&](NodeIndex k) { return carried_[k].known() ? smooth(nodes_[k]) : Departure{}; });
    std::vector<Vec2f> positions(band_.size());
    forAll(positions, 0.85, 1, [&](NodeIndex i) { return position(i); });
    return positions;
}

LogMap::Frame frameAt(const Field& field, const SurfacePoint& seed, const Vec3d& reference) {
    const Band& band = *field.band;
    const Vec3d sheetNormal(band.normal[seed.node]);
    const Vec3d n = SurfaceCell(band, *field.metric, seed.pIndex, sheetNormal).normal;
    Vec3d u = tangential(reference, n);
    if (!(length(u) > 1e-6 * length(reference))) {
        int least = 0;
        for (int a = 1; a < 3; ++a)
            if (std::abs(n[a]) < std::abs(n[least])) least = a;
        Vec3d axis;
        axis[least] = 1;
        u = tangential(axis, n);
    }
    u = normalized(u);
    return {u, cross(n, u)};
}

}  // namespace

LogMap logMap(const Field& field, const Vec3d& reference, Progress& progress) {
    if (!field.atFootPoints || field.gradient.size() != field.distance.size())
        throw Error(Error::Kind::InvalidArgument,
                    "the logarithmic map needs a field that has a gradient at foot points",
                    "march with the scheme jet");
    if (field.metric->anisotropic())
        throw Error(Error::Kind::InvalidArgument,
                    "the logarithmic map is not known for tensor metrics",
                    "leave the tensor out, or use weights");
    for (const SurfacePoint& seed : field.seeds)
        if (seed.joined || seed.segment != Vec3d{})
            throw Error(
                Error::Kind::InvalidArgument,
                "the logarithmic map is known about points, and a seed is a curve, a region "
                "or a group",
                "give the seeds as points");
    LogMap map;
    for (const SurfacePoint& seed : field.seeds)
        map.frames.push_back(frameAt(field, seed, reference));
    map.position = LogMapper(field, map.frames).map(progress);
    if (field.band->transform.mirrors()) {
        for (LogMap::Frame& frame : map.frames) frame.v = -frame.v;
        for (Vec2f& at : map.position) at.y = -at.y;
    }
    return map;
}

Vec2f positionAt(const Field& field, const LogMap& map, const SurfacePoint& p) {
    constexpr Vec2f kNone{kUnknown, kUnknown};
    const Vec3d normal(field.band->normal[p.node]);
    const Arrival arrival = arrivalAt(field, p.pIndex, normal);
    if (!(arrival.distance < kInfinity)) return kNone;
    const SurfaceCell cell(*field.band, *field.metric, p.pIndex, normal);
    auto known = [&](std::size_t k, std::optional<std::uint32_t> source) {
        const NodeIndex i = cell.node[k];
        return i != kNoNode && cell.weight[k] > 0 && !std::isnan(map.position[i].x) &&
               (!source || field.label.empty() || field.label[i] == *source);
    };
    auto leadOf = [&](std::optional<std::uint32_t> wanted) {
        std::size_t lead = 8;
        for (std::size_t k = 0; k < 8; ++k)
            if (known(k, wanted) && (lead == 8 || cell.weight[k] > cell.weight[lead])) lead = k;
        return lead;
    };
    std::uint32_t source = arrival.source;
    std::size_t lead = leadOf(source);
    // Where two seeds are equally far, all nodes around may belong to the other.
    if (lead == 8) lead = leadOf({});
    if (lead == 8) return kNone;
    if (!field.label.empty()) source = field.label[cell.node[lead]];
    const double radius = arrival.distance - field.seeds[source].start;
    if (!(radius > 0)) return {0, 0};
    // Beyond the cut locus geodesics arrive from another side.
    constexpr double kNear = 4, kTurn = 0.5;  // voxels, radians
    const Vec2f first = map.position[cell.node[lead]];
    const double within = std::max(kNear * field.metric->largest(), kTurn * double(length(first)));
    Vec2f sum{};
    for (std::size_t k = 0; k < 8; ++k)
        if (known(k, source) && double(length(map.position[cell.node[k]] - first)) <= within)
            sum = sum + float(cell.weight[k]) * map.position[cell.node[k]];
    const float len = length(sum);
    return len > 0 ? float(radius) / len * sum : kNone;
}

}  // namespace igeo
