/// The manifest of a batch: its jobs.
#pragma once

#include <set>
#include <string>
#include <vector>

struct ManifestJob {
    std::string name;
    /// Arguments of an ordinary run: --option=value, in alphabetical order.
    std::vector<std::string> arguments;
    std::set<std::string> defaults;  ///< options that the job takes from the defaults

    std::string quoted() const { return "job '" + name + "'"; }
};

/// Reads docs/batch.schema.json, or a table: a .csv file with a row per job, whose first line names
/// an option per column, and `name`. "files" makes a job for each file that matches a pattern; in
/// all values {name} is the job's name, and {file} this file. Each job becomes the arguments of an
/// ordinary run, so it accepts all options of a run, and errors have the same messages.
/// @throws igeo::Error  Io, BadInput
std::vector<ManifestJob> readManifest(const std::string& file);
