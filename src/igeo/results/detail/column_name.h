/// Column names that every format can store. Internal.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace igeo {

/// `name` in UTF-8, with _ in place of each character that is no ASCII letter, digit, dot or
/// hyphen.
inline std::string plainName(const std::string& name) {
    std::string plain;
    for (const char c : name) {
        if ((static_cast<unsigned char>(c) & 0xC0) == 0x80) continue;  // goes on with a character
        const bool isPlain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                             (c >= '0' && c <= '9') || c == '.' || c == '-';
        plain += isPlain ? c : '_';
    }
    return plain;
}

/// The names for the distances from sources, all different: where those of two are alike they end
/// in the source's number.
/// @param names  per source; empty: use the number
inline std::vector<std::string> distanceColumns(const std::vector<std::string>& names) {
    std::map<std::string, int> count;
    std::vector<std::string> columns;
    for (std::size_t k = 0; k < names.size(); ++k) {
        columns.push_back("distance_" +
                          (names[k].empty() ? std::to_string(k) : plainName(names[k])));
        ++count[columns.back()];
    }
    std::set<std::string> taken;
    for (const auto& [name, times] : count)
        if (times == 1) taken.insert(name);
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (count[columns[k]] == 1) continue;
        columns[k] += "_" + std::to_string(k);
        while (!taken.insert(columns[k]).second) columns[k] += "_";
    }
    return columns;
}

}  // namespace igeo
