#include "options/batch_options.h"

#include <string>
#include <utility>

#include "options/command.h"

Command batchCommand(BatchOptions& o) {
    Command command{
        .name = "implicit-geodesic batch",
        .about = "Run many jobs; those that are done already are left out",
        .arguments = {{.names = {"JOBS"},
                       .text = "The jobs (docs/batch.schema.json), or a table of them; .json .csv",
                       .reads = text(o.manifest)}},
        .exitCodes = {{0, "all jobs are done"},
                      {1, "failed, or the largest code of a job that failed"},
                      {2, "wrong usage"},
                      {3, "unusable input or output"},
                      {4, "all jobs are done, but a target, pair or --via is unreached"},
                      {130, "interrupted"}},
        .examples = {{"implicit-geodesic batch jobs.json",
                      "all jobs of jobs.json; after an interruption: those that are left"},
                     {"implicit-geodesic batch jobs.json --shard 2/8 --threads 1",
                      "the second of eight parts of them, for eight processes on any machines"}}};
    command.add(
        "Jobs",
        {{.names = {"--shard"},
          .value = "K/N",
          .text = "Only the K-th of N parts of the jobs",
          .reads = parsed(o.shard, Part::parse)},
         {.names = {"--summary"},
          .value = "FILE",
          .text = "The result of each job, as JSON [beside the jobs: jobs.summary.json]",
          .reads = text(o.summary)},
         {.names = {"--log"},
          .value = "FILE",
          .text = "Append a line of JSON for each job as it ends: when, how long, warnings",
          .reads = text(o.log)},
         {.names = {"--view"},
          .value = "FILE.html",
          .text = "A page of all jobs: their pictures, and links to their files",
          .reads = text(o.view)},
         {.names = {"--dry-run"},
          .text = "Check everything, print each job, its state and its command, run nothing",
          .reads = flag(o.dryRun)}});
    addProcessOptions(command, o);
    command.add("Run", {helpOption()});
    command.check = [&o] {
        if (o.manifest.empty())
            usageError("no manifest is given", "name a file of jobs; see docs/formats.md");
        for (const auto& [option, file] :
             {std::pair("--summary", &o.summary), {"--log", &o.log}, {"--view", &o.view}})
            if (*file == "-")
                usageError(std::string(option) + " -: a batch writes no file to stdout",
                           "give a file");
    };
    return command;
}
