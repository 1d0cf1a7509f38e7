#include <igeo/base/atomic_file.h>

#include <fmt/core.h>
#include <igeo/base/detail/system.h>
#include <igeo/base/error.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>
#include <utility>

namespace igeo {

namespace fs = std::filesystem;

namespace {

std::atomic<std::size_t> committedFiles{0};

std::mutex& registryMutex() {
    static std::mutex m;
    return m;
}
std::set<std::string>& registry() {
    static std::set<std::string> names;
    return names;
}

std::string folderOf(const std::string& path) {
    const fs::path folder = fs::path(path).parent_path();
    return folder.empty() ? "." : folder.string();
}

}  // namespace

void AtomicFile::throwWriteError(const std::string& path, int systemError) {
    const std::string folder = folderOf(path);
    std::string remedy = "check that the folder '" + folder + "' exists and is writable";
    if (isOutOfSpace(systemError))
        remedy = "free some space or write to another disk; nothing was changed";
    if (systemError == EPIPE || systemError == EBADF)
        remedy = "the program that reads it has ended; write to a file instead";
    const std::string why = systemError ? std::strerror(systemError) : "write failed";
    throw Error(Error::Kind::Io, "cannot write '" + path + "': " + why, remedy);
}

std::string fileBehindLinks(const std::string& path) {
    std::error_code ignored;
    constexpr int kMostLinks = 40;  // as in Linux
    fs::path end = path;
    for (int k = 0; fs::is_symlink(end, ignored); ++k) {
        if (k == kMostLinks)
            throw Error(Error::Kind::Io, "the links of '" + path + "' run in a circle",
                        "remove them, or name another file");
        end = end.parent_path() / fs::read_symlink(end, ignored);
    }
    return end.string();
}

AtomicFile::AtomicFile(const std::string& path, std::string finalPath)
    : path_(path), finalPath_(std::move(finalPath)) {}

AtomicFile::AtomicFile(const std::string& path) : AtomicFile(path, fileBehindLinks(path)) {
    std::error_code ignored;
    if (const fs::file_status status = fs::status(path, ignored); fs::exists(status)) {
        if (fs::is_directory(status)) throwWriteError(path, EISDIR);
        if (!fs::is_regular_file(status)) {
            stream_.open(path, std::ios::out | std::ios::binary);
            if (!stream_) throwWriteError(path, errno);
            return;
        }
        // The rename would replace even a read-only file.
        if (const int error = writeRefusal(path)) throwWriteError(path, error);
    }
    int error = EEXIST;
    for (int attempt = 0; attempt < 100 && error == EEXIST; ++attempt) {
        std::string name = fmt::format("{}.tmp-{}-{}", finalPath_, processId(), attempt);
        std::lock_guard<std::mutex> lock(registryMutex());
        // Before the file is there: memory may run out.
        if (!registry().insert(name).second) continue;
        error = createFile(name);
        if (error == 0)
            temporary_ = std::move(name);
        else
            registry().erase(name);
    }
    if (error != 0) throwWriteError(path, error);
    if (const fs::file_status status = fs::status(finalPath_, ignored); fs::exists(status))
        fs::permissions(temporary_, status.permissions(), ignored);
    stream_.open(temporary_, std::ios::in | std::ios::out | std::ios::binary);
    if (!stream_) throwWriteError(path, errno);
}

AtomicFile::~AtomicFile() {
    if (temporary_.empty()) return;
    // On a full disk closing fails too; it must not throw here.
    stream_.exceptions(std::ios::goodbit);
    stream_.close();
    std::lock_guard<std::mutex> lock(registryMutex());
    std::remove(temporary_.c_str());
    registry().erase(temporary_);
}

void AtomicFile::commit() {
    errno = 0;
    stream_.clear(stream_.rdstate() & ~std::ios::eofbit);
    stream_.exceptions(std::ios::goodbit);
    stream_.flush();
    const bool good = stream_.good();
    const int flushError = errno;
    stream_.close();
    if (!good || stream_.fail()) throwWriteError(path_, flushError ? flushError : errno);
    if (temporary_.empty()) return;

    if (const int error = syncFile(temporary_)) throwWriteError(path_, error);
    std::lock_guard<std::mutex> lock(registryMutex());
    std::error_code error;
    fs::rename(temporary_, finalPath_, error);
    if (error) throwWriteError(path_, error.default_error_condition().value());
    registry().erase(temporary_);
    temporary_.clear();
    ++committedFiles;
}

std::size_t AtomicFile::committed() noexcept { return committedFiles; }

void AtomicFile::discardAll() noexcept {
    registryMutex().lock();  // for good
    for (const std::string& name : registry()) std::remove(name.c_str());
}

void writeFile(const std::string& path, const std::string& content) {
    AtomicFile file(path);
    errno = 0;
    if (!file.stream().write(content.data(), std::streamsize(content.size())))
        AtomicFile::throwWriteError(path, errno);
    file.commit();
}

}  // namespace igeo
