/// The parts of a page, embedded when igeo was built (results/viewer, three.js). Internal.
#pragma once

#include <string_view>

namespace igeo {

struct ViewFiles {
    std::string_view page, style, drawing, script, license;
    std::string_view library;  ///< three.js and its controls, gzip; empty: built without
};
const ViewFiles& viewFiles();

}  // namespace igeo
