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

struct Manifest {
    std::vector<ManifestJob> jobs;
    std::string table;  ///< file of the jobs, where the manifest names one; else empty
    /// Files that "files" matches and the batch writes itself: they get no job.
    std::vector<std::string> leftOut;
};

/// Reads docs/batch.schema.json, or a table: a .csv file with a row per job, whose first line names
/// an option per column, and `name`. "files" makes a job for each file that matches a pattern; in
/// all values {name} is the job's name, and {file} this file. Files that a job for another match
/// writes are left out: an earlier run has left them. Each job becomes the arguments of an
/// ordinary run, so it accepts all options of a run, and errors have the same messages.
/// @param others  the files of the batch itself, which are left out as well, by their wholeName
/// @throws igeo::Error  Io, BadInput
Manifest readManifest(const std::string& file, const std::set<std::string>& others);
