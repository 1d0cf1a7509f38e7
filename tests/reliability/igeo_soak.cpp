/// Uses the library as a long-lived process would, run after run, and watches the memory in use.
///
/// usage: igeo_soak [--runs N] [--warm-up N]
///
/// The heap in use is compared from round to round, a round being one run of every kind: after the
/// warm-up it must not grow by more than kBound.
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/io/mesh_file.h>
#include <igeo/io/vdb_write.h>
#include <igeo/march/godunov.h>
#include <igeo/march/jet.h>
#include <igeo/path/straighten.h>
#include <igeo/results/field_grids.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/surface/level_set_band.h>
#include <igeo/surface/mesh_band.h>
#include <igeo/surface/point_band.h>
#include <malloc.h>
#include <support/arguments.h>
#include <support/clouds.h>
#include <support/errors.h>
#include <support/field_checks.h>
#include <support/mesh_shapes.h>
#include <support/random_surface.h>
#include <support/temp_dir.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>

namespace igeo::test {
namespace {

/// What the allocator's cache of one thread can hold back in one round and not in another: glibc
/// keeps up to 7 freed pieces of each of 64 sizes up to 1 kB, and counts them as in use. Over 900
/// runs a quarter of a kilobyte lost per run is more.
constexpr double kBound = 7 * 64 * 512;

/// Bytes.
double heapInUse() {
    const auto info = mallinfo2();
    return double(info.uordblks + info.hblkhd);
}
double residentMemory() {
    std::size_t pages = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> pages >> resident;
    return double(resident) * double(sysconf(_SC_PAGESIZE));
}

/// Says stop after some reports.
class StopSoon : public Progress {
public:
    explicit StopSoon(int after) : left_(after) {}
    void update(const char*, double) override { --left_; }
    bool cancelled() const override { return left_ <= 0; }

private:
    std::atomic<int> left_;
};

void require(bool held, const char* what) {
    if (!held) throw std::runtime_error(std::string("not so: ") + what);
}

/// Runs `f`, which has to throw an Error of a kind.
template <typename F>
void requireError(Error::Kind kind, const F& f) {
    try {
        f();
    } catch (const Error& e) {
        require(e.kind() == kind, "the kind of error that is due");
        return;
    }
    require(false, "an error is thrown");
}

LevelSet levelSetOf(unsigned number) {
    const auto transform = openvdb::math::Transform::createLinearTransform(1.5);
    return checkedLevelSet(randomLevelSet(1 + number % 8, number % 2 ? 5 : 0, *transform));
}

void traceAll(const Field& field) {
    const auto targets = spreadPoints(field, 8);
    for (Path& path : tracePaths(field, targets)) straighten(field, path);
}

void volumeRun(unsigned number, const TempDir& folder) {
    const LevelSet s = levelSetOf(number);
    const Band band = bandFromLevelSet(s, std::sqrt(3.0));
    const Field field = marchJet(band, {}, {nearestSurfacePoint(band, {30, 20, 10})});
    traceAll(field);
    const std::string file = folder / "distance.vdb";
    writeVdb(file, {distanceGrid(field, s.psi->transform(), "psi_geodesic")});
    require(readScalarGrid({file, {}}).grid->activeVoxelCount() == field.reached,
            "what is written comes back");
    require(!surfaceMesh(s, field).triangles.empty(), "a mesh comes out");
}

void godunovRun(unsigned number, const TempDir&) {
    const Band band = bandFromLevelSet(levelSetOf(number), std::sqrt(3.0));
    auto metric = std::make_shared<Metric>();
    metric->weight.assign(band.size(), 1.0f + float(number % 3));
    GodunovOptions options;
    options.order = 1 + int(number % 2);
    traceAll(marchGodunov(band, metric, {nearestSurfacePoint(band, {30, 20, 10})}, options));
}

void meshRun(unsigned number, const TempDir& folder) {
    const std::array<const char*, 4> kEndings{"ply", "obj", "off", "stl"};
    const std::string file = folder / (std::string("ball.") + kEndings[number % 4]);
    writeMesh(sphereMesh({1, 2, 3}, 10, 2 + int(number % 2)), file);
    const Band band = bandFromMesh(readMesh(file), 1, std::sqrt(3.0));
    traceAll(marchJet(band, {}, {nearestSurfacePoint(band, {30, 20, 10})}));
}

void cloudRun(unsigned number, const TempDir&) {
    CloudOptions options;
    options.seed = 1 + number % 4;
    options.normals = number % 2;
    const PointSurface surface(sphereCloud(1500, 10, {}, options));
    const Band band = bandFromPoints(surface, PointBandKind::Fits, 0.5, std::sqrt(3.0));
    traceAll(marchJet(band, {}, {nearestSurfacePoint(band, {30, 20, 10})}));
}

void refusedRun(unsigned number, const TempDir& folder) {
    const std::string file = folder / "broken";
    for (const char* ending : {".vdb", ".ply", ".obj"}) {
        std::ofstream(file + ending) << "ply\nformat ascii 1.0\nelement vertex " << number << "\n";
        requireError(Error::Kind::BadInput, [&] {
            if (ending == std::string(".vdb"))
                readLevelSetGrid({file + ending, {}});
            else
                readMesh(file + ending);
        });
    }
    requireError(Error::Kind::BadInput, [&] {
        const auto grid = levelSetOf(number).psi->deepCopy();
        for (auto it = grid->beginValueOn(); it; ++it) it.setValue(std::abs(*it));
        checkedLevelSet(grid);
    });
    const LevelSet s = levelSetOf(number);
    requireError(Error::Kind::InvalidArgument, [&] { bandFromLevelSet(s, 100); });
    requireError(Error::Kind::Io, [&] { writeVdb(folder / "no/such/folder.vdb", {s.psi}); });
}

void cancelledRun(unsigned number, const TempDir&) {
    StopSoon atOnce(0);
    const Band band = bandFromLevelSet(levelSetOf(number), std::sqrt(3.0));
    requireError(Error::Kind::Cancelled,
                 [&] { bandFromLevelSet(levelSetOf(number), std::sqrt(3.0), {}, atOnce); });
    requireError(Error::Kind::Cancelled, [&] {
        StopSoon soon(1 + int(number % 5));
        marchJet(band, {}, {nearestSurfacePoint(band, {30, 20, 10})}, {}, soon);
    });
    requireError(Error::Kind::Cancelled,
                 [&] { bandFromMesh(sphereMesh({}, 10, 3), 1, std::sqrt(3.0), atOnce); });
}

using Run = void (*)(unsigned, const TempDir&);
constexpr std::array<Run, 6> kRuns{volumeRun, godunovRun, meshRun,
                                   cloudRun,  refusedRun, cancelledRun};

bool soak(unsigned runs, unsigned warmUp) {
    const TempDir folder;
    double warm = 0, highest = 0, residentWarm = 0, residentHighest = 0;
    for (unsigned k = 0; k < runs; ++k) {
        {
            const ThreadLimit limit(1 + int(k / kRuns.size() % 3));
            kRuns[k % kRuns.size()](unsigned(k / kRuns.size()), folder);
        }
        // After whole rounds only: what a run leaves in a cache depends on its kind.
        if (k % kRuns.size() != kRuns.size() - 1) continue;
        const double heap = heapInUse(), resident = residentMemory();
        if (k < warmUp) {
            warm = std::max(warm, heap);
            residentWarm = std::max(residentWarm, resident);
        } else {
            highest = std::max(highest, heap);
            residentHighest = std::max(residentHighest, resident);
        }
    }
    std::printf(
        "%u runs: heap in use at most %.1f kB in the first %u runs and %.1f kB after, "
        "resident memory %.1f MB and %.1f MB; %.1f kB more are allowed\n",
        runs, warm / 1024, warmUp, highest / 1024, residentWarm / 1048576,
        residentHighest / 1048576, kBound / 1024);
    return highest - warm <= kBound;
}

}  // namespace
}  // namespace igeo::test

int main(int argc, char** argv) {
    unsigned runs = 0, warmUp = 0;
    try {
        const igeo::test::Arguments args(argc, argv, 1);
        args.require({"runs", "warm-up"});
        runs = unsigned(args.number("runs", 1000)), warmUp = unsigned(args.number("warm-up", 100));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\nusage: igeo_soak [--runs N] [--warm-up N]\n", e.what());
        return 2;
    }
    openvdb::initialize();
    return igeo::test::soak(runs, warmUp) ? 0 : 1;
}
