// Values of a field at points of S: what results and paths read.
#include <igeo/march/field.h>

#include <igeo/band/detail/chord.h>
#include <igeo/band/tangent_frame.h>
#include <igeo/march/detail/circular_front.h>
#include <igeo/march/detail/fermat_update.h>
#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/known_jets.h>
#include <igeo/march/detail/mesh_read.h>

namespace igeo {

namespace {

/// The distance by a start disc.
struct Straight {
    const SurfacePoint* seed = nullptr;
    double distance = kInfinity;
    bool ofNearest = false;  ///< no other seed of the source is nearer
    /// By straight lines at the least cost, whether S runs along them or not: no distance is less.
    double bound = 0;
};

/// A point on the triangles or beside them; then on those of its sheet.
SurfaceTriangles::Place placeOf(const SurfaceTriangles& triangles, const Vec3d& p,
                                const Vec3d& sheetNormal) {
    constexpr double kOn = 1e-3;  // voxels
    const SurfaceTriangles::Place at = triangles.nearest(p);
    return at.squared < kOn * kOn ? at : triangles.nearest(p, kInfinity, sheetNormal);
}

/// The cell around a point. Beside facing sheets of a level set only the corners that psi joins
/// with the point are left, unless it joins none.
SurfaceCell cellOnSheet(const Field& field, const Vec3d& p, const Vec3d& sheetNormal) {
    const Band& band = *field.band;
    const SurfaceCell all(band, *field.metric, p, sheetNormal);
    const bool thin = std::any_of(all.node.begin(), all.node.end(), [&](NodeIndex i) {
        return i != kNoNode && band.facing[i] & (Band::kFacing | Band::kBesideSevered);
    });
    if (!thin || !field.atFootPoints || band.triangles) return all;
    SurfaceCell joined = all;
    for (NodeIndex& i : joined.node)
        if (i != kNoNode && !psiJoins(band, p, band.footPoint(i)))
            i = kNoNode, joined.complete = false;
    return joined.empty() ? all : joined;
}

bool isOnCrease(const Band& band, const SurfaceCell& cell) {
    constexpr float kOneFace = 0.8f;  // 37 degrees
    const Vec3f* first = nullptr;
    for (const NodeIndex i : cell.node) {
        if (i == kNoNode) continue;
        if (!first) first = &band.normal[i];
        if (dot(*first, band.normal[i]) <= kOneFace) return true;
    }
    return false;
}

/// Reads a field at a point of S.
class Reader {
public:
    /// @param corner  the jets at the corners of the cell; unreached: +infinity
    Reader(const Field& field, const std::array<NodeJet, 8>& corner, const Vec3d& pIndex,
           const ReadPlace& place)
        : field_(field),
          band_(*field.band),
          metric_(*field.metric),
          p_(pIndex),
          place_(place),
          cell_(place.cell),
          corner_(corner),
          onMesh_(place.onMesh) {}

    Arrival first() const {
        for (const Field::Region& region : field_.regions)
            if (isInside(*region.body)) return {0, region.source, nullptr};
        return field_.atFootPoints ? byJets() : byVoxels();
    }

private:
    bool isInside(const Obstacles& region) const {
        return region.contains(p_, cell_.normal) && !metric_.blocked(p_, p_, cell_.normal);
    }
    Arrival byVoxels() const;
    Arrival byJets() const;
    /// Of a source, by its value at the point and its start discs.
    Arrival ofSource(std::uint32_t source, double value) const;
    static void takeFirst(Arrival& first, const Arrival& other) {
        if (std::pair(other.distance, other.source) < std::pair(first.distance, first.source))
            first = other;
    }

    /// The tangent plane at the point.
    struct Chart {
        const Reader& reader;
        TangentFrame frame;
        PlaneMetric plane;
        double here;  ///< the weight at the point

        explicit Chart(const Reader& r);
        /// @param voxel  of node j
        JetNeighbor neighbor(NodeIndex j, const Ijk& voxel, const NodeJet& jet) const;
    };

    /// The least distance by the start discs that contain the point.
    /// @param d     the distance by the corners; it separates a seed on this sheet from one on a
    ///              sheet close by
    /// @param isOf  selects seeds
    template <typename IsOf>
    Straight straight(double d, const IsOf& isOf) const;
    /// Where no walk tells: whether the straight line to a seed runs along S, over no edge, and not
    /// across a gap or through a wall (seedNeighborhoodJet). A seed on an edge lies in the planes
    /// of both faces.
    bool alongSurface(const SurfacePoint& seed, const Vec3d& chord) const;
    const SurfaceTriangles::Place& onMesh() const {
        if (!onMesh_) onMesh_ = placeOf(*band_.triangles, p_, cell_.normal);
        return *onMesh_;
    }
    std::uint32_t sourceOf(const SurfacePoint& seed) const {
        return field_.source[std::size_t(&seed - field_.seeds.data())];
    }
    bool isOnMesh() const { return onMesh().triangle != SurfaceTriangles::kNone; }
    /// The length of a walk from a point of a seed over edges of a mesh; +infinity: none up to
    /// `most`.
    double walkFrom(const SurfacePoint& seed, const Vec3d& at, double most) const;
    /// The first arrival, or a seed on the same page where that has few nodes, as in StartDisc.
    Arrival orFromPage(Arrival first) const;
    Arrival arrival(double d, const Straight& disc, std::uint32_t source) const;
    Arrival orDisc(const Arrival& first, const Straight& disc) const {
        if (!(disc.distance < first.distance)) return first;
        return {disc.distance, sourceOf(*disc.seed), disc.seed};
    }
    /// The first arrival, or the disc of a seed so close to others that no node is nearest to it.
    Arrival orBetweenNodes(const Arrival& first) const;
    /// Whether an earlier front reached a corner within the disc of this seed.
    bool isOverrun(const SurfacePoint& seed) const;
    double trilinear() const;
    /// A lower bound of the distance, over the weight here: from the value of a corner on the same
    /// face it differs by the line between them at most. It stops fronts whose direction is wrong,
    /// as at a node on the end of an edge.
    double leastOnFace(const Chart& chart, std::uint32_t source) const;
    /// Whether a seed is so near that nodes here are in its start disc, or might be.
    bool isBesideSeed() const;
    /// The jets of one source, blended.
    /// @param isClear  set to false where several fronts seem to meet
    double blended(std::uint32_t source, bool& isClear) const;
    /// The first arrival by walks over triangles.
    Arrival byWalks() const;
    /// The nodes of the core at the cell and beside it; none near obstacles.
    std::vector<NodeIndex> coreAround() const;
    /// From the core around the cell, where the corners are too few to separate fronts.
    std::optional<Jet> whereFrontsMeet(const Chart& chart, std::uint32_t source) const;

    const Field& field_;
    const Band& band_;
    const Metric& metric_;
    const Vec3d p_;
    const ReadPlace& place_;
    const SurfaceCell& cell_;
    const std::array<NodeJet, 8>& corner_;
    mutable std::optional<SurfaceTriangles::Place> onMesh_;
};

template <typename IsOf>
Straight Reader::straight(double d, const IsOf& isOf) const {
    // Between the corners the tip of the cone is blunt, between several tips the more; where a
    // value is larger by more, the front went around something.
    // Where the surface ends, jets of all corners may go past a tip close by.
    constexpr double kOtherPath = 1.2, kBlunt = 1, kBluntAtRim = 3, kAtTip = 0.5;  // voxels
    const double leastCost = field_.lines.leastCost();
    const double here = metric_.anisotropic() ? 1 : metric_.at(cell_);
    Straight least;
    double nearest = kInfinity, bound = kInfinity;
    field_.seedsNear.forNear(p_, [&](std::size_t k) {
        const SurfacePoint& s = field_.seeds[k];
        const Vec3d at = s.nearestTo(p_);
        const double r = length(p_ - at);
        if (!(r < field_.startRadius) || !isOf(k)) return;
        bound = std::min(bound, s.rim ? 0 : s.start + leastCost * r);
        if (r < nearest) nearest = r, least.ofNearest = false;
        if (field_.atFootPoints && costsJump(band_, metric_, s, p_, here)) return;
        const bool walks = place_.hasWalks && isOnMesh(),
                   flat = !walks && field_.atFootPoints && alongSurface(s, p_ - at);
        const double mean = meanToSeed(field_, s, p_, here);
        if (walks && !(s.start + mean * r < least.distance)) return;
        const double cost = walks                   ? mean * walkFrom(s, at, field_.startRadius)
                            : metric_.anisotropic() ? costToSeed(field_, s, p_, cell_.normal, here)
                                                    : mean * r,
                     perVoxel = metric_.anisotropic() && r > 0 ? cost / r : mean;
        const double blunt = !cell_.complete && r < kAtTip ? kBluntAtRim : kBlunt;
        const bool along = walks ? cost < kInfinity
                           : field_.atFootPoints
                               ? flat && d - s.start <= kOtherPath * cost + blunt * perVoxel
                               : d - s.start < 1.5 * field_.startRadius * perVoxel;
        if (along && s.start + cost < least.distance && !metric_.blocked(p_, at, cell_.normal) &&
            (walks || followsSurface(band_, p_, at)))
            least.seed = &s, least.distance = s.start + cost, least.ofNearest = r == nearest;
    });
    // Inside a region no seed is near.
    if (nearest < kInfinity)
        least.bound = std::min(bound, field_.leastStart + leastCost * field_.startRadius);
    return least;
}

bool Reader::alongSurface(const SurfacePoint& seed, const Vec3d& chord) const {
    // Over an edge, and beside a hollow one, the normal of a cell is between those of both faces.
    constexpr double kSmooth = 0.8;
    const Vec3d ofSeed(seed.normal);
    if (dot(cell_.normal, ofSeed) >= kSmooth && !isOverStep(chord, cell_.normal, ofSeed))
        return true;
    return runsInPlane(band_, p_ - chord, chord, cell_.normal);
}

double Reader::walkFrom(const SurfacePoint& seed, const Vec3d& at, double most) const {
    const auto from = placeOn(*band_.triangles, seed, at);
    return ShortWalk(*band_.triangles)
        .tightLength({from.triangle, from.point}, {onMesh().triangle, onMesh().point}, most);
}

Arrival Reader::orFromPage(Arrival first) const {
    if (!field_.evenCosts || band_.spine.empty()) return first;
    field_.seedsNear.forNear(p_, [&](std::size_t k) {
        const SurfacePoint& s = field_.seeds[k];
        const Vec3d at = s.nearestTo(p_);
        const double r = length(p_ - at);
        if (r > Band::kSpineReach || !(s.start + s.weight * r < first.distance)) return;
        const double d = s.start + s.weight * walkFrom(s, at, kBeforeTight * r);
        if (d < first.distance) first = {d, field_.source[k], &s};
    });
    return first;
}

Arrival Reader::arrival(double d, const Straight& disc, std::uint32_t source) const {
    const double bounded = std::max(d, disc.bound);
    if (!disc.seed) return {bounded, source, nullptr};
    // A nearer seed of the source may lie over an edge.
    if (disc.ofNearest && !disc.seed->rim) return {disc.distance, source, disc.seed};
    return {std::min(bounded, disc.distance), source, disc.seed};
}

bool Reader::isOverrun(const SurfacePoint& seed) const {
    constexpr double kRounding = 1e-3;  // voxels
    const std::uint32_t source = sourceOf(seed);
    auto isEarlier = [&](NodeIndex j, double distance) {
        const Vec3d voxel(band_.ijk(j));
        double straight = kInfinity;
        field_.seedsNear.forNear(voxel, [&](std::size_t k) {
            const SurfacePoint& s = field_.seeds[k];
            const Vec3d chord = voxel - s.nearestTo(voxel);
            if (field_.source[k] == source && length(chord) <= field_.startRadius)
                straight = std::min(straight, s.start + metric_.stepCost(s.node, chord));
        });
        return straight < kInfinity && distance < straight - kRounding * metric_.at(j);
    };
    for (std::size_t k = 0; k < 8; ++k)
        if (corner_[k].distance < kInfinity && isEarlier(cell_.node[k], corner_[k].distance))
            return true;
    return false;
}

/// For values that belong to voxels.
double Reader::trilinear() const {
    double sum = 0, weight = 0, nearest = kInfinity;
    for (std::size_t k = 0; k < 8; ++k) {
        const double d = corner_[k].distance;
        if (!(d < kInfinity)) continue;
        nearest = std::min(nearest, d);
        sum += cell_.weight[k] * d;
        weight += cell_.weight[k];
    }
    return weight > 0 ? sum / weight : nearest;
}

Reader::Chart::Chart(const Reader& r) : reader(r), frame(Vec3f(r.cell_.normal), r.band_.faceted) {
    if (r.metric_.anisotropic())
        plane = r.metric_.inPlane(frame, r.cell_);
    else
        plane.weight = r.metric_.at(r.cell_);
    here = plane.weight;
}

JetNeighbor Reader::Chart::neighbor(NodeIndex j, const Ijk& voxel, const NodeJet& jet) const {
    const Band& band = reader.band_;
    const Metric& metric = reader.metric_;
    const Vec3f nj = band.normal[j];
    Vec3f chord(reader.p_ - (Vec3d(voxel) + Vec3d(band.footOf(j)))), g = jet.gradient;
    if (metric.anisotropic()) {
        g *= float(1 / here);
    } else if (metric.weighted()) {
        chord *= float((1 + metric.at(j) / here) / 2);
        g = normalized(g);
    }
    const JetNeighbor n =
        flattened(frame, chord, nj, dot(frame.normal(), nj), g, jet.distance / here);
    return metric.anisotropic() ? stretched(plane.stretch, n) : n;
}

double Reader::leastOnFace(const Chart& chart, std::uint32_t source) const {
    constexpr float kOneFace = 0.9f;
    const double kOff = band_.triangles ? 0.25 : 0.1;  // voxels
    double least = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        if (!(corner_[k].distance < kInfinity) || corner_[k].label != source ||
            dot(chart.frame.normal(), band_.normal[cell_.node[k]]) < kOneFace)
            continue;
        const JetNeighbor n = chart.neighbor(cell_.node[k], cell_.voxel(k), corner_[k]);
        least = std::max(least, n.u - double(length(n.a)) - kOff);
    }
    return least;
}

bool Reader::isBesideSeed() const {
    bool is = false;
    field_.seedsNear.forNear(p_, [&](std::size_t k) {
        is = is || length(p_ - field_.seeds[k].nearestTo(p_)) < field_.startRadius;
    });
    return is;
}

double Reader::blended(std::uint32_t source, bool& isClear) const {
    const Chart chart(*this);
    JetNeighbors all;
    BlendWeights weight{};
    auto gather = [&](bool beyondSeeds) {
        for (std::size_t k = 0; k < 8; ++k) {
            const NodeJet& jet = corner_[k];
            if (!(jet.distance < kInfinity) || jet.label != source) continue;
            const JetNeighbor n = chart.neighbor(cell_.node[k], cell_.voxel(k), jet);
            // The front would come to p before it starts: p is on the other side of the seed.
            if (!beyondSeeds && n.u + double(dot(n.g, n.a)) < field_.leastStart / chart.here)
                continue;
            // A single corner at p itself needs a positive weight.
            weight[std::size_t(all.count())] = float(cell_.weight[k]) + 1e-6f;
            all.add(n);
        }
    };
    gather(false);
    if (all.count() == 0) gather(true);
    Jet jet = blendJets(all, weight, isBesideSeed());
    jet.u = std::max(jet.u, leastOnFace(chart, source));
    if (jet.usedFallback && !metric_.anisotropic()) {
        constexpr double kBlendError = 0.25;  // voxels
        const auto met = whereFrontsMeet(chart, source);
        if (met && std::abs(met->u - jet.u) < kBlendError) return chart.here * met->u;
    }
    isClear &= jet.ofOneFront;
    return chart.here * jet.u;
}

std::vector<NodeIndex> Reader::coreAround() const {
    std::vector<NodeIndex> nodes;
    for (const NodeIndex i : cell_.node) {
        if (i == kNoNode) continue;
        if (!metric_.clear(i)) return {};
        if (band_.inCore(i)) nodes.push_back(i);
        band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (band_.inCore(j) && band_.joined(i, j)) nodes.push_back(j);
        });
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

std::optional<Jet> Reader::whereFrontsMeet(const Chart& chart, std::uint32_t source) const {
    constexpr float kSmooth = 0.9f;
    const std::vector<NodeIndex> nodes = coreAround();
    std::vector<JetNeighbor> neighbors;
    for (const NodeIndex j : nodes) {
        const NodeJet jet = field_.at(j);
        if (!(jet.distance < kInfinity)) continue;
        const bool sameCost = std::abs(metric_.at(j) - chart.here) < 1e-6 * chart.here;
        if (jet.label != source || !sameCost ||
            dot(chart.frame.normal(), band_.normal[j]) < kSmooth)
            return {};
        neighbors.push_back(chart.neighbor(j, band_.ijk(j), jet));
    }
    return fitCircularFront(neighbors);
}

Arrival Reader::byVoxels() const {
    const double d = std::max(field_.leastStart, trilinear());
    const Straight disc = straight(d, [](std::size_t) { return true; });
    if (disc.seed && d < disc.distance && field_.sourceCount() > 1 && isOverrun(*disc.seed))
        return {d, 0, nullptr};
    return arrival(d, disc, 0);
}

Arrival Reader::ofSource(std::uint32_t source, double value) const {
    // Beside a seed in a groove, jets are extrapolated past the seed.
    const double d = std::max({field_.leastStart, value, field_.lines.from(source, p_)});
    const Straight disc = straight(d, [&](std::size_t s) { return field_.source[s] == source; });
    return arrival(d, disc, source);
}

Arrival Reader::byWalks() const {
    JetsByWalks around = coreByWalks(field_, onMesh(), cell_);
    const std::vector<Seen> seen =
        place_.byWays ? seenFrom(field_, onMesh(), around.here()) : std::vector<Seen>{};
    addSeen(seen, around);
    Arrival first;
    for (const std::uint32_t own : around.sources())
        takeFirst(first, ofSource(own, around.first(own).distance));
    // A seed that is nearer than any node of its sheet.
    first = orDisc(first, straight(first.distance, [](std::size_t) { return true; }));
    for (const Seen& s : seen)
        if (s.seed && s.distance() < first.distance) first = {s.distance(), s.jet.label, s.seed};
    return orFromPage(first);
}

Arrival Reader::byJets() const {
    if (place_.byWalks) return byWalks();
    std::array<std::uint32_t, 8> sources;
    std::size_t count = 0;
    for (const NodeJet& jet : corner_) {
        if (!(jet.distance < kInfinity)) continue;
        const auto end = sources.begin() + std::ptrdiff_t(count);
        if (std::find(sources.begin(), end, jet.label) == end) sources[count++] = jet.label;
    }
    Arrival first;
    bool isClear = true;
    for (std::size_t k = 0; k < count; ++k)
        takeFirst(first, ofSource(sources[k], blended(sources[k], isClear)));
    // Beside creases of a mesh fronts may seem to differ that are one.
    if (!isClear && place_.hasWalks && band_.faceted && field_.evenCosts && isOnMesh()) {
        const Arrival walked = byWalks();
        if (walked.distance < kInfinity) return walked;
    }
    return count > 0 && field_.sourceCount() > 1 ? orBetweenNodes(first) : first;
}

Arrival Reader::orBetweenNodes(const Arrival& first) const {
    constexpr double kCell2 = 3;  // squared diagonal
    const auto isBeside = [&](std::size_t k) {
        const SurfacePoint& s = field_.seeds[k];
        const Vec3d r = s.nearestTo(p_) - p_;
        return dot(r, r) < kCell2 &&
               dot(Vec3d(band_.normal[s.node]), cell_.normal) > Band::kOtherSheet;
    };
    return orDisc(first, straight(first.distance, isBeside));
}

}  // namespace

ReadPlace::ReadPlace(const Field& field, const Vec3d& p, const Vec3d& sheetNormal)
    : cell(cellOnSheet(field, p, sheetNormal)),
      hasWalks(field.atFootPoints && field.band->triangles && !field.metric->anisotropic()) {
    if (!hasWalks) return;
    const Band& band = *field.band;
    const bool ways = hasWays(band, cell, field.evenCosts);
    if (!ways && !hasThinWalls(band, cell) && !isOnCrease(band, cell)) return;
    onMesh = placeOf(*band.triangles, p, cell.normal);
    byWalks = onMesh->triangle != SurfaceTriangles::kNone;
    byWays = ways && byWalks;
}

Arrival arrivalAt(const Field& field, const Vec3d& pIndex, const Vec3d& sheetNormal) {
    if (const auto first = arrivalFromCore(field, pIndex, sheetNormal)) return *first;
    const ReadPlace place(field, pIndex, sheetNormal);
    return Reader(field, field.at(place.cell.node), pIndex, place).first();
}

Arrival arrivalAt(const Field& field, const KnownJets& known, const Vec3d& pIndex,
                  const ReadPlace& place) {
    return Reader(field, known.at(place.cell.node), pIndex, place).first();
}

KnownJets::KnownJets(const Field& field, std::span<const ReadPlace* const> places) {
    for (const ReadPlace* place : places)
        for (const NodeIndex i : place->cell.node)
            if (i != kNoNode) nodes_.push_back(i);
    std::sort(nodes_.begin(), nodes_.end());
    nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
    jets_.resize(nodes_.size());
    field.at(nodes_, jets_.data());
}

std::array<NodeJet, 8> KnownJets::at(const std::array<NodeIndex, 8>& nodes) const {
    std::array<NodeJet, 8> jets;
    for (std::size_t k = 0; k < 8; ++k)
        if (nodes[k] != kNoNode)
            jets[k] = jets_[std::size_t(std::lower_bound(nodes_.begin(), nodes_.end(), nodes[k]) -
                                        nodes_.begin())];
    return jets;
}

}  // namespace igeo
