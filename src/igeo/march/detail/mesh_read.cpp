#include <igeo/march/detail/mesh_read.h>

#include <igeo/band/detail/mesh_ways.h>
#include <igeo/march/detail/fermat_update.h>

#include <algorithm>

namespace igeo {

namespace {

constexpr double kFarthest = 3, kLongestWalk = 5;  // voxels; longer between pages

/// A core node near a point.
struct Near {
    double least;  ///< of the point, if the front comes from there
    NodeIndex node;
    Vec3d foot;
    NodeJet jet;
};

/// The core nodes with a jet whose foot points are near a point, no obstacle between; those that
/// matter most first.
/// @param normal  of S there
std::vector<Near> coreNear(const Field& field, const Vec3d& p, const Vec3d& normal) {
    const Band& band = *field.band;
    std::vector<NodeIndex> nodes;
    const Ijk low = floorToIjk(p);
    band.forVoxels(low - Ijk{2, 2, 2}, low + Ijk{3, 3, 3}, [&](NodeIndex i, const Ijk& voxel) {
        const Vec3d foot = Vec3d(voxel) + Vec3d(band.footOf(i));
        if (length(foot - p) < kFarthest && band.inCore(i) &&
            !field.metric->blocked(p, foot, normal))
            nodes.push_back(i);
    });
    if (field.evenCosts) {
        const std::vector<NodeIndex> spine = band.spineNear(p);
        nodes.insert(nodes.end(), spine.begin(), spine.end());
        std::sort(nodes.begin(), nodes.end());
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    }
    std::vector<NodeJet> jets(nodes.size());
    field.at(nodes, jets.data());
    std::vector<Near> found;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const Vec3d foot = band.footPoint(nodes[k]);
        if (jets[k].distance < kInfinity)
            found.push_back({jets[k].distance + field.metric->at(nodes[k]) * length(foot - p),
                             nodes[k], foot, jets[k]});
    }
    std::sort(found.begin(), found.end(), [](const Near& a, const Near& b) {
        return std::pair(a.least, a.node) < std::pair(b.least, b.node);
    });
    return found;
}

/// Whether an obstacle blocks any of the straight parts of a line over triangles.
struct BlockedSegments {
    const Metric& metric;
    const SurfaceTriangles& triangles;
    bool any = false;

    void operator()(const Vec3d& a, const Vec3d& b, std::uint32_t triangle) {
        any = any || metric.blocked(a, b, triangles.normal(triangle));
    }
};

/// The weight at a point; where its cell has no node, that of the nearest.
double weightAt(const Field& field, const Vec3d& p, const BandCell& cell,
                const std::vector<Near>& nodes) {
    const auto isNearer = [&](const Near& a, const Near& b) {
        return length(a.foot - p) < length(b.foot - p);
    };
    if (nodes.empty() ||
        std::any_of(cell.node.begin(), cell.node.end(), [](NodeIndex i) { return i != kNoNode; }))
        return field.metric->at(cell);
    return field.metric->at(std::min_element(nodes.begin(), nodes.end(), isNearer)->node);
}

}  // namespace

bool hasThinWalls(const Band& band, const BandCell& cell) {
    bool any = false, severed = false;
    for (const NodeIndex i : cell.node)
        if (i != kNoNode) any = true, severed |= bool(band.facing[i] & Band::kBesideSevered);
    return band.triangles && (severed || !any);
}

SurfaceTriangles::Place footPlace(const SurfaceTriangles& triangles, const Vec3d& foot,
                                  const Vec3d& normal) {
    constexpr double kRounding = 0.01;  // voxels
    const auto place = triangles.nearest(foot, kRounding, normal);
    return place.triangle != SurfaceTriangles::kNone ? place
                                                     : triangles.nearest(foot, kInfinity, normal);
}

double sideOf(const SurfaceTriangles& triangles, const SurfaceTriangles::Place& foot,
              const Vec3d& normal) {
    return dot(triangles.normal(foot.triangle), normal) < Band::kOtherSheet ? -1 : 1;
}

void LineCost::operator()(const Vec3d& a, const Vec3d& b, std::uint32_t triangle) {
    const Vec3d normal = band_.triangles->normal(triangle);
    const double far = length(b - a), parts = std::ceil(far);
    for (double k = 1; k <= parts; ++k) {
        done_ += far / parts;
        const SurfaceCell cell(band_, metric_, a + (k / parts) * (b - a), normal);
        if (!cell.empty()) take(metric_.at(cell));
    }
}

std::size_t JetsByWalks::faceOf(const Vec3d& up) {
    constexpr double kOneFace = 0.8;  // 37 degrees
    std::size_t face = 0;
    while (face < faceNormal_.size() && dot(faceNormal_[face], up) < kOneFace) ++face;
    if (face == faceNormal_.size()) faceNormal_.push_back(up);
    return face;
}

void JetsByWalks::addAcross(NodeIndex node, const NodeJet& jet, double weight, bool isJump) {
    constexpr float kAlike = -0.2f, kStep = 0.3f;  // voxels
    const Vec3d up = triangles_.normal(at_.triangle);
    if (up == Vec3d{}) return;
    const std::size_t face = faceOf(up);
    const TangentFrame frame{Vec3f(faceNormal_[face])};
    const Vec3f& normal = band_.normal[node];
    const float cosine = dot(frame.normal(), normal);
    if (cosine < kAlike) return;
    const float mean = float((1 + weight / here_) / 2);
    const Vec3f chord(at_.at - band_.footPoint(node));
    // Up a step the planes do not meet between the two: one end is above both, the other below.
    const float rise = dot(chord, normal), climb = dot(chord, frame.normal());
    if (isJump && rise * climb > 0 && std::min(std::abs(rise), std::abs(climb)) > kStep) return;
    const Vec2f a = frame.unfold(chord, normal, cosine),
                g = frame.flat(
                    Vec3f(turned(Vec3d(jet.gradient), Vec3d(normal), faceNormal_[face])));
    if (!(length(g) > 0)) return;
    jets_.push_back(
        {{mean * a, (1 / length(g)) * g, jet.distance / here_}, face, node, jet.label, {}, up});
}

double JetsByWalks::add(NodeIndex node, const NodeJet& jet, double weight, double most) {
    const SurfaceTriangles::Place place = band_.footPlace(node);
    const MeshPoint from{place.triangle, place.point};
    const WalkEnds way = walk_.ends(from, at_, most);
    if (!(way.length < kInfinity) || isBlocked(from, way)) return kInfinity;
    return addOver(way, node, jet, costOf(from, way, weight));
}

double JetsByWalks::add(const WalkEnds& line, NodeIndex node, const NodeJet& jet, double weight) {
    constexpr double kRoom = 0.1;  // voxels: a walk goes around vertices less tightly
    double mean = (here_ + weight) / 2;
    if (!metric_.weight.empty()) {
        const SurfaceTriangles::Place place = band_.footPlace(node);
        const MeshPoint from{place.triangle, place.point};
        const WalkEnds way = walk_.ends(from, at_, kBeforeTight * line.length + kRoom);
        if (way.length > 0 && way.length < kInfinity) mean = costOf(from, way, weight) / way.length;
    }
    return addOver(line, node, jet, mean * line.length);
}

double JetsByWalks::costOf(const MeshPoint& from, const WalkEnds& way, double weight) const {
    constexpr double kShort = 1;  // voxels
    if (metric_.weight.empty() || way.length <= kShort) return (here_ + weight) / 2 * way.length;
    LineCost cost(band_, metric_, here_);
    walk_.forSegments(from, at_, cost);
    return cost.endingAt(weight);
}

bool JetsByWalks::isBlocked(NodeIndex node, double walk) {
    constexpr double kTimes = 1.5, kRoom = 1;  // before it is pulled tight; voxels
    if (!metric_.obstacles || !metric_.obstacles->mayBeNear(at_.at, walk)) return false;
    const SurfaceTriangles::Place place = band_.footPlace(node);
    const MeshPoint from{place.triangle, place.point};
    const WalkEnds way = walk_.ends(from, at_, kTimes * walk + kRoom);
    return way.length < kInfinity ? isBlocked(from, way) : band_.joints == 0;
}

bool JetsByWalks::isBlocked(const MeshPoint& from, const WalkEnds& way) const {
    if (!(way.length < kInfinity) || !metric_.obstacles ||
        !metric_.obstacles->mayBeNear(at_.at, way.length))
        return false;
    BlockedSegments segments{metric_, triangles_};
    walk_.forSegments(from, at_, segments);
    return segments.any;
}

double JetsByWalks::addOver(const WalkEnds& way, NodeIndex node, const NodeJet& jet, double cost) {
    const double over = cost / here_;
    const Vec3d up = triangles_.normal(way.last);
    Carried carried{
        {{float(over), 0}, {}, jet.distance / here_}, kNoFace, node, jet.label, way.in, up};
    const Vec3d start = triangles_.normal(way.first);
    if (way.straight && up != Vec3d{} && start != Vec3d{}) {
        const std::size_t face = carried.face = faceOf(up);
        const Vec3d normal(band_.normal[node]),
            own = sideOf(triangles_, band_.footPlace(node), normal) * normal,
            g = normalized(turned(Vec3d(jet.gradient), own, start));
        const double left = dot(g, cross(start, way.out));
        const Vec2f in = TangentFrame(Vec3f(faceNormal_[face])).flat(Vec3f(way.in));
        const Vec2f to = length(in) > 0 ? (1 / length(in)) * in : Vec2f{1, 0};
        carried.jet.a = float(over) * to;
        carried.jet.g =
            float(dot(g, way.out)) * to + float(way.mirrored ? -left : left) * Vec2f{-to.y, to.x};
    }
    jets_.push_back(carried);
    return jet.distance + cost;
}

std::vector<std::uint32_t> JetsByWalks::sources() const {
    std::vector<std::uint32_t> all;
    for (const Carried& carried : jets_) all.push_back(carried.source);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

void JetsByWalks::setApart(const Carried& p, Carried& q, double apart) {
    const Vec2f a = p.jet.a, b = q.jet.a;
    const double sides = double(length(a)) * double(length(b)), left = double(cross(a, b));
    if (!(sides > 0)) return;
    const double cosine = (double(dot(a, a)) + double(dot(b, b)) - apart * apart) / (2 * sides),
                 angle = std::copysign(std::acos(std::clamp(cosine, -1.0, 1.0)), left) -
                         std::atan2(left, double(dot(a, b)));
    const auto c = float(std::cos(angle)), s = float(std::sin(angle));
    for (Vec2f* v : {&q.jet.a, &q.jet.g}) *v = {c * v->x - s * v->y, s * v->x + c * v->y};
}

Jet JetsByWalks::firstOnFace(const std::vector<const Carried*>& jets, int pairsLeft) {
    constexpr double kOff = 0.03;  // voxels
    JetNeighbors all;
    for (const Carried* carried : jets)
        if (all.count() < JetNeighbors::kMax) all.add(carried->jet);
    std::array<std::uint8_t, 2> ends;
    Jet first = fermatUpdate(all, &ends);
    const Carried &p = *jets[ends[0]], &q = *jets[ends[1]];
    // Across a gap there is no walk.
    if (pairsLeft == 0 || &p == &q || metric_.weighted() || p.in == Vec3d{} || q.in == Vec3d{})
        return first;
    const SurfaceTriangles::Place from = band_.footPlace(p.node), to = band_.footPlace(q.node);
    const double laid = double(length(p.jet.a - q.jet.a)),
                 walked = walk_.tightLength({from.triangle, from.point}, {to.triangle, to.point},
                                            kBeforeTight * laid + kOff);
    if (std::abs(walked - laid) < kOff) return first;
    first = {};
    if (walked < kInfinity) {
        Carried apart = q;
        setApart(p, apart, walked);
        JetNeighbors both;
        both.add(p.jet), both.add(apart.jet);
        first = fermatUpdate(both);
    }
    for (const Carried* end : {&p, &q}) {
        std::vector<const Carried*> rest = jets;
        std::erase(rest, end);
        if (const Jet other = firstOnFace(rest, pairsLeft - 1); other.u < first.u) first = other;
    }
    return first;
}

JetsByWalks::First JetsByWalks::first(std::uint32_t source) {
    constexpr int kPairs = 4;
    First first;
    for (std::size_t face = 0; face < faceNormal_.size(); ++face) {
        std::vector<const Carried*> on;
        for (const Carried& carried : jets_)
            if (carried.source == source && carried.face == face) on.push_back(&carried);
        if (on.empty()) continue;
        // Those that come first, where there are more than fermatUpdate takes.
        std::stable_sort(on.begin(), on.end(), [](const Carried* a, const Carried* b) {
            return a->jet.u + double(length(a->jet.a)) < b->jet.u + double(length(b->jet.a));
        });
        const Jet jet = firstOnFace(on, kPairs);
        if (const double d = here_ * jet.u; d < first.distance)
            first = {d, Vec3d(TangentFrame(Vec3f(faceNormal_[face])).lift(jet.g)),
                     faceNormal_[face]};
    }
    for (const Carried& carried : jets_)
        if (carried.source == source && carried.face == kNoFace)
            if (const double d = here_ * (carried.jet.u + double(length(carried.jet.a)));
                d < first.distance)
                first = {d, carried.in, carried.up};
    return first;
}

bool isBlocked(const Metric& metric, const SurfaceTriangles& triangles,
               const MeshFan<SurfaceTriangles>& fan, std::size_t k, const Vec3d& to) {
    if (!metric.obstacles || !metric.obstacles->mayBeNear(to, MeshWays::kReach)) return false;
    BlockedSegments segments{metric, triangles};
    fan.forSegments(k, to, segments);
    return segments.any;
}

double costOf(const Band& band, const Metric& metric, const MeshFan<SurfaceTriangles>& fan,
              std::size_t k, const Vec3d& to, const WalkEnds& line, double here, double there) {
    if (metric.weight.empty()) return line.length;
    LineCost cost(band, metric, there);
    fan.forSegments(k, to, cost);
    return cost.endingAt(here);
}

bool hasWays(const Band& band, const BandCell& cell, bool even) {
    if (!band.ways) return false;
    bool found = false;
    band.forVoxels(cell.low - Ijk{1, 1, 1}, cell.low + Ijk{2, 2, 2}, [&](NodeIndex i, const Ijk&) {
        found |= band.facing[i] & Band::kHasWays && (even || band.ways->hasOthersThanAtRim(i));
    });
    return found;
}

std::vector<Seen> seenFrom(const Field& field, const SurfaceTriangles::Place& at, double here,
                           bool withCrossings) {
    const Band& band = *field.band;
    const SurfaceTriangles& triangles = *band.triangles;
    const MeshFan fan(triangles, MeshPoint{at.triangle, at.point}, MeshWays::kReach,
                      AtVertex::GoAround);
    std::vector<std::pair<std::uint32_t, std::size_t>> seeds;
    field.seedsNear.forNear(at.point, [&](std::size_t k) {
        const SurfacePoint& s = field.seeds[k];
        if (s.segment == Vec3d{} && length(s.pIndex - at.point) < MeshWays::kReach)
            for (const std::uint32_t t :
                 trianglesAt(triangles, {placeOn(triangles, s, s.pIndex).triangle, s.pIndex}))
                seeds.emplace_back(t, k);
    });
    std::vector<Seen> all;
    WalkEnds out;
    auto add = [&](std::size_t part, NodeIndex node, const SurfacePoint* seed, const Vec3d& there,
                   const NodeJet& jet) {
        if (isBlocked(*field.metric, triangles, fan, part, there)) return;
        const double weight = seed ? seed->weight : field.metric->at(node);
        all.push_back({node,
                       seed,
                       jet,
                       out.reversed(),
                       costOf(band, *field.metric, fan, part, there, out, here, weight),
                       {}});
        if (!withCrossings) return;
        all.back().crossings = fan.crossings(part, there);
        std::reverse(all.back().crossings.begin(), all.back().crossings.end());
    };
    for (std::size_t k = 0; k < fan.parts().size(); ++k) {
        const std::uint32_t t = fan.parts()[k].triangle;
        band.ways->nodes.forOn(t, [&](NodeIndex i) {
            if (!fan.sees(k, band.footPoint(i), out)) return;
            const NodeJet jet = field.at(i);
            if (jet.distance < kInfinity) add(k, i, nullptr, band.footPoint(i), jet);
        });
        for (const auto& [triangle, s] : seeds)
            if (triangle == t && fan.sees(k, field.seeds[s].pIndex, out))
                add(k, kNoNode, &field.seeds[s], field.seeds[s].pIndex,
                    {field.seeds[s].start, {}, field.source[s]});
    }
    return all;
}

void addSeen(const std::vector<Seen>& seen, JetsByWalks& jets) {
    for (const Seen& s : seen)
        if (s.node != kNoNode) jets.addOver(s.line, s.node, s.jet, s.cost);
}

JetsByWalks coreByWalks(const Field& field, const SurfaceTriangles::Place& at,
                        const BandCell& cell) {
    constexpr double kAround = 1;  // voxels: beside the nodes from which the front comes
    const Band& band = *field.band;
    const std::vector<Near> nodes = coreNear(field, at.point, band.triangles->normal(at.triangle));
    const double here = weightAt(field, at.point, cell, nodes);
    JetsByWalks jets(band, *field.metric, at, here);
    double first = kInfinity;
    std::vector<NodeIndex> joined;
    std::vector<const Near*> apart;
    for (const Near& near : nodes) {
        if (near.least > first + kAround * here) break;
        const double most = std::max(kLongestWalk, kBeforeTight * length(near.foot - at.point));
        const double d = jets.add(near.node, near.jet, field.metric->at(near.node), most);
        if (d < kInfinity)
            joined.push_back(near.node);
        else
            apart.push_back(&near);
        first = std::min(first, d);
    }
    // Between the rim of a gap and the first nodes beside it no front is known on this side.
    if (band.joints == 0) return jets;
    for (const Near* near : apart) {
        bool bridged = false, isJump = true;
        band.forBridges(near->node, [&](const Bridge& b) {
            if (std::find(joined.begin(), joined.end(), b.to) == joined.end()) return;
            bridged = true, isJump &= b.jump;
        });
        if (bridged) jets.addAcross(near->node, near->jet, field.metric->at(near->node), isJump);
    }
    return jets;
}

}  // namespace igeo
