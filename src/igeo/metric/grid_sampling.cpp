#include <igeo/metric/grid_sampling.h>

#include <igeo/base/detail/box.h>
#include <igeo/base/detail/steps.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/base/symmetric_eigen.h>
#include <igeo/metric/index_map.h>
#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <atomic>
#include <optional>

namespace igeo {

namespace {

using Kind = Error::Kind;

bool isWeight(float w) { return w > 0 && w < float(kInfinity); }

/// Reads a grid trilinearly at points of a band's index space. For one thread.
template <typename Grid, typename Sum>
class Trilinear {
public:
    struct Sample {
        Sum value{};
        bool active = false;  ///< at least one voxel around is active
        bool covered = true;  ///< all voxels around are active
    };

    Trilinear(const Grid& grid, const IndexMap& map)
        : voxels_(grid.constTree()), background_(grid.background()), map_(map) {}

    Sample at(const Vec3d& pIndex) const {
        const Vec3d p = map_(pIndex);
        if (!hasIjk(p)) return {Sum(background_), false, false};
        const Ijk low = floorToIjk(p);
        const Vec3d t = p - Vec3d(low);
        Sample s;
        for (int k = 0; k < 8; ++k) {
            const int a = k >> 2, b = k >> 1 & 1, c = k & 1;
            const double share = (a ? t.x : 1 - t.x) * (b ? t.y : 1 - t.y) * (c ? t.z : 1 - t.z);
            if (share == 0) continue;  // A value with share 0 has no effect, not even NaN.
            typename Grid::ValueType value;
            const bool active = voxels_.probeValue({low.x + a, low.y + b, low.z + c}, value);
            s.value += share * Sum(active ? value : background_);
            s.active |= active;
            s.covered &= active;
        }
        return s;
    }

private:
    openvdb::tree::ValueAccessor<const typename Grid::TreeType, false> voxels_;
    typename Grid::ValueType background_;
    IndexMap map_;
};

/// A weight, or the reason why a value is none.
class WeightReader {
public:
    using Value = float;

    WeightReader(const LoadedGrid& grid, const Band& band, const std::string& where)
        : grid_(*grid.grid, indexMap(band.transform, grid.grid->transform(), where)),
          background_(grid.grid->background()) {}

    /// @param active  set where a voxel of the grid is active
    bool read(const Vec3d& foot, float& weight, bool& active) const {
        const auto s = grid_.at(foot);
        active |= s.active;
        weight = float(s.value);
        return isWeight(weight) && (s.covered || isWeight(background_));
    }
    std::string fault(const Vec3d& foot) const {
        const auto s = grid_.at(foot);
        if (!s.covered && !isWeight(background_))
            return fmt::format("the weight does not cover the surface there: background is {:g}",
                               background_);
        return fmt::format("the weight is {:g} there; it must be positive and finite", s.value);
    }
    static const char* remedy() {
        return "give positive weights all along the surface, or a positive background; for places "
               "no path may enter use MetricDefinition::obstacles";
    }

private:
    Trilinear<openvdb::FloatGrid, double> grid_;
    float background_;
};

/// A tensor, or the reason why a value is none.
class TensorReader {
public:
    using Value = Tensor;

    TensorReader(const TensorGrids& grids, const Band& band, const std::string& where)
        : axis_(band.transform.axis),
          diagonal_(*grids.diagonal, indexMap(band.transform, grids.diagonal->transform(), where)),
          background_(grids.diagonal->background()) {
        if (grids.offdiagonal)
            offdiagonal_.emplace(*grids.offdiagonal,
                                 indexMap(band.transform, grids.offdiagonal->transform(), where));
    }

    bool read(const Vec3d& foot, Tensor& tensor, bool& active) const {
        const World g = worldAt(foot);
        active |= g.active;
        tensor = turned(g.matrix);
        return g.covered && isFinite(tensor) && isPositive(eigenvalues(g.matrix));
    }
    std::string fault(const Vec3d& foot) const {
        const World g = worldAt(foot);
        if (!g.covered)
            return "the tensor does not cover the surface there: background is " +
                   background_.str();
        if (!isFinite(turned(g.matrix))) return "the tensor is NaN or infinite there";
        const auto [least, largest] = eigenvalues(g.matrix);
        return fmt::format(
            "the tensor is not positive definite there: its least eigenvalue is {:g}, its largest "
            "{:g}; the least must be above 1e-6 of the largest",
            least, largest);
    }
    static const char* remedy() {
        return "give symmetric tensors with three positive eigenvalues all along the surface; for "
               "places that no path may enter use MetricDefinition::obstacles";
    }

private:
    using Matrix = openvdb::math::Mat3d;
    struct World {
        Matrix matrix;
        bool active, covered;
    };
    using Vectors = Trilinear<openvdb::Vec3SGrid, openvdb::Vec3d>;

    World worldAt(const Vec3d& foot) const {
        const auto d = diagonal_.at(foot);
        const auto o = offdiagonal_ ? offdiagonal_->at(foot) : Vectors::Sample{};
        const openvdb::Vec3d &m = d.value, &n = o.value;
        return {{m[0], n[0], n[1], n[0], m[1], n[2], n[1], n[2], m[2]},
                d.active,
                d.covered || (isWeight(background_[0]) && isWeight(background_[1]) &&
                              isWeight(background_[2]))};
    }
    /// Q^T G Q.
    Tensor turned(const Matrix& g) const {
        const auto component = [&](std::size_t a, std::size_t b) {
            double sum = 0;
            for (int r = 0; r < 3; ++r)
                for (int c = 0; c < 3; ++c) sum += axis_[a][r] * g(r, c) * axis_[b][c];
            return float(sum);
        };
        return {component(0, 0), component(1, 1), component(2, 2),
                component(0, 1), component(0, 2), component(1, 2)};
    }
    static bool isFinite(const Tensor& t) {
        const float sum = std::abs(t.xx) + std::abs(t.yy) + std::abs(t.zz) + std::abs(t.xy) +
                          std::abs(t.xz) + std::abs(t.yz);
        return std::isfinite(sum);
    }
    static std::pair<double, double> eigenvalues(const Matrix& g) {
        const auto e = symmetricEigenvalues({g(0, 0), g(1, 1), g(2, 2), g(0, 1), g(0, 2), g(1, 2)});
        return {e[0], e[2]};
    }
    static bool isPositive(const std::pair<double, double>& e) {
        return e.first > 1e-6 * e.second && e.second > 0;
    }

    std::array<Vec3d, 3> axis_;
    Vectors diagonal_;
    std::optional<Vectors> offdiagonal_;
    openvdb::Vec3s background_;
};

/// World space, as the next two.
std::string describe(const Box& box) {
    return fmt::format("{} to {}", textOf(box.low), textOf(box.high));
}

Box boxOf(const Band& band) {
    Box box;
    for (std::size_t k = 0; k < band.size(); ++k)
        box.include(band.transform.worldFromIndex(band.footPoint(NodeIndex(k))));
    return box;
}

Box boxOf(const openvdb::GridBase& grid) {
    const auto voxels = grid.evalActiveVoxelBoundingBox();
    Box box;
    for (int k = 0; k < 8; ++k) {
        const auto corner = [&](unsigned a) {
            return k >> a & 1 ? voxels.max()[a] + 0.5 : voxels.min()[a] - 0.5;
        };
        const openvdb::Vec3d p = grid.indexToWorld(openvdb::Vec3d(corner(0), corner(1), corner(2)));
        box.include({p.x(), p.y(), p.z()});
    }
    return box;
}

/// The reader's values at the foot points of all nodes.
template <typename Reader>
std::vector<typename Reader::Value> readAll(const Reader& reader, const openvdb::GridBase& grid,
                                            const Band& band, const std::string& where,
                                            Progress& progress) {
    const std::string remedy = "check the grid's transform against that of the surface";
    if (grid.activeVoxelCount() == 0)
        throw Error(Kind::BadInput, "the grid has no active voxels" + where, remedy);
    std::vector<typename Reader::Value> values(band.size());
    std::vector<std::uint8_t> good(band.size());
    std::atomic<bool> met{false};
    Steps steps(progress, "metric", band.size());
    parallelFor(band.size(), 4096, progress, [&](std::size_t begin, std::size_t end) {
        const Reader mine = reader;
        bool active = false;
        for (std::size_t k = begin; k < end; ++k)
            good[k] = mine.read(band.footPoint(NodeIndex(k)), values[k], active);
        if (active) met = true;
        steps.add(end - begin);
    });
    if (!met)
        throw Error(Kind::BadInput,
                    "none of the grid's active voxels lies at the surface: they span " +
                        describe(boxOf(grid)) + " in the world, the surface " +
                        describe(boxOf(band)) + where,
                    remedy);
    const auto first = std::find(good.begin(), good.end(), 0);
    if (first == good.end()) return values;
    const Vec3d foot = band.footPoint(NodeIndex(first - good.begin()));
    throw Error(Kind::BadInput,
                fmt::format("at {}, the first of {} bad places, {}{}",
                            textOf(band.transform.worldFromIndex(foot)),
                            std::count(first, good.end(), 0), reader.fault(foot), where),
                Reader::remedy());
}

template <typename Source>
std::string whereOf(const Source& grid) {
    return " (" + grid.file + ", grid '" + grid.name + "')";
}

}  // namespace

std::vector<float> sampleWeight(const LoadedGrid& grid, const Band& band, Progress& progress) {
    const std::string where = whereOf(grid);
    return readAll(WeightReader(grid, band, where), *grid.grid, band, where, progress);
}

double leastWeight(const LoadedGrid& grid) {
    double least = kInfinity;
    // Comparisons with NaN are false: NaN is ignored here and refused where the weight is read.
    for (auto it = grid.grid->cbeginValueOn(); it; ++it) least = std::min(least, double(*it));
    if (isWeight(grid.grid->background())) least = std::min(least, double(grid.grid->background()));
    return least < kInfinity ? std::max(least, 0.0) : 0;
}

std::vector<Tensor> sampleTensor(const TensorGrids& grids, const Band& band, Progress& progress) {
    const std::string where = whereOf(grids);
    return readAll(TensorReader(grids, band, where), *grids.diagonal, band, where, progress);
}

}  // namespace igeo
