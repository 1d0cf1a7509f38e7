#include <igeo/band/band.h>

#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <atomic>
#include <limits>
#include <tuple>

namespace igeo {

namespace {

std::size_t hashOf(const Ijk& origin) {
    // Leaves are 8 voxels wide: drop the zero bits, then mix (64-bit finalizer of SplitMix64).
    std::uint64_t key = (std::uint64_t(std::uint32_t(origin.x >> 3)) << 42) ^
                        (std::uint64_t(std::uint32_t(origin.y >> 3)) << 21) ^
                        std::uint64_t(std::uint32_t(origin.z >> 3));
    key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9ULL;
    key = (key ^ (key >> 27)) * 0x94d049bb133111ebULL;
    return std::size_t(key ^ (key >> 31));
}

Ijk leafOrigin(const Ijk& ijk) { return {ijk.x & ~7, ijk.y & ~7, ijk.z & ~7}; }

template <typename T>
std::size_t bytes(const std::vector<T>& v) {
    return v.capacity() * sizeof(T);
}

}  // namespace

LeafIndex Band::leafAt(const Ijk& ijk) const {
    if (table_.empty()) return kNoLeaf;
    const Ijk origin = leafOrigin(ijk);
    const std::size_t last = table_.size() - 1;
    for (std::size_t slot = hashOf(origin) & last;; slot = (slot + 1) & last) {
        const LeafIndex l = table_[slot];
        if (l == kNoLeaf || leaves[l].origin == origin) return l;
    }
}

void LeafNodes::number(NodeIndex start) {
    firstNode = start;
    count = 0;
    for (std::size_t x = 0; x < 8; ++x) {
        before[x] = std::uint16_t(count);
        count += bitCount(mask[x]);
    }
}

void Band::buildTopology(bool withFeet) {
    std::size_t count = 0;
    for (BandLeaf& l : leaves) {
        l.neighbor.fill(kNoLeaf);
        l.band.number(NodeIndex(count));
        count += l.band.count;
        if (count >= kNoNode)
            throw Error(Error::Kind::BadInput, "the band holds more than 4294967294 voxels",
                        "use a narrower band or coarser voxels");
    }

    std::size_t slots = 16;
    while (slots < 2 * leaves.size()) slots *= 2;
    table_.assign(slots, kNoLeaf);
    for (std::size_t l = 0; l < leaves.size(); ++l) {
        std::size_t slot = hashOf(leaves[l].origin) & (slots - 1);
        while (table_[slot] != kNoLeaf) slot = (slot + 1) & (slots - 1);
        table_[slot] = LeafIndex(l);
    }

    leafOfBlock_.resize((count + kBlock - 1) / kBlock);
    resizeByAll(offset_, count);
    resizeByAll(psi, count);
    if (withFeet) resizeByAll(foot, count);
    resizeByAll(normal, count);
    facing.assign(count, 0);
    parallelFor(leaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            BandLeaf& here = leaves[l];
            // Of two leaves the first finds the other.
            here.neighbor[13] = LeafIndex(l);
            for (std::size_t k = 0; k < 13; ++k) {
                const Ijk step = Ijk{int(k / 9), int(k / 3 % 3), int(k % 3)} - Ijk{1, 1, 1};
                const LeafIndex other = here.neighbor[k] = leafAt(here.origin + 8 * step);
                if (other != kNoLeaf) leaves[other].neighbor[26 - k] = LeafIndex(l);
            }
            // The blocks that begin in this leaf.
            const std::size_t first = here.band.firstNode, last = first + here.band.count;
            for (std::size_t b = (first + kBlock - 1) / kBlock; b * kBlock < last; ++b)
                leafOfBlock_[b] = LeafIndex(l);
            forNodes(LeafIndex(l),
                     [&](NodeIndex i, unsigned at) { offset_[i] = std::uint16_t(at); });
        }
    });
}

void Band::numberCore(const std::vector<NodeIndex>& rim) {
    // Half of an edge, and a margin for a psi that is 10 % off: where S has a hole in the core,
    // fronts would go around it.
    constexpr float kHalfEdge = 0.55f, kUnit = 1.01f;  // no normal is longer
    // psi of a level set may be off by more, and hold the nearer end so far from S.
    constexpr float kRoughHalf = 0.75f;
    const bool isLevelSet = foot.empty();
    const float farthest = isLevelSet ? kRoughHalf : kHalfEdge;
    // Whether the other end of the edge that S crosses lies on another sheet, in a plate thinner
    // than a voxel: then this end is the nearest of its own. Or psi changes along the edge by more
    // than a distance does, and this end is the nearer one.
    auto isEndOfEdge = [&](NodeIndex i, const Vec3f& n, float most) {
        Ijk step{};
        const int axis = std::abs(n.x) == most ? 0 : std::abs(n.y) == most ? 1 : 2;
        step[axis] = (n[axis] < 0) == (psi[i] < 0) ? -1 : 1;
        const NodeIndex j = neighbor(i, step);
        if (j == kNoNode) return false;
        const float here = std::abs(psi[i]), there = std::abs(psi[j]);
        return (facing[i] && here <= most && dot(n, normal[j]) < kOtherSheet) ||
               (isLevelSet && (psi[i] < 0) != (psi[j] < 0) && here <= there &&
                here + there > 2 * kHalfEdge * most);
    };
    parallelFor(leaves.size(), 32, [&](std::size_t begin, std::size_t end) {
        for (std::size_t l = begin; l < end; ++l) {
            LeafNodes& core = leaves[l].core;
            core.mask = {};
            // Few nodes come into question. Without branches: a processor would guess half of them
            // wrong.
            const LeafNodes& nodes = leaves[l].band;
            std::array<NodeIndex, 512> some;
            std::size_t count = 0;
            for (NodeIndex i = nodes.firstNode; i < nodes.firstNode + nodes.count; ++i) {
                some[count] = i;
                count +=
                    std::size_t(std::abs(psi[i]) <= kUnit * farthest) | std::size_t(facing[i] != 0);
            }
            for (std::size_t k = 0; k < count; ++k) {
                const NodeIndex i = some[k];
                const Vec3f n = normal[i];
                const float most = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}),
                            edges = std::abs(psi[i]);
                bool is = edges <= kHalfEdge * most;
                if (!is && (facing[i] || edges <= farthest * most)) is = isEndOfEdge(i, n, most);
                core.mask[offset_[i] >> 6] |= std::uint64_t(is) << (offset_[i] & 63);
            }
        }
    });
    for (const NodeIndex i : rim) {
        const Place at = placeOf(i);
        leaves[at.leaf].core.insert(at.offset);
    }
    coreSize_ = 0;
    for (BandLeaf& here : leaves) {
        here.core.number(NodeIndex(coreSize_));
        coreSize_ += here.core.count;
    }
}

void Band::markFacing(NodeIndex i, const Ijk& step) {
    const NodeIndex j = neighbor(i, step);
    if (j == kNoNode) return;
    const Vec3f a = normal[i], b = normal[j];
    if (dot(a, b) > kOtherSheet && !igeo::stacked(Vec3f(step) + footOf(j) - footOf(i), a, b))
        return;
    // Several threads may set one flag: always to 1.
    std::atomic_ref(facing[i]).fetch_or(kFacing, std::memory_order_relaxed);
    std::atomic_ref(facing[j]).fetch_or(kFacing, std::memory_order_relaxed);
}

void Band::markFacing(NodeIndex i) {
    for (int face = 0; face < 6; ++face)
        for (const int steps : {1, 2}) markFacing(i, steps * faceStep(face));
}

void Band::markKink(NodeIndex i) {
    std::atomic_ref(facing[i]).fetch_or(kKink, std::memory_order_relaxed);
    markFacing(i);
}

void Band::markFacing() {
    parallelFor(size(), 4096, [&](std::size_t begin, std::size_t end) {
        // Each pair from one end.
        for (auto i = NodeIndex(begin); i < end; ++i)
            for (int face = 1; face < 6; face += 2)
                for (const int steps : {1, 2}) markFacing(i, steps * faceStep(face));
    });
}

void Band::sever(const std::vector<Link>& links) {
    std::vector<std::pair<NodeIndex, std::uint32_t>> steps;
    steps.reserve(2 * links.size());
    for (const auto& [i, j] : links) {
        const Ijk d = ijk(j) - ijk(i);
        steps.emplace_back(i, SeveredLinks::bit(d.x, d.y, d.z));
        steps.emplace_back(j, SeveredLinks::bit(-d.x, -d.y, -d.z));
    }
    severed_.add(steps);
    for (const auto& step : steps) {
        const NodeIndex i = step.first;
        if (facing[i] & kSevered) continue;
        facing[i] |= kSevered | kBesideSevered;
        forNeighbors(&BandLeaf::band, i,
                     [&](NodeIndex j, int, int, int) { facing[j] |= kBesideSevered; });
    }
}

void Band::markBesideSevered() {
    std::vector<NodeIndex> beside;
    for (NodeIndex i = 0; i < size(); ++i)
        if (facing[i] & kBesideSevered) beside.push_back(i);
    for (const NodeIndex i : beside)
        forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (!inCore(j)) facing[j] |= kBesideSevered;
        });
}

void Band::bridge(const std::vector<Bridge>& bridges) {
    for (const Bridge& b : bridges) {
        bridges_.push_back(b);
        bridges_.push_back({b.to, b.from, b.stretch, b.jump});
        facing[b.from] |= kBridged;
        facing[b.to] |= kBridged;
    }
    std::sort(bridges_.begin(), bridges_.end(), [](const Bridge& a, const Bridge& b) {
        return std::tie(a.from, a.to, a.stretch) < std::tie(b.from, b.to, b.stretch);
    });
}

void Band::stretch(std::vector<StretchedLink> links) {
    stretched_ = std::move(links);
    std::sort(stretched_.begin(), stretched_.end(),
              [](auto& a, auto& b) { return std::tie(a.from, a.bit) < std::tie(b.from, b.bit); });
    for (const StretchedLink& l : stretched_) facing[l.from] |= kStretched;
}

bool Band::severed(NodeIndex i, NodeIndex j) const {
    const std::uint32_t steps = severedSteps(i);
    if (!steps) return false;
    const Ijk d = ijk(j) - ijk(i);
    return steps & SeveredLinks::bit(d.x, d.y, d.z);
}

bool Band::joined(NodeIndex i, NodeIndex j) const {
    if (!(facing[i] & facing[j] & kBesideSevered) || i == j) return true;
    return joined(placeOf(i), ijk(j) - ijk(i), severedSteps(i), severedSteps(j));
}

std::vector<NodeIndex> Band::spineNear(const Vec3d& p) const {
    constexpr int kOff = 2;  // voxels: from a foot point to its node, at most
    std::vector<NodeIndex> found;
    if (spine.empty()) return found;
    const int range = int(std::ceil(kSpineReach)) + kOff;
    const Ijk at = floorToIjk(p), low = leafOrigin(at - Ijk{range, range, range}),
              high = at + Ijk{range + 1, range + 1, range + 1};
    for (int x = low.x; x <= high.x; x += 8)
        for (int y = low.y; y <= high.y; y += 8)
            for (int z = low.z; z <= high.z; z += 8) {
                const LeafIndex l = leafAt({x, y, z});
                if (l == kNoLeaf) continue;
                const LeafNodes& nodes = leaves[l].band;
                for (auto i = std::lower_bound(spine.begin(), spine.end(), nodes.firstNode);
                     i != spine.end() && *i < nodes.firstNode + nodes.count; ++i)
                    if (length(footPoint(*i) - p) <= kSpineReach) found.push_back(*i);
            }
    std::sort(found.begin(), found.end());
    return found;
}

std::size_t Band::memUsage() const {
    return bytes(leaves) + bytes(leafOfBlock_) + bytes(offset_) + bytes(psi) + bytes(foot) +
           bytes(normal) + bytes(facing) + bytes(spine) + severed_.memUsage() + bytes(bridges_) +
           bytes(stretched_) + bytes(table_);
}

BandCell cellAt(const Band& band, const Vec3d& p) {
    BandCell cell;
    cell.low = floorToIjk(p);
    cell.t = p - Vec3d(cell.low);
    const LeafIndex l = band.leafAt(cell.low);
    const unsigned at = Band::offsetOf(cell.low.x, cell.low.y, cell.low.z);
    if (l != kNoLeaf && std::max({cell.low.x & 7, cell.low.y & 7, cell.low.z & 7}) < 7) {
        for (unsigned a = 0; a < 2; ++a) band.leaves[l].band.square(at + 64 * a, &cell.node[4 * a]);
    } else {
        cell.node.fill(kNoNode);
        auto visit = [&](NodeIndex i, std::size_t k) { cell.node[k] = i; };
        if (l != kNoLeaf) {
            band.forCorners(&BandLeaf::band, l, at, {}, visit);
        } else {
            for (std::size_t k = 0; k < 8; ++k) visit(band.nodeAt(cell.voxel(k)), k);
        }
    }
    NodeIndex most = 0;  // kNoNode, if there is one
    for (const NodeIndex i : cell.node) most = std::max(most, i);
    cell.complete = most != kNoNode;
    const Vec3d &up = cell.t, down{1 - up.x, 1 - up.y, 1 - up.z};
    const std::array<double, 4> square{down.x * down.y, down.x * up.y, up.x * down.y, up.x * up.y};
    for (std::size_t k = 0; k < 4; ++k) {
        cell.weight[2 * k] = square[k] * down.z;
        cell.weight[2 * k + 1] = square[k] * up.z;
    }
    return cell;
}

namespace {

void dropParted(const Band& band, NodeIndex onSheet, BandCell& cell) {
    for (NodeIndex& i : cell.node)
        if (i != kNoNode && i != onSheet && band.severed(onSheet, i)) {
            i = kNoNode;
            cell.complete = false;
        }
}

}  // namespace

bool meshJoins(const Band& band, const SurfaceTriangles::Place& at, NodeIndex i) {
    constexpr double kLonger = 1.15, kRoom = 0.1;  // voxels
    const SurfaceTriangles::Place foot = band.footPlace(i);
    return band.triangles->joins(at, foot, kLonger / 2 * length(foot.point - at.point) + kRoom);
}

NodeIndex firstOnSheet(const Band& band, const SurfaceTriangles::Place& at,
                       std::span<std::pair<float, NodeIndex>> nodes) {
    if (nodes.empty()) return kNoNode;
    std::sort(nodes.begin(), nodes.end());
    const auto first = std::find_if(nodes.begin(), nodes.end(), [&](const auto& node) {
        return meshJoins(band, at, node.second);
    });
    return first == nodes.end() ? nodes.front().second : first->second;
}

Vec3d dropFacingCorners(const Band& band, BandCell& cell, const Vec3d& sheetNormal) {
    auto blended = [&] {
        Vec3d sum{};
        for (std::size_t k = 0; k < 8; ++k)
            if (cell.node[k] != kNoNode) sum += cell.weight[k] * Vec3d(band.normal[cell.node[k]]);
        return normalized(sum);
    };
    const Vec3f n(sheetNormal == Vec3d{} ? blended() : sheetNormal);
    std::array<std::pair<float, NodeIndex>, 8> left;
    std::size_t count = 0;
    bool parted = false;
    for (std::size_t k = 0; k < 8; ++k) {
        NodeIndex& i = cell.node[k];
        if (i == kNoNode) continue;
        const Vec3d t = cell.t - Vec3d(double(k >> 2), double(k >> 1 & 1), double(k & 1));
        const Vec3f chord = Vec3f(t) - band.footOf(i);
        const float cosine = dot(n, band.normal[i]), rise = dot(n, chord);
        if (cosine < Band::kOtherSheet ||
            (band.facing[i] & Band::kFacing && stacked(chord, n, band.normal[i]))) {
            i = kNoNode;
            cell.complete = false;
            continue;
        }
        parted |= (band.facing[i] & Band::kSevered) != 0;
        // Where sheets cross, the plane that is meant tells more than the nearest foot point.
        left[count++] = {dot(chord, chord) + rise * rise + (1 - cosine), i};
    }
    if (parted) {
        const std::span nodes(left.data(), count);
        const auto first = std::min_element(nodes.begin(), nodes.end());
        dropParted(
            band,
            band.triangles
                ? firstOnSheet(band, band.triangles->nearest(cell.point(), kInfinity, Vec3d(n)),
                               nodes)
                : first->second,
            cell);
    }
    return sheetNormal == Vec3d{} && !parted ? Vec3d(n) : blended();
}

namespace {

Vec3d fromCorner(const BandCell& cell, std::size_t k) {
    return cell.t - Vec3d(double(k >> 2), double(k >> 1 & 1), double(k & 1));
}

/// What psi at a corner says of the position.
double byCorner(const Band& band, const BandCell& cell, std::size_t k) {
    const NodeIndex i = cell.node[k];
    return double(band.psi[i]) + dot(Vec3d(band.normal[i]), fromCorner(cell, k)) / 2;
}

/// As samplePsi has it where corners are missing.
PsiSample sampleAtRim(const Band& band, const BandCell& cell) {
    constexpr double kLeast = 0.05;
    PsiSample s;
    double there = 0;
    for (std::size_t k = 0; k < 8; ++k) {
        if (cell.node[k] == kNoNode) continue;
        const Vec3d normal(band.normal[cell.node[k]]), chord = fromCorner(cell, k);
        there += cell.weight[k];
        s.psi += cell.weight[k] * (double(band.psi[cell.node[k]]) + dot(normal, chord));
        s.gradient += cell.weight[k] * normal;
    }
    if (there < kLeast) return {};
    s.valid = true, s.psi /= there;
    s.gradient = (1 / there) * s.gradient;
    return s;
}

}  // namespace

double psiAt(const Band& band, const Vec3d& p) {
    const BandCell cell = cellAt(band, p);
    if (!cell.complete) {
        const PsiSample s = sampleAtRim(band, cell);
        return s.valid ? s.psi : std::numeric_limits<double>::quiet_NaN();
    }
    double psi = 0;
    for (std::size_t k = 0; k < 8; ++k) psi += cell.weight[k] * byCorner(band, cell, k);
    return psi;
}

PsiSample samplePsi(const Band& band, const Vec3d& p) {
    PsiSample s;
    const BandCell cell = cellAt(band, p);
    if (!cell.complete) return sampleAtRim(band, cell);
    s.valid = true;
    for (std::size_t k = 0; k < 8; ++k) {
        const Vec3d normal(band.normal[cell.node[k]]);
        const double v = byCorner(band, cell, k);
        const double wx = k >> 2 ? cell.t.x : 1 - cell.t.x,
                     wy = k >> 1 & 1 ? cell.t.y : 1 - cell.t.y,
                     wz = k & 1 ? cell.t.z : 1 - cell.t.z;
        s.psi += cell.weight[k] * v;
        s.gradient += cell.weight[k] / 2 * normal;
        s.gradient.x += (k >> 2 ? v : -v) * wy * wz;
        s.gradient.y += (k >> 1 & 1 ? v : -v) * wx * wz;
        s.gradient.z += (k & 1 ? v : -v) * wx * wy;
    }
    return s;
}

namespace {

bool projectToPsi(const Band& band, Vec3d& pIndex) {
    constexpr double kTolerance = 1e-6;
    Vec3d p = pIndex;
    for (int iteration = 0; iteration < 20; ++iteration) {
        const PsiSample s = samplePsi(band, p);
        if (!s.valid) return false;
        if (std::abs(s.psi) <= kTolerance) {
            pIndex = p;
            return true;
        }
        const double g2 = dot(s.gradient, s.gradient);
        if (g2 < 1e-4) return false;
        // At a crease |grad psi| < 1 and the full Newton step could jump across a thin part.
        const double step = std::min(std::abs(s.psi) / std::sqrt(g2), 1.0);
        p -= (std::copysign(step, s.psi) / std::sqrt(g2)) * s.gradient;
    }
    return false;
}

}  // namespace

bool projectToSurface(const Band& band, Vec3d& pIndex, const Vec3d& sheetNormal) {
    constexpr double kFarthest = 2;
    if (!band.triangles) return projectToPsi(band, pIndex);
    const SurfaceTriangles::Place at = band.triangles->nearest(pIndex, kFarthest, sheetNormal);
    if (at.triangle == SurfaceTriangles::kNone) return false;
    pIndex = at.point;
    return true;
}

Vec3d ontoSurface(const Band& band, const Vec3d& pIndex) {
    Vec3d p = pIndex;
    return projectToSurface(band, p) && length(p - pIndex) < 1 ? p : pIndex;
}

Vec3d surfaceNormal(const Band& band, const Vec3d& p) {
    constexpr double kFarthest = 2;
    if (!band.triangles) {
        const PsiSample psi = samplePsi(band, p);
        return psi.valid ? normalized(psi.gradient) : Vec3d{};
    }
    const SurfaceTriangles::Place at = band.triangles->nearest(p, kFarthest);
    return at.triangle == SurfaceTriangles::kNone ? Vec3d{} : band.triangles->normal(at.triangle);
}

}  // namespace igeo
