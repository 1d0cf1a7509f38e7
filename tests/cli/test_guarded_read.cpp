// What a fault of a library does while a file is read, and what sizes without sense do.
#include <igeo/base/atomic_file.h>
#include <input/guarded_read.h>
#include <process.h>
#include <support/catch.h>
#include <support/temp_dir.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "program.h"

namespace igeo::test {

namespace {

struct Ending {
    int exitCode;  ///< -1: by a signal
    std::string err;
};

/// How a process ends that does `work`, with faults caught.
template <typename Work>
Ending endOf(const Work& work) {
    int fds[2];
    REQUIRE(::pipe(fds) == 0);
    const pid_t pid = ::fork();
    REQUIRE(pid >= 0);
    if (pid == 0) {
        ::dup2(fds[1], STDERR_FILENO);
        catchFaults();
        work();
        ::_exit(0);
    }
    ::close(fds[1]);
    Ending ending{-1, ""};
    char buffer[4096];
    for (ssize_t n; (n = ::read(fds[0], buffer, sizeof buffer)) > 0;)
        ending.err.append(buffer, std::size_t(n));
    ::close(fds[0]);
    int status = 0;
    REQUIRE(::waitpid(pid, &status, 0) == pid);
    if (WIFEXITED(status)) ending.exitCode = WEXITSTATUS(status);
    return ending;
}

/// Uses up the stack.
int deep(int n) {
    volatile char room[4096];
    room[0] = char(n);
    return n < 0 ? 0 : deep(n + 1) + room[0];
}

}  // namespace

TEST_CASE("a fault while a file is read is the fault of the file") {
    const int number = GENERATE(SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT);
    const Ending reading = endOf([&] {
        const FileGuard guard("some file.vdb");
        std::raise(number);
    });
    CHECK(reading.exitCode == 3);
    const auto told = lines(reading.err);
    REQUIRE(told.size() == 2);
    CHECK_THAT(told[0], startsWith("implicit-geodesic: error: ") && contains("'some file.vdb'") &&
                            contains("crashed"));
    CHECK_THAT(told[1], startsWith("  "));

    const Ending later = endOf([&] {
        { const FileGuard guard("some file.vdb"); }
        std::raise(number);
    });
    CHECK(later.exitCode == 1);
    REQUIRE(lines(later.err).size() == 2);
    CHECK_THAT(later.err, contains("please report") && !contains("some file"));
}

TEST_CASE("a fault after a refusal is the fault of the file that was refused") {
    const Ending ending = endOf([] {
        try {
            guardedRead("torn.vdb", [] { throw std::runtime_error("a block is too long"); });
        } catch (const igeo::Error&) {
            std::raise(SIGSEGV);
        }
    });
    CHECK(ending.exitCode == 3);
    CHECK_THAT(ending.err, contains("'torn.vdb'"));
}

TEST_CASE("what the system refuses to another thread is said") {
    // As TBB does where one of its threads starts the next.
    const auto thrownOnAThread = [](const auto& exception, bool reading) {
        return endOf([&] {
            std::optional<FileGuard> guard;
            if (reading) guard.emplace("some file.vdb");
            std::thread([&] { throw exception; }).join();
        });
    };
    const std::runtime_error noThread("pthread_create has failed: no resources");
    for (const bool reading : {false, true}) {
        CAPTURE(reading);
        const Ending thread = thrownOnAThread(noThread, reading);
        CHECK(thread.exitCode == 1);
        REQUIRE(lines(thread.err).size() == 2);
        CHECK_THAT(thread.err, contains("error: the system refuses a thread") &&
                                   contains("--threads") && !contains("some file"));

        const Ending memory = thrownOnAThread(std::bad_alloc(), reading);
        CHECK(memory.exitCode == (reading ? 3 : 1));
        REQUIRE(lines(memory.err).size() == 2);
        CHECK_THAT(memory.err,
                   contains(reading ? "'some file.vdb': out of memory" : "error: out of memory"));

        const Ending other = thrownOnAThread(std::runtime_error("odd"), reading);
        CHECK(other.exitCode == (reading ? 3 : 1));
        CHECK_THAT(other.err, contains("crashed"));
    }
}

TEST_CASE("faults on several threads at once end in one report, and no file is left") {
    const TempDir folder;
    const Ending ending = endOf([&] {
        std::vector<std::unique_ptr<igeo::AtomicFile>> files;
        for (int k = 0; k < 200; ++k)
            files.push_back(std::make_unique<igeo::AtomicFile>(folder / std::to_string(k)));
        std::vector<std::thread> threads;
        for (int k = 0; k < 16; ++k) threads.emplace_back([] { throw std::bad_alloc(); });
        for (std::thread& thread : threads) thread.join();
    });
    CHECK(ending.exitCode == 1);
    CHECK(lines(ending.err).size() == 2);
    CHECK_THAT(ending.err, contains("error: out of memory"));
    CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("the end of the stack is survived") {
    const Ending ending = endOf([] {
        const FileGuard guard("deep.json");
        deep(0);
    });
    CHECK(ending.exitCode == 3);
    CHECK_THAT(ending.err, contains("'deep.json'"));
}

TEST_CASE("reading without end is ended") {
    const Ending ending = endOf([] {
        const FileGuard guard("endless.vdb", 0.2);
        for (volatile bool on = true; on;) {  // not volatile, it could be taken to end
        }
    });
    CHECK(ending.exitCode == 3);
    CHECK_THAT(ending.err, contains("'endless.vdb'") && contains("s of computing"));
}

TEST_CASE("what a reader throws becomes a refusal that names the file") {
    auto refusal = [](const auto& read) {
        try {
            guardedRead("f.vdb", read);
        } catch (const igeo::Error& e) {
            return std::string(e.what());
        }
        return std::string("none");
    };
    using igeo::Error;
    CHECK(guardedRead("f.vdb", [] { return 7; }) == 7);
    CHECK_THAT(refusal([] { throw std::bad_alloc(); }), contains("'f.vdb': out of memory"));
    CHECK_THAT(refusal([] { std::vector<int>().reserve(std::size_t(-1)); }),
               contains("'f.vdb'") && contains("memory"));
    CHECK_THAT(refusal([] { throw std::runtime_error("odd"); }), contains("'f.vdb': odd"));
    CHECK(refusal([] { throw Error(Error::Kind::Io, "as it is"); }) == "as it is");
}

TEST_CASE("a mesh that runs assimp out of its stack is refused") {
    const TempWorkspace desk;
    const std::size_t levels = 200000;
    std::string nested;
    for (std::size_t k = 0; k < levels; ++k) nested += R"({"a":)";
    writeBytes(desk / "deep.gltf", nested + "1" + std::string(levels, '}'));
    requireRefused(desk, "--mesh deep.gltf --seed 0,0,1 -o out.vdb", 3,
                   {"'deep.gltf'", "crashed", "write the file again"});
}

/// Memory that is seen here is taken: a compiler may leave out what nothing looks at.
const void* volatile gSeen = nullptr;

TEST_CASE("memory that a file asks for without end is refused by --memory-limit") {
    const Ending ending = endOf([] {
        limitMemory(0, 1);
        // 256 MB are always allowed.
        try {
            std::vector<char> room(200 << 20);
            gSeen = room.data();
            guardedRead("huge.vdb", [] {
                const std::vector<char> more(400 << 20);
                gSeen = more.data();
            });
        } catch (const igeo::Error& e) {
            std::fprintf(stderr, "%s", e.what());
            ::_exit(3);
        }
    });
    CHECK(ending.exitCode == 3);
    CHECK_THAT(ending.err, contains("'huge.vdb': out of memory"));
}

}  // namespace igeo::test
