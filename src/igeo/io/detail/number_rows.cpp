#include <igeo/io/detail/number_rows.h>

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace igeo {

namespace {

/// A first line in which no field starts like a number names the columns.
bool isHeader(const std::string& line) {
    std::stringstream parts(line);
    for (std::string part; std::getline(parts, part, ',');) {
        char* end = nullptr;
        std::strtod(part.c_str(), &end);
        if (end != part.c_str()) return false;
    }
    return true;
}

/// Puts commas between the fields: those of a line without a comma are separated by semicolons, or
/// else by blanks. A comma in a line with semicolons may be a decimal comma, so such a line is left
/// as it is, which is no row.
std::string withCommas(std::string line) {
    if (line.find(',') != std::string::npos) return line;
    if (line.find(';') != std::string::npos) {
        std::replace(line.begin(), line.end(), ';', ',');
        return line;
    }
    std::stringstream words(line);
    std::string fields;
    for (std::string word; words >> word;) fields += (fields.empty() ? "" : ",") + word;
    return fields;
}

}  // namespace

std::vector<double> numbersIn(const std::string& text) {
    std::vector<double> out;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        // strtod also reads "nan" and "1x": both are refused here.
        char* end = nullptr;
        const double v = std::strtod(part.c_str(), &end);
        const bool blank = part.find_first_not_of(" \t\r") == std::string::npos;
        while (*end == ' ' || *end == '\t' || *end == '\r') ++end;
        if (blank || *end != '\0' || !std::isfinite(v)) return {};
        out.push_back(v);
    }
    if (!text.empty() && text.back() == ',') return {};
    return out;
}

std::vector<std::vector<double>> rowsFromText(std::istream& in, const std::string& file,
                                              const std::vector<std::size_t>& counts,
                                              const std::string& shape) {
    std::vector<std::vector<double>> rows;
    std::size_t lineNumber = 0;
    bool mayBeHeader = true;
    for (std::string line; std::getline(in, line);) {
        ++lineNumber;
        // Spreadsheets start UTF-8 files with a byte order mark.
        if (lineNumber == 1 && line.compare(0, 3, "\xEF\xBB\xBF") == 0) line.erase(0, 3);
        if (const auto hash = line.find('#'); hash != std::string::npos) line.erase(hash);
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        std::vector<double> v = numbersIn(withCommas(line));
        if (std::count(counts.begin(), counts.end(), v.size()) > 0)
            rows.push_back(std::move(v));
        else if (!mayBeHeader || !isHeader(withCommas(line)))
            throw Error(
                Error::Kind::BadInput,
                fmt::format("{}, line {}: '{}' is not {}", file, lineNumber, line.substr(0, 60),
                            shape),
                "write that many finite numbers with commas, semicolons or blanks between them");
        mayBeHeader = false;
    }
    return rows;
}

}  // namespace igeo
