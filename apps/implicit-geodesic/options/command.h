/// A command as plain data: its options and its work. The parser, the help, the manual page and the
/// completions are made from it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "options/reader.h"

struct Option {
    std::vector<std::string> names;  ///< as written: -o, --output; of an argument: FILE
    std::string value = {};          ///< its name in the help; empty for a flag
    std::string text = {};
    Reader reads = {};  ///< without a function: help or version, which end the program
    std::vector<std::string> excludes = {};  ///< incompatible options, by their long names
    bool required = false;
    std::string group = {};
    std::string brief = {};  ///< its text for -h; empty: only in --help

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
    std::string name;                    ///< with its parents: "batch merge"
    std::string about;                   ///< lines
    std::vector<Option> arguments = {};  ///< positional
    std::vector<Option> options = {};    ///< arguments have no group
    std::function<void()> check = {};    ///< checks all values together, without reading files
    std::vector<ExitMeaning> exitCodes = {};
    std::vector<Example> examples = {};
    std::vector<Command> commands = {};

    void add(const std::string& group, const std::vector<Option>& more);
    std::string lastName() const { return name.substr(name.rfind(' ') + 1); }
    /// The options incompatible with an option, declared by either of the two, in the order of the
    /// options.
    std::vector<std::string> excludedBy(const Option& option) const;
};

Option helpOption();
Option versionOption();
