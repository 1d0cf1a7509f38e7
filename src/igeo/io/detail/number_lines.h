/// Lines of numbers in text files. Internal.
#pragma once

#include <igeo/base/detail/numbers.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace igeo {

/// Calls visit(line, number) for all lines, without line ends and comments (#).
template <typename Visit>
void forLines(const std::string& bytes, const Visit& visit) {
    // Spreadsheets start UTF-8 files with a byte order mark.
    std::size_t at = bytes.compare(0, 3, "\xEF\xBB\xBF") == 0 ? 3 : 0;
    for (std::size_t number = 1; at < bytes.size(); ++number) {
        const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
        std::string_view line(bytes.data() + at, end - at);
        line = line.substr(0, line.find('#'));
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())))
            line.remove_suffix(1);
        if (!line.empty()) visit(line, number);
        at = end + 1;
    }
}

inline bool isSeparator(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// The numbers of a line, separated by a comma, a semicolon or blanks; empty where the line holds
/// anything else. nan and inf are numbers here.
inline std::vector<double> numbersIn(std::string_view line) {
    std::vector<double> numbers;
    const char *at = line.data(), *const end = at + line.size();
    for (bool first = true;; first = false) {
        while (at != end && isSeparator(*at)) ++at;
        if (at == end) return numbers;
        if (!first && (*at == ',' || *at == ';')) {
            do ++at;
            while (at != end && isSeparator(*at));
        }
        if (at != end && *at == '+') ++at;
        const char* const stop =
            std::find_if(at, end, [](char c) { return isSeparator(c) || c == ',' || c == ';'; });
        const auto value = parseDouble({at, std::size_t(stop - at)});
        if (!value) return {};
        numbers.push_back(*value);
        at = stop;
    }
}

}  // namespace igeo
