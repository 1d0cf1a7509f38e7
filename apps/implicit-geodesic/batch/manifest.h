/// The file of the jobs of a batch.
#pragma once

#include <set>
#include <string>
#include <vector>

struct ManifestJob {
    std::string name;
    /// Of an ordinary run: --option=value, in alphabetical order.
    std::vector<std::string> arguments;
    std::set<std::string> defaults;  ///< options that the job has from those of all

    std::string quoted() const { return "job '" + name + "'"; }
};

/// Reads docs/batch.schema.json, or a table: a .csv file with a row per job, whose first line names
/// an option per column, and `name`. "files" makes a job of each file of a pattern; in all values
/// {name} is the job's name, and {file} such a file. Each job becomes the arguments of an ordinary
/// run, so it takes every option that a run takes, and is refused in the same words.
/// @throws igeo::Error  Io, BadInput
std::vector<ManifestJob> readManifest(const std::string& file);
