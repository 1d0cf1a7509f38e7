#include "options/process_options.h"

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
