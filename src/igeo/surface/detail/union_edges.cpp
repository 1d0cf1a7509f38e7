#include <igeo/surface/detail/union_edges.h>

#include <igeo/band/band.h>
#include <igeo/base/parallel.h>
#include <igeo/base/types.h>
#include <igeo/surface/detail/leaf_block.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <unordered_map>
#include <utility>

namespace igeo {

namespace {

using openvdb::Coord;

Vec3d toVec3d(const Coord& c) { return {double(c.x()), double(c.y()), double(c.z())}; }
Coord nearestVoxel(const Vec3d& p) {
    return {int(std::lround(p.x)), int(std::lround(p.y)), int(std::lround(p.z))};
}
template <typename Visit>
void forBox(const Coord& middle, int reach, const Visit& visit) {
    for (int x = -reach; x <= reach; ++x)
        for (int y = -reach; y <= reach; ++y)
            for (int z = -reach; z <= reach; ++z) visit(middle.offsetBy(x, y, z));
}

/// The plane that psi shows at a voxel. Psi counts as negative there, and n points to S.
struct Face {
    Vec3d at, n;
    double psi, laplacian;
    double height(const Vec3d& p) const { return psi + dot(n, p - at); }
    Vec3d foot() const { return at - psi * n; }
};

/// psi and its gradients, leaf by leaf.
class Gradients {
public:
    Gradients(const openvdb::FloatTree& psi, double dx) : psi_(psi), dx_(dx) {}

    /// psi at a voxel in voxels, and NaN at inactive ones.
    double psiAt(const Coord& v) {
        const OfLeaf* leaf = leafOf(v);
        return leaf ? double(leaf->psi[offsetOf(v)]) : double(kMissingVoxel);
    }
    /// The plane at a voxel on one side of S where the gradient is that of a distance without
    /// kinks. It is none where the level sets of psi are round about a hollow edge.
    /// @param side  the sign of psi there
    std::optional<Face> faceAt(const Coord& v, double side) {
        constexpr float kOffUnit = 0.03f, kRound = 0.2f;
        const OfLeaf* leaf = leafOf(v);
        if (!leaf) return std::nullopt;
        const std::size_t at = offsetOf(v);
        const float slope = leaf->slope[at];
        if (!(std::abs(slope - 1) < kOffUnit && float(side) * leaf->psi[at] > 0 &&
              float(side) * leaf->laplacian[at] < kRound))
            return std::nullopt;
        return Face{toVec3d(v), -side / double(slope) * Vec3d(leaf->gradient[at]),
                    -side * double(leaf->psi[at]), double(leaf->laplacian[at])};
    }

private:
    struct OfLeaf {
        std::array<float, 512> psi, laplacian, slope;  ///< slope: NaN where a neighbor is missing
        std::array<Vec3f, 512> gradient;
    };
    static std::size_t offsetOf(const Coord& v) { return LeafBlock::Leaf::coordToOffset(v); }

    const OfLeaf* leafOf(const Coord& v) {
        const Coord origin = v & ~7;
        if (origin != last_ || !looked_) {
            looked_ = true, last_ = origin;
            auto& leaf = leaves_[origin];
            if (!leaf) leaf = make(origin);
            here_ = leaf.get();
        }
        return here_;
    }
    std::unique_ptr<OfLeaf> make(const Coord& origin) {
        auto leaf = std::make_unique<OfLeaf>();
        block_.gather(psi_, origin, dx_, LeafBlock::kFaces);
        std::size_t at = 0;
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y)
                for (int z = 0; z < 8; ++z, ++at) {
                    const PsiDifferences d(block_, x, y, z);
                    const Vec3d gradient = d.central();
                    leaf->laplacian[at] = float(d.laplacian(1));
                    leaf->psi[at] = float(block_.at(x, y, z));
                    leaf->gradient[at] = Vec3f(gradient);
                    leaf->slope[at] = float(length(gradient));
                }
        return leaf;
    }

    const LeafBlock::Accessor psi_;
    double dx_;
    LeafBlock block_;
    std::unordered_map<Coord, std::unique_ptr<OfLeaf>> leaves_;
    Coord last_;
    bool looked_ = false;
    const OfLeaf* here_ = nullptr;
};

/// Looks for the edge that is nearest to a voxel.
class EdgeSearch {
public:
    /// @param most  voxels: no distance is larger
    EdgeSearch(const openvdb::FloatTree& psi, double dx, double most)
        : gradients_(psi, dx), most_(most) {}

    /// In voxels, without sign.
    std::optional<double> distanceTo(const Coord& v) {
        constexpr double kFarther = 0.05, kBetweenVoxels = 0.3, kSameFace = 0.8;
        constexpr int kRounds = 4;
        const double value = gradients_.psiAt(v);
        if (std::isnan(value)) return std::nullopt;
        side_ = value < 0 ? -1 : 1;
        const double depth = std::abs(value);
        const Vec3d here = toVec3d(v);
        std::optional<Face> a = faceAbove(v, depth);
        if (!a) return std::nullopt;
        const Vec3d foot = here + depth * a->n;
        std::optional<Face> b = nearest(nearestVoxel(foot), [&](const Face& f) {
            return dot(f.n, a->n) < double(Band::kOtherSheet) && f.height(foot) < -kInside
                       ? length(f.foot() - foot)
                       : kInfinity;
        });
        if (!b || !(depthInBalls(foot) > std::max(kInside, -b->height(foot) - kBetweenVoxels)))
            return std::nullopt;
        double distance = most_;
        for (int round = 0; round < kRounds && distance <= most_ + 1; ++round) {
            const bool isUnion = b->height(a->at) > a->psi && a->height(b->at) > b->psi;
            const auto toEdge = isUnion ? stepToEdge(*a, *b, here) : std::nullopt;
            if (!toEdge) return std::nullopt;
            distance = length(*toEdge);
            // As planes of curved faces have it: those at the edge count.
            const Vec3d edge = here + *toEdge;
            const auto atEdge = [&](const Face& face) {
                return nearest(nearestVoxel(edge), [&](const Face& f) {
                    return dot(f.n, face.n) > kSameFace ? length(f.foot() - edge) : kInfinity;
                });
            };
            const auto nextA = atEdge(*a), nextB = atEdge(*b);
            if (nextA) a = nextA;
            if (nextB) b = nextB;
        }
        if (!(distance > depth + kFarther) || mayHaveFoot(v, depth)) return std::nullopt;
        return std::min(distance, most_);
    }

private:
    static constexpr double kInside = 0.05;  ///< voxels
    static constexpr int kFar = 2;           ///< how far voxels are looked at

    /// The plane around a voxel for which `off` is least, and finite.
    template <typename Off>
    std::optional<Face> nearest(const Coord& middle, const Off& off) {
        std::optional<Face> found;
        double least = kInfinity;
        forBox(middle, kFar, [&](const Coord& v) {
            const std::optional<Face> face = gradients_.faceAt(v, side_);
            if (!face) return;
            const double here = off(*face);
            if (here < least) least = here, found = face;
        });
        return found;
    }
    /// The nearest plane that is as far from a voxel as psi has it, but for its bend.
    std::optional<Face> faceAbove(const Coord& v, double depth) {
        constexpr double kOff = 0.02, kMostBend = 0.08;
        const Vec3d here = toVec3d(v);
        return nearest(v, [&](const Face& f) {
            const double away = length(f.at - here),
                         bend = std::min(std::abs(f.laplacian) / 2 * away * away, kMostBend);
            // Of planes equally near the one that fits best: it is the same on turned axes.
            const double off = std::abs(f.height(here) + depth);
            return off < kOff + bend ? away + off : kInfinity;
        });
    }
    /// To the line in which planes meet, if it is the nearest part of what is above both.
    static std::optional<Vec3d> stepToEdge(const Face& a, const Face& b, const Vec3d& from) {
        const double toA = -a.height(from), toB = -b.height(from), cosine = dot(a.n, b.n),
                     sine2 = 1 - cosine * cosine, alongA = (toA - cosine * toB) / sine2,
                     alongB = (toB - cosine * toA) / sine2;
        if (!(alongA > 0 && alongB > 0)) return std::nullopt;
        return alongA * a.n + alongB * b.n;
    }
    /// How deep a point is in the balls around voxels in which, as psi has it, there is no S.
    double depthInBalls(const Vec3d& p) {
        double deepest = -kInfinity;
        forBox(nearestVoxel(p), kFar, [&](const Coord& v) {
            const double radius = side_ * gradients_.psiAt(v);
            deepest = std::max(deepest, radius - length(toVec3d(v) - p));
        });
        return deepest;
    }
    /// Whether the foot point of a voxel on some plane beside it may be on S.
    bool mayHaveFoot(const Coord& v, double depth) {
        constexpr double kOff = 0.1;
        const Vec3d here = toVec3d(v);
        bool found = false;
        forBox(v, kFar, [&](const Coord& beside) {
            if (found) return;
            const std::optional<Face> f = gradients_.faceAt(beside, side_);
            found = f && std::abs(f->height(here) + depth) < kOff &&
                    !(depthInBalls(here + depth * f->n) > kInside);
        });
        return found;
    }

    Gradients gradients_;
    double most_;
    double side_ = -1;  ///< the sign of psi
};

}  // namespace

std::vector<EdgeDistance> distancesToUnionEdges(const openvdb::FloatGrid& psi,
                                                const std::vector<Coord>& kinks, double halfWidth) {
    const double dx = psi.transform().voxelSize()[0];
    openvdb::MaskTree seen;
    std::vector<Coord> front;
    const auto add = [&](const Coord& v) {
        if (seen.isValueOn(v) || !psi.tree().isValueOn(v)) return;
        seen.setValueOn(v);
        front.push_back(v);
    };
    for (const Coord& v : kinks) add(v);
    std::vector<EdgeDistance> all;
    while (!front.empty()) {
        const std::vector<Coord> here = std::exchange(front, {});
        std::vector<float> found(here.size());
        parallelFor(here.size(), 256, [&](std::size_t begin, std::size_t end) {
            EdgeSearch search(psi.constTree(), dx, halfWidth / dx);
            for (std::size_t k = begin; k < end; ++k)
                if (const auto distance = search.distanceTo(here[k]))
                    found[k] = float(*distance * dx);
        });
        for (std::size_t k = 0; k < here.size(); ++k) {
            if (!(found[k] > 0)) continue;
            all.push_back({here[k], std::copysign(found[k], psi.tree().getValue(here[k]))});
            forBox(here[k], 1, add);
        }
    }
    return all;
}

}  // namespace igeo
