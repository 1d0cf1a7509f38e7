/// Lines of numbers in text files. Internal.
#pragma once

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace igeo {

/// Calls visit(line, number) for all lines, without line ends and comments (#).
template <typename Visit>
void forLines(const std::string& bytes, const Visit& visit) {
    std::string_view rest = withoutByteOrderMark(bytes);
    for (std::size_t number = 1; !rest.empty(); ++number) {
        std::string_view line = cutLine(rest);
        line = line.substr(0, line.find('#'));
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())))
            line.remove_suffix(1);
        if (!line.empty()) visit(line, number);
    }
}

inline bool isSeparator(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Whether the character at k is a comma with a digit on both sides.
inline bool isTightComma(std::string_view line, std::size_t k) {
    const auto isDigit = [&](std::size_t i) {
        return i < line.size() && std::isdigit(static_cast<unsigned char>(line[i]));
    };
    return line[k] == ',' && k > 0 && isDigit(k - 1) && isDigit(k + 1);
}

/// Refuses a line of numbers that has both commas between digits and numbers that a semicolon or
/// blanks alone separate, as 1,5;2,5 and 1,5 2,5: those are decimal commas.
/// @throws Error  BadInput, with the line
inline void requireDecimalPoints(const std::string& file, std::size_t number,
                                 std::string_view line) {
    constexpr std::string_view kBetween = " \t\r,;";
    bool tight = false, others = false;
    std::size_t at = line.find_first_not_of(kBetween);
    while ((at = line.find_first_of(kBetween, at)) < line.size()) {
        const std::size_t end = line.find_first_not_of(kBetween, at);
        if (end == line.npos) break;  // blanks at the end
        const bool hasComma = line.substr(at, end - at).find(',') != line.npos;
        tight = tight || (hasComma && isTightComma(line, at));
        others = others || !hasComma;
        at = end;
    }
    if (tight && others)
        throw Error(Error::Kind::BadInput,
                    fmt::format("{}, line {}: '{}' has commas between digits, and semicolons or "
                                "blanks between numbers: decimal commas are not read",
                                file, number, line.substr(0, 60)),
                    "write decimal points, 1.5 for 1,5; or separate all numbers by commas alone");
}

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

/// The same of a line of a file.
/// @throws Error  BadInput for decimal commas
inline std::vector<double> numbersIn(const std::string& file, std::size_t number,
                                     std::string_view line) {
    std::vector<double> numbers = numbersIn(line);
    if (!numbers.empty()) requireDecimalPoints(file, number, line);
    return numbers;
}

}  // namespace igeo
