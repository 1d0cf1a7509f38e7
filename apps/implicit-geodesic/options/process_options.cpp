#include "options/process_options.h"

#include <algorithm>

#include "options/command.h"

namespace {

const Names<ProgressWhen> kWhen{
    {"auto", ProgressWhen::Auto}, {"always", ProgressWhen::Always}, {"never", ProgressWhen::Never}};

}  // namespace

void addProcessOptions(Command& command, ProcessOptions& o) {
    command.add("Run",
                {{.names = {"--threads"},
                  .value = "N",
                  .text = "Threads; 0 uses all cores [0]",
                  .reads = wholeNumber(o.threads, 0, 4096)},
                 {.names = {"--progress"},
                  .value = "WHEN",
                  .text = "Progress on stderr: auto (if it is a terminal), always, never [auto]",
                  .reads = choice(o.progress, kWhen)},
                 {.names = {"-q", "--quiet"},
                  .text = "Print errors only",
                  .reads = flag(o.quiet),
                  .excludes = {"--verbose"}},
                 {.names = {"-v", "--verbose"},
                  .text = "Print what was found and how long it took",
                  .reads = flag(o.verbose)}});
}

std::vector<std::string> withoutProcessOptions(const std::vector<std::string>& words) {
    std::vector<std::string> kept;
    bool isValue = false;
    for (const std::string& word : words) {
        // With one dash or two, as in readCommandLine.
        const std::size_t dashes = std::min<std::size_t>(word.find_first_not_of('-'), 3);
        const std::string all = dashes == 1 || dashes == 2 ? word.substr(dashes) : "",
                          name = all.substr(0, all.find('='));
        const bool isFlag = name == "q" || name == "quiet" || name == "v" || name == "verbose";
        const bool takesValue = name == "threads" || name == "progress";
        if (!isValue && !isFlag && !takesValue) kept.push_back(word);
        isValue = takesValue && name == all;
    }
    return kept;
}
