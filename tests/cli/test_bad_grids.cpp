// Files that hold something other than one sound level set.
#include <support/catch.h>

#include "program.h"

namespace igeo::test {

namespace {

struct BadGrid {
    std::string kind;               ///< of make_shape bad
    std::vector<std::string> says;  ///< what the message has to name
};

/// Refused in a file, and the same from standard input.
void requireGridRefused(const BadGrid& bad) {
    const TempWorkspace desk;
    desk.make("in.vdb", "bad " + bad.kind);
    auto says = bad.says;
    says.push_back("in.vdb");
    requireRefused(desk, "--sdf in.vdb --seed 1,0,0 -o out.vdb --report out.json", kUnusable, says);

    Command piped = desk.command("--sdf - --seed 1,0,0 -o out.vdb");
    piped.stdinBytes = readBytes(desk / "in.vdb");
    says.back() = "standard input";
    requireRefused(desk, piped, kUnusable, says);
}

}  // namespace

TEST_CASE("a file without a level set is refused with what it holds") {
    const BadGrid bad = GENERATE(
        BadGrid{"no-grids", {"holds no grids", "level set"}},
        BadGrid{"fog", {"holds no level set", "'density' (float, fog volume)", "fogToSdf"}},
        BadGrid{"vector", {"holds no level set", "'velocity' (vec3s, unknown)", "float or double"}},
        BadGrid{"int", {"holds no level set", "'psi' (int32, level set)", "float or double"}});
    requireGridRefused(bad);
}

TEST_CASE("a grid that is no signed distance is refused with what it shows") {
    const BadGrid bad = GENERATE(
        BadGrid{"empty", {"no active voxels", "grid 'psi'"}},
        BadGrid{"positive", {"positive everywhere", "grid 'psi'", "negative inside"}},
        // every hundredth of 30367 voxels
        BadGrid{"nan", {"304 voxels are NaN or infinite", "index -19,-9,-9", "grid 'psi'"}},
        BadGrid{"inf", {"304 voxels are NaN or infinite", "index -19,-9,-9", "grid 'psi'"}},
        BadGrid{"scaled-values", {"not a distance", "[0.75, 1.25]", "grid 'psi'", "voxel size"}},
        BadGrid{"hollow", {"hollow", "more than 50 %", "grid 'psi'", "--mesh"}});
    requireGridRefused(bad);
}

TEST_CASE("a transform that does not keep distances is refused by its name") {
    const BadGrid bad =
        GENERATE(BadGrid{"nonuniform", {"not cubes", "0.05, 0.05, 0.1", "grid 'psi'", "resample"}},
                 // a slant of 0.3: the axes meet at acos(0.3 / sqrt(1.09)) = 73.3 degrees
                 BadGrid{"sheared", {"shears", "73.3 degrees, not 90", "grid 'psi'", "resample"}},
                 BadGrid{"frustum", {"Frustum", "not linear", "grid 'psi'", "resample"}});
    requireGridRefused(bad);
}

TEST_CASE("among several level sets one has to be named") {
    const TempWorkspace desk;
    desk.make("two.vdb", "bad two-level-sets");
    desk.make("same.vdb", "bad same-name");
    const std::string rest = " --seed 1,0,0 -q -o out.vdb";
    requireRefused(desk, "--sdf two.vdb" + rest, kUnusable,
                   {"file 'two.vdb'", "2 level sets", "'psi_a'", "'psi_b'", "two.vdb:psi_a"});
    requireRefused(desk, "--sdf same.vdb" + rest, kUnusable,
                   {"file 'same.vdb'", "2 level sets", "'psi[0]'", "'psi[1]'", "same.vdb:psi[0]"});
    requireRefused(desk, "--sdf two.vdb:psi" + rest, kUnusable,
                   {"file 'two.vdb'", "no grid 'psi'", "'psi_a'", "'psi_b'"});
    for (const char* source : {"two.vdb:psi_a", "two.vdb:psi_b", "same.vdb:psi[1]"})
        CHECK(requireDone(desk, "--sdf " + std::string(source) + rest).err.empty());
}

TEST_CASE("a grid of the wrong kind is refused when it is named as well") {
    const TempWorkspace desk;
    desk.make("fog.vdb", "bad fog");
    desk.make("vector.vdb", "bad vector");
    requireRefused(desk, "--sdf fog.vdb:density --seed 1,0,0 -o out.vdb", kUnusable,
                   {"'density'", "fog volume", "file 'fog.vdb'"});
    requireRefused(desk, "--sdf vector.vdb:velocity --seed 1,0,0 -o out.vdb", kUnusable,
                   {"'velocity'", "vec3s", "float or double", "file 'vector.vdb'"});
}

}  // namespace igeo::test
