#include <igeo/io/detail/number_rows.h>

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/number_lines.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <optional>
#include <sstream>

namespace igeo {

namespace {

/// The number that a field is, with blanks around it; nan and inf are numbers.
std::optional<double> numberIn(std::string_view field) {
    constexpr std::string_view kBlanks = " \t\r\n\v\f";
    field.remove_prefix(std::min(field.find_first_not_of(kBlanks), field.size()));
    field = field.substr(0, field.find_last_not_of(kBlanks) + 1);
    if (field.starts_with('+') && !field.starts_with("+-")) field.remove_prefix(1);
    return parseDouble(field);
}

/// A first line in which no field is a number, or starts like one, names the columns.
bool isHeader(const std::string& line) {
    std::stringstream parts(line);
    for (std::string part; std::getline(parts, part, ',');) {
        const auto first = part.find_first_not_of(" \t\r+-.");
        if (numberIn(part) || (first != part.npos && part[first] >= '0' && part[first] <= '9'))
            return false;
    }
    return true;
}

/// Puts commas between the fields: those of a line without a comma are separated by semicolons, or
/// else by blanks.
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

/// The name of a column in lower case, without blanks, quotes and slashes around it.
std::string nameInHeader(std::string field) {
    const auto isName = [](unsigned char c) { return std::isalnum(c) != 0; };
    field.erase(std::find_if(field.rbegin(), field.rend(), isName).base(), field.end());
    field.erase(field.begin(), std::find_if(field.begin(), field.end(), isName));
    return lowerCase(std::move(field));
}

}  // namespace

std::vector<double> numbersIn(const std::string& text) {
    std::vector<double> out;
    std::stringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) {
        const auto v = numberIn(part);
        if (!v || !std::isfinite(*v)) return {};
        out.push_back(*v);
    }
    if (!text.empty() && text.back() == ',') return {};
    return out;
}

std::vector<std::string> namesInHeader(std::string_view header) {
    std::stringstream fields(withCommas(std::string(header)));
    std::vector<std::string> names;
    for (std::string field; std::getline(fields, field, ',');) names.push_back(nameInHeader(field));
    return names;
}

std::vector<bool> extraColumns(const std::vector<std::string>& names) {
    const auto isOneOf = [](const std::string& name, std::initializer_list<const char*> others) {
        return std::find(others.begin(), others.end(), name) != others.end();
    };
    const auto isThere = [&](const char* name) {
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    const bool hasColors = isThere("r") && isThere("g") && isThere("b");
    std::vector<bool> extra;
    for (const std::string& name : names)
        extra.push_back(
            isOneOf(name, {"red", "green", "blue", "alpha", "rgb", "rgba", "gray", "intensity",
                           "reflectance", "label", "class", "classification"}) ||
            (hasColors && isOneOf(name, {"r", "g", "b", "a", "i"})));
    return extra;
}

void requireColumns(const std::string& file, std::size_t number, std::string_view header,
                    const std::string& columns, std::size_t numbers) {
    std::stringstream order(columns);
    const std::vector<std::string> names = namesInHeader(header);
    const std::vector<bool> extra = extraColumns(names);
    // Tables with the names of rows, which the header does not count.
    if (names.size() >= 3 && numbers == names.size() + 1)
        throw Error(Error::Kind::BadInput,
                    fmt::format("{}, line {}: the header '{}' names {} columns, and lines below it "
                                "hold {} numbers",
                                file, number, header.substr(0, 60), names.size(), numbers),
                    "name all columns in the order " + columns + ", and leave out others");
    const auto isPosition = [](const std::string& c) { return c == "x" || c == "y" || c == "z"; };
    std::string read;
    for (std::size_t k = 0; k < names.size() && std::getline(order, read, ','); ++k) {
        const std::string& name = names[k];
        constexpr std::array<const char*, 6> kOthers{"x", "y", "z", "nx", "ny", "nz"};
        const bool isKnown =
            extra[k] || std::find(kOthers.begin(), kOthers.end(), name) != kOthers.end();
        // Columns from the fourth on may be left out, so only their names tell what they hold.
        const bool needsName = k >= 3 && k < numbers && !isPosition(read);
        if ((isKnown || needsName) && name != read)
            throw Error(Error::Kind::BadInput,
                        fmt::format("{}, line {}: the header '{}' names column {} '{}', which is "
                                    "read as {}",
                                    file, number, header.substr(0, 60), k + 1, name, read),
                        "write the columns in the order " + columns + "; leave out others");
    }
}

std::vector<std::vector<double>> rowsFromText(std::istream& in, const std::string& file,
                                              const std::string& columns,
                                              const std::vector<std::size_t>& counts,
                                              const std::string& shape) {
    std::vector<std::vector<double>> rows;
    std::string header;
    std::size_t lineNumber = 0, headerNumber = 0, most = 0;  // numbers in a line
    bool mayBeHeader = true;
    const std::string bytes(std::istreambuf_iterator<char>(in), {});
    for (std::string_view rest = withoutByteOrderMark(bytes); !rest.empty();) {
        std::string line(cutLine(rest));
        ++lineNumber;
        if (const auto hash = line.find('#'); hash != std::string::npos) line.erase(hash);
        if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
        std::vector<double> v = numbersIn(withCommas(line));
        if (headerNumber > 0 && v.size() > most)
            requireColumns(file, headerNumber, header, columns, v.size());
        most = std::max(most, v.size());
        if (std::count(counts.begin(), counts.end(), v.size()) > 0) {
            rows.push_back(std::move(v));
        } else if (mayBeHeader && isHeader(withCommas(line))) {
            header = line;
            headerNumber = lineNumber;
        } else {
            numbersIn(file, lineNumber, line);  // names decimal commas as such
            throw Error(
                Error::Kind::BadInput,
                fmt::format("{}, line {}: '{}' is not {}", file, lineNumber, line.substr(0, 60),
                            shape),
                "write that many finite numbers with commas, semicolons or blanks between them");
        }
        mayBeHeader = false;
    }
    return rows;
}

}  // namespace igeo
