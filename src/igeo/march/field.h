/// The distance a march leaves on the band, and how it is read at points of the surface.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/types.h>
#include <igeo/march/seeds.h>
#include <igeo/metric/metric.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace igeo {

struct CoreJets;

/// What a field says at a node of the band.
struct NodeJet {
    double distance = kInfinity;  ///< +inf: not reached, or beyond an early stop
    Vec3f gradient;               ///< as Field::gradient
    std::uint32_t label = 0;      ///< as Field::label; 0 for one source
};

/// Distances in voxels times weight; multiply by band->transform.dx for world units.
struct Field {
    const Band* band = nullptr;  ///< that it lies on; not owned: it has to outlive the field and to
                                 ///< stay where it is
    std::vector<double> distance;  ///< per band node; +inf: not reached, or beyond an early stop
    std::vector<Vec3f> gradient;   ///< per band node, along S, as long as the weight there (1 in
                                   ///< G^-1 where the metric is a tensor G); empty where nothing
                                   ///< was marched
    bool atFootPoints = false;  ///< distance and gradient are those of the foot points (jet), not
                                ///< of the voxels (godunov)
    std::vector<std::uint32_t>
        label;                      ///< per band node: the source it is nearest to; empty for one
    std::vector<std::int8_t> sign;  ///< per band node, of what the sources enclose
                                    ///< (signed_field.h); empty: distances have no sign
    /// The jets of the core, where they were not extended to the band (JetOptions::extend): then
    /// distance, gradient and label are empty, and `at` finds what they would hold. Else null.
    std::shared_ptr<const CoreJets> core;
    std::size_t solved = 0;             ///< nodes that were marched (jet: of the core)
    std::size_t fallbackCount = 0;      ///< of those, solved by the fallback (jet)
    std::vector<SurfacePoint> seeds;    ///< where it starts
    std::vector<std::uint32_t> source;  ///< per seed: the point, curve or region it belongs to
    SeedsNear seedsNear;                ///< finds seeds by place
    MetricPtr metric = std::make_shared<Metric>();  ///< what was marched with; never null
    std::string scheme;                             ///< what computed it, e.g. "godunov, order 2"
    double startRadius = 0;     ///< within it, distances around seeds are exact; voxels
    std::size_t reached = 0;    ///< nodes with a finite distance; of the core if not extended
    double leastStart = 0;      ///< the least start value of its seeds
    StraightLines lines;        ///< below which no distance is (jet)
    double maxDistance = 0;     ///< the largest finite distance
    bool stoppedEarly = false;  ///< a limit ended the march: +inf need not mean unconnected
    double limit = kInfinity;   ///< larger distances are left out

    /// What is known at a node. O(1).
    NodeJet at(NodeIndex i) const { return core ? atCore(i) : atBand(i); }
    std::size_t sourceCount() const { return source.empty() ? 0 : source.back() + 1; }

    /// Sets `reached`, `leastStart`, `maxDistance`, `source` and `seedsNear`.
    void summarize();

private:
    NodeJet atBand(NodeIndex i) const {
        if (!(distance[i] < kInfinity)) return {};
        return {distance[i], gradient.empty() ? Vec3f{} : gradient[i],
                label.empty() ? 0 : label[i]};
    }
    NodeJet atCore(NodeIndex i) const;
};

/// Extends the jets of the core to the whole band, if that was not done by the march.
/// Time O(n), in parallel; 20 bytes per node.
void extendToBand(Field& field);

/// The largest distance on the band, without extending all of it.
double largestOnBand(const Field& field);

/// Calls visit(l, jets) for every leaf of the band, with what is known at its nodes, in their
/// order: for those who need each node once, and no field on the whole band. In parallel.
void forLeaves(const Field& field,
               const std::function<void(LeafIndex, const std::vector<NodeJet>&)>& visit);

/// Gradient of the distance along S per node: M&S 4.1, grad d - (grad d . n) n, by differences of
/// reached neighbors (central where both sides are reached, one-sided otherwise). Its length is
/// the weight up to the scheme's error; zero where nothing is known. Voxel units, in parallel.
/// Reads band, distance and metric; for schemes that leave no gradient of their own.
std::vector<Vec3f> surfaceGradient(const Field& field);

/// Cost of the segment from a point of S, where its normal is `normal`, to a seed next to it,
/// at the seed's metric.
double costToSeed(const Field& field, const SurfacePoint& seed, const Vec3d& pIndex,
                  const Vec3d& normal);

/// The cell around a point of S without the corners that lie on another sheet or behind an
/// obstacle, and the normal blended from those left on the sheet.
/// @param sheetNormal of the sheet that is meant, where two face each other within a cell
struct SurfaceCell : BandCell {
    Vec3d normal;
    SurfaceCell(const Band& band, const Metric& metric, const Vec3d& pIndex,
                const Vec3d& sheetNormal);
};

/// Cost of the segment between two points of S, a voxel or so apart: |b - a| by the metric, the
/// mean of both ends; voxels times weight.
/// @param sheetNormal of their sheet
double segmentCost(const Band& band, const Metric& metric, const Vec3d& a, const Vec3d& b,
                   const Vec3d& sheetNormal);

/// The front that comes first to a point of S.
struct Arrival {
    double distance = kInfinity;  ///< +inf: not reached
    std::uint32_t source = 0;     ///< as Field::label, where there are labels
    /// The seed whose start disc holds the point with nothing in between, where its front is the
    /// first; else nullptr.
    const SurfacePoint* seed = nullptr;
};

/// How all readers read a field. Between the reached corners of the point's cell: trilinear
/// (godunov), or each jet carried there (jet; detail/jet_blend.h); of several fronts, of one source
/// or of several, each is read by itself and the first counts. Within a start disc the straight
/// distance to its seed, as interpolation blunts the cone there. Never below the least start value.
/// @param sheetNormal of the sheet that is meant, where two face each other within a cell
Arrival arrivalAt(const Field& field, const Vec3d& pIndex, const Vec3d& sheetNormal = {});

/// The gradient of the distance along S where a front arrives: index space, as long as the weight
/// there. Blended from the corners of the cell that have the front's source; within a start disc
/// the direction away from the seed. 0 where not reached and at a seed.
/// @param cell  around the point
Vec3d gradientAt(const Field& field, const Arrival& arrival, const Vec3d& pIndex,
                 const SurfaceCell& cell);

/// Its distance.
inline double sampleDistance(const Field& field, const Vec3d& pIndex,
                             const Vec3d& sheetNormal = {}) {
    return arrivalAt(field, pIndex, sheetNormal).distance;
}

}  // namespace igeo
