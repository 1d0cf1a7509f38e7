// Seeds and targets that cannot be used.
#include <support/catch.h>

#include <filesystem>
#include <regex>

#include "program.h"

namespace igeo::test {

namespace {

struct BadFile {
    std::string name, content;
    std::vector<std::string> says;
};

}  // namespace

TEST_CASE("a run without a seed is refused") {
    const Sphere desk;
    requireRefused(desk, "--sdf in.vdb -o out.vdb", kUsage, {"no seed", "--seed x,y,z", "--seeds"});
}

TEST_CASE("a point that is not three finite numbers is refused") {
    const std::string option = GENERATE("--seed", "--target");
    const Sphere desk;
    for (const std::string point : {"a", "0,0", "0,0,1,2", "nan,0,0", "0,inf,0", "0,0,1x", "0,,1"})
        requireRefused(desk, "--sdf in.vdb --seed 0,0,1 -o out.vdb " + option + " " + point, kUsage,
                       {option, "'" + point + "'", "three finite numbers"});
}

TEST_CASE("a point off the surface is refused with its distance and the nearest point") {
    const std::string option = GENERATE("seed", "target");
    const Sphere desk;
    // The half-width is 3 voxels of 0.1; the point is 2 above the pole.
    const std::string line = "--sdf in.vdb --seed 0,0,1 -o out.vdb --" + option + " 0,0,3";
    const std::string number = option == "seed" ? "seed 1" : "target 0";
    requireRefused(desk, line, kUsage, {number, "(0,0,3)", "0.3 is allowed", "--snap"});

    const std::string told = desk.run(line).err;
    std::smatch found;
    const std::regex numbers(
        "is ([0-9.]+) from the surface.*\n.*surface is ([-+0-9.e]+),([-+0-9.e]+),([-+0-9.e]+) ");
    REQUIRE(std::regex_search(told, found, numbers));
    // Trilinear psi is off by at most dx^2 / 8 times the sum of the curvatures, 2: by 0.0025.
    CHECK(std::stod(found[1]) == Approx(2).margin(0.005));
    CHECK(std::stod(found[2]) == Approx(0).margin(0.005));
    CHECK(std::stod(found[3]) == Approx(0).margin(0.005));
    CHECK(std::stod(found[4]) == Approx(1).margin(0.005));

    requireDone(desk, line + " --snap 2.01 -q");
}

TEST_CASE("points far outside the range of the volume are refused as well") {
    const Sphere desk;
    for (const std::string seed : {"1e8,0,0", "1e12,0,0", "0,-1e200,0", "1e308,1e308,1e308"})
        requireRefused(desk, "--sdf in.vdb -o out.vdb --seed " + seed, kUsage,
                       {"seed 0", "from the surface", "0.3 is allowed", "--snap"});
}

TEST_CASE("a file of points that says something else is refused with the place") {
    const BadFile bad = GENERATE(
        BadFile{"p.csv", "", {"no points", "x,y,z"}}, BadFile{"p.csv", "x,y,z\n", {"no points"}},
        BadFile{"p.csv", "# nothing\n\n", {"no points"}},
        BadFile{"p.csv", "1,0,0\n1,2\n", {"line 2", "'1,2'", "x,y,z,start"}},
        BadFile{"p.csv", "1,2\n1,0,0\n", {"line 1", "'1,2'"}},
        BadFile{"p.csv", "nan,0,0\n1,0,0\n", {"line 1", "'nan,0,0'"}},
        BadFile{"p.csv", "x,y,z\n1,0,0\nx,y,z\n", {"line 3", "'x,y,z'"}},
        BadFile{"p.csv", "1,5;0;0\n", {"line 1", "'1,5;0;0'", "semicolons"}},
        BadFile{"p.csv", "1,5 0 0\n", {"line 1", "'1,5 0 0'", "decimal commas", "1.5"}},
        BadFile{"p.csv", "y,x,z\n1,0,0\n", {"line 1", "'y,x,z'", "order x,y,z,start"}},
        BadFile{"p.csv", "1,0,0,-0.5\n", {"start", "-0.5", "at least 0"}},
        BadFile{"p.json", "", {"not a JSON list", "position"}},
        BadFile{"p.json", "[]", {"no points"}},
        BadFile{"p.json", "{\"seeds\": []}", {"not a JSON list"}},
        BadFile{"p.json", "[[1, 0, 0]", {"not a JSON list"}},
        BadFile{"p.json", "[[1, 0, 0], [1, 0]]", {"entry 1", "[x, y, z]"}},
        BadFile{"p.json", "[[1, 0, \"a\"]]", {"entry 0", "numbers"}},
        BadFile{"p.json", "[{\"start\": 1}]", {"entry 0", "no \"position\""}},
        BadFile{"p.json",
                "[{\"position\": [1, 0, 0], \"start\": \"a\"}]",
                {"entry 0", "\"start\" is a number"}},
        BadFile{"p.json", "[{\"position\": [1, 0, 0], \"start\": -1}]", {"start", "-1"}});
    const std::string option = GENERATE("--seeds", "--targets");
    const Sphere desk;
    INFO(bad.content);
    writeBytes(desk / bad.name, bad.content);
    auto says = bad.says;
    says.push_back(bad.name);
    requireRefused(desk, "--sdf in.vdb --seed 0,0,1 -o out.vdb " + option + " " + bad.name,
                   kUnusable, says);
}

TEST_CASE("a file of points that cannot be read is refused") {
    const Sphere desk;
    std::filesystem::create_directory(desk / "folder.csv");
    requireRefused(desk, "--sdf in.vdb --seeds none.csv -o out.vdb", kUnusable,
                   {"'none.csv'", "No such file"});
    requireRefused(desk, "--sdf in.vdb --seeds folder.csv -o out.vdb", kUnusable,
                   {"'folder.csv'", "it is a folder"});
}

}  // namespace igeo::test
