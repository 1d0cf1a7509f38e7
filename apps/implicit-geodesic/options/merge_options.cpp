#include "options/merge_options.h"

#include "options/command.h"

Command mergeCommand(MergeOptions& o) {
    Command command{
        .name = "implicit-geodesic batch merge",
        .about = "Joins the summaries of all shards of a batch into one, or the parts of a matrix",
        .arguments = {{.names = {"PARTS"},
                       .text = "Summaries, or with --matrix parts; .json",
                       .reads = texts(o.parts),
                       .required = true}},
        .exitCodes = {{0, "all jobs are done"},
                      {1, "failed, or the largest code of a job that failed"},
                      {2, "wrong usage"},
                      {3, "unusable or incomplete input"},
                      {4, "all jobs are done, but a target, pair or --via is unreached"}},
        .examples = {{"implicit-geodesic batch merge jobs.summary-1-of-2.json "
                      "jobs.summary-2-of-2.json -o jobs.summary.json",
                      "one summary of both shards"},
                     {"implicit-geodesic batch merge --matrix rows-1.json rows-2.json -o "
                      "distances.npy",
                      "one matrix of the parts that --matrix-rows 1/2 and 2/2 wrote"}}};
    command.add("Results",
                {{.names = {"-o", "--output"},
                  .value = "FILE",
                  .text = "Output file; - is stdout [-]",
                  .reads = text(o.output)},
                 {.names = {"--matrix"},
                  .text = "Join parts of a matrix, as --matrix-rows writes them: to .csv, .json "
                          "or .npy",
                  .reads = flag(o.matrix)}});
    command.add("Run", {helpOption()});
    return command;
}
