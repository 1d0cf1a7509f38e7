#include "options/options.h"

#include <algorithm>

#include "options/command.h"
#include "options/command_description.h"
#include "options/command_line.h"
#include "options/run_command.h"
#include "output/stdout.h"

std::optional<Options> parseOptions(int argc, char** argv) {
    RunOptions run;
    InfoOptions info;
    BatchOptions batch;
    MergeOptions merge;
    Command program = runCommand(run), batchWithMerge = batchCommand(batch);
    batchWithMerge.commands = {mergeCommand(merge)};
    program.commands = {infoCommand(info), batchWithMerge};

    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (words == std::vector<std::string>{"--dump-options"}) {
        results() << descriptionJson(program);
        return std::nullopt;
    }
    const Command* const named = readCommandLine(program, words);
    if (!named) return std::nullopt;
    const std::string name = named->lastName();
    run.words = info.words = words;
    if (name == "info") return info;
    if (name == "batch") return batch;
    if (name == "merge") return merge;
    return run;
}

RunOptions parseJob(const std::vector<std::string>& arguments) {
    RunOptions options;
    readCommandLine(jobCommand(options), arguments);
    options.words = arguments;
    return options;
}
