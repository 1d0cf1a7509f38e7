#include <igeo/io/grid_source.h>

#include <filesystem>
#include <system_error>

namespace igeo {

GridSource parseGridSource(const std::string& text) {
    std::error_code ignored;
    const auto colon = text.rfind(':');
    if (colon == std::string::npos || std::filesystem::exists(text, ignored)) return {text, ""};
    return {text.substr(0, colon), text.substr(colon + 1)};
}

}  // namespace igeo
