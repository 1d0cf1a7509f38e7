#include "json_file.h"

#include <igeo/io/detail/json_depth.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

Json readJson(const std::string& file) {
    std::error_code ignored;
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in || std::filesystem::is_directory(file, ignored))
        throw igeo::Error(
            igeo::Error::Kind::Io,
            "cannot read '" + file + "': " + (in ? "it is a folder" : std::strerror(errno)),
            "check the name and its permissions");
    try {
        return Json::parse(in, igeo::JsonGuard<Json>(file));
    } catch (const std::ios_base::failure& e) {
        throw igeo::Error(igeo::Error::Kind::Io,
                          "cannot read '" + file + "': " + e.code().message(),
                          "name a regular file");
    } catch (const Json::exception& e) {
        const std::string text = e.what();  // "[json.exception.parse_error.101] parse error at ..."
        inputError(file + " is no JSON: " + text.substr(text.find(']') + 2),
                   "correct it; python3 -m json.tool shows the place as well");
    }
}
