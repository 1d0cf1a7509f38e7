#include "options/command_line.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <deque>
#include <list>

#include "options/command_description.h"
#include "output/stdout.h"
#include "usage_error.h"
#include "version_text.h"

namespace {

/// A command in CLI11, which only splits the words: values stay text here, and our code parses and
/// checks them. (CLI11's own messages change from version to version, and it accepts "nan".)
class Words {
public:
    Words(const Command& command, CLI::App& app) : command_(command), app_(app) {
        app.set_help_flag();
        for (const Option& argument : command.arguments) declare(argument);
        for (const Option& option : command.options) declare(option);
        for (const Command& below : command.commands)
            below_.emplace_back(below, *app.add_subcommand(below.lastName()));
    }
    Words(const Words&) = delete;
    Words& operator=(const Words&) = delete;

    /// The commands named by the words, each below the one before it.
    std::vector<const Words*> named() const {
        std::vector<const Words*> chain{this};
        for (const Words& below : below_)
            if (below.app_.parsed())
                for (const Words* words : below.named()) chain.push_back(words);
        return chain;
    }
    const Command& command() const { return command_; }

    /// Refuses words that are no option, no value and no command.
    [[noreturn]] void refuseExtra() const;
    /// Refuses a word that is nearly a command.
    void refuseMisspelled() const;

    /// CLI11 reports a missing value; its message starts with the option.
    [[noreturn]] void refuseMissing(const std::string& message) const {
        const std::string name = message.substr(0, message.find(':'));
        for (const Given& given : given_)
            if (given.option->longName() == name)
                usageError(name + ": its value " + given.option->value + " is missing",
                           "write " + name + " " + given.option->value);
        refuse(message, command_);
    }
    /// Refuses options of this command before a subcommand.
    void refuseBefore(const Command& below) const {
        for (const Given& given : given_)
            if (given.here())
                refuse(below.lastName() + " goes before all options, and " +
                           given.option->longName() + " is before it",
                       below);
    }
    void refuseConflicts() const;
    /// Sets the fields.
    void read() const;

private:
    /// An option and its words.
    struct Given {
        const Option* option;
        std::string one = {};
        std::vector<std::string> several = {};
        bool flag = false;
        CLI::Option* parsed = nullptr;

        bool here() const { return parsed->count() > 0; }
    };

    void declare(const Option& option);
    bool has(const std::string& name) const {
        return std::any_of(given_.begin(), given_.end(), [&](const Given& given) {
            return given.option->longName() == name && given.here();
        });
    }
    [[noreturn]] static void refuse(const std::string& what, const Command& command) {
        usageError(what, "see " + command.name + " --help");
    }

    const Command& command_;
    CLI::App& app_;
    std::deque<Given> given_;  // CLI11 keeps the addresses
    std::list<Words> below_;   // a list allows the incomplete type
};

void Words::declare(const Option& option) {
    std::string names;
    for (const std::string& name : option.names) names += (names.empty() ? "" : ",") + name;
    if (!option.reads.read) {
        if (option.longName() == "--help")
            app_.set_help_flag(names);
        else
            app_.set_version_flag(names, versionText);
        return;
    }
    Given& given = given_.emplace_back(Given{&option});
    if (option.reads.isFlag)
        given.parsed = app_.add_flag(names, given.flag);
    else if (option.reads.repeatable)
        given.parsed = app_.add_option(names, given.several);
    else
        given.parsed = app_.add_option(names, given.one)->take_last();  // refused if given twice
    const bool isArgument = option.names.front().front() != '-';
    if (option.reads.repeatable && !isArgument) given.parsed->allow_extra_args(false);
}

void Words::refuseExtra() const {
    const std::vector<std::string> extras = app_.remaining(/*recurse=*/true);
    const std::string first = extras.empty() ? "" : extras.front();
    if (first.size() > 1 && first[0] == '-' && !numberOf(first)) {
        std::vector<std::string> names;
        for (const Option& option : command_.options)
            names.insert(names.end(), option.names.begin(), option.names.end());
        refuse("unknown option " + first + didYouMean(first, names), command_);
    }
    refuseMisspelled();
    refuse("'" + first + "' belongs to no option", command_);
}

void Words::refuseMisspelled() const {
    std::vector<std::string> commands{"help"};
    for (const Command& below : command_.commands) commands.push_back(below.lastName());
    for (const Given& given : given_) {
        const bool isArgument = given.option->names.front().front() != '-';
        if (!isArgument || !given.here() || command_.commands.empty()) continue;
        // A name with an ending is a file.
        const std::string hint = didYouMean(given.one, commands);
        if (!hint.empty() && given.one.find_first_of("./") == std::string::npos)
            refuse("'" + given.one + "' is no command" +
                       (given.one == "help" ? ", did you mean '--help'?" : hint),
                   command_);
    }
}

void Words::refuseConflicts() const {
    for (const Given& given : given_) {
        const Option& option = *given.option;
        const bool isArgument = option.names.front().front() != '-';
        const std::string name =
            isArgument && given.here() ? "'" + given.one + "'" : option.longName();
        if (option.required && !given.here()) refuse(name + " is required", command_);
        if (!given.here()) continue;
        const bool once = !option.reads.repeatable && !option.reads.isFlag;
        if (const auto times = given.parsed->count(); times > 1 && once)
            usageError(name + " is given " + std::to_string(times) + " times", "give it once");
        for (const std::string& excluded : option.excludes)
            if (has(excluded)) usageError(name + " excludes " + excluded, "give one of the two");
    }
}

void Words::read() const {
    for (const Given& given : given_) {
        const Option& option = *given.option;
        std::vector<std::string> words = given.several;
        if (option.reads.isFlag ? given.flag : given.here() && !option.reads.repeatable)
            words = {given.one};
        try {
            for (const std::string& word : words) option.reads.read(word);
        } catch (const igeo::Error& e) {
            const std::string what = option.longName() + ": " + e.what();
            if (e.remedy().empty()) refuse(what, command_);
            throw igeo::Error(e.kind(), what, e.remedy());
        }
    }
}

/// Refuses unquoted coordinates: --seed 0 0 1
void refuseLooseNumbers(const std::vector<std::string>& words) {
    for (std::size_t k = 1; k + 1 < words.size(); ++k) {
        if (!words[k - 1].starts_with("--") || !numberOf(words[k]) || !numberOf(words[k + 1]))
            continue;
        std::string joined = words[k];
        for (std::size_t n = k + 1; n < words.size() && numberOf(words[n]); ++n)
            joined += "," + words[n];
        usageError("'" + words[k + 1] + "' belongs to no option",
                   "numbers of one option are joined by commas: " + words[k - 1] + " " + joined);
    }
}

/// OpenVDB's tools write options with one dash: -help and -version are accepted here too.
std::vector<std::string> withTwoDashes(std::vector<std::string> words) {
    for (std::string& word : words)
        if (word == "-help" || word == "-version") word = "-" + word;
    return words;
}

}  // namespace

const Command* readCommandLine(const Command& command, std::vector<std::string> words) {
    CLI::App app("", command.name);
    const Words parsed(command, app);
    words = withTwoDashes(words);
    refuseLooseNumbers(words);
    auto has = [&](const char* word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    const bool brief = has("-h") && !has("--help");
    try {
        std::reverse(words.begin(), words.end());  // CLI11 takes them in reverse order
        app.parse(words);
    } catch (const CLI::CallForHelp&) {
        results() << helpText(parsed.named().back()->command(), brief);
        return nullptr;
    } catch (const CLI::CallForVersion&) {
        results() << versionText() << "\n";
        return nullptr;
    } catch (const CLI::ExtrasError&) {
        parsed.named().back()->refuseExtra();
    } catch (const CLI::ArgumentMismatch& e) {
        parsed.named().back()->refuseMissing(e.what());
    } catch (const CLI::ParseError& e) {
        usageError(e.what(), "see " + parsed.named().back()->command().name + " --help");
    }
    const std::vector<const Words*> chain = parsed.named();
    for (std::size_t k = 0; k + 1 < chain.size(); ++k)
        chain[k]->refuseBefore(chain[k + 1]->command());
    chain.back()->refuseMisspelled();
    chain.back()->refuseConflicts();
    chain.back()->read();
    if (chain.back()->command().check) chain.back()->command().check();
    return &chain.back()->command();
}
