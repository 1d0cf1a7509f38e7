#include <igeo/surface/detail/hollow_edges.h>

#include <igeo/surface/detail/psi_around.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

namespace igeo {

namespace {

/// Voxels: in front of a hollow edge the step lowers no larger |psi| much.
constexpr float kFarthest = 1.5f;

/// What a row shows.
/// @param complete  bits: voxels with all face neighbors
template <int Width>
IGEO_INLINE void lookAtRow(const LeafBlock& block, int x, int y, unsigned complete,
                           std::uint8_t& plane, std::uint8_t& mayBeLowered) {
    // Inside, in front of no hollow edge, the renormalization has changed nothing.
    constexpr float kInside = -0.2f, kFlat = 0.03f;
    using V = typename Registers<Width>::Vector;
    unsigned planes = 0, kinks = 0;
    for (int z = 0; z < 8; z += Width) {
        auto at = [&](int i, int j, int k) __attribute__((always_inline)) {
            return loadLanes<Width>(block.row(x + i, y + j) + z + k);
        };
        const V here = at(0, 0, 0);
        auto flat = here < kInside;
        const auto isNear = absolute(here) < kFarthest;
        if (!bitsOf<Width>(flat | isNear)) continue;
        V square{};
        auto add = [&](const V& low, const V& high) __attribute__((always_inline)) {
            const V slope = (high - low) / 2;
            flat &= absolute(high + low - 2 * here) < kFlat;
            square += slope * slope;
        };
        add(at(-1, 0, 0), at(1, 0, 0)), add(at(0, -1, 0), at(0, 1, 0));
        add(at(0, 0, -1), at(0, 0, 1));
        kinks |= bitsOf<Width>(isNear & ~PsiRow<Width>::isSmooth(square)) << z;
        takeRoots<Width>(square);
        planes |= bitsOf<Width>(flat & (absolute(square - 1) < kFlat)) << z;
    }
    plane = std::uint8_t(planes & complete);
    mayBeLowered = std::uint8_t(kinks & complete);
}

template <int Width>
IGEO_INLINE void findHere(const LeafBlock& block, HollowEdges::Shown& shown) {
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y) {
            const auto at = std::size_t(8 * x + y);
            shown.plane[at] = shown.mayBeLowered[at] = 0;
            if (const unsigned complete = PsiRow<Width>::completeIn(block, x, y))
                lookAtRow<Width>(block, x, y, complete, shown.plane[at], shown.mayBeLowered[at]);
        }
}

void findByFour(const LeafBlock& block, HollowEdges::Shown& shown) { findHere<4>(block, shown); }
#ifdef IGEO_AVX2
IGEO_AVX2 void findByEight(const LeafBlock& block, HollowEdges::Shown& shown) {
    findHere<8>(block, shown);
}
#endif

bool hasAny(const HollowEdges::Bits& bits) {
    std::uint64_t any = 0;
    for (std::size_t row = 0; row < bits.size(); row += 8) any |= loadAs<std::uint64_t>(&bits[row]);
    return any != 0;
}

}  // namespace

/// What psi was around a leaf before OpenVDB's renormalization, in voxels.
class HollowEdges::Before {
public:
    Before(const openvdb::FloatTree& psi, double dx, const std::vector<Shown>& shown)
        : tree_(psi), psi_(psi, dx), shown_(shown) {}

    /// @return false where there is no face
    bool moveTo(const openvdb::Coord& origin) {
        origin_ = origin;
        isGathered_ = false;
        unsigned any = 0;
        for (int x = -1; x <= 1; ++x)
            for (int y = -1; y <= 1; ++y) any |= takePlanes(x, y);
        return any != 0;
    }
    /// Whether there is a face within reach.
    bool besideFace(const Ijk& v) const {
        for (int x = -kReach; x <= kReach; ++x)
            for (int y = -kReach; y <= kReach; ++y)
                if (planesAround(v, x, y)) return true;
        return false;
    }
    /// Then psi is known too.
    void gather() {
        if (isGathered_) return;
        isGathered_ = true;
        psi_.moveTo({origin_.x(), origin_.y(), origin_.z()});
        sharp_.fill(kUnknown);
    }
    float stored(const Ijk& v) const { return psi_.voxel(v); }
    /// The least height over the planes of faces, if that is more than the stored value.
    float sharp(const Ijk& v) {
        float& known = sharp_[indexOf(v)];
        if (std::isnan(known)) known = overPlanes(v);
        return known;
    }
    /// What the renormalization makes of it.
    float renormalized(const Ijk& v) {
        constexpr auto kOffset = float(kRenormalizedAbout);
        const float p = sharp(v) - kOffset, side = p > 0 ? 1.0f : -1.0f;
        float square = 0;
        for (std::size_t a = 0; a < 3; ++a) {
            const float before = p - (sharp(v - unit(a)) - kOffset),
                        after = p - (sharp(v + unit(a)) - kOffset),
                        most = std::max({side * before, side * after, 0.0f});
            square += most * most;
        }
        const float step = p / std::sqrt(p * p + square) * (std::sqrt(square) - 1);
        return std::min(p, p - step) + kOffset;
    }

private:
    static constexpr int kReach = 2;            ///< voxels to the faces
    static constexpr int kMargin = kReach + 1;  ///< of what is known of faces, around the leaf
    static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

    struct Height {
        float height = float(kInfinity);
        Vec3f slope;
    };

    static Ijk unit(std::size_t axis) { return {axis == 0, axis == 1, axis == 2}; }
    static std::size_t indexOf(const Ijk& v) {
        return std::size_t((10 * (v.x + 1) + v.y + 1) * 10 + v.z + 1);
    }
    static std::size_t rowOf(int x, int y) {
        return std::size_t((8 + 2 * kMargin) * (x + kMargin) + y + kMargin);
    }
    /// The planes in a leaf.
    const Bits& planesOf(const openvdb::Coord& origin) const {
        static constexpr Bits kNone{};
        const LeafBlock::Leaf* leaf = tree_.probeConstLeaf(origin);
        return leaf ? shown_[leaf->transientData()].plane : kNone;
    }
    /// Takes the bits of the three leaves in a column.
    /// @param sx, sy  leaves to the column
    /// @return all bits
    unsigned takePlanes(int sx, int sy) {
        auto first = [](int step) { return step < 0 ? 8 - kMargin : 0; };
        auto last = [](int step) { return step > 0 ? kMargin : 8; };
        constexpr unsigned kAll = (1u << (8 + 2 * kMargin)) - 1;
        const openvdb::Coord origin = origin_.offsetBy(8 * sx, 8 * sy, 0);
        const Bits &low = planesOf(origin.offsetBy(0, 0, -8)), &here = planesOf(origin),
                   &high = planesOf(origin.offsetBy(0, 0, 8));
        unsigned any = 0;
        for (int x = first(sx); x < last(sx); ++x)
            for (int y = first(sy); y < last(sy); ++y) {
                const auto at = std::size_t(8 * x + y);
                const unsigned column =
                    low[at] | unsigned(here[at]) << 8 | unsigned(high[at]) << 16;
                any |= planes_[rowOf(x + 8 * sx, y + 8 * sy)] = column >> (8 - kMargin) & kAll;
            }
        return any;
    }
    /// Bits by z + kReach: faces in the row (x, y) beside a voxel.
    unsigned planesAround(const Ijk& v, int x, int y) const {
        constexpr unsigned kAcross = (1u << (2 * kReach + 1)) - 1;
        return planes_[rowOf(v.x + x, v.y + y)] >> (v.z + kMargin - kReach) & kAcross;
    }
    Vec3f slopeAt(const Ijk& v) const {
        Vec3f slope;
        for (std::size_t a = 0; a < 3; ++a)
            slope[int(a)] = (stored(v + unit(a)) - stored(v - unit(a))) / 2;
        return slope;
    }
    float overPlanes(const Ijk& v) {
        constexpr float kOneFace = 0.9f, kAgree = 0.2f;
        const float value = stored(v);
        if (!(std::abs(value) < kFarthest)) return value;
        std::size_t count = 0;
        Height least;
        float most = float(kInfinity);
        for (int x = -kReach; x <= kReach; ++x)
            for (int y = -kReach; y <= kReach; ++y)
                for (unsigned bits = planesAround(v, x, y); bits; bits &= bits - 1) {
                    const Ijk step{x, y, std::countr_zero(bits) - kReach};
                    const Vec3f slope = slopeAt(v + step);
                    const float inside = stored(v + step);
                    const Height h{inside - dot(slope, Vec3f(step)), slope};
                    heights_[count++] = h;
                    if (h.height < least.height) least = h;
                    most = std::min(most, inside + length(Vec3f(step)));
                }
        if (!(least.height < most)) return value;
        bool otherFace = false;
        for (std::size_t k = 0; k < count; ++k) {
            const bool same = dot(heights_[k].slope, least.slope) > kOneFace;
            if (same && heights_[k].height > least.height + kAgree) return value;
            otherFace |= !same;
        }
        return otherFace ? std::max(value, least.height) : value;
    }

    LeafBlock::Accessor tree_;
    PsiAround psi_;
    const std::vector<Shown>& shown_;
    openvdb::Coord origin_;
    bool isGathered_ = false;
    std::array<unsigned, 14 * 14> planes_;  ///< bits by row and z + kMargin
    std::array<float, 10 * 10 * 10> sharp_;
    /// In work: over the planes around a voxel.
    std::array<Height, (2 * kReach + 1) * (2 * kReach + 1) * (2 * kReach + 1)> heights_;
};

HollowEdges::Shown HollowEdges::shownBy(const LeafBlock& block) {
    Shown shown;
#ifdef IGEO_AVX2
    if (eightAtATime()) return findByEight(block, shown), shown;
#endif
    return findByFour(block, shown), shown;
}

HollowEdges::HollowEdges(const openvdb::FloatTree& psi, double dx, const std::vector<Shown>& shown)
    : before_(std::make_unique<Before>(psi, dx, shown)), shown_(shown), dx_(dx) {}
HollowEdges::~HollowEdges() = default;

void HollowEdges::look(const LeafBlock::Leaf& leaf, std::vector<LoweredVoxel>& lowered) {
    // Voxels. Heights are less exact where faces are narrow or bend.
    constexpr float kNearly = 0.2f, kLeast = 0.03f;
    const Bits& mayBe = shown_[leaf.transientData()].mayBeLowered;
    const openvdb::Coord origin = leaf.origin();
    if (!hasAny(mayBe) || !before_->moveTo(origin)) return;
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (unsigned bits = mayBe[std::size_t(8 * x + y)]; bits; bits &= bits - 1) {
                const Ijk v{x, y, std::countr_zero(bits)};
                if (!before_->besideFace(v)) continue;
                before_->gather();
                const float value = before_->stored(v), was = before_->sharp(v);
                if (!(was > value + kLeast)) continue;
                const float off = std::abs(before_->renormalized(v) - value);
                if (off < kNearly)
                    lowered.push_back(
                        {origin.offsetBy(v.x, v.y, v.z), float(double(was) * dx_), off});
            }
}

}  // namespace igeo
