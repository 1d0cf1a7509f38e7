#include <igeo/results/log_map.h>

#include <igeo/band/tangent_frame.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/march/detail/jet_state.h>

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
float angleFrom(Vec2f a, Vec2f b) { return std::atan2(cross(a, b), dot(a, b)); }

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
    Vec2f direction;    ///< unit; 0: unknown
    float slope = 0;    ///< of its angle, per length (times weight) along the front to the left
    bool bent = false;  ///< the geodesic may bend, before the node or at it
    bool known() const { return direction.x != 0 || direction.y != 0; }
};

/// A node's tangent plane, the direction of its geodesic there, and the weight.
struct Chart {
    TangentFrame frame;
    Vec2f direction;
    double distance;
    float weight;
    Vec3f logGradient;
};

/// A neighbor in that chart: where its geodesic passes the node. Lengths are times the weight.
struct FrontNeighbor {
    NodeIndex core;
    float weight;        ///< for fits: larger for nearer neighbors
    Vec2f vector;        ///< the chord from it
    float ahead, aside;  ///< its parts along and to the left of its geodesic
    float along;         ///< the node is so far ahead of it, along both geodesics
    float left;          ///< so far to the left of the node its geodesic passes
    float rise;          ///< of the distance
    float slope;         ///< of its departure, to the left of the node's chart
    bool bends;          ///< the geodesics bend between the two
    Vec3f chord;         ///< in space, voxels
};

/// The neighbors that one front reached.
class FrontNeighbors {
public:
    void add(const FrontNeighbor& n) {
        if (count_ < all_.size()) all_[count_++] = n;
    }
    const FrontNeighbor* begin() const { return all_.data(); }
    const FrontNeighbor* end() const { return all_.data() + count_; }
    bool empty() const { return count_ == 0; }

private:
    std::array<FrontNeighbor, 40> all_;
    std::size_t count_ = 0;
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

/// A slope further along: it falls as geodesics spread.
float spread(float slope, float along) {
    constexpr float kLeast = 0.5f;
    return slope / std::max(kLeast, 1 + std::abs(slope) * along);
}

/// The angle between the departures of two geodesics that pass each other at a distance: exact
/// around a seed in the plane.
/// @param a, b  slopes of the two
float angleBetween(float left, float a, float b) {
    constexpr float kMost = 0.9f;
    const bool fan = a * b > 0 && std::abs(a) < 2 * std::abs(b) && std::abs(b) < 2 * std::abs(a);
    const float mean = fan ? 2 * a * b / (a + b) : (a + b) / 2;
    return 2 * std::asin(std::clamp(left * mean / 2, -kMost, kMost));
}

class LogMapper {
public:
    LogMapper(const Field& field, const std::vector<LogMap::Frame>& frames)
        : band_(*field.band),
          field_(field),
          metric_(*field.metric),
          core_(*field.jets->core),
          frames_(frames),
          carried_(core_.nodes.size()),
          measured_(core_.nodes.size()) {
        nodes_.reserve(core_.nodes.size());
        for (const JetNode& node : core_.nodes) nodes_.push_back(core_.inBand(node));
    }
    std::vector<Vec2f> map(Progress& progress);

private:
    std::uint32_t label(NodeIndex i) const { return field_.label.empty() ? 0 : field_.label[i]; }
    double distance(NodeIndex i) const { return field_.distance[i] - field_.seeds[label(i)].start; }
    float weight(NodeIndex i) const { return float(metric_.at(i)); }
    Vec3f logGradient(NodeIndex i) const;
    Chart chart(NodeIndex i) const {
        const TangentFrame frame(band_.normal[i], band_.faceted);
        return {frame, frame.flat(igeo::normalized(field_.gradient[i])), distance(i), weight(i),
                logGradient(i)};
    }

    bool carryFromSeed(NodeIndex i, const Chart& here, Carried& out) const;
    void addNeighbor(NodeIndex i, const Chart& here, NodeIndex core, const Vec3f& chord,
                     FrontNeighbors& all) const;
    FrontNeighbors neighbors(NodeIndex i, const Chart& here) const;
    bool mayBendAt(NodeIndex core) const;
    bool bendBefore(NodeIndex core, const FrontNeighbors& all) const;
    void carry(NodeIndex i);
    bool carryFrame(const Chart& here, const FrontNeighbors& all, Carried& out) const;
    Departure carryDeparture(const FrontNeighbors& all) const;
    Vec2f measure(NodeIndex i, const Carried& frame) const;
    Departure smooth(NodeIndex i) const;
    Vec2f interpolate(NodeIndex i) const;
    Vec2f position(NodeIndex i) const;

    const Band& band_;
    const Field& field_;
    const Metric& metric_;
    const JetCore& core_;
    const std::vector<LogMap::Frame>& frames_;
    // By core number:
    std::vector<NodeIndex> nodes_;  ///< the band's number
    std::vector<std::uint8_t> mayBend_;
    std::vector<Carried> carried_;
    std::vector<Departure> measured_, departures_;
};

Vec3f LogMapper::logGradient(NodeIndex i) const {
    if (!metric_.weighted()) return {};
    const TangentFrame frame(band_.normal[i], band_.faceted);
    float xx = 1e-6f, xy = 0, yy = 1e-6f;
    Vec2f right;
    band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        if (dot(band_.normal[i], band_.normal[j]) < 0.5f) return;
        const Vec2f a = frame.flat(Vec3f(band_.footPoint(j) - band_.footPoint(i)));
        const auto rise = float(std::log(metric_.at(j) / metric_.at(i)));
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
    constexpr double kLonger = 1.05, kSlack = 0.05;  // the latter voxels
    const std::uint32_t k = label(i);
    const SurfacePoint& seed = field_.seeds[k];
    const Vec3d foot = band_.footPoint(i);
    const Vec3f chord(foot - seed.pIndex);
    const Vec3f normal(igeo::cross(frames_[k].u, frames_[k].v));
    const float cosine = igeo::dot(normal, here.frame.normal());
    if (length(chord) > float(field_.startRadius) || cosine < 0) return false;
    // The front may have come another way: from a sheet close to the seed's, around a corner, or
    // over a jump of the weight.
    const double straight = double(length(here.frame.unfold(chord, normal, cosine)));
    if (here.distance >
        (kLonger * straight + kSlack) * meanFromSeed(band_, metric_, seed, foot, here.weight))
        return false;
    Carried there;
    there.axis = Vec3f(frames_[k].u);
    there.logGradient = here.logGradient;
    out.axis = here.frame.lift(carriedAxis(here, chord, normal, there));
    return true;
}

void LogMapper::addNeighbor(NodeIndex i, const Chart& here, NodeIndex core, const Vec3f& chord,
                            FrontNeighbors& all) const {
    constexpr float kOneWay = 0.9f, kEven = 1.3f;
    const NodeIndex j = nodes_[core], own = band_.coreNode(i);
    if (!measured_[core].known() || label(j) != label(i)) return;
    // Over the seam of a one-sided mesh normals oppose: seen from the other side, left is right.
    Vec3f normal = band_.normal[j];
    const bool isTurned = igeo::dot(here.frame.normal(), normal) < Band::kOtherSheet;
    if (isTurned) normal = -normal;
    const JetNeighbor n =
        flattened(here.frame, chord, normal, igeo::dot(here.frame.normal(), normal),
                  igeo::normalized(field_.gradient[j]), 0);
    const Vec2f g = normalized(n.g);
    const float there = weight(j), mean = (here.weight + there) / 2,
                cosine = dot(g, here.direction), size = length(n.a),
                rise = float(here.distance - distance(j)),
                slope = isTurned ? -measured_[core].slope : measured_[core].slope;
    FrontNeighbor found{core,
                        1 / (size * size + 0.1f),
                        mean * n.a,
                        mean * dot(g, n.a),
                        mean * cross(g, n.a),
                        0,
                        0,
                        rise,
                        slope,
                        false,
                        chord};
    const bool mayBend = mayBend_[core] || (own != kNoNode && mayBend_[own]);
    if (!mayBend && cosine < jet::kSameFront) return;
    const bool even = there < kEven * here.weight && here.weight < kEven * there;
    if (!mayBend || (even && cosine > kOneWay)) {
        const Vec2f way = normalized(g + here.direction);
        found.along = dot(way, found.vector), found.left = -cross(way, found.vector);
    } else {
        // The geodesic bends where the plane fronts at both ends agree, `back` from the node.
        constexpr float kBeyond = 0.2f;
        const float back = (rise - there * dot(g, n.a)) / (here.weight - there * cosine);
        const Vec2f before = n.a - back * here.direction;
        const float ahead = dot(g, before);
        if (!(rise > 0 && back > -kBeyond && back < size + kBeyond && ahead > -kBeyond)) return;
        found.along = std::max(rise, 0.1f * mean * size);
        found.left = -there * cross(g, before);
        found.bends = true;
    }
    all.add(found);
}

FrontNeighbors LogMapper::neighbors(NodeIndex i, const Chart& here) const {
    FrontNeighbors all;
    forLinks(core_, band_.coreNode(i), [&](NodeIndex core, const Ijk&, const Vec3f& chord, float) {
        addNeighbor(i, here, core, chord, all);
    });
    if (band_.facing[i] & Band::kBridged)
        forJumps(core_, band_.coreNode(i), [&](NodeIndex core, const Vec3f& chord) {
            addNeighbor(i, here, core, chord, all);
        });
    return all;
}

/// Whether geodesics may bend at a core node: beside a rim, an obstacle, a crease or a jump of the
/// weight.
bool LogMapper::mayBendAt(NodeIndex core) const {
    constexpr float kEven = 1.1f;
    const NodeIndex i = nodes_[core];
    bool bends = !metric_.clear(i) || (band_.facing[i] & Band::kBridged) ||
                 core_.rims.isBesideOpen(core_, core);
    if (!bends && metric_.weighted())
        band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            bends = bends || weight(j) > kEven * weight(i) || weight(i) > kEven * weight(j);
        });
    if (!bends)
        forLinks(core_, core, [&](NodeIndex, const Ijk&, const Vec3f&, float cosine) {
            bends = bends || cosine < JetLink::kSmooth;
        });
    return bends;
}

/// Whether geodesics to a core node bend, there or before.
bool LogMapper::bendBefore(NodeIndex core, const FrontNeighbors& all) const {
    constexpr float kShare = 0.1f;
    if (mayBend_[core]) return true;
    float bent = 0, sum = 0;
    for (const FrontNeighbor& n : all) {
        if (!(n.along > 0)) continue;
        const float w = n.weight * n.along * n.along / dot(n.vector, n.vector);
        sum += w;
        if (measured_[n.core].bent) bent += w;
    }
    return bent > kShare * sum;
}

/// The frame and the departure at a core node, from those of nodes with smaller distances.
void LogMapper::carry(NodeIndex i) {
    const Chart here = chart(i);
    const NodeIndex core = band_.coreNode(i);
    Carried frame;
    Departure found;
    if (carryFromSeed(i, here, frame)) {
        found = {measure(i, frame), float(1 / here.distance)};
    } else {
        const FrontNeighbors all = neighbors(i, here);
        found = carryDeparture(all);
        found.bent = bendBefore(core, all) || !carryFrame(here, all, frame);
        if (!found.bent && found.known()) found.direction = measure(i, frame);
    }
    if (!found.bent) {
        carried_[core] = frame;
        carried_[core].logGradient = here.logGradient;
    }
    measured_[core] = found;
}

bool LogMapper::carryFrame(const Chart& here, const FrontNeighbors& all, Carried& out) const {
    constexpr float kPull = 0.005f;
    // Angles are relative to the axis of one of them.
    Vec2f from;
    LineFit fit;
    float turn = 0;
    for (const FrontNeighbor& n : all) {
        const float along = dot(here.direction, n.vector);
        const Carried& there = carried_[n.core];
        if (!(along > 0) || n.bends || !there.known()) continue;
        const Vec2f axis = carriedAxis(here, n.chord, band_.normal[nodes_[n.core]], there);
        if (fit.s0 == 0) from = axis;
        const float w = along * along / dot(n.vector, n.vector) * n.weight;
        fit.add(w, -cross(here.direction, n.vector) / 2,
                angleFrom(from, axis) + there.turn * n.aside / 2);
        turn += w * there.turn;
    }
    if (!(fit.s0 > 0)) return false;
    float angle;
    fit.solve(kPull, turn / fit.s0, angle, out.turn);
    out.axis = here.frame.lift(normalized(turned(from, angle)));
    return true;
}

/// The departure is constant along geodesics.
Departure LogMapper::carryDeparture(const FrontNeighbors& all) const {
    constexpr float kPull = 0.005f;
    constexpr int kRounds = 3;
    auto weightOf = [](const FrontNeighbor& n) {
        return n.weight * n.along * n.along / (n.along * n.along + n.left * n.left);
    };
    Vec2f from;
    auto angleOf = [&](const FrontNeighbor& n) {
        return angleFrom(from, measured_[n.core].direction);
    };
    float sum = 0, guess = 0;
    for (const FrontNeighbor& n : all) {
        if (!(n.along > 0)) continue;
        if (sum == 0) from = measured_[n.core].direction;
        const float w = weightOf(n);
        sum += w, guess += w * (n.bends ? n.slope : spread(n.slope, n.rise));
    }
    if (!(sum > 0)) return {};
    guess /= sum;
    float angle = 0, slope = 0;
    for (int round = 0; round < kRounds; ++round) {
        LineFit fit;
        for (const FrontNeighbor& n : all) {
            if (!(n.along > 0)) continue;
            // Geodesics that spread as in the plane: b_ij = (2 / s_i - rise) sin(turn / 2).
            const float turn = angleOf(n) - angle, sine = std::sin(turn / 2);
            if (round == 0 || n.bends)
                fit.add(weightOf(n), n.left, turn);
            else
                fit.add(weightOf(n), n.left + n.rise * sine, 2 * sine);
        }
        float change;
        fit.solve(kPull, guess, change, slope);
        angle += change;
    }
    float off = 0;
    for (const FrontNeighbor& n : all)
        if (n.along > 0)
            off += weightOf(n) *
                   (angleOf(n) - angleBetween(n.left, n.slope, n.bends ? n.slope : slope));
    return {turned(from, off / sum), slope};
}

/// The angle between geodesic and frame, which is constant along the geodesic.
Vec2f LogMapper::measure(NodeIndex i, const Carried& frame) const {
    const Vec3f g = igeo::normalized(field_.gradient[i]), n = band_.normal[i];
    return normalized(Vec2f{dot(frame.axis, g), igeo::dot(n, igeo::cross(frame.axis, g))});
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
    std::array<Estimate, 41> estimates;
    std::size_t count = 0;
    estimates[count++] = {1, 0, 0};
    for (const FrontNeighbor& n : neighbors(i, here)) {
        const Departure& there = measured_[n.core];
        if (n.bends) continue;
        if (own.bent) {
            estimates[count++] = {n.weight, n.left,
                                  angleFrom(own.direction, there.direction) -
                                      angleBetween(n.left, n.slope, own.slope)};
            continue;
        }
        // Laid flat around the seed, where geodesics are straight lines.
        const auto d = float(distance(nodes_[n.core]));
        const Vec2f at = (d + n.ahead) * there.direction +
                         n.aside * Vec2f{-there.direction.y, there.direction.x};
        estimates[count++] = {n.weight, -n.aside, angleFrom(own.direction, at)};
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
    const float before = own.bent ? own.slope : float(1 / here.distance);
    return {turned(own.direction, angle), before + slope, own.bent};
}

/// Between core nodes: the mean of the nearest and of all that agree with it.
Vec2f LogMapper::interpolate(NodeIndex i) const {
    constexpr float kAgree = 0.98f;
    const Chart here = chart(i);
    if (Carried carried; carryFromSeed(i, here, carried)) return measure(i, carried);
    FrontNeighbors all;
    auto addAround = [&](NodeIndex core) {
        const NodeIndex j = nodes_[core];
        if (igeo::dot(here.frame.normal(), band_.normal[j]) >= Band::kOtherSheet &&
            band_.joined(i, j) && !metric_.blocked(band_, i, j))
            addNeighbor(i, here, core, Vec3f(band_.footPoint(i) - band_.footPoint(j)), all);
    };
    const Vec3f f = band_.footOf(i);
    const Ijk low{floorToInt(f.x), floorToInt(f.y), floorToInt(f.z)};
    band_.forCorners(&BandLeaf::core, i, low, [&](NodeIndex k, unsigned) { addAround(k); });
    if (all.empty())
        band_.forNeighbors(&BandLeaf::core, i, [&](NodeIndex k, int, int, int) { addAround(k); });
    if (all.empty()) return {};
    auto estimate = [&](const FrontNeighbor& n) {
        const Departure& there = departures_[n.core];
        // Along the neighbor's geodesic: beyond rims directions of the band are less exact.
        return turned(there.direction, n.bends ? -n.left * there.slope
                                               : std::atan(n.aside * spread(there.slope, n.ahead)));
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
    auto forAll = [&](auto& out, double from, double to, const auto& value) {
        Steps steps(progress, "logmap", out.size(), from, to);
        parallelFor(out.size(), 1024, [&](std::size_t begin, std::size_t end) {
            if (steps.cancelled()) return;
            for (std::size_t k = begin; k < end; ++k) out[k] = value(NodeIndex(k));
            steps.add(end - begin);
        });
        progress.throwIfCancelled();
    };
    mayBend_.resize(nodes_.size());
    forAll(mayBend_, 0, 0.05, [&](NodeIndex k) { return mayBendAt(k); });
    constexpr std::size_t kAtOnce = 4096;
    Steps carrying(progress, "logmap", order.size(), 0.05, 0.6);
    for (std::size_t k = 0; k < order.size(); k += kAtOnce) {
        const std::size_t end = std::min(k + kAtOnce, order.size());
        for (std::size_t n = k; n < end; ++n) carry(order[n]);
        carrying.add(end - k);
        progress.throwIfCancelled();
    }
    departures_.resize(nodes_.size());
    forAll(departures_, 0.6, 0.85,
           [&](NodeIndex k) { return measured_[k].known() ? smooth(nodes_[k]) : Departure{}; });
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
    if (!field.jets || field.gradient.size() != field.distance.size())
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
