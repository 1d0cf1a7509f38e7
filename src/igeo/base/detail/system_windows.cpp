#include <fcntl.h>
#include <igeo/base/detail/system.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>
#include <windows.h>

#include <cerrno>

namespace igeo {

int processId() { return ::_getpid(); }

int writeRefusal(const std::string& path) {
    constexpr int kWrite = 2;
    return ::_access(path.c_str(), kWrite) == 0 ? 0 : errno;
}

int createFile(const std::string& path) {
    const int fd =
        ::_open(path.c_str(), _O_CREAT | _O_EXCL | _O_WRONLY | _O_NOINHERIT, _S_IREAD | _S_IWRITE);
    if (fd < 0) return errno;
    ::_close(fd);
    return 0;
}

int syncFile(const std::string& path) {
    const int fd = ::_open(path.c_str(), _O_WRONLY | _O_BINARY | _O_NOINHERIT);
    if (fd < 0) return errno;
    const int error = ::_commit(fd) == 0 ? 0 : errno;
    ::_close(fd);
    return error;
}

void askForLargePages(void*, std::size_t) {}

bool wouldGive(std::size_t bytes) {
    void* const memory = ::VirtualAlloc(nullptr, bytes, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
    return memory && ::VirtualFree(memory, 0, MEM_RELEASE);
}

bool isOutOfSpace(int error) { return error == ENOSPC || error == EFBIG; }

}  // namespace igeo
