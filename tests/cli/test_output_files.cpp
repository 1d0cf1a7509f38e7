// How outputs reach the disk: whole or not at all, with the links and permissions that were there.
#include <support/catch.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "program.h"

namespace igeo::test {
namespace fs = std::filesystem;

namespace {

const std::string kRun = "--sdf in.vdb --seed 0,0,1 -q ";

/// The same run started by a shell after `setup`.
Command throughShell(const TempWorkspace& desk, const std::string& setup, const std::string& line) {
    Command command = desk.command("");
    command.args = {"-c", setup + " && exec \"$0\" \"$@\"", command.program};
    for (const std::string& word : split(line)) command.args.push_back(word);
    command.program = "sh";
    return command;
}

unsigned permissions(const std::string& file) {
    return unsigned(fs::status(file).permissions()) & 07777u;
}

/// A character device of the test's own, like /dev/null (minor 3) or /dev/full (7): run by root, a
/// program that replaces its output would replace the machine's. Others cannot, and get that one.
std::string makeDevice(const TempWorkspace& desk, const std::string& name, unsigned minor) {
    if (::geteuid() != 0) return "/dev/" + name;
    const std::string path = desk / name;
    const bool made = ::mknod(path.c_str(), S_IFCHR | 0666, makedev(1, minor)) == 0;
    if (made && std::ofstream(path)) return path;
    fs::remove(path);
    return {};
}

/// A file system of `bytes`, mounted while this lives; needs the right to mount.
class SmallDisk {
public:
    SmallDisk(const std::string& folder, std::size_t bytes) : folder_(folder) {
        fs::create_directory(folder);
        const std::string size = "size=" + std::to_string(bytes);
        mounted_ = ::mount("tmpfs", folder.c_str(), "tmpfs", 0, size.c_str()) == 0;
    }
    ~SmallDisk() {
        if (mounted_) ::umount(folder_.c_str());
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;
    bool mounted() const { return mounted_; }

private:
    std::string folder_;
    bool mounted_ = false;
};

}  // namespace

TEST_CASE("when files cannot grow nothing is left and nothing is lost") {
    const Sphere desk;
    requireDone(desk, kRun + "-o o.vdb --target 1,0,0 --paths o.json");
    const auto size = fs::file_size(desk / "o.vdb"), pathSize = fs::file_size(desk / "o.json");
    fs::remove(desk / "o.vdb");
    fs::remove(desk / "o.json");
    REQUIRE(pathSize + 100 < size);

    Command command = desk.command(kRun + "-o out.vdb");
    for (const std::uint64_t limit : {std::uint64_t(0), std::uint64_t(1000), size / 2, size - 1}) {
        INFO("limit " << limit << " of " << size);
        command.fileSizeLimit = limit;
        requireRefused(desk, command, kUnusable, {"'out.vdb'", "too large", "free some space"});
    }
    command.fileSizeLimit = size;
    CHECK(run(command).exitCode == 0);
}

TEST_CASE("on a full disk nothing is left and nothing is lost") {
    const Sphere desk;
    const SmallDisk disk(desk / "disk", 64 * 1024);
    if (!disk.mounted()) {
        WARN("skipped: no right to mount a small file system");
        return;
    }
    writeBytes(desk / "disk/old.vdb", std::string(40 * 1024, 'x'));
    requireRefused(desk, kRun + "-o disk/new.vdb", kUnusable,
                   {"'disk/new.vdb'", "No space left", "free some space"});
    requireRefused(desk, kRun + "-o disk/old.vdb", kUnusable,
                   {"'disk/old.vdb'", "No space left", "free some space"});
}

TEST_CASE("a device or a stdout that takes nothing is an error") {
    const Sphere desk;
    const std::string full = makeDevice(desk, "full", 7);
    if (full.empty()) {
        WARN("skipped: devices do not work in the temporary folder");
        return;
    }
    requireRefused(desk, kRun + "-o " + full, kUnusable, {"'" + full + "'", "No space left"});
    CHECK(fs::is_character_file(full));
    Command command = desk.command(kRun + "-o -");
    command.stdoutFile = full;
    requireRefused(desk, command, kUnusable, {"standard output", "No space left"});
    requireRefused(desk, throughShell(desk, "exec >&-", kRun + "-o -"), kUnusable,
                   {"standard output", "Bad file descriptor"});
}

TEST_CASE("a folder without permission to write is refused") {
    const Sphere desk;
    fs::create_directory(desk / "locked");
    writeBytes(desk / "locked/old.vdb", "old");
    fs::permissions(desk / "locked", fs::perms(0555));
    writeBytes(desk / "readonly.vdb", "old");
    fs::permissions(desk / "readonly.vdb", fs::perms(0444));

    for (const std::string out : {"locked/new.vdb", "locked/old.vdb", "readonly.vdb"}) {
        Command command = desk.command(kRun + "-o " + out);
        if (::geteuid() == 0) {  // root may write everywhere, unless it gives up that right
            command.args.insert(command.args.begin(), {"--bounding-set=-all", command.program});
            command.program = "setpriv";
            if (run(desk.command("--version")).exitCode == 0 && run(command).exitCode == 127) {
                WARN("skipped: as root this needs setpriv");
                return;
            }
        }
        requireRefused(desk, command, kUsage, {"-o " + out, "no permission", "elsewhere"});
    }
    fs::permissions(desk / "locked", fs::perms(0755));
}

TEST_CASE("a new output has the permissions that umask asks for, an old one keeps its own") {
    const Sphere desk;
    const std::string line = kRun + "-o out.vdb --report out.json --target 1,0,0 --paths out.obj";
    REQUIRE(run(throughShell(desk, "umask 027", line)).exitCode == 0);
    for (const char* name : {"out.vdb", "out.json", "out.obj"}) {
        CHECK(permissions(desk / name) == 0640u);
        fs::permissions(desk / name, fs::perms(0604));
    }
    REQUIRE(run(throughShell(desk, "umask 022", line)).exitCode == 0);
    for (const char* name : {"out.vdb", "out.json", "out.obj"})
        CHECK(permissions(desk / name) == 0604u);
}

TEST_CASE("an output behind a link is written where the link points") {
    const Sphere desk;
    requireDone(desk, kRun + "-o plain.vdb");
    const std::string expected = readBytes(desk / "plain.vdb");
    fs::create_directory(desk / "far");
    writeBytes(desk / "far/old.vdb", "old");
    fs::create_symlink("far/old.vdb", desk / "toOld.vdb");
    fs::create_symlink("far/new.vdb", desk / "toNothing.vdb");
    fs::create_symlink("toOld.vdb", desk / "toLink.vdb");
    for (const std::string link : {"toOld.vdb", "toNothing.vdb", "toLink.vdb"}) {
        const std::string target = link == "toNothing.vdb" ? "far/new.vdb" : "far/old.vdb";
        requireDone(desk, kRun + "-o " + link);
        CHECK(fs::is_symlink(desk / link));
        CHECK_FALSE(fs::is_symlink(desk / target));
        CHECK((readBytes(desk / target) == expected));
        fs::remove(desk / target);
        writeBytes(desk / "far/old.vdb", "old");
    }
    CHECK(desk.files().size() == 7);  // in, plain, far, old and three links: no temporaries
}

TEST_CASE("a device takes all results and stays a device") {
    const Sphere desk;
    const std::string null = makeDevice(desk, "null", 3);
    if (null.empty()) {
        WARN("skipped: devices do not work in the temporary folder");
        return;
    }
    const auto before = desk.files().size();
    requireDone(desk, kRun + "-o " + null + " --report " + null);
    CHECK(fs::is_character_file(null));
    CHECK(desk.files().size() == before);
}

TEST_CASE("an existing output is replaced as a whole") {
    const Sphere desk;
    requireDone(desk, kRun + "-o plain.vdb");
    writeBytes(desk / "out.vdb", std::string(1000000, 'x'));
    requireDone(desk, kRun + "-o out.vdb");
    CHECK((readBytes(desk / "out.vdb") == readBytes(desk / "plain.vdb")));
}

}  // namespace igeo::test
