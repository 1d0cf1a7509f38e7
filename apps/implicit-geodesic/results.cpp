#include "results.h"

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <streambuf>

namespace {

/// A stream's end in a C file, which buffers.
class FileBuffer : public std::streambuf {
public:
    void open(std::FILE* file) { file_ = file; }

protected:
    int_type overflow(int_type c) override {
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        return std::putc(c, file_);
    }
    std::streamsize xsputn(const char* bytes, std::streamsize n) override {
        return std::streamsize(std::fwrite(bytes, 1, std::size_t(n), file_));
    }
    int sync() override { return std::fflush(file_); }

private:
    std::FILE* file_ = stdout;
};

FileBuffer& buffer() {
    static FileBuffer b;
    return b;
}

/// Takes everything and keeps nothing.
class Nowhere : public std::streambuf {
protected:
    int_type overflow(int_type c) override { return traits_type::not_eof(c); }
    std::streamsize xsputn(const char*, std::streamsize n) override { return n; }
};

}  // namespace

void reserveStdout() {
    const int given = ::dup(STDOUT_FILENO);
    std::FILE* const file = given < 0 ? nullptr : ::fdopen(given, "wb");
    // Without a second descriptor stdout is shared, as by any program.
    if (file && ::dup2(STDERR_FILENO, STDOUT_FILENO) >= 0) buffer().open(file);
}

std::ostream& results() {
    static std::ostream stream(&buffer());
    return stream;
}

LibrariesSilenced::LibrariesSilenced() : printed_(std::cout.rdbuf()) {
    static Nowhere nowhere;
    std::cout.rdbuf(&nowhere);
}

LibrariesSilenced::~LibrariesSilenced() { std::cout.rdbuf(printed_); }
