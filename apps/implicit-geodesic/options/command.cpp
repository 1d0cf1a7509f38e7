#include "options/command.h"

#include <algorithm>

void Command::add(const std::string& group, const std::vector<Option>& more) {
    for (Option option : more) {
        option.group = group;
        options.push_back(option);
    }
}

std::vector<std::string> Command::excludedBy(const Option& option) const {
    auto names = [](const Option& a, const Option& b) {
        return std::count(a.excludes.begin(), a.excludes.end(), b.longName()) > 0;
    };
    std::vector<std::string> excluded;
    for (const Option& other : options)
        if (names(option, other) || names(other, option)) excluded.push_back(other.longName());
    return excluded;
}

Option helpOption() { return {.names = {"-h", "--help"}, .text = "Print this help"}; }

Option versionOption() {
    return {.names = {"-V", "--version"},
            .text = "Print the versions of the program and of what it is built with"};
}
