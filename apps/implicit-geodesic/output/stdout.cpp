#include "output/stdout.h"

#include <igeo/base/atomic_file.h>

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <streambuf>

#include "process.h"

namespace {

/// A stream buffer that writes to a C file, which buffers itself.
class FileBuffer : public std::streambuf {
public:
    void open(std::FILE* file) { file_ = file; }
    int error() const { return error_; }  ///< of the first write that failed

protected:
    int_type overflow(int_type c) override {
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        return noted(std::putc(c, file_), c);
    }
    std::streamsize xsputn(const char* bytes, std::streamsize n) override {
        return noted(std::streamsize(std::fwrite(bytes, 1, std::size_t(n), file_)), n);
    }
    int sync() override { return noted(std::fflush(file_), 0); }

private:
    /// Returns `result`; keeps the system's reason if it differs from `expected`.
    template <typename Result>
    Result noted(Result result, Result expected) {
        if (result != expected && error_ == 0) error_ = errno;
        return result;
    }

    std::FILE* file_ = stdout;
    int error_ = 0;
};

FileBuffer& buffer() {
    static FileBuffer b;
    return b;
}

/// Discards all output.
class Nowhere : public std::streambuf {
protected:
    int_type overflow(int_type c) override { return traits_type::not_eof(c); }
    std::streamsize xsputn(const char*, std::streamsize n) override { return n; }
};

}  // namespace

void reserveStdout() {
    // If that fails, libraries share stdout, as in any program.
    if (std::FILE* const given = takeStdout()) buffer().open(given);
}

std::ostream& results() {
    static std::ostream stream(&buffer());
    return stream;
}

void flushResults() {
    if (results().flush()) return;
    if (buffer().error() == EPIPE) throw ReaderGone();
    igeo::AtomicFile::throwWriteError("standard output", buffer().error());
}

LibrariesSilenced::LibrariesSilenced() : printed_(std::cout.rdbuf()) {
    static Nowhere nowhere;
    std::cout.rdbuf(&nowhere);
}

LibrariesSilenced::~LibrariesSilenced() { std::cout.rdbuf(printed_); }
