/// Parses the word of an option into a typed value.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "options/spelling.h"
#include "usage_error.h"

/// Sets a field of an options struct, and describes the words that it accepts.
struct Reader {
    /// @throws igeo::Error  InvalidArgument for a word that is not accepted; if the remedy is
    ///         empty, the help is shown
    std::function<void(const std::string& word)> read = {};
    std::string range = {};                 ///< "1 to 2"; empty: any value
    std::vector<std::string> choices = {};  ///< the accepted words, or their beginnings
    bool isFlag = false, repeatable = false;
    char separator = 0;  ///< between several values in one word; 0: one value
};

Reader flag(bool& field);
Reader text(std::string& field);
Reader texts(std::vector<std::string>& field);
Reader numberAboveZero(double& field);
Reader numberFromZero(std::optional<double>& field);
Reader number(std::optional<double>& field);
Reader wholeNumber(int& field, int least, int most);
Reader wholeNumber(std::optional<int>& field, int least, int most);

/// The finite number in a word.
std::optional<double> numberOf(const std::string& word);

/// A reader from a function that parses a word, and throws as Reader::read does.
template <typename Field, typename Parse>
Reader parsed(Field& field, const Parse& parse) {
    return {.read = [&field, parse](const std::string& word) { field = parse(word); }};
}

/// The same for an option that may be repeated.
template <typename Value, typename Parse>
Reader parsedEach(std::vector<Value>& field, const Parse& parse) {
    return {.read = [&field, parse](const std::string& word) { field.push_back(parse(word)); },
            .repeatable = true};
}

/// Values by name.
template <typename Value>
using Names = std::vector<std::pair<std::string, Value>>;

template <typename Value>
std::vector<std::string> namesIn(const Names<Value>& values) {
    std::vector<std::string> names;
    for (const auto& entry : values) names.push_back(entry.first);
    return names;
}

/// "a, b, c"
std::string commaList(const std::vector<std::string>& words);

template <typename Value>
Value valueNamed(const std::string& word, const Names<Value>& values) {
    for (const auto& [name, value] : values)
        if (name == word) return value;
    usageError("'" + word + "' is none of " + commaList(namesIn(values)) +
                   didYouMean(word, namesIn(values)),
               "");
}

template <typename Field, typename Value>
Reader choice(Field& field, const Names<Value>& values) {
    Reader reader =
        parsed(field, [values](const std::string& word) { return valueNamed(word, values); });
    reader.choices = namesIn(values);
    return reader;
}
