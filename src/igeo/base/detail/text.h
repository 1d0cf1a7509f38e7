/// Text of points and shares in messages, names of files, letters in lower case. Internal.
#pragma once

#include <fmt/core.h>
#include <igeo/base/types.h>

#include <filesystem>
#include <string>

namespace igeo {

inline std::string textOf(const Vec3d& p, int digits = 6) {
    return fmt::format("{:.{}g},{:.{}g},{:.{}g}", p.x, digits, p.y, digits, p.z, digits);
}

/// `share` in percent: two digits, three from 0.995 on, as in "0.034 %", "12 %", "100 %".
inline std::string percent(double share) {
    return fmt::format("{:.{}g} %", 100 * share, share < 0.995 ? 2 : 3);
}

/// `text` with a-z for A-Z; other bytes stay as they are, in every locale.
inline std::string lowerCase(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return text;
}

/// The name of a file without folder and ending: bunny of a/bunny.obj, head of head.nii.gz. Names
/// of FreeSurfer have no endings: lh.pial is returned as it is.
inline std::string stemOf(const std::string& file) {
    std::filesystem::path name = std::filesystem::path(file).filename();
    if (name.extension() == ".gz") name = name.stem();
    const std::string stem = name.stem().string();
    return stem == "lh" || stem == "rh" ? name.string() : stem;
}

}  // namespace igeo
