/// The parts of a page, as they were found when igeo was built (results/viewer, three.js).
/// Internal.
#pragma once

#include <string_view>

namespace igeo {

struct ViewFiles {
    std::string_view page, style, drawing, script, license;
    std::string_view three, controls;  ///< empty: built without three.js
};
const ViewFiles& viewFiles();

}  // namespace igeo
