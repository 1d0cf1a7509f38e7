#include <igeo/base/atomic_file.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/temp_dir.h>
#include <support/test_device.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

namespace igeo::test {
namespace {

namespace fs = std::filesystem;

std::string contentOf(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

void put(const std::string& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

std::size_t filesIn(const TempDir& folder) {
    return std::size_t(std::distance(fs::directory_iterator(folder.path()), {}));
}

/// What `work` returns in a process of its own, which then ends at once.
template <typename Work>
int exitCodeOf(const Work& work) {
    const pid_t process = ::fork();
    REQUIRE(process >= 0);
    if (process == 0) std::_Exit([&]() noexcept { return work(); }());
    int status = 0;
    REQUIRE(::waitpid(process, &status, 0) == process);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

TEST_CASE("AtomicFile: nothing under the final name until commit") {
    const TempDir folder;
    const std::string path = folder / "out";
    {
        AtomicFile file(path);
        file.stream() << "new";
        file.stream().flush();
        CHECK(!fs::exists(path));
        file.commit();
        CHECK(contentOf(path) == "new");
    }
    CHECK(contentOf(path) == "new");
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("AtomicFile: an abandoned file leaves no trace") {
    const TempDir folder;
    put(folder / "out", "old");
    {
        AtomicFile file(folder / "out");
        file.stream() << "new";
        file.stream().flush();
        CHECK(filesIn(folder) == 2);
    }
    CHECK(contentOf(folder / "out") == "old");
    CHECK(filesIn(folder) == 1);
    // The same through an exception.
    try {
        AtomicFile file(folder / "out");
        file.stream() << "new";
        throw std::runtime_error("trouble");
    } catch (const std::runtime_error&) {
    }
    CHECK(contentOf(folder / "out") == "old");
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("AtomicFile: a failed write keeps what was there") {
    const TempDir folder;
    put(folder / "out", "old");
    expectError(Error::Kind::Io, {"cannot write", "out"}, [&] {
        AtomicFile file(folder / "out");
        file.stream() << "new";
        file.stream().setstate(std::ios::badbit);
        file.commit();
    });
    CHECK(contentOf(folder / "out") == "old");
    CHECK(filesIn(folder) == 1);
    // A full device, which is written directly.
    if (const std::string full = testDevice(folder, "full", kFullMinor); !full.empty()) {
        expectError(Error::Kind::Io, {full, "No space left", "free some space"},
                    [&] { writeFile(full, std::string(100000, 'x')); });
        expectError(Error::Kind::Io, {full, "No space left"}, [&] { writeFile(full, "x"); });
    }
}

TEST_CASE("AtomicFile: several files at once, also of one name") {
    const TempDir folder;
    AtomicFile a(folder / "out"), b(folder / "out");
    a.stream() << "a";
    b.stream() << "b";
    a.commit();
    CHECK(contentOf(folder / "out") == "a");
    b.commit();
    CHECK(contentOf(folder / "out") == "b");
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("AtomicFile: keeps permissions, and gives new files those of the umask") {
    const TempDir folder;
    put(folder / "out", "old");
    REQUIRE(::chmod((folder / "out").c_str(), 0640) == 0);
    writeFile(folder / "out", "new");
    struct stat info {};
    REQUIRE(::stat((folder / "out").c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0640);

    const mode_t mask = ::umask(027);
    writeFile(folder / "fresh", "new");
    ::umask(mask);
    REQUIRE(::stat((folder / "fresh").c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0640);

    // The superuser may write anything.
    if (::geteuid() == 0) return markSkipped("run by root, no file is read-only");
    REQUIRE(::chmod((folder / "out").c_str(), 0440) == 0);
    expectError(Error::Kind::Io, {"Permission denied"}, [&] { writeFile(folder / "out", "x"); });
    CHECK(contentOf(folder / "out") == "new");
}

TEST_CASE("AtomicFile: follows links") {
    const TempDir folder;
    fs::create_directory(folder / "sub");
    put(folder / "sub/target", "old");
    fs::create_symlink("sub/target", folder / "link");
    fs::create_symlink("link", folder / "chain");
    writeFile(folder / "chain", "new");
    CHECK(fs::is_symlink(folder / "chain"));
    CHECK(fs::is_symlink(folder / "link"));
    CHECK(contentOf(folder / "sub/target") == "new");
    // Also to a file that does not exist yet.
    fs::create_symlink("sub/fresh", folder / "dangling");
    writeFile(folder / "dangling", "new");
    CHECK(fs::is_symlink(folder / "dangling"));
    CHECK(contentOf(folder / "sub/fresh") == "new");
}

TEST_CASE("AtomicFile: devices are written, not replaced") {
    const TempDir folder;
    const std::string null = testDevice(folder, "null", kNullMinor);
    if (null.empty()) return;
    writeFile(null, "gone");
    CHECK(fs::is_character_file(null));
    // Also through a link.
    fs::create_symlink(null, folder / "link");
    writeFile(folder / "link", "gone");
    CHECK(fs::is_character_file(null));
    CHECK(fs::is_symlink(folder / "link"));
}

TEST_CASE("AtomicFile: says what is wrong with the folder") {
    const TempDir folder;
    expectError(Error::Kind::Io, {"No such file", "none' exists"},
                [&] { AtomicFile file(folder / "none/out"); });
    expectError(Error::Kind::Io, {"directory"}, [&] { AtomicFile file(folder.path().string()); });
    put(folder / "plain", "");
    expectError(Error::Kind::Io, {"Not a directory"},
                [&] { AtomicFile file(folder / "plain/out"); });
}

TEST_CASE("AtomicFile: a file that cannot be opened leaves none behind") {
    const TempDir folder;
    fs::permissions(folder.path(), fs::perms::all);
    put(folder / "write-only", "old");
    fs::permissions(folder / "write-only", fs::perms(0222));
    const int code = exitCodeOf([&] {
        if (::geteuid() == 0 && ::setuid(65534) != 0) return 2;  // root may read all
        try {
            AtomicFile file(folder / "write-only");
        } catch (const Error&) {
            return 0;
        }
        return 1;
    });
    CHECK(code == 0);
    CHECK(filesIn(folder) == 1);
}

TEST_CASE("AtomicFile: discardAll removes what is not committed, and nothing follows") {
    const TempDir folder;
    const int code = exitCodeOf([&] {
        AtomicFile open(folder / "open"), late(folder / "late");
        open.stream() << "half";
        open.stream().flush();
        writeFile(folder / "done", "whole");
        if (filesIn(folder) != 3) return 1;
        AtomicFile::discardAll();
        std::thread([&] {
            try {
                late.commit();
            } catch (const Error&) {
                // It is removed already.
            }
        }).detach();
        std::thread([&] { static const AtomicFile next(folder / "next"); }).detach();
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        std::_Exit(0);  // removing the files would wait
    });
    CHECK(code == 0);
    CHECK(filesIn(folder) == 1);
    CHECK(contentOf(folder / "done") == "whole");
}

}  // namespace igeo::test
