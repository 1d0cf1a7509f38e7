#include <igeo/atomic_file.h>

#include <fcntl.h>
#include <igeo/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>

namespace igeo {

namespace fs = std::filesystem;

namespace {

std::mutex& registryMutex() {
    static std::mutex m;
    return m;
}
std::set<std::string>& registry() {
    static std::set<std::string> names;
    return names;
}

bool exists(const std::string& path, struct stat& info) { return ::stat(path.c_str(), &info) == 0; }

/// Follows links, also one to a file that does not exist yet.
std::string resolve(fs::path path) {
    std::error_code ignored;
    constexpr int kMostLinks = 40;  // as Linux
    for (int k = 0; k < kMostLinks && fs::is_symlink(path, ignored); ++k)
        path = path.parent_path() / fs::read_symlink(path, ignored);
    return path.string();
}

std::string folderOf(const std::string& path) {
    const fs::path folder = fs::path(path).parent_path();
    return folder.empty() ? "." : folder.string();
}

}  // namespace

void AtomicFile::throwWriteError(const std::string& path, int systemError) {
    const std::string folder = folderOf(path);
    std::string remedy = "check that the folder '" + folder + "' exists and is writable";
    if (systemError == ENOSPC || systemError == EDQUOT || systemError == EFBIG)
        remedy = "free some space or write to another disk; nothing was changed";
    if (systemError == EPIPE || systemError == EBADF)
        remedy = "the program that was to read it has gone; write to a file instead";
    const std::string why = systemError ? std::strerror(systemError) : "write failed";
    throw Error(Error::Kind::Io, "cannot write '" + path + "': " + why, remedy);
}

AtomicFile::AtomicFile(const std::string& path) : path_(path), finalPath_(resolve(path)) {
    struct stat info {};
    if (exists(path, info)) {
        if (S_ISDIR(info.st_mode)) throwWriteError(path, EISDIR);
        if (!S_ISREG(info.st_mode)) {
            stream_.open(path, std::ios::out | std::ios::binary);
            if (!stream_) throwWriteError(path, errno);
            return;
        }
        // A rename would replace even a file that its owner has made read-only.
        if (::access(path.c_str(), W_OK) != 0) throwWriteError(path, errno);
    }
    int fd = -1;
    for (int attempt = 0; attempt < 100 && fd < 0; ++attempt) {
        temporary_ =
            finalPath_ + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
        std::lock_guard<std::mutex> lock(registryMutex());
        fd = ::open(temporary_.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
        if (fd < 0 && errno != EEXIST) {
            temporary_.clear();
            throwWriteError(path, errno);
        }
        if (fd >= 0) registry().insert(temporary_);
    }
    if (fd < 0) throwWriteError(path, EEXIST);
    if (exists(finalPath_, info)) ::fchmod(fd, info.st_mode & 07777);
    ::close(fd);
    stream_.open(temporary_, std::ios::in | std::ios::out | std::ios::binary);
    if (!stream_) throwWriteError(path, errno);
}

AtomicFile::~AtomicFile() {
    if (temporary_.empty()) return;
    // On a full disk closing fails as well: it must not throw here.
    stream_.exceptions(std::ios::goodbit);
    stream_.close();
    std::lock_guard<std::mutex> lock(registryMutex());
    ::unlink(temporary_.c_str());
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

    const int fd = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) throwWriteError(path_, errno);
    const int synced = ::fsync(fd), syncError = errno;
    ::close(fd);
    if (synced != 0 && syncError != EINVAL) throwWriteError(path_, syncError);

    std::lock_guard<std::mutex> lock(registryMutex());
    if (std::rename(temporary_.c_str(), finalPath_.c_str()) != 0) throwWriteError(path_, errno);
    registry().erase(temporary_);
    temporary_.clear();
}

void AtomicFile::discardAll() noexcept {
    std::lock_guard<std::mutex> lock(registryMutex());
    for (const std::string& name : registry()) ::unlink(name.c_str());
    registry().clear();
}

void writeFile(const std::string& path, const std::string& content) {
    AtomicFile file(path);
    errno = 0;
    if (!file.stream().write(content.data(), std::streamsize(content.size())))
        AtomicFile::throwWriteError(path, errno);
    file.commit();
}

}  // namespace igeo
