#include "json_file.h"

#include <igeo/io/detail/json_depth.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <vector>

Json readJson(const std::string& file) {
    std::error_code ignored;
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    if (!in || std::filesystem::is_directory(file, ignored))
        throw igeo::Error(
            igeo::Error::Kind::Io,
            "cannot read '" + file + "': " + (in ? "it is a folder" : std::strerror(errno)),
            "check the name and its permissions");
    std::vector<std::set<std::string>> members;  // of the objects that are open
    const auto check = [&](int depth, Json::parse_event_t event, Json& value) {
        igeo::requireShallow(depth, file);
        if (event == Json::parse_event_t::object_start) members.emplace_back();
        if (event == Json::parse_event_t::object_end) members.pop_back();
        if (event == Json::parse_event_t::key && !members.back().insert(value).second)
            inputError(file + ": '" + value.get<std::string>() + "' stands twice in one object",
                       "keep one; a list holds several values");
        return true;
    };
    try {
        return Json::parse(in, check);
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
