#include "command_description.h"

#include <igeo/base/version.h>

#include <algorithm>
#include <sstream>

#include "json_file.h"

namespace {

constexpr std::size_t kTextColumn = 28, kColumns = 80;

std::string joined(const std::vector<std::string>& words, const char* separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
    return text;
}

/// In lines of kColumns; those after the first begin in `column`, where the first stands already.
std::string wrapped(const std::string& text, std::size_t column) {
    std::istringstream words(text);
    std::string out;
    std::size_t end = column;
    for (std::string word; words >> word; end += word.size(), out += word) {
        if (out.empty()) continue;
        const bool fits = end + 1 + word.size() <= kColumns;
        out += fits ? " " : "\n" + std::string(column, ' ');
        end = fits ? end + 1 : column;
    }
    return out + "\n";
}

/// Text beside a head, or below it if the head is too long.
std::string entry(const std::string& head, const std::string& text) {
    std::string out = "  " + head;
    const bool beside = out.size() + 2 <= kTextColumn;
    out +=
        beside ? std::string(kTextColumn - out.size(), ' ') : "\n" + std::string(kTextColumn, ' ');
    return out + wrapped(text, kTextColumn);
}

std::string headOf(const OptionDescription& option) {
    const std::string names = joined(option.names, ", ");
    return option.value.empty() ? names : names + " " + option.value;
}

/// FILE[:GRID]; PARTS... for several.
std::string headOfArgument(const OptionDescription& argument) {
    return argument.names.front() + argument.value + (argument.repeatable ? "..." : "");
}

/// The text and, in parentheses, what goes with the option.
std::string textOf(const OptionDescription& option) {
    std::vector<std::string> notes;
    if (!option.range.empty()) notes.push_back(option.range);
    if (!option.needs.empty()) notes.push_back("needs " + joined(option.needs, ", "));
    if (!option.excludes.empty()) notes.push_back("not with " + joined(option.excludes, ", "));
    return option.text + (notes.empty() ? "" : " (" + joined(notes, "; ") + ")");
}

std::string usage(const CommandDescription& command) {
    std::string text = command.name;
    for (const OptionDescription& argument : command.arguments)
        text += " " + headOfArgument(argument);
    return text + " [options]\n";
}

/// Groups are in the order of their first options.
std::string optionGroups(const CommandDescription& command) {
    std::vector<std::pair<std::string, std::string>> groups;
    for (const OptionDescription& option : command.options) {
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const auto& g) { return g.first == option.group; });
        if (group == groups.end()) group = groups.insert(group, {option.group, ""});
        group->second += entry(headOf(option), textOf(option));
    }
    std::string text;
    for (const auto& [name, entries] : groups) text += "\n" + name + ":\n" + entries;
    return text;
}

Json toJson(const OptionDescription& o) {
    return {{"names", o.names},
            {"value", o.value},
            {"choices", o.choices},
            {"range", o.range},
            {"separator", o.separator ? std::string(1, o.separator) : ""},
            {"repeatable", o.repeatable},
            {"required", o.required},
            {"needs", o.needs},
            {"excludes", o.excludes},
            {"group", o.group},
            {"text", o.text}};
}

Json toJson(const ExitCode& e) { return {{"code", e.code}, {"meaning", e.meaning}}; }

Json toJson(const Example& e) { return {{"command", e.command}, {"meaning", e.meaning}}; }

Json toJson(const CommandDescription& c);

template <class Item>
Json listOf(const std::vector<Item>& items) {
    Json list = Json::array();
    for (const Item& item : items) list.push_back(toJson(item));
    return list;
}

Json toJson(const CommandDescription& c) {
    return {{"name", c.name},
            {"about", c.about},
            {"arguments", listOf(c.arguments)},
            {"options", listOf(c.options)},
            {"exit_codes", listOf(c.exitCodes)},
            {"examples", listOf(c.examples)},
            {"commands", listOf(c.commands)}};
}

}  // namespace

std::string helpText(const CommandDescription& command) {
    std::string text;
    std::istringstream about(command.about);
    for (std::string line; std::getline(about, line);) text += wrapped(line, 0);
    text += "\nUsage: " + usage(command);
    for (const CommandDescription& below : command.commands) text += "       " + usage(below);
    if (!command.arguments.empty()) text += "\nArguments:\n";
    for (const OptionDescription& argument : command.arguments)
        text += entry(headOfArgument(argument), textOf(argument));
    text += optionGroups(command);
    if (!command.commands.empty()) text += "\nCommands:\n";
    for (const CommandDescription& below : command.commands)
        text += entry(below.name.substr(command.name.size() + 1), below.about);
    text += "\nExit codes:\n";
    for (const ExitCode& e : command.exitCodes) {
        const std::string code = std::to_string(e.code);
        text += "  " + code + std::string(5 - code.size(), ' ') + e.meaning + "\n";
    }
    text += "\nExamples:\n";
    for (const Example& e : command.examples)
        text += "  " + e.command + "\n      " + e.meaning + "\n";
    return text;
}

std::string descriptionJson(const CommandDescription& command) {
    Json all = toJson(command);
    all["version"] = igeo::kVersion;
    return all.dump(2) + "\n";
}
