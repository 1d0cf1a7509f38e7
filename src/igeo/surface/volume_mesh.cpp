#include <igeo/surface/volume_mesh.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;

/// Strides and neighbors of voxels in an array.
struct Lattice {
    std::array<std::size_t, 3> size;

    std::size_t count() const { return size[0] * size[1] * size[2]; }
    /// Calls visit(neighbor) for the six neighbors of a voxel; beyond the border it is the voxel
    /// itself.
    template <typename Visit>
    void forBeside(std::size_t k, const Visit& visit) const {
        std::size_t step = 1, rest = k;
        for (const std::size_t n : size) {
            const std::size_t at = rest % n;
            visit(at > 0 ? k - step : k);
            visit(at + 1 < n ? k + step : k);
            step *= n;
            rest /= n;
        }
    }
};

/// The voxels next to one of the other class, ascending.
std::vector<std::size_t> atBorder(const Lattice& lattice, const std::vector<float>& sides) {
    std::vector<std::size_t> voxels;
    for (std::size_t k = 0; k < sides.size(); ++k) {
        bool isAtBorder = false;
        lattice.forBeside(k, [&](std::size_t j) { isAtBorder |= sides[j] != sides[k]; });
        if (isAtBorder) voxels.push_back(k);
    }
    return voxels;
}

/// A function with the sign of `sides` (1 and -1) in every voxel, smooth where the two meet:
/// repeated averages over neighbors, clamped to the sign of each voxel.
std::vector<float> smoothed(const Lattice& lattice, const std::vector<float>& sides,
                            const Progress& progress) {
    // In trials with balls and tilted planes, fewer rounds leave more of the staircase, and more
    // shrink small bodies.
    constexpr int kRounds = 8;
    constexpr float kLeast = 1e-3f;
    const std::vector<std::size_t> voxels = atBorder(lattice, sides);
    std::vector<float> values = sides, next(voxels.size());
    for (int round = 0; round < kRounds; ++round) {
        progress.throwIfCancelled();
        parallelFor(voxels.size(), 4096, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                const std::size_t k = voxels[v];
                float sum = 0;
                lattice.forBeside(k, [&](std::size_t j) { sum += values[j]; });
                const float mean = 0.25f * values[k] + 0.125f * sum;
                next[v] = sides[k] > 0 ? std::max(mean, kLeast) : std::min(mean, -kLeast);
            }
        });
        for (std::size_t v = 0; v < voxels.size(); ++v) values[voxels[v]] = next[v];
    }
    return values;
}

/// The values of a grid, and the value of the surface.
struct Samples {
    std::vector<float> values;
    float iso = 0;
    float spread = 1;  ///< half the range of the values
};

/// Whether most voxels at the border of the volume are `iso` or more.
bool mostlyAboveAtBorder(const Lattice& lattice, const Samples& samples) {
    std::size_t above = 0, all = 0;
    for (std::size_t k = 0; k < lattice.count(); ++k) {
        bool isBorder = false;
        lattice.forBeside(k, [&](std::size_t j) { isBorder |= j == k; });
        all += isBorder;
        above += isBorder && samples.values[k] >= samples.iso;
    }
    return 2 * above > all;
}

/// The grid of the samples, with `background` around it.
openvdb::FloatGrid::Ptr gridOf(const Lattice& lattice, Samples& samples, float background) {
    openvdb::initialize();
    const openvdb::Coord last(int(lattice.size[0]) - 1, int(lattice.size[1]) - 1,
                              int(lattice.size[2]) - 1);
    const openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> dense(
        openvdb::CoordBBox(openvdb::Coord(0), last), samples.values.data());
    auto grid = openvdb::FloatGrid::create(background);
    openvdb::tools::copyFromDense(dense, *grid, 0.0f);
    return grid;
}

/// Appends the polygons within the volume; those that close its border toward the background are no
/// surface.
class MeshMaker {
public:
    MeshMaker(const VoxelVolume& volume, const std::vector<openvdb::Vec3s>& points, bool turned)
        : points_(points), turned_(turned) {
        for (std::size_t a = 0; a < 3; ++a) last_[a] = float(volume.size[a]) - 1;
        for (const openvdb::Vec3s& p : points)
            mesh.points.push_back(volume.worldFromIndex({p.x(), p.y(), p.z()}));
        mesh.file = volume.file;
    }
    void triangle(openvdb::Index32 a, openvdb::Index32 b, openvdb::Index32 c) {
        if (!isWithin(a) || !isWithin(b) || !isWithin(c)) return;
        if (turned_) std::swap(b, c);
        mesh.triangles.push_back({a, b, c});
    }
    void quad(const openvdb::Vec4I& q) {
        for (int k = 0; k < 4; ++k)
            if (!isWithin(q[k])) return;
        // Along the shorter diagonal.
        const bool first = (points_[q[0]] - points_[q[2]]).lengthSqr() <=
                           (points_[q[1]] - points_[q[3]]).lengthSqr();
        const int k = first ? 0 : 1;
        triangle(q[k], q[k + 1], q[k + 2]);
        triangle(q[k], q[k + 2], q[(k + 3) % 4]);
    }

    TriangleMesh mesh;

private:
    bool isWithin(openvdb::Index32 i) const {
        for (int a = 0; a < 3; ++a)
            if (points_[i][a] < 0 || points_[i][a] > last_[std::size_t(a)]) return false;
        return true;
    }

    const std::vector<openvdb::Vec3s>& points_;
    std::array<float, 3> last_{};
    bool turned_;
};

Samples samplesOf(const VoxelVolume& volume, const VolumeRange& range, double iso,
                  const Progress& progress) {
    const Lattice lattice{volume.size};
    if (range.isMask) {
        std::vector<float> sides(volume.values.size());
        for (std::size_t k = 0; k < sides.size(); ++k)
            sides[k] = double(volume.values[k]) >= iso ? 1.0f : -1.0f;
        return {smoothed(lattice, sides, progress), 0, 1};
    }
    // A surface through the centers of voxels, as whole-number thresholds give, would have
    // coinciding points.
    const float spread = 0.5f * (range.high - range.low);
    return {volume.values, float(iso) - 1e-4f * spread, spread};
}

/// Empty where single precision holds the values well.
std::string roundingWarning(const VoxelVolume& volume, const VolumeRange& range) {
    // Of 100 voxels across a distance this is a thousandth of a voxel.
    constexpr double kMost = 1e-5, kSingle = 6e-8, kWhole = 1 << 22;
    const double low = double(range.low), high = double(range.high),
                 largest = std::max(std::abs(low), std::abs(high));
    if (kSingle * largest <= kMost * (high - low)) return {};
    const bool isExact =
        largest < kWhole && std::all_of(volume.values.begin(), volume.values.end(),
                                        [](float v) { return v == std::floor(v); });
    if (isExact) return {};
    return fmt::format(
        "values from {:.9g} to {:.9g} are rounded by up to {:.2g} in single precision, and the "
        "surface is as rough as that: subtract {:.3g} from all",
        low, high, kSingle * largest, 0.5 * (low + high));
}

double chosenIso(const VoxelVolume& volume, const VolumeRange& range, std::optional<double> iso) {
    const double low = double(range.low), high = double(range.high);
    if (!(low < high))
        throw Error(
            Kind::BadInput,
            fmt::format("all voxels of '{}' are {:.6g}: there is no surface", volume.file, low),
            "give another volume");
    if (!iso && !range.isMask)
        throw Error(Kind::BadInput,
                    fmt::format("'{}' has values from {:.6g} to {:.6g}, and none is said to be the "
                                "surface",
                                volume.file, low, high),
                    "give one in between as the iso of volumeMesh()");
    const double value = iso.value_or(0.5 * (low + high));
    if (value > low && value <= high) return value;
    throw Error(Kind::InvalidArgument,
                fmt::format("no surface has the value {:.6g}: '{}' goes from {:.6g} to {:.6g}",
                            value, volume.file, low, high),
                "give a value in between as the iso of volumeMesh()");
}

}  // namespace

VolumeRange rangeOf(const VoxelVolume& volume) {
    VolumeRange range;
    if (volume.values.empty()) return range;
    const auto [least, most] = std::minmax_element(volume.values.begin(), volume.values.end());
    range.low = *least;
    range.high = *most;
    range.isMask = range.low < range.high &&
                   std::all_of(volume.values.begin(), volume.values.end(),
                               [&](float v) { return v == range.low || v == range.high; });
    return range;
}

VolumeFacts volumeFacts(const VoxelVolume& volume) {
    const auto& axis = volume.axis;
    return {volume.kind,
            volume.size,
            {length(axis[0]), length(axis[1]), length(axis[2])},
            rangeOf(volume)};
}

TriangleMesh volumeMesh(const VoxelVolume& volume, std::optional<double> asked,
                        Progress& progress) {
    const VolumeRange range = rangeOf(volume);
    const double iso = chosenIso(volume, range, asked);
    const Lattice lattice{volume.size};
    Samples samples = samplesOf(volume, range, iso, progress);
    // The outside gets the value of most border voxels, so that the fewest polygons are dropped.
    const bool above = mostlyAboveAtBorder(lattice, samples);
    const float beyond = samples.iso + (above ? samples.spread : -samples.spread);
    const openvdb::FloatGrid::Ptr grid = gridOf(lattice, samples, beyond);
    progress.throwIfCancelled();

    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    std::vector<openvdb::Vec4I> quads;
    openvdb::tools::volumeToMesh(*grid, points, triangles, quads, double(samples.iso));
    progress.throwIfCancelled();
    MeshMaker maker(volume, points, above == volume.mirrors());
    for (const openvdb::Vec3I& t : triangles) maker.triangle(t[0], t[1], t[2]);
    for (const openvdb::Vec4I& q : quads) maker.quad(q);
    TriangleMesh mesh = std::move(maker.mesh);
    mesh.warnings = volume.warnings;
    if (const std::string rounded = roundingWarning(volume, range); !rounded.empty())
        mesh.warnings.push_back(rounded);
    if (range.isMask)
        mesh.warnings.push_back(
            "the volume is a mask: its staircase was smoothed, and every voxel stays on its side "
            "of the surface" +
            (asked ? fmt::format("; the iso of volumeMesh() changes nothing between {:.6g} and "
                                 "{:.6g}",
                                 range.low, range.high)
                   : ""));
    weld(mesh);
    if (mesh.triangles.empty())
        throw Error(Kind::BadInput,
                    fmt::format("the surface of value {:.6g} in '{}' lies beyond its voxels", iso,
                                volume.file),
                    "give a volume that reaches further");
    return mesh;
}

}  // namespace igeo
