// Files that are missing, something else, or cut off.
#include <openvdb/io/Stream.h>
#include <support/catch.h>
#include <support/openvdb.h>

#include <filesystem>
#include <sstream>

#include "program.h"

namespace igeo::test {

namespace {

/// Where to cut a file of `size` bytes: through the header (57 bytes), the metadata and the grid's
/// description at its start, evenly through the rest, and just before its end.
std::vector<std::size_t> cuts(std::size_t size) {
    std::vector<std::size_t> at{1, 4, 7, 8, 13, 20, 21, 40, 57, 58, 61, 70, 100, 150, 300, 700};
    for (std::size_t k = 1; k < 16; ++k) at.push_back(k * size / 16);
    for (const std::size_t missing : {100, 8, 4, 1}) at.push_back(size - missing);
    return at;
}

}  // namespace

TEST_CASE("what is no VDB file is refused") {
    const TempWorkspace desk;
    std::filesystem::create_directory(desk / "folder");
    writeBytes(desk / "text.vdb", "# Wavefront OBJ\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    writeBytes(desk / "empty.vdb", "");
    const std::string rest = " --seed 1,0,0 -o out.vdb";
    requireRefused(desk, "--sdf missing.vdb" + rest, kUnusable,
                   {"'missing.vdb'", "No such file", "check the name"});
    requireRefused(desk, "--sdf folder" + rest, kUnusable, {"'folder'", "it is a folder"});
    requireRefused(desk, "--sdf text.vdb" + rest, kUnusable, {"'text.vdb'", "not a VDB file"});
    requireRefused(desk, "--sdf empty.vdb" + rest, kUnusable, {"'empty.vdb'", "not a VDB file"});

    Command piped = desk.command("--sdf -" + rest);
    piped.stdinFile = "/dev/null";
    requireRefused(desk, piped, kUnusable, {"standard input is empty"});
    piped.stdinFile = desk / "text.vdb";
    requireRefused(desk, piped, kUnusable, {"standard input", "not a VDB file"});
}

TEST_CASE("a file that is cut off is refused wherever it was cut") {
    const std::string shape = GENERATE("sphere --voxel-size 0.1", "trefoil --voxel-size 0.04");
    const bool asPipe = GENERATE(false, true);
    const TempWorkspace desk;
    desk.make("whole.vdb", shape);
    const std::string whole = readBytes(desk / "whole.vdb");
    // Any point will do as a seed, so that nothing but the cut can be refused.
    const std::string rest = " --seed 1,0,0 --snap 9 -q -o out.vdb";
    REQUIRE(desk.run("--sdf whole.vdb" + rest).exitCode == 0);
    std::filesystem::remove(desk / "out.vdb");

    for (const std::size_t at : cuts(whole.size())) {
        INFO(shape << " cut after " << at << " of " << whole.size() << " bytes");
        writeBytes(desk / "cut.vdb", whole.substr(0, at));
        Command command = desk.command((asPipe ? "--sdf -" : "--sdf cut.vdb") + rest);
        command.timeout = 20;
        allowLeaks(command);
        if (asPipe) command.stdinFile = desk / "cut.vdb";
        const bool hasMagic = at >= 4 || asPipe;
        requireRefused(
            desk, command, kUnusable,
            {asPipe ? "standard input" : "'cut.vdb'", hasMagic ? "is cut off" : "not a VDB"});
    }
}

TEST_CASE("a file that was written to a stream is read, and refused when it is cut off") {
    // Such a file says in its header that it has no directory of grids.
    const TempWorkspace desk;
    desk.make("file.vdb", "sphere --voxel-size 0.1");
    openvdb::io::File file(desk / "file.vdb");
    file.open();
    std::ostringstream bytes;
    openvdb::io::Stream(bytes).write(*file.getGrids());
    const std::string whole = bytes.str();
    const std::string rest = " --seed 0,0,1 -q -o out.vdb";

    writeBytes(desk / "stream.vdb", whole);
    requireDone(desk, "--sdf stream.vdb" + rest);
    const std::string fromStream = readBytes(desk / "out.vdb");
    requireDone(desk, "--sdf file.vdb" + rest);
    CHECK((fromStream == readBytes(desk / "out.vdb")));
    std::filesystem::remove(desk / "out.vdb");
    for (const std::size_t missing : {std::size_t(1), std::size_t(100), whole.size() / 2}) {
        writeBytes(desk / "stream.vdb", whole.substr(0, whole.size() - missing));
        Command command = desk.command("--sdf stream.vdb" + rest);
        allowLeaks(command);
        requireRefused(desk, command, kUnusable, {"'stream.vdb'", "is cut off"});
    }
}

}  // namespace igeo::test
