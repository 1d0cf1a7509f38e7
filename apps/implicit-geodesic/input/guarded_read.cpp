#include "input/guarded_read.h"

#include <igeo/base/atomic_file.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <vector>

#include "exit_code.h"
#include "options/spelling.h"
#include "process.h"

namespace {

/// A message composed in advance, because a signal handler cannot compose one.
struct Message {
    std::array<char, 1024> text{};
    std::size_t size = 0;

    void set(const std::string& words) {
        size = std::min(words.size(), text.size());
        std::memcpy(text.data(), words.data(), size);
    }
    void write() const { writeToStderr(text.data(), size); }
};

/// What the system refused where the exception that says so could not be caught.
enum class Refused { Nothing, Memory, Thread };

Message gFault, gOutOfMemory, gThreadRefused, gFileFault, gFileMemory, gFileTime;
std::atomic<bool> gReading{false};
std::atomic<Refused> gRefused{Refused::Nothing};
std::mutex gGuard;
// Erases a line of progress.
const char* gLineStart = "";

/// An exception that cannot be caught, such as one on a thread of TBB: there it means no memory, or
/// no further thread.
[[noreturn]] void onTerminate() {
    try {
        if (const std::exception_ptr e = std::current_exception()) std::rethrow_exception(e);
    } catch (const std::bad_alloc&) {
        gRefused = Refused::Memory;
    } catch (const std::exception& e) {
        if (isThreadRefused(e)) gRefused = Refused::Thread;
    } catch (...) {
    }
    std::abort();
}

const Message& messageOfFault() {
    switch (gRefused) {
        case Refused::Memory:
            return gReading ? gFileMemory : gOutOfMemory;
        case Refused::Thread:
            return gThreadRefused;
        case Refused::Nothing:
            break;
    }
    return gReading ? gFileFault : gFault;
}

void reportFault(bool timeIsUp) {
    (timeIsUp ? gFileTime : messageOfFault()).write();
    igeo::AtomicFile::discardAll();
}

[[noreturn]] void endNow() {
    std::_Exit(gReading && gRefused != Refused::Thread ? kUnusable : kFailed);
}

double readingSeconds(const std::string& file) {
    constexpr double kLeast = 300, kUnknown = 3600, kPerMegabyte = 10;
    std::error_code none;
    const bool known = file != "-" && std::filesystem::is_regular_file(file, none);
    return known ? kLeast + kPerMegabyte * double(std::filesystem::file_size(file, none)) / 1e6
                 : kUnknown;
}

}  // namespace

void catchFaults() {
    if (stderrIsTerminal()) gLineStart = "\r\033[K";
    gFault.set(std::string(gLineStart) +
               "implicit-geodesic: error: the program has crashed\n"
               "  please report this, with the command and its files; no output is half written\n");
    gOutOfMemory.set(std::string(gLineStart) +
                     "implicit-geodesic: error: out of memory\n"
                     "  use larger voxels or a larger machine\n");
    gThreadRefused.set(std::string(gLineStart) + "implicit-geodesic: error: " + kThreadRefused +
                       "\n  " + kFewerThreads + "\n");
    std::set_terminate(onTerminate);
    onFault(reportFault, endNow);
}

std::string namesLike(const std::string& file) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (file == "-" || fs::symlink_status(file, error).type() != fs::file_type::not_found)
        return "";
    constexpr int kMost = 10000;  // file names to compare
    const fs::path folder = fs::path(file).parent_path();
    std::vector<std::string> names;
    for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end;
         !error && entry != end && names.size() < kMost; entry.increment(error))
        names.push_back((folder / entry->path().filename()).string());
    std::sort(names.begin(), names.end());
    const auto longer = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
        return name.starts_with(file + ".");
    });
    return longer == names.end() ? didYouMean(file, names) : ", did you mean '" + *longer + "'?";
}

FileGuard::FileGuard(const std::string& file) : FileGuard(file, readingSeconds(file)) {}

FileGuard::FileGuard(const std::string& file, double seconds)
    : alone_(gGuard), exceptions_(std::uncaught_exceptions()) {
    const std::string start = std::string(gLineStart) + "implicit-geodesic: error: cannot read " +
                              (file == "-" ? "standard input" : "'" + file.substr(0, 600) + "'");
    gFileFault.set(start +
                   ": its reader crashed, as damaged files cause it\n"
                   "  write the file again, or in another format\n");
    gFileMemory.set(start + ": out of memory\n  " + kTooLarge + "\n");
    gFileTime.set(start + ": it took more than " + std::to_string(std::llround(seconds)) +
                  " s of computing\n"
                  "  the file is damaged: write it again\n");
    gReading = true;
    limitComputing(seconds);
}

FileGuard::~FileGuard() {
    limitComputing(0);
    if (std::uncaught_exceptions() == exceptions_) gReading = false;
}
