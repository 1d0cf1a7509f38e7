#include "output/stdout.h"

#include <cstdio>
#include <iostream>
#include <streambuf>

#include "process.h"

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
    // Where that fails, stdout is shared with libraries, as in any program.
    if (std::FILE* const given = takeStdout()) buffer().open(given);
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
