#include "options/command_description.h"

#include <igeo/base/version.h>

#include <algorithm>
#include <sstream>

#include "json_file.h"
#include "output/result_table.h"
#include "process.h"

namespace {

constexpr std::size_t kTextColumn = 28;

/// The width of the terminal, or of a page.
std::size_t columns() {
    constexpr int kPage = 80, kLeast = 60, kMost = 120;
    static const int width = stdoutColumns();
    return std::size_t(width > 0 ? std::clamp(width, kLeast, kMost) : kPage);
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
    return text;
}

/// Wraps a text to columns() characters; lines after the first are indented by `column`, where the
/// first starts.
std::string wrapped(const std::string& text, std::size_t column) {
    std::istringstream words(text);
    std::string out;
    std::size_t end = column;
    for (std::string word; words >> word; end += word.size(), out += word) {
        if (out.empty()) continue;
        const bool fits = end + 1 + word.size() <= columns();
        out += fits ? " " : "\n" + std::string(column, ' ');
        end = fits ? end + 1 : column;
    }
    return out + "\n";
}

/// Text next to a head, or below it if the head is too long.
std::string entry(const std::string& head, const std::string& text) {
    std::string out = "  " + head;
    const bool beside = out.size() + 2 <= kTextColumn;
    out +=
        beside ? std::string(kTextColumn - out.size(), ' ') : "\n" + std::string(kTextColumn, ' ');
    return out + wrapped(text, kTextColumn);
}

std::string headOf(const Option& option) {
    const std::string names = joined(option.names, ", ");
    return option.value.empty() ? names : names + " " + option.value;
}

/// FILE[:GRID]; PARTS... for several.
std::string headOfArgument(const Option& argument) {
    return argument.names.front() + argument.value + (argument.reads.repeatable ? "..." : "");
}

/// The text of an option, with its range in parentheses.
std::string textOf(const Option& option) {
    return option.text + (option.reads.range.empty() ? "" : " (" + option.reads.range + ")");
}

std::string usage(const Command& command) {
    std::string text = command.name;
    for (const Option& argument : command.arguments) text += " " + headOfArgument(argument);
    return text + " [options]\n";
}

std::string allUsages(const Command& command) {
    std::string text = "\nUsage: " + usage(command);
    for (const Command& below : command.commands) text += "       " + usage(below);
    return text;
}

std::string aboutLines(const Command& command) {
    std::string text;
    std::istringstream about(command.about);
    for (std::string line; std::getline(about, line);) text += wrapped(line, 0);
    return text;
}

/// One screen: the options that have a brief text.
std::string briefHelp(const Command& command) {
    std::string text = aboutLines(command) + allUsages(command) + "\n";
    for (const Option& argument : command.arguments)
        text += entry(headOfArgument(argument), argument.brief);
    for (const Option& option : command.options)
        if (!option.brief.empty()) text += entry(headOf(option), option.brief);
    text += "\nExample:\n  " + command.examples.front().command + "\n      " +
            command.examples.front().meaning + "\n";
    return text + "\nAll " + std::to_string(command.options.size()) + " options: " + command.name +
           " --help\n";
}

bool hasBriefHelp(const Command& command) {
    return std::any_of(command.options.begin(), command.options.end(),
                       [](const Option& option) { return !option.brief.empty(); });
}

/// Groups in the order of their first options.
std::string optionGroups(const Command& command) {
    std::vector<std::pair<std::string, std::string>> groups;
    for (const Option& option : command.options) {
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const auto& g) { return g.first == option.group; });
        if (group == groups.end()) group = groups.insert(group, {option.group, ""});
        group->second += entry(headOf(option), textOf(option));
    }
    std::string text;
    for (const auto& [name, entries] : groups) text += "\n" + name + ":\n" + entries;
    return text;
}

Json optionsJson(const std::vector<Option>& options, const Command& command) {
    Json list = Json::array();
    for (const Option& o : options)
        list.push_back({{"names", o.names},
                        {"value", o.value},
                        {"choices", o.reads.choices},
                        {"range", o.reads.range},
                        {"separator", o.reads.separator ? std::string(1, o.reads.separator) : ""},
                        {"repeatable", o.reads.repeatable},
                        {"required", o.required},
                        {"excludes", command.excludedBy(o)},
                        {"group", o.group},
                        {"text", o.text}});
    return list;
}

Json toJson(const ExitMeaning& e) { return {{"code", e.code}, {"meaning", e.meaning}}; }

Json toJson(const Example& e) { return {{"command", e.command}, {"meaning", e.meaning}}; }

Json toJson(const Command& c);

template <class Item>
Json listOf(const std::vector<Item>& items) {
    Json list = Json::array();
    for (const Item& item : items) list.push_back(toJson(item));
    return list;
}

Json toJson(const Command& c) {
    return {{"name", c.name},
            {"about", c.about},
            {"arguments", optionsJson(c.arguments, c)},
            {"options", optionsJson(c.options, c)},
            {"exit_codes", listOf(c.exitCodes)},
            {"examples", listOf(c.examples)},
            {"commands", listOf(c.commands)}};
}

}  // namespace

std::string helpText(const Command& command, bool brief) {
    if (brief && hasBriefHelp(command)) return briefHelp(command);
    std::string text = aboutLines(command) + allUsages(command);
    if (!command.arguments.empty()) text += "\nArguments:\n";
    for (const Option& argument : command.arguments)
        text += entry(headOfArgument(argument), textOf(argument));
    text += optionGroups(command);
    if (!command.commands.empty()) text += "\nCommands:\n";
    for (const Command& below : command.commands) text += entry(below.lastName(), below.about);
    text += "\nExit codes:\n";
    for (const ExitMeaning& e : command.exitCodes) {
        const std::string code = std::to_string(e.code);
        text += "  " + code + std::string(5 - code.size(), ' ') + e.meaning + "\n";
    }
    text += "\nExamples:\n";
    for (const Example& e : command.examples)
        text += "  " + e.command + "\n      " + e.meaning + "\n";
    return text;
}

std::string descriptionJson(const Command& command) {
    Json all = toJson(command);
    all["version"] = igeo::kVersion;
    all["results"] = Json::array();
    for (const ResultKind& kind : resultKinds())
        all["results"].push_back(
            {{"option", kind.option}, {"name", kind.name}, {"endings", kind.endings}});
    return all.dump(2) + "\n";
}
