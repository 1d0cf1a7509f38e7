// Command lines that make no sense.
#include <support/catch.h>

#include <filesystem>

#include "option_words.h"
#include "program.h"

namespace igeo::test {

namespace {

struct BadLine {
    std::string line;  ///< behind "--sdf in.vdb --seed 0,0,1 -o out.vdb "
    std::vector<std::string> says;
};

}  // namespace

TEST_CASE("a wrong option is refused by its name, with the values allowed") {
    const BadLine bad = GENERATE(
        BadLine{"--color", {"--color", "--help"}},
        BadLine{"other.vdb", {"'other.vdb' excludes --sdf", "one of the two"}},
        BadLine{"--max-distance", {"--max-distance", "D is missing"}},
        BadLine{"--order 3", {"--order", "3", "1 to 2"}}, BadLine{"--order two", {"--order"}},
        BadLine{"--threads -1", {"--threads", "-1", "0 to 4096"}},
        BadLine{"--threads all", {"--threads", "all"}},
        BadLine{"--scheme dijkstra", {"--scheme", "dijkstra", "jet", "godunov"}},
        BadLine{"--space local", {"--space", "local", "world", "index"}},
        BadLine{"--grids paint", {"--grids", "'paint'", "surface, gradient"}},
        BadLine{"--progress sometimes", {"--progress", "auto", "always", "never"}},
        BadLine{"--band -0.2", {"--band", "-0.2", "above 0"}},
        BadLine{"--band nan", {"--band", "nan", "above 0"}},
        BadLine{"--band-voxels 0", {"--band-voxels", "0", "above 0"}},
        BadLine{"--max-distance inf", {"--max-distance", "inf", "above 0"}},
        BadLine{"--snap -1", {"--snap", "-1", "at least 0"}},
        BadLine{"--band 0.2 --band-voxels 2", {"--band", "--band-voxels", "excludes"}},
        BadLine{"--matrix m.csv --scheme godunov", {"--matrix", "jet", "godunov", "--report"}},
        BadLine{"--pairs p.csv --scheme godunov", {"--pairs", "jet", "godunov", "--report"}});
    const Sphere desk;
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 -o out.vdb " + bad.line, kUsage, bad.says);
}

TEST_CASE("a malformed value is refused before any file is read") {
    const BadLine bad = GENERATE(
        BadLine{"--seed 1,2", {"--seed", "'1,2'", "three finite numbers"}},
        BadLine{"--target 1,2,nan", {"--target", "'1,2,nan'", "three finite numbers"}},
        BadLine{"--shoot 1,2", {"--shoot", "'1,2'", "x,y,z,dx,dy,dz,length"}},
        BadLine{"--shoot 0,0,1,0,0,0,1", {"--shoot", "direction"}},
        BadLine{"--rebuild --iso x", {"--iso", "x", "number"}},
        BadLine{"--obstacle-sphere 1,2,3", {"--obstacle-sphere", "'1,2,3'", "x,y,z,r", "4"}},
        BadLine{"--obstacle-sphere 1,2,3,0", {"--obstacle-sphere", "'1,2,3,0'", "above 0"}},
        BadLine{"--obstacle-box 1,2,3", {"--obstacle-box", "'1,2,3'", "two corners", "6"}},
        BadLine{"--weight-slope up=z", {"--weight-slope", "'up=z'", "max=30deg"}},
        BadLine{"--weight-slope max=90deg", {"--weight-slope", "below 90"}},
        BadLine{"--weight-slope max=30,up=w", {"--weight-slope", "'w'", "x, y, z"}},
        BadLine{"--weight-slope max=30,power=0", {"--weight-slope", "'power=0'", "power=P"}},
        BadLine{"--weight-curvature hill", {"--weight-curvature", "hill", "valley", "principal"}},
        BadLine{"--weight-curvature valley,q=1", {"--weight-curvature", "'q=1'", "eps=E", "p=P"}},
        BadLine{"--metric-curvature seek", {"--metric-curvature", "seek", "avoid", "prefer"}},
        BadLine{"--metric-curvature avoid,2", {"--metric-curvature", "'avoid,2'", "length="}},
        BadLine{"--image-size 640", {"--image-size", "'640'", "1280x960"}},
        BadLine{"--camera 1,2", {"--camera", "'1,2'", "x,y,z"}},
        BadLine{"--matrix m.json --matrix-rows 0/2", {"--matrix-rows", "'0/2'", "1/4"}},
        BadLine{"--scheme jett", {"--scheme", "'jett'", "did you mean 'jet'?"}},
        BadLine{"--memory-limit 4XB", {"--memory-limit", "'4XB'", "500MB"}},
        BadLine{"-q -v", {"--quiet", "--verbose"}},
        BadLine{"--sead 0,0,1", {"--sead", "did you mean '--seed'?"}},
        BadLine{"--target 0 0 1", {"'0' belongs to no option", "--target 0,0,1"}},
        BadLine{"a.vdb b.vdb", {"'b.vdb' belongs to no option"}},
        BadLine{"inf", {"'inf' is no command", "did you mean 'info'?"}},
        BadLine{"--scheme jet --scheme jet", {"--scheme", "2 times", "once"}});
    const TempWorkspace desk;
    requireRefused(desk, "--sdf none.vdb --seed 0,0,1 -o out.vdb " + bad.line, kUsage, bad.says);
}

TEST_CASE("a run without a surface is refused") {
    const TempWorkspace desk;
    requireRefused(desk, "", kUsage, {"--sdf", "--help"});
    requireRefused(desk, "--seed 0,0,1", kUsage, {"--sdf", "--help"});
    requireRefused(desk, "--sdf a.obj --seed 0,0,1", kUsage, {"--sdf a.obj", "--mesh a.obj"});
    requireRefused(desk, "--sdf a.xyz --seed 0,0,1", kUsage, {"--sdf a.xyz", "--points a.xyz"});
}

TEST_CASE("a band outside the bounds is refused with the bounds") {
    // sqrt(3) voxels of 0.1 below; above, the radius of curvature, about 1 (some percent off).
    const std::string band =
        GENERATE("--band 0.15", "--band-voxels 1.5", "--band 1.5", "--band-voxels 15");
    const Sphere desk;
    requireRefused(
        desk, "--sdf in.vdb --seed 0,0,1 -o out.vdb " + band, kUsage,
        {"outside the bounds", "at least 0.173205 (sqrt(3) voxels)", "curvature", "--band"});
}

TEST_CASE("an output that has nowhere to go is refused before any work") {
    const Sphere desk;
    std::filesystem::create_directory(desk / "folder");
    const std::string run = "--sdf in.vdb --seed 0,0,1 ";
    requireRefused(desk, run + "-o none/out.vdb", kUsage, {"-o none/out.vdb", "no folder 'none'"});
    requireRefused(desk, run + "-o folder", kUsage, {"-o folder", "that is a folder"});
    requireRefused(desk, run + "-o out.vdb --report none/out.json", kUsage,
                   {"--report none/out.json", "no folder 'none'"});
    requireRefused(desk, run + "-o out.obj", kUsage, {"-o out.obj", ".vdb"});
    for (const std::string paths : {"out.stl", "out", "out.vdb"})
        requireRefused(desk, run + "-o o.vdb --target 1,0,0 --paths " + paths, kUsage,
                       {"--paths " + paths, ".json", ".obj"});
}

TEST_CASE("an output never replaces an input") {
    const Sphere desk;
    writeBytes(desk / "points.json", "[[1, 0, 0]]");
    std::filesystem::create_symlink("in.vdb", desk / "link.vdb");
    std::filesystem::create_hard_link(desk / "in.vdb", desk / "hard.vdb");
    std::filesystem::create_directory(desk / "folder");
    const std::string run = "--sdf in.vdb --seed 0,0,1 ";
    for (const std::string out :
         {"in.vdb", "./in.vdb", "folder/../in.vdb", "link.vdb", "hard.vdb"}) {
        requireRefused(desk, run + "-o " + out, kUsage, {"-o " + out, "overwrite", "'in.vdb'"});
        requireRefused(desk, run + "-o out.vdb --report " + out, kUsage,
                       {"--report " + out, "overwrite", "'in.vdb'", "another name"});
    }
    requireRefused(desk, "--sdf link.vdb --seed 0,0,1 -o in.vdb", kUsage, {"-o in.vdb"});
    requireRefused(desk, run + "-o out.vdb --targets points.json --paths points.json", kUsage,
                   {"--paths points.json", "overwrite", "'points.json'"});
    requireRefused(desk, run + "-o out.vdb --seeds points.json --report points.json", kUsage,
                   {"--report points.json", "overwrite", "'points.json'"});
}

TEST_CASE("two outputs never go to one place") {
    const Sphere desk;
    writeBytes(desk / "existing.vdb", "");
    std::filesystem::create_symlink("existing.vdb", desk / "link");
    const std::string run = "--sdf in.vdb --seed 0,0,1 ";
    const std::string outputs = GENERATE(
        "-o out.vdb --report out.vdb", "-o out.vdb --report ./out.vdb",
        "-o existing.vdb --report link", "-o - --report -", "--report - --target 1,0,0 --paths -");
    requireRefused(desk, run + outputs, kUsage, {"one place", "its own name"});
}

TEST_CASE("options without effect are refused, with what would make them matter") {
    const TempWorkspace desk;
    const BadLine bad = GENERATE(
        BadLine{"--straighten", {"--straighten", "--target"}},
        BadLine{"--paths p.json", {"--paths", "--target", "--shoot"}},
        BadLine{"--stop-at-targets", {"--stop-at-targets", "--targets"}},
        BadLine{"--levels 5", {"--levels", "--isolines", "--image"}},
        BadLine{"--spacing 0.1", {"--spacing", "--grids engraved"}},
        BadLine{"--image-size 80x60", {"--image-size", "--image"}},
        BadLine{"--camera 1,2,3", {"--camera", "--image"}}, BadLine{"--up y", {"--up", "--image"}},
        BadLine{"--color-map magma", {"--color-map", "--mesh-out"}},
        BadLine{"--color-map magma --mesh-out m.vtp", {"--color-map", "holds colors"}},
        BadLine{"--color-map magma --matrix m.csv", {"--color-map", "holds colors"}},
        BadLine{"--order 2", {"--order", "--scheme godunov"}},
        BadLine{"--curvature-scale 3", {"--curvature-scale", "--weight-curvature"}},
        BadLine{"--pairs-out p.csv", {"--pairs-out", "--pairs"}});
    // Before any file is read: there is none.
    std::vector<std::string> says = bad.says;
    says.push_back("no effect");
    requireRefused(desk, "--sdf none.vdb --seed 0,0,1 " + bad.line, kUsage, says);
    const BadLine seedless = GENERATE(BadLine{"--max-distance 1", {"--max-distance", "a seed"}},
                                      BadLine{"--target 1,0,0", {"--target", "a seed"}},
                                      BadLine{"--targets t.csv", {"--targets", "a seed"}},
                                      BadLine{"--grids label", {"--grids", "a seed"}},
                                      BadLine{"--name d", {"--name", "a seed"}});
    requireRefused(desk, "--sdf none.vdb --pairs p.csv " + seedless.line, kUsage, seedless.says);
}

namespace {

const std::string kNoMesh = "--mesh none.obj ", kAt = "--seed vertex:1 ",
                  kShot = "--shoot 0,0,1,1,0,0,1 --paths p.json ",
                  kVia = "--via vertex:1;vertex:2 --paths p.json ";

}  // namespace

TEST_CASE("options are refused where no point, no march and no colors are for them") {
    const TempWorkspace desk;
    const std::string mesh = kNoMesh, at = kAt, shot = mesh + kShot, via = mesh + kVia;
    const BadLine bad = GENERATE_COPY(
        BadLine{mesh + at + "--space index", {"--space has no effect", "x,y,z"}},
        BadLine{mesh + "--sample 3 --space index", {"--space has no effect"}},
        BadLine{via + "--space index", {"--space has no effect"}},
        BadLine{mesh + "--sample 3 --snap 1", {"--snap has no effect", "a point to move"}},
        BadLine{mesh + "--seed-mask m.vdb --snap 1", {"--snap has no effect"}},
        BadLine{shot + "--scheme godunov", {"--scheme has no effect", "a seed"}},
        BadLine{via + "--scheme godunov", {"--scheme has no effect", "a seed"}},
        BadLine{shot + "--weight w.vdb", {"--weight has no effect", "a seed, --pairs or --via"}},
        BadLine{shot + "--weight-curvature valley", {"--weight-curvature has no effect"}},
        BadLine{shot + "--weight-slope max=30deg", {"--weight-slope has no effect"}},
        BadLine{shot + "--metric m.vdb", {"--metric has no effect"}},
        BadLine{shot + "--metric-curvature avoid", {"--metric-curvature has no effect"}},
        BadLine{shot + "--obstacle o.vdb", {"--obstacle has no effect"}},
        BadLine{shot + "--obstacle-sphere 0,0,0,1", {"--obstacle-sphere has no effect"}},
        BadLine{shot + "--obstacle-box 0,0,0,1,1,1", {"--obstacle-box has no effect"}},
        BadLine{mesh + at + "--color-map gray --per-vertex v.csv", {"--color-map", "colors"}},
        BadLine{mesh + at + "--color-map gray --per-vertex v.gii", {"--color-map", "colors"}},
        BadLine{mesh + at + "--color-map gray --per-vertex -", {"--color-map", "colors"}});
    requireRefused(desk, bad.line, kUsage, bad.says);
}

TEST_CASE("where options have an effect, it is the file that is missing") {
    const TempWorkspace desk;
    const std::string mesh = kNoMesh, at = kAt, shot = mesh + kShot, via = mesh + kVia,
                      pair = mesh + "--pairs p.csv ";
    const std::string good = GENERATE_COPY(
        mesh + at + "--space index --target 0,0,1", mesh + "--seeds s.csv --space index",
        mesh + "--via vertex:1;0,0,1 --paths p.json --space index", shot + "--space index",
        shot + "--snap 1", pair + "--snap 1", mesh + "--seed-curve c.csv --snap 1",
        "--points none.xyz --shoot 0,0,1,1,0,0,1 --scheme godunov", shot + at + "--scheme godunov",
        shot + at + "--weight w.vdb", via + "--weight w.vdb", pair + "--obstacle-sphere 0,0,0,1",
        mesh + at + "--color-map gray --mesh-out -",
        mesh + at + "--color-map gray --mesh-out m.glb",
        mesh + at + "--color-map gray --per-vertex v.obj",
        mesh + at + "--color-map gray --per-vertex v.csv --grids color");
    requireRefused(desk, good, kUnusable, {"none."});
}

TEST_CASE("inOptionWords: what the library calls its parameters, the program calls its options") {
    CHECK(inOptionWords("raise maxSnap") == "raise --snap");
    CHECK(inOptionWords("rebuilt(psi, D) makes one, the iso of rebuilt()") ==
          "--rebuild --iso D makes one, --iso");
    CHECK(inOptionWords("use Scheme::Jet, or maxDistance and maxDistance") ==
          "use --scheme jet, or --max-distance and --max-distance");
    CHECK(inOptionWords("a file of points") == "a file of points");
}

}  // namespace igeo::test
