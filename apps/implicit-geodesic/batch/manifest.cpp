#include "batch/manifest.h"

#include <igeo/base/detail/text.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "batch/job_table.h"
#include "file_ending.h"
#include "json_file.h"
#include "options/options.h"
#include "output/output_files.h"
#include "output/result_checks.h"
#include "printable.h"

namespace fs = std::filesystem;

namespace {

/// Values of options by name; sorted, so that their order in the file has no effect.
using Values = std::map<std::string, Json>;

/// The members of an object except its name.
Values valuesOf(const Json& object, const std::string& where) {
    Values values;
    for (const auto& [key, value] : object.items()) {
        if (key == "name") continue;
        // The option --name is different from the name of the job.
        const std::string option = key.rfind("--", 0) == 0 ? key.substr(2) : key;
        if (option.empty() || option.front() == '-' ||
            option.find_first_not_of("abcdefghijklmnopqrstuvwxyz-") != std::string::npos)
            inputError(where + ": '" + key + "' is no option",
                       "write the long name of an option without its dashes; see "
                       "implicit-geodesic --help");
        if (!values.emplace(option, value).second)
            inputError(where + ": '" + option + "' is given with and without dashes",
                       "keep one of the two");
    }
    return values;
}

bool allNumbers(const Json& list) {
    for (const Json& item : list)
        if (!item.is_number()) return false;
    return !list.empty();
}

/// A value as one word of a command line.
std::string wordOf(const Json& value, const std::string& where) {
    if (value.is_string()) {
        const std::string word = value.get<std::string>();
        if (hasControls(word))
            inputError(where + ": '" + printable(word) + "' holds a control character",
                       "take it out");
        return word;
    }
    if (value.is_number()) return value.dump();
    std::string word;
    if (value.is_array() && allNumbers(value)) {
        for (const Json& number : value) word += (word.empty() ? "" : ",") + number.dump();
        return word;
    }
    inputError(where + ": " + value.dump(-1, ' ', false, Json::error_handler_t::replace) +
                   " is no value of an option",
               "give a string, a number, true, false, or a list of strings, numbers or points");
}

/// A list of numbers is one value, such as a point; any other list is a repeated option.
void addArguments(const std::string& option, const Json& value, const std::string& where,
                  std::vector<std::string>& arguments) {
    if (value.is_boolean()) {
        if (value.get<bool>()) arguments.push_back("--" + option);
        return;
    }
    const bool repeated = value.is_array() && !allNumbers(value);
    for (const Json& item : repeated ? value : Json::array({value}))
        arguments.push_back("--" + option + "=" + wordOf(item, where + ": '" + option + "'"));
}

/// Replaces {name} and, in a job made from a file, {file}.
std::string filled(std::string text, const std::string& name, const std::string& file) {
    for (const auto& [mark, word] : {std::pair("{name}", name), {"{file}", file}}) {
        const std::size_t size = std::string(mark).size();
        if (word.empty()) continue;
        for (auto at = text.find(mark); at != text.npos; at = text.find(mark, at + word.size()))
            text.replace(at, size, word);
    }
    return text;
}

/// Whether a name, put into a path, may lead out of the path's folder.
bool leadsOut(const std::string& name) {
    const std::filesystem::path path(name);
    return path.has_root_path() || std::find(path.begin(), path.end(), "..") != path.end();
}

ManifestJob jobOf(const Json& entry, const Values& defaults, const std::string& file,
                  std::size_t number) {
    const std::string place = file + ": job " + std::to_string(number);
    if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string() ||
        entry["name"].get<std::string>().empty())
        inputError(place + " (counted from 0) has no name", "give it a \"name\", a string");
    ManifestJob job;
    job.name = entry["name"].get<std::string>();
    const std::string where = file + ": " + job.quoted();
    if (hasControls(job.name))
        inputError(printable(where) + " has a control character in its name", "take it out");
    Values values = valuesOf(entry, where);
    for (const auto& [option, value] : defaults)  // unless the job sets them
        if (values.emplace(option, value).second) job.defaults.insert("--" + option);
    for (const auto& [option, value] : values) addArguments(option, value, where, job.arguments);
    for (std::string& argument : job.arguments) {
        if (leadsOut(job.name) && argument.find("{name}") != argument.npos)
            inputError(where + ": its name leads out of the folder of '" + argument + "'",
                       "take \"..\" and a leading \"/\" out of the name, or write the path itself");
        if (argument.find("{file}") != argument.npos)
            inputError(where + ": '" + argument + "' asks for {file}, and the job is of no file",
                       "write the name of the file; {file} is for \"files\", without \"jobs\"");
        argument = filled(argument, job.name, "");
    }
    return job;
}

/// A job for a file: it is the surface, unless the defaults use {file}.
ManifestJob jobOfFile(const fs::path& path, const Values& defaults, const std::string& manifest) {
    const std::string file = path.string(), name = igeo::stemOf(file);
    ManifestJob job;
    job.name = name;
    bool used = false;
    for (const auto& [option, value] : defaults) {
        addArguments(option, value, manifest + ": defaults", job.arguments);
        job.defaults.insert("--" + option);
    }
    for (std::string& argument : job.arguments) {
        used = used || argument.find("{file}") != argument.npos;
        argument = filled(argument, name, file);
    }
    if (!used) job.arguments.push_back(optionFor(kindByName(file)) + "=" + file);
    std::sort(job.arguments.begin(), job.arguments.end());
    return job;
}

/// Files that a job writes; none of a job that cannot run, which is refused later.
std::vector<std::string> filesWrittenBy(const ManifestJob& job) {
    try {
        return outputFiles(parseJob(job.arguments));
    } catch (const igeo::Error&) {
        return {};
    }
}

/// Takes out the files that the batch writes itself, which an earlier run of it may have left.
/// @param files   those of the jobs
/// @param others  files of the batch that no job writes
void leaveOutOwnFiles(const std::vector<fs::path>& files, const fs::path& folder,
                      const std::set<std::string>& others, Manifest& read) {
    std::multimap<std::string, std::size_t> writers;
    for (std::size_t k = 0; k < files.size(); ++k)
        for (const std::string& file : filesWrittenBy(read.jobs[k]))
            writers.emplace(wholeName((folder / file).string()), k);
    std::vector<ManifestJob> kept;
    for (std::size_t k = 0; k < files.size(); ++k) {
        const std::string whole = wholeName((folder / files[k]).string());
        const auto [begin, end] = writers.equal_range(whole);
        // A job that writes its own input is refused later.
        const bool isOwn = others.count(whole) > 0 ||
                           std::any_of(begin, end, [&](const auto& w) { return w.second != k; });
        if (isOwn)
            read.leftOut.push_back(files[k].string());
        else
            kept.push_back(std::move(read.jobs[k]));
    }
    read.jobs = std::move(kept);
}

/// Adds the jobs of "files": a pattern, or a list of patterns.
void addJobsOfFiles(const Json& patterns, const Values& defaults, const std::string& manifest,
                    const std::set<std::string>& others, Manifest& read) {
    const fs::path folder = fs::path(wholeName(manifest)).parent_path();
    std::vector<fs::path> files;
    for (const Json& pattern : patterns.is_array() ? patterns : Json::array({patterns})) {
        if (!pattern.is_string())
            inputError(manifest + ": \"files\" is no pattern, nor a list of them",
                       "write for instance \"scans/*.obj\"");
        const std::string text = pattern.get<std::string>();
        const std::vector<fs::path> found = filesLike(text, folder);
        if (found.empty())
            inputError(manifest + ": no file is like '" + text + "'",
                       "* and ? stand for letters of the name; folders are those of the manifest");
        files.insert(files.end(), found.begin(), found.end());
    }
    for (const fs::path& file : files) read.jobs.push_back(jobOfFile(file, defaults, manifest));
    leaveOutOwnFiles(files, folder, others, read);
    if (read.jobs.empty())
        inputError(manifest + ": the batch writes all files itself that are like its \"files\"",
                   "name others, which it is to read");
}

/// A JSON document with jobs, or the rows of a table as one.
Json manifestOf(const std::string& file) {
    if (igeo::lowerCase(endingOf(file)) != ".csv") return readJson(file);
    return {{"version", 2}, {"jobs", jobsOfTable(file)}};
}

}  // namespace

Manifest readManifest(const std::string& file, const std::set<std::string>& others) {
    Manifest read;
    Json manifest = manifestOf(file);
    const bool hasVersion =
        manifest.is_object() && manifest.contains("version") && manifest["version"] == 2;
    if (hasVersion && manifest.contains("jobs") && manifest["jobs"].is_string()) {
        read.table = (fs::path(file).parent_path() / manifest["jobs"].get<std::string>()).string();
        manifest["jobs"] = jobsOfTable(read.table);
    }
    const bool hasJobs = hasVersion && manifest.contains("jobs") && manifest["jobs"].is_array();
    if (!hasVersion || hasJobs == manifest.contains("files"))
        inputError(
            file + " is no manifest of version 2",
            "write {\"version\": 2, \"defaults\": {...}, \"jobs\": [{\"name\": ...}, ...]}, or "
            "\"files\" instead of \"jobs\"");
    for (const auto& [key, value] : manifest.items())
        if (key != "version" && key != "defaults" && key != "jobs" && key != "files" &&
            key != "$schema")
            inputError(file + ": '" + key + "' is no member of a manifest",
                       "options belong to \"defaults\" and to the jobs");
    Values defaults;
    if (manifest.contains("defaults")) {
        const Json& given = manifest["defaults"];
        if (!given.is_object() || given.contains("name"))
            inputError(file + ": \"defaults\" is no object of options, or has a name",
                       "names belong to jobs; the option --name is written \"--name\"");
        defaults = valuesOf(given, file + ": defaults");
    }
    std::vector<ManifestJob>& jobs = read.jobs;
    if (hasJobs)
        for (const Json& entry : manifest["jobs"])
            jobs.push_back(jobOf(entry, defaults, file, jobs.size()));
    else
        addJobsOfFiles(manifest["files"], defaults, file, others, read);
    std::set<std::string> names;
    for (const ManifestJob& job : jobs)
        if (!names.insert(job.name).second)
            inputError(file + ": two jobs are named '" + job.name + "'",
                       "give each a name of its own: results are recorded by it");
    if (jobs.empty()) inputError(file + " has no jobs", "add some to \"jobs\"");
    return read;
}
