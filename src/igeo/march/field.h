/// The distance on the band after a march, and its values at points of the surface.
#pragma once

#include <igeo/band/band.h>
#include <igeo/band/surface_point.h>
#include <igeo/base/progress.h>
#include <igeo/base/types.h>
#include <igeo/march/seeds.h>
#include <igeo/metric/metric.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace igeo {

struct CoreJets;
struct LiftedJet;

/// The values of a field at a node of the band.
struct NodeJet {
    double distance = kInfinity;  ///< +infinity: unreached, or beyond an early stop
    Vec3f gradient;               ///< as Field::gradient
    std::uint32_t label = 0;      ///< as Field::label; 0 for one source
};

/// Distances in voxels times weight; multiply by band->transform.dx for world units.
struct Field {
    const Band* band = nullptr;    ///< not owned: it must outlive the field and keep its address
    std::vector<double> distance;  ///< per band node; +infinity: unreached, or beyond an early stop
    /// Per band node, along S, as long as the weight there (1 in G^-1 where the metric is a tensor
    /// G); empty without a march
    std::vector<Vec3f> gradient;
    bool atFootPoints = false;  ///< distance and gradient are those of the foot points (jet), not
                                ///< of the voxels (godunov)
    std::vector<std::uint32_t> label;  ///< per band node: its nearest source; empty for one source
    /// Per band node: negative where the sources enclose it (signed_field.h); empty: distances have
    /// no sign
    std::vector<std::int8_t> sign;
    /// A region inside which the distance is 0.
    struct Region {
        std::shared_ptr<const Obstacles> body;
        std::uint32_t source;
    };
    std::vector<Region> regions;  ///< the first that holds a point counts; none where signs are
    /// The jets of the core, if they are not extended to the band (JetOptions::extend): then
    /// distance, gradient and label are empty, and `at` computes their values. Else null.
    std::shared_ptr<const CoreJets> core;
    /// The same, also once they are extended: points are read from them. Null: another scheme, or
    /// values were changed since.
    std::shared_ptr<const CoreJets> jets;
    std::size_t solved = 0;             ///< nodes that were marched (jet: of the core)
    std::size_t fallbackCount = 0;      ///< of those, solved by the fallback (jet)
    std::vector<SurfacePoint> seeds;    ///< the seeds of the march
    std::vector<std::uint32_t> source;  ///< per seed: the point, curve or region it belongs to
    SeedsNear seedsNear;                ///< finds seeds by position
    MetricPtr metric = std::make_shared<Metric>();  ///< the metric of the march; never null
    std::string scheme;                             ///< the scheme, such as "godunov, order 2"
    bool evenCosts = true;                          ///< one cost everywhere, and no obstacles
    double startRadius = 0;   ///< voxels; closer to a seed, distances are exact
    std::size_t reached = 0;  ///< nodes with a finite distance; of the core if not extended
    double leastStart = 0;    ///< the least start value of its seeds
    StraightLines lines;      ///< lower bounds of the distance (jet)
    /// The largest finite distance; if not extended, of the core, and before rays where fronts meet
    double maxDistance = 0;
    bool stoppedEarly = false;  ///< a limit ended the march: +infinity need not mean unconnected
    double limit = kInfinity;   ///< of nodes: larger distances are dropped
    /// Of points: larger distances count as unreached. The limit of the caller; `limit` may be
    /// less, where targets ended the march.
    double greatest = kInfinity;

    /// The values at a node. O(1).
    NodeJet at(NodeIndex i) const {
        NodeJet jet;
        if (core)
            atCore({&i, 1}, &jet);
        else
            jet = atBand(i);
        return jet;
    }
    /// The same at the corners of a cell, side by side; unreached where there is no node.
    std::array<NodeJet, 8> at(const std::array<NodeIndex, 8>& nodes) const {
        std::array<NodeJet, 8> found;
        if (core)
            atCore(nodes, found.data());
        else
            for (std::size_t k = 0; k < 8; ++k)
                if (nodes[k] != kNoNode) found[k] = atBand(nodes[k]);
        return found;
    }
    /// The same at any nodes, to one jet per node.
    void at(std::span<const NodeIndex> nodes, NodeJet* to) const;
    /// The number of nodes that have values or may have: those of the core, if not extended.
    std::size_t size() const;
    /// Whether each node knows its source.
    bool labeled() const { return core ? sourceCount() > 1 : !label.empty(); }
    std::size_t sourceCount() const { return source.empty() ? 0 : source.back() + 1; }

    /// Sets `reached`, `leastStart`, `maxDistance`, `source` and `seedsNear`.
    void summarize();

private:
    NodeJet atBand(NodeIndex i) const {
        if (!(distance[i] < kInfinity)) return {};
        return {distance[i], gradient.empty() ? Vec3f{} : gradient[i],
                label.empty() ? 0 : label[i]};
    }
    /// @param to  one per node; left as it is for kNoNode
    void atCore(std::span<const NodeIndex> nodes, NodeJet* to) const;
};

/// Extends the jets of the core to the whole band, if the march has not. Time O(n), in parallel; 20
/// bytes per node.
void extendToBand(Field& field);

/// The largest distance on the band, without extending all of it.
double largestOnBand(const Field& field);

/// Calls visit(l, jets) for every leaf of the band, with the values at its nodes in their order:
/// for passes that need each node once, without a field on the whole band. In parallel.
void forLeaves(const Field& field,
               const std::function<void(LeafIndex, std::span<const NodeJet>)>& visit);

/// Gradient of the distance along S per node: M&S 4.1, grad d - (grad d . n) n, by differences of
/// reached neighbors (central where both sides are reached, one-sided otherwise). Its length is the
/// weight up to the scheme's error; zero where d is unknown. Voxel units, in parallel. Reads band,
/// distance and metric; for schemes that compute no gradient of their own.
std::vector<Vec3f> surfaceGradient(const Field& field);

/// Whether the weight jumps on the straight line from a seed to a point near it, so that the
/// shortest path need not be straight. Next to the seed the line says enough.
/// @param here  the weight at the point
bool costsJump(const Band& band, const Metric& metric, const SurfacePoint& seed,
               const Vec3d& pIndex, double here);
/// The mean weight on the straight line from a seed to a point near it, by Simpson's rule.
/// @param here  the weight at the point
double meanFromSeed(const Band& band, const Metric& metric, const SurfacePoint& seed,
                    const Vec3d& pIndex, double here);
/// The same as the scheme has it around seeds: for `godunov` the weight of the seed.
inline double meanToSeed(const Field& field, const SurfacePoint& seed, const Vec3d& pIndex,
                         double here) {
    return field.atFootPoints ? meanFromSeed(*field.band, *field.metric, seed, pIndex, here)
                              : seed.weight;
}
/// Cost of the segment from a point of S with normal `normal` to a seed close to it: a tensor is
/// that of its middle.
double costToSeed(const Field& field, const SurfacePoint& seed, const Vec3d& pIndex,
                  const Vec3d& normal, double here);

/// The cell around a point of S without the corners that lie on another sheet or behind an
/// obstacle, and the normal blended from the remaining corners.
/// @param sheetNormal selects the sheet, where two face each other within a cell
struct SurfaceCell : BandCell {
    Vec3d normal;
    SurfaceCell(const Band& band, const Metric& metric, const Vec3d& pIndex,
                const Vec3d& sheetNormal);
    /// Whether no corner is left.
    bool empty() const {
        return std::all_of(node.begin(), node.end(), [](NodeIndex i) { return i == kNoNode; });
    }
};

/// Cost of the segment between two points of S, about a voxel apart: |b - a| times the mean weight
/// of both ends; voxels times weight.
/// @param sheetNormal of their sheet
double segmentCost(const Band& band, const Metric& metric, const Vec3d& a, const Vec3d& b,
                   const Vec3d& sheetNormal);

/// The first front at a point of S.
struct Arrival {
    double distance = kInfinity;  ///< +infinity: unreached
    std::uint32_t source = 0;     ///< as Field::label, if there are labels
    /// The seed whose start disc contains the point with nothing in between, if its front is the
    /// first; else nullptr.
    const SurfacePoint* seed = nullptr;
};

/// The one function by which results read a field. Between the reached corners of the point's cell:
/// trilinear (godunov), or a blend of the jets extrapolated to the point (jet; detail/jet_blend.h).
/// Where the core around a point of a level set or of points is of one smooth front, of constant
/// cost and far from seeds, its jets alone are blended.
/// Where several fronts, of one source or of several, reach the cell, each is read by itself and
/// the first is used. Within a start disc it is the straight distance to the seed, because
/// interpolation would blunt the cone there. Never below the least start value.
/// @param sheetNormal selects the sheet, where two face each other within a cell
Arrival arrivalAt(const Field& field, const Vec3d& pIndex, const Vec3d& sheetNormal = {});

/// Reads a field at many points of S, side by side: as arrivalAt, to the bit, if no error is
/// allowed. Nothing is extended to the band.
class ArrivalReader {
public:
    /// Time and memory O(core).
    /// @param field   must outlive the reader
    /// @param points  to be read, roughly
    explicit ArrivalReader(const Field& field,
                           std::size_t points = std::numeric_limits<std::size_t>::max());
    /// Several threads may read at a time.
    /// @param sheetNormals  of the points: those of S, roughly
    /// @param to            as many as points
    /// @param tolerance     voxels: from 0.01 on, the core alone is read on meshes too, from 0.1
    ///                      on also where fronts meet
    /// @param isSmooth      if not null, per point: whether one smooth front is known to pass it
    void read(std::span<const Vec3d> points, std::span<const Vec3f> sheetNormals, Arrival* to,
              double tolerance = 0, std::uint8_t* isSmooth = nullptr) const;

private:
    friend class SharedPoints;
    /// @return the points that want more care: they are not read
    std::vector<std::size_t> readFromCore(std::span<const Vec3d> points,
                                          std::span<const Vec3f> sheetNormals, Arrival* to,
                                          double tolerance = 0,
                                          std::uint8_t* isSmooth = nullptr) const;

    const Field& field_;
    bool fromCore_;
    std::shared_ptr<const std::vector<LiftedJet>> lifted_;  ///< of the core; empty: few points
};

struct ReadPlace;

/// Points of S at which several fields on one band in one metric are read: the surface around each
/// is looked at once. Some 250 bytes per point beside creases, thin walls and cut loci.
class SharedPoints {
public:
    SharedPoints(const Band& band, const std::vector<SurfacePoint>& points);
    ~SharedPoints();
    SharedPoints(const SharedPoints&) = delete;
    SharedPoints& operator=(const SharedPoints&) = delete;

    /// As ArrivalReader, to the bit. Several threads may read at a time.
    std::vector<Arrival> read(const Field& field) const;

private:
    struct Places;
    const ReadPlace& placeOf(const Field& field, std::size_t k) const;

    std::vector<Vec3d> point_;
    std::vector<Vec3f> normal_;
    std::unique_ptr<Places> places_;
};

/// The same in parallel.
/// @throws Error  Cancelled
std::vector<Arrival> arrivalsAt(const Field& field, const std::vector<Vec3d>& points,
                                const std::vector<Vec3f>& sheetNormals, double tolerance = 0,
                                const Progress& progress = Progress::none());

constexpr std::uint32_t kAnySource = std::numeric_limits<std::uint32_t>::max();
/// The gradient of the front that arrives first at a point of S, along S: blended from the corners
/// of its cell with directions within 45 degrees, or over a crease. Where fronts meet, the mean of
/// all would lead along the line where they do.
/// @param cell    around the point
/// @param source  of the fronts that count
/// @return 0 where corners are unreached, and where fronts meet head on over a crease, or godunov's
Vec3d gradientOfFirst(const Field& field, const Vec3d& pIndex, const SurfaceCell& cell,
                      std::uint32_t source = kAnySource);

/// The gradient of the distance along S at an arrival: index space, as long as the weight there.
/// Blended from the corners of the cell with the front's source; within a start disc the direction
/// away from the seed. 0 where unreached and at a seed.
/// @param cell  around the point
Vec3d gradientAt(const Field& field, const Arrival& arrival, const Vec3d& pIndex,
                 const SurfaceCell& cell);

/// The distance of arrivalAt.
inline double sampleDistance(const Field& field, const Vec3d& pIndex,
                             const Vec3d& sheetNormal = {}) {
    return arrivalAt(field, pIndex, sheetNormal).distance;
}

}  // namespace igeo
