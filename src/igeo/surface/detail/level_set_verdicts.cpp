#include <igeo/surface/detail/level_set_verdicts.h>

#include <fmt/core.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numeric>

namespace igeo {

namespace {

using Kind = Error::Kind;
using Leaf = LeafBlock::Leaf;

/// The share of voxels with |grad psi| in [0.9, 1.1] by differences to one side of kinks
/// (psiGradient): in parts of about two voxels most voxels lie at kinks.
double gradientShareBesideKinks(const LevelSet& s) {
    constexpr double kTolerance = 0.1;
    const std::vector<const Leaf*> leaves = leavesOf(*s.psi);
    std::vector<std::uint64_t> all(leaves.size()), good(leaves.size());
    parallelFor(leaves.size(), 64, [&](std::size_t begin, std::size_t end) {
        const LeafBlock::Accessor psi(s.psi->constTree());
        const auto block = std::make_unique<LeafBlock>();
        for (std::size_t l = begin; l < end; ++l) {
            block->gather(psi, leaves[l]->origin(), s.transform.dx, LeafBlock::kFaces);
            for (auto it = leaves[l]->cbeginValueOn(); it; ++it) {
                const openvdb::Coord at = Leaf::offsetToLocalCoord(it.pos());
                const PsiDifferences d(*block, at.x(), at.y(), at.z());
                if (!d.complete()) continue;
                const double slope = length(psiGradient(d, block->at(at.x(), at.y(), at.z())));
                ++all[l];
                good[l] += std::abs(slope - 1) <= kTolerance;
            }
        }
    });
    const auto sum = [](const std::vector<std::uint64_t>& n) {
        return double(std::accumulate(n.begin(), n.end(), std::uint64_t(0)));
    };
    return sum(all) > 0 ? sum(good) / sum(all) : 0;
}

constexpr const char* kClampRemedy =
    "clamp psi at 3 voxels or more and switch off the voxels that it clamps; or redistance it by "
    "rebuilt(), which needs no more than the voxels beside the surface";

/// Where many voxels hold the largest |psi|, as in dense grids of truncated distances: a sentence
/// on that. Else empty.
std::string clampOf(const LevelSet& s) {
    constexpr double kMany = 0.05, kSame = 1 - 1e-6;
    const double most = kSame * s.stats.halfWidth * s.transform.dx;
    std::size_t clamped = 0;
    for (const Leaf* leaf : leavesOf(*s.psi))
        for (auto it = leaf->cbeginValueOn(); it; ++it) clamped += std::abs(double(*it)) >= most;
    const double share = double(clamped) / double(std::max<std::size_t>(s.stats.activeVoxels, 1));
    if (share < kMany) return "";
    return fmt::format("; psi is clamped: {} of the voxels have the largest |psi|, {:.4g}",
                       percent(share), s.stats.halfWidth * s.transform.dx);
}

void judgeGradient(LevelSet& s) {
    const LevelSetStats& st = s.stats;
    const std::string remedy =
        "values in voxel units must be multiplied by the voxel size, those of a grid whose "
        "transform was scaled by the same factor; anything else must be redistanced by rebuilt(); "
        "what is too thin or too rough for its voxels stays none";
    if (std::isnan(st.gradientMedian))
        throw Error(Kind::BadInput,
                    fmt::format("psi is not a distance: it is up to {:.3g} voxels, and no voxel "
                                "has six active neighbors, as most of a distance have{}",
                                st.halfWidth, where(s)),
                    remedy);
    if (std::abs(st.gradientMedian - 1) > 0.1 || st.gradientShare < 0.7) {
        constexpr double kThinDistance = 0.75;  // beams of 2.1 voxels: 0.84; noise of 0.6: 0.64
        if (gradientShareBesideKinks(s) >= kThinDistance) {
            s.warnings.push_back(fmt::format(
                "{:.0f} % of the voxels lie where psi has a kink between two sheets: much of the "
                "surface is two voxels thin or less, and results there are unreliable; smaller "
                "voxels, or the mesh itself, tell the sheets apart",
                100 * (1 - st.gradientShare)));
            return;
        }
        const std::string clamp = clampOf(s);
        const std::string seen = fmt::format(
            "psi changes by {:.3g} per unit length (median), and {:.0f} % of its voxels lie in "
            "[0.75, 1.25]; a signed distance has 1 and at least 70 %{}",
            st.gradientMedian, 100 * st.gradientShare, clamp);
        throw Error(Kind::BadInput, "psi is not a distance: " + seen + where(s),
                    clamp.empty() ? remedy : std::string(kClampRemedy) + "; " + remedy);
    }
    if (st.gradientShare < 0.95)
        s.warnings.push_back(
            fmt::format("{:.1f} % of the voxels have |grad psi| outside [0.75, 1.25]: psi is a "
                        "rough distance, and results near there are unreliable",
                        100 * (1 - st.gradientShare)));
    else if (constexpr double kClear = 0.03;
             st.dividedBy == 1 && std::abs(st.gradientMedian - 1) > kClear)
        s.warnings.push_back(
            fmt::format("psi changes by {:.3g} per unit length (median), where a distance changes "
                        "by 1, as where it was filtered, or scaled along one axis: results are off "
                        "by parts of a voxel; redistance it by rebuilt()",
                        st.gradientMedian));
}

}  // namespace

std::string where(const LevelSet& s) { return " (" + s.file + ", grid '" + s.name + "')"; }

std::vector<const LeafBlock::Leaf*> leavesOf(const openvdb::FloatGrid& grid) {
    std::vector<const LeafBlock::Leaf*> leaves;
    grid.constTree().getNodes(leaves);
    return leaves;
}

void judgeExtent(const LevelSet& s) {
    for (const Leaf* leaf : leavesOf(*s.psi))
        for (std::size_t a = 0; a < 3; ++a)
            if (const openvdb::Coord o = leaf->origin();
                o[a] <= -kFarthestIndex || o[a] >= kFarthestIndex)
                throw Error(
                    Kind::BadInput,
                    fmt::format(
                        "voxels at index {},{},{}: indices must lie within -2^30 and 2^30 ({}){}",
                        o.x(), o.y(), o.z(), kFarthestIndex, where(s)),
                    "give the grid indices near 0 and put where it lies into its "
                    "transform");
}

void judgeRange(const LevelSet& s) {
    const LevelSetStats& st = s.stats;
    if (st.badVoxels)
        throw Error(
            Kind::BadInput,
            fmt::format("{} voxels are NaN or infinite, the first at index {},{},{}{}",
                        st.badVoxels, st.firstBad.x, st.firstBad.y, st.firstBad.z, where(s)),
            "rebuild the level set from its source");
    if (st.negative == 0 || st.negative == st.activeVoxels)
        throw Error(Kind::BadInput,
                    std::string("psi is ") + (st.negative ? "negative" : "positive") +
                        " everywhere: there is no surface where it changes sign" + where(s),
                    "give a signed distance, negative inside; of an unsigned one, rebuilt(psi, D) "
                    "makes the surface at distance D; open surfaces can be given as TriangleMesh");
    if (st.halfWidth < 0.9) {
        const std::string clamp = clampOf(s);
        throw Error(
            Kind::BadInput,
            fmt::format(
                "active voxels reach only {:.3g} voxels from the surface, 1 is the least{}{}",
                st.halfWidth, clamp, where(s)),
            clamp.empty()
                ? "check that psi is in world units; rebuild the level set with a half-width of 3"
                : kClampRemedy);
    }
}

void judgeShape(LevelSet& s) {
    const LevelSetStats& st = s.stats;
    if (st.nearSurface == 0)
        throw Error(
            Kind::BadInput,
            "no voxel lies within one voxel of the surface; the least |psi| is larger" + where(s),
            "check that psi is in world units and zero on the surface");
    judgeGradient(s);
    if (st.crossingShare < 0.2)
        throw Error(
            Kind::BadInput,
            fmt::format("only {:.1f} % of the voxels next to the surface see the other sign (a "
                        "closed surface: more than 50 %): psi is hollow, as it becomes when an "
                        "open mesh is turned into a level set{}",
                        100 * st.crossingShare, where(s)),
            "give the mesh itself as TriangleMesh, which may be open; or close it (fill its holes) "
            "before converting it");
    if (st.crossingShare < 0.45)
        s.warnings.push_back(
            fmt::format("only {:.0f} % of the voxels next to the surface see the other sign: parts "
                        "of psi look hollow, as from an open mesh",
                        100 * st.crossingShare));
    constexpr double kManyLowered = 0.001;
    if (double(st.loweredVoxels) > kManyLowered * double(st.nearSurface))
        s.warnings.push_back(fmt::format(
            "hollow edges are rounded next to {} of the surface, as OpenVDB's conversion "
            "from a mesh does: {} voxels get back what they had, but distances over hollow edges "
            "that are acute, bend or lie close to others may be off by voxels; the mesh itself has "
            "sharp ones",
            percent(double(st.loweredVoxels) / double(st.nearSurface)), st.loweredVoxels));
    if (st.cutVoxels)
        s.warnings.push_back(
            fmt::format("{} voxels of the surface lie at the edge of the volume: the surface is "
                        "cut there, and no path passes",
                        st.cutVoxels));
}

}  // namespace igeo
