/// What a command takes and does, as plain data: the parser, the help, the manual page and the
/// completions are made from it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "options/reader.h"

struct Option {
    std::vector<std::string> names;  ///< as spelled: -o, --output; of an argument: FILE
    std::string value = {};          ///< as the help names it; empty for a flag
    std::string text = {};
    Reader reads = {};  ///< without a function: the help or the version, which end the program
    std::vector<std::string> excludes = {};  ///< other options, by their long names
    bool required = false;
    std::string group = {};
    std::string brief = {};  ///< what -h says of it; empty: --help alone has it

    const std::string& longName() const { return names.back(); }
};

struct ExitMeaning {
    int code;
    std::string meaning;
};

struct Example {
    std::string command, meaning;
};

struct Command {
    std::string name;                    ///< with those it is below: "batch merge"
    std::string about;                   ///< lines
    std::vector<Option> arguments = {};  ///< without a dash
    std::vector<Option> options = {};    ///< arguments have no group
    std::function<void()> check = {};    ///< of all values together; no file is read
    std::vector<ExitMeaning> exitCodes = {};
    std::vector<Example> examples = {};
    std::vector<Command> commands = {};

    void add(const std::string& group, const std::vector<Option>& more);
    std::string lastName() const { return name.substr(name.rfind(' ') + 1); }
    /// What does not go with an option, whichever of the two says so, in the order of the options.
    std::vector<std::string> excludedBy(const Option& option) const;
};

Option helpOption();
Option versionOption();
