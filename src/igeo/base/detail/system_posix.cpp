#include <fcntl.h>
#include <igeo/base/detail/system.h>
#include <unistd.h>

#include <cerrno>

namespace igeo {

int processId() { return ::getpid(); }

int writeRefusal(const std::string& path) { return ::access(path.c_str(), W_OK) == 0 ? 0 : errno; }

int createFile(const std::string& path) {
    const int fd = ::open(path.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (fd < 0) return errno;
    ::close(fd);
    return 0;
}

int syncFile(const std::string& path) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) return errno;
    const int error = ::fsync(fd) == 0 ? 0 : errno;
    ::close(fd);
    return error == EINVAL ? 0 : error;  // files that cannot be synced are no failure
}

bool isOutOfSpace(int error) { return error == ENOSPC || error == EDQUOT || error == EFBIG; }

}  // namespace igeo
