#include <igeo/io/detail/file_bytes.h>

#include <igeo/base/detail/deflate.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace igeo {

std::string fileBytes(const std::string& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw Error(Error::Kind::Io, "cannot read '" + file + "': it is a folder", "give a file");
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    std::ostringstream all;
    if (in) all << in.rdbuf();
    if (!in || in.bad())
        throw Error(Error::Kind::Io,
                    "cannot read '" + file + "'" + (errno ? ": " : "") +
                        (errno ? std::strerror(errno) : ""),
                    "check the name and the permissions");
    return std::move(all).str();
}

std::string_view withoutByteOrderMark(std::string_view text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
    return text;
}

std::string_view cutLine(std::string_view& text) {
    // find_first_of would call a function for every byte.
    const auto endsLine = [](char c) { return c == '\n' || c == '\r'; };
    const auto end = std::size_t(std::find_if(text.begin(), text.end(), endsLine) - text.begin());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + (text.substr(end).starts_with("\r\n") ? 2 : 1), text.size()));
    return line;
}

bool isGzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::string inflatedFileBytes(const std::string& file) {
    constexpr std::size_t kMost = std::size_t(1) << 36;
    const std::string bytes = fileBytes(file);
    if (!isGzip(bytes)) return bytes;
    return naming("'" + file + "'", [&] { return inflated(bytes, kMost); });
}

std::string endingBeforeGz(const std::string& file) {
    std::string name = lowerCase(std::filesystem::path(file).filename().string());
    if (name.ends_with(".gz")) name.resize(name.size() - 3);
    const auto dot = name.rfind('.');
    return dot == std::string::npos ? "" : name.substr(dot);
}

void refuseFile(const std::string& file, const std::string& what, const std::string& remedy) {
    throw Error(Error::Kind::BadInput, "'" + file + "' " + what, remedy);
}

}  // namespace igeo
