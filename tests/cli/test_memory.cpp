// The memory that info predicts, beside that of runs.
#include <igeo/io/vdb_write.h>
#include <openvdb/tools/FastSweeping.h>
#include <support/random_surface.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "program.h"

namespace igeo::test {

namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kExtraMemory = true;
#elif defined(__has_feature)
constexpr bool kExtraMemory = bool(__has_feature(address_sanitizer));
#else
constexpr bool kExtraMemory = false;
#endif

/// A ball of 90 units with the channels of a gyroid in it: folds, in which fronts meet all over,
/// and creases.
openvdb::FloatGrid::Ptr sponge() {
    constexpr double kRadius = 45, kPeriod = 25;
    const auto sdf = [](const openvdb::Vec3d& p) {
        const openvdb::Vec3d q = (2 * M_PI / kPeriod) * p;
        const double gyroid = std::sin(q.x()) * std::cos(q.y()) +
                              std::sin(q.y()) * std::cos(q.z()) + std::sin(q.z()) * std::cos(q.x());
        return std::max(p.length() - kRadius, kPeriod / (2 * M_PI) / 1.5 * gyroid);
    };
    const openvdb::BBoxd bounds(openvdb::Vec3d(-kRadius), openvdb::Vec3d(kRadius));
    return openvdb::tools::sdfToSdf(
        *makeLevelSet(Shape{"sponge", sdf, bounds, true, nullptr}, /*dx=*/0.3, 4));
}

struct Memory {
    double predicted, used;  ///< MB
};

/// Of runs on one thread from where a ray along x first meets the surface: the median of so many.
Memory memoryOf(const TempWorkspace& desk, const std::string& file, std::size_t runs) {
    const Result survey = desk.run("info --json " + file);
    INFO(survey.err);
    REQUIRE(survey.exitCode == 0);
    const json surface = parseJson(survey.out)["surface"];
    const json box = surface["components"][0]["box"];
    std::string seed, comma;
    double size = 0;
    for (int a = 0; a < 3; ++a) {
        const double low = box[0][a], high = box[1][a];
        seed += comma + std::to_string(a == 0 ? high : (low + high) / 2);
        comma = ",";
        size = std::max(size, high - low);
    }
    std::vector<double> used(runs);
    for (double& bytes : used) {
        const Result done = desk.run(file + " --seed " + seed + " --snap " + std::to_string(size) +
                                     " --threads 1 -q -o out.vdb --report r.json");
        INFO(done.err);
        REQUIRE((done.exitCode == 0 || done.exitCode == kUnreached));
        bytes = reportOf(desk)["peakMemoryBytes"].get<double>();
    }
    std::sort(used.begin(), used.end());
    return {1e-6 * surface["estimate"]["bytes"].get<double>(), 1e-6 * used[runs / 2]};
}

/// Pages that the processes which this one started, and which ended, touched first.
long touchedPages() {
    rusage usage{};
    ::getrusage(RUSAGE_CHILDREN, &usage);
    return usage.ru_minflt;
}

bool systemHasLargePages() {
    std::ifstream setting("/sys/kernel/mm/transparent_hugepage/enabled");
    std::string all;
    std::getline(setting, all);
    return !all.empty() && all.find("[never]") == all.npos;
}

}  // namespace

TEST_CASE("the memory of a run is in large pages") {
    if (kExtraMemory) return markSkipped("the address sanitizer has a heap of its own");
    if (!systemHasLargePages()) return markSkipped("this system has no large pages");
    const TempWorkspace desk;
    const auto pagesOf = [&](const std::string& file) {
        const long before = touchedPages();
        const Result done = desk.run(file + " --seed 0.5,0,0 --threads 1 -q -o out.vdb");
        INFO(done.err);
        REQUIRE(done.exitCode == 0);
        return double(touchedPages() - before);
    };
    desk.make("least.vdb", "sphere --voxel-size 0.05 --param radius=0.5");
    desk.make("ball.vdb", "sphere --voxel-size 0.004 --param radius=0.5");
    const double least = pagesOf("least.vdb");  // of the program and its libraries
    INFO(least << " pages");
    // 650,000 nodes. Of pages of 4 KB the run touched 6565 more; now 83, of either kind.
    CHECK(pagesOf("ball.vdb") - least < 2000);
}

TEST_CASE("info predicts the memory of a run, whatever the level set is like") {
    if (kExtraMemory) return markSkipped("the address sanitizer takes memory of its own");
    const TempWorkspace desk;
    // The program and its libraries, which differ by machine. The system decides about single pages
    // of 2 MB, 1 MB to either side here: the surfaces take 57 to 142 MB.
    desk.make("least.vdb", "sphere --voxel-size 0.1");
    const Memory least = memoryOf(desk, "least.vdb", 5);
    const std::string ball = "sphere --voxel-size 0.003 --param radius=0.5";
    desk.make("ball.vdb", ball);
    desk.make("wide.vdb", ball + " --half-width 10");
    desk.make("double.vdb", ball + " --double");
    desk.make("box.vdb", "box --voxel-size 0.0045");
    writeVdb(desk / "union.vdb",
             {randomLevelSet(5, 0, *openvdb::math::Transform::createLinearTransform(0.09))});
    writeVdb(desk / "sponge.vdb", {sponge()});
    for (const char* file :
         {"ball.vdb", "wide.vdb", "double.vdb", "box.vdb", "union.vdb", "sponge.vdb"}) {
        const Memory m = memoryOf(desk, file, 1);
        const double ratio = (m.predicted - least.predicted) / (m.used - least.used);
        INFO(file << ": " << m.predicted << " MB predicted, " << m.used
                  << " used, beside the least " << least.predicted << " and " << least.used);
        CHECK(ratio == Approx(1.0).margin(0.1));  // 0.06 off at the most
    }
}

}  // namespace igeo::test
