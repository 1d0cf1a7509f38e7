/// What a command takes and does, as plain data: the help, and the JSON that the manual page and
/// the completions are made from (scripts/make_pages.py).
#pragma once

#include <string>
#include <utility>
#include <vector>

struct OptionDescription {
    std::vector<std::string> names;  ///< as spelled: -o, --output; of an argument: FILE
    std::string value;               ///< as the help names it; empty for a flag
    std::vector<std::string> choices;
    std::string range;   ///< "1 to 2"; empty: any value
    char separator = 0;  ///< between several values in one word; 0: one value
    bool repeatable = false, required = false;
    std::vector<std::string> needs, excludes;  ///< other options, by their long names
    std::string group, text;
};

struct ExitCode {
    int code;
    std::string meaning;
};

struct Example {
    std::string command, meaning;
};

struct CommandDescription {
    std::string name;                                   ///< with those it is below: "batch merge"
    std::string about;                                  ///< lines
    std::vector<OptionDescription> options, arguments;  ///< arguments have no dash
    std::vector<ExitCode> exitCodes;
    std::vector<Example> examples;
    std::vector<CommandDescription> commands;
};

/// In lines of 80 columns; an example stays in one line, for a shell to take.
std::string helpText(const CommandDescription& command);

/// Of a command and those below it.
std::string descriptionJson(const CommandDescription& command);
