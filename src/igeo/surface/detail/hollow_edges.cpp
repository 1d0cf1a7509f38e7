#include <igeo/surface/detail/hollow_edges.h>

#include <igeo/surface/detail/psi_around.h>

#include <bit>
#include <cmath>
#include <vector>

namespace igeo {

namespace {

/// Voxels: in front of a hollow edge the step lowers no larger |psi| much.
constexpr float kFarthest = 1.5f;

/// Bits by row: voxels of a leaf that a hollow edge may have lowered.
using LeafBits = std::array<std::uint8_t, 64>;

template <int Width>
IGEO_INLINE void findLoweredHere(const LeafBlock& block, LeafBits& mayBe) {
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y) {
            unsigned bits = within<Width>(block.row(x, y), kFarthest);
            if (bits) {
                const PsiRow<Width> row(block, x, y);
                bits &= row.complete & ~row.smooth;
            }
            mayBe[std::size_t(8 * x + y)] = std::uint8_t(bits);
        }
}

void findLoweredByFour(const LeafBlock& block, LeafBits& mayBe) {
    findLoweredHere<4>(block, mayBe);
}
#ifdef IGEO_AVX2
IGEO_AVX2 void findLoweredByEight(const LeafBlock& block, LeafBits& mayBe) {
    findLoweredHere<8>(block, mayBe);
}
#endif

void findLowered(const LeafBlock& block, LeafBits& mayBe) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return findLoweredByEight(block, mayBe);
#endif
    findLoweredByFour(block, mayBe);
}

}  // namespace

/// What psi was around a leaf before OpenVDB's renormalization, in voxels.
class HollowEdges::Before {
public:
    Before(const openvdb::FloatTree& psi, double dx) : psi_(psi, dx) {}

    void moveTo(const Ijk& origin) {
        psi_.moveTo(origin);
        faces_.fill(Face::Unknown);
        sharp_.fill(kUnknown);
    }
    float stored(const Ijk& v) const { return psi_.voxel(v); }
    /// The least height over the planes of faces, if that is more than the stored value.
    float sharp(const Ijk& v) {
        float& known = sharp_[indexOf(v, 1)];
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
    static constexpr int kReach = 2;  ///< voxels to the faces
    static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
    /// Whether psi around a voxel is that of one face.
    enum class Face : std::uint8_t { Unknown, None, Plane };

    static Ijk unit(std::size_t axis) { return {axis == 0, axis == 1, axis == 2}; }
    static std::size_t indexOf(const Ijk& v, int margin) {
        const int edge = 8 + 2 * margin;
        return std::size_t(((v.x + margin) * edge + v.y + margin) * edge + v.z + margin);
    }
    float bend(const Ijk& v, const Ijk& step) const {
        return stored(v + step) + stored(v - step) - 2 * stored(v);
    }
    /// The slope of psi around a voxel on one face; null elsewhere.
    const Vec3f* slopeAt(const Ijk& v) {
        const std::size_t k = indexOf(v, 1 + kReach);
        if (faces_[k] == Face::Unknown)
            faces_[k] = isOnPlane(v, slopes_[k]) ? Face::Plane : Face::None;
        return faces_[k] == Face::Plane ? &slopes_[k] : nullptr;
    }
    bool isOnPlane(const Ijk& v, Vec3f& slope) const {
        // Inside, in front of no hollow edge, the renormalization has changed nothing.
        constexpr float kInside = -0.2f, kFlat = 0.03f;
        if (!(stored(v) < kInside)) return false;
        for (std::size_t a = 0; a < 3; ++a) {
            if (!(std::abs(bend(v, unit(a))) < kFlat)) return false;
            slope[int(a)] = (stored(v + unit(a)) - stored(v - unit(a))) / 2;
        }
        return std::abs(length(slope) - 1) < kFlat;
    }
    float overPlanes(const Ijk& v) {
        constexpr float kOneFace = 0.9f, kAgree = 0.2f;
        const float value = stored(v);
        if (!(std::abs(value) < kFarthest)) return value;
        struct Height {
            float height = float(kInfinity);
            Vec3f slope;
        };
        std::array<Height, (2 * kReach + 1) * (2 * kReach + 1) * (2 * kReach + 1)> heights;
        std::size_t count = 0;
        Height least;
        float most = float(kInfinity);
        for (int x = -kReach; x <= kReach; ++x)
            for (int y = -kReach; y <= kReach; ++y)
                for (int z = -kReach; z <= kReach; ++z) {
                    const Ijk step{x, y, z};
                    const Vec3f* const slope = slopeAt(v + step);
                    if (!slope) continue;
                    const float inside = stored(v + step);
                    const Height h{inside - dot(*slope, Vec3f(step)), *slope};
                    heights[count++] = h;
                    if (h.height < least.height) least = h;
                    most = std::min(most, inside + length(Vec3f(step)));
                }
        if (!(least.height < most)) return value;
        bool otherFace = false;
        for (std::size_t k = 0; k < count; ++k) {
            const bool same = dot(heights[k].slope, least.slope) > kOneFace;
            if (same && heights[k].height > least.height + kAgree) return value;
            otherFace |= !same;
        }
        return otherFace ? std::max(value, least.height) : value;
    }

    PsiAround psi_;
    std::array<Face, 14 * 14 * 14> faces_;
    std::array<Vec3f, 14 * 14 * 14> slopes_;  ///< set on planes
    std::array<float, 10 * 10 * 10> sharp_;
};

HollowEdges::HollowEdges(const openvdb::FloatTree& psi, double dx)
    : before_(std::make_unique<Before>(psi, dx)), dx_(dx) {}
HollowEdges::~HollowEdges() = default;

void HollowEdges::look(const LeafBlock& block, const openvdb::Coord& origin,
                       std::vector<LoweredVoxel>& lowered) {
    // Voxels. Heights are less exact where faces are narrow or bend.
    constexpr float kNearly = 0.2f, kLeast = 0.03f;
    bool moved = false;
    LeafBits mayBe;
    findLowered(block, mayBe);
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (unsigned bits = mayBe[std::size_t(8 * x + y)]; bits; bits &= bits - 1) {
                if (!moved) before_->moveTo({origin.x(), origin.y(), origin.z()});
                moved = true;
                const Ijk v{x, y, std::countr_zero(bits)};
                const float value = before_->stored(v), was = before_->sharp(v);
                if (was > value + kLeast && std::abs(before_->renormalized(v) - value) < kNearly)
                    lowered.push_back({origin.offsetBy(v.x, v.y, v.z), float(double(was) * dx_)});
            }
}

}  // namespace igeo
