#include "options/reader.h"

#include <charconv>
#include <cmath>
#include <cstdlib>

std::optional<double> numberOf(const std::string& word) {
    char* end = nullptr;
    const double v = std::strtod(word.c_str(), &end);
    if (end == word.c_str() || *end != '\0' || !std::isfinite(v)) return std::nullopt;
    return v;
}

std::string commaList(const std::vector<std::string>& words) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
    return list;
}

Reader flag(bool& field) {
    return {.read = [&field](const std::string&) { field = true; }, .isFlag = true};
}

Reader text(std::string& field) {
    return parsed(field, [](const std::string& word) { return word; });
}

Reader texts(std::vector<std::string>& field) {
    return parsedEach(field, [](const std::string& word) { return word; });
}

Reader numberAboveZero(double& field) {
    Reader reader = parsed(field, [](const std::string& word) {
        const std::optional<double> v = numberOf(word);
        if (!v || !(*v > 0)) usageError(word + " is no number above 0", "");
        return *v;
    });
    reader.range = "above 0";
    return reader;
}

Reader numberFromZero(std::optional<double>& field) {
    Reader reader = parsed(field, [](const std::string& word) {
        const std::optional<double> v = numberOf(word);
        if (!v || !(*v >= 0)) usageError(word + " is no number at least 0", "");
        return *v;
    });
    reader.range = "at least 0";
    return reader;
}

Reader number(std::optional<double>& field) {
    return parsed(field, [](const std::string& word) {
        const std::optional<double> v = numberOf(word);
        if (!v) usageError(word + " is no finite number", "");
        return *v;
    });
}

namespace {

template <typename Field>
Reader wholeNumberInto(Field& field, int least, int most) {
    const std::string range = std::to_string(least) + " to " + std::to_string(most);
    Reader reader = parsed(field, [=](const std::string& word) {
        int v = 0;
        const char* const end = word.data() + word.size();
        const auto [stop, error] = std::from_chars(word.data(), end, v);
        if (error != std::errc() || stop != end || v < least || v > most)
            usageError(word + " is no whole number from " + range, "");
        return v;
    });
    reader.range = range;
    return reader;
}

}  // namespace

Reader wholeNumber(int& field, int least, int most) { return wholeNumberInto(field, least, most); }
Reader wholeNumber(std::optional<int>& field, int least, int most) {
    return wholeNumberInto(field, least, most);
}
