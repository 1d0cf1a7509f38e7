#include "output/output_files.h"

#include <igeo/base/atomic_file.h>
#include <igeo/base/detail/system.h>
#include <igeo/base/detail/text.h>
#include <igeo/io/data_files.h>
#include <igeo/results/picture_options.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <utility>
#include <vector>

#include "output/stdout.h"
#include "printable.h"
#include "process.h"
#include "usage_error.h"

namespace fs = std::filesystem;

std::vector<std::string> inputFiles(const RunOptions& o) {
    std::vector<std::string> files{o.source.file, o.seedFile, o.targetFile, o.pairs};
    files.insert(files.end(), o.seedCurves.begin(), o.seedCurves.end());
    for (const Via& via : o.vias)
        if (via.curve.points.empty()) files.push_back(via.text);
    for (const auto* list : {&o.weights, &o.obstacles, &o.seedMasks})
        for (const igeo::GridSource& source : *list) files.push_back(source.file);
    if (o.metric) files.push_back(o.metric->file);
    files.erase(std::remove(files.begin(), files.end(), ""), files.end());
    for (const std::string& beside : igeo::dataFilesOf(o.source.file)) files.push_back(beside);
    return files;
}

namespace {

void checkEnding(const OutputFile& output) {
    const std::string ending = endingOf(output.file), allowed = output.endings;
    if (allowed.empty() || output.file == "-") return;
    // Devices and pipes have no endings; writing to a folder is refused below.
    std::error_code ignored;
    const fs::file_type type = fs::status(output.file, ignored).type();
    using Type = fs::file_type;
    if (type == Type::character || type == Type::fifo || type == Type::directory) return;
    if (ending.empty() || (" " + allowed + " ").find(" " + ending + " ") == std::string::npos)
        usageError(
            std::string(output.option) + " " + output.file + ": the ending is none of " + allowed,
            "name the file with one of them");
}

/// Whether standard output gets binary data: the format of the first ending.
bool isBinary(const OutputFile& output) {
    const std::string endings = output.endings, first = endings.substr(0, endings.find(' '));
    return first == ".vdb" || first == ".ply" || first == ".png" || first == ".npz";
}

}  // namespace

std::string distanceFile(const RunOptions& options, const std::string* grid) {
    if (!options.output.empty()) return options.output;
    const std::string& file = options.source.file;
    if (file != "-") return igeo::stemOf(file) + "_geodesic.vdb";
    if (!grid) return "";
    // Names in files are no paths: the last part alone, whichever system it is from.
    const std::size_t slash = grid->find_last_of("/\\");
    return grid->substr(slash == std::string::npos ? 0 : slash + 1) + "_geodesic.vdb";
}

std::string colorMapOf(const RunOptions& options) {
    return options.colorMap.empty() ? igeo::PictureOptions{}.colorMap : options.colorMap;
}

std::string wholeName(const std::string& file) {
    std::error_code error, ignored;
    const fs::path whole = fs::absolute(igeo::fileBehindLinks(file), error);
    if (error)
        throw igeo::Error(igeo::Error::Kind::Io,
                          "cannot tell where '" + file + "' is: the working folder is gone",
                          "go to a folder that exists, or give absolute names");
    return fs::weakly_canonical(whole, ignored).string();
}

void checkOutputFiles(const std::vector<OutputFile>& outputs,
                      const std::vector<std::string>& inputs) {
    std::vector<std::string> taken;
    for (const OutputFile& output : outputs) {
        const std::string &file = output.file, named = std::string(output.option) + " " + file;
        checkEnding(output);
        if (hasControls(file))
            usageError(named + ": the name holds a control character", "take it out");
        std::error_code ignored;
        const std::string whole = file == "-" ? file : wholeName(file);
        if (file == "-" && stdoutIsTerminal() && isBinary(output))
            usageError(std::string(output.option) + " - would write binary data to the terminal",
                       "redirect standard output to a file or a program");
        for (const std::string& input : inputs)
            if (input != "-" && file != "-" && fs::equivalent(file, input, ignored))
                usageError(named + " would overwrite the input '" + input + "'",
                           std::string("give ") + output.option + " another name");
        const bool device = fs::exists(file, ignored) && !fs::is_regular_file(file, ignored) &&
                            !fs::is_directory(file, ignored);
        if (!device && std::find(taken.begin(), taken.end(), whole) != taken.end())
            usageError(named + ": two results cannot go to one place", "give each its own name");
        taken.push_back(whole);
        if (file == "-" || device) continue;
        const fs::path folder =
            fs::path(file).parent_path().empty() ? "." : fs::path(file).parent_path();
        if (!fs::is_directory(folder, ignored))
            usageError(named + ": there is no folder '" + folder.string() + "'",
                       "create it first, or write elsewhere");
        if (fs::is_directory(file, ignored))
            usageError(named + ": that is a folder", "add a file name");
        const bool exists = fs::exists(file, ignored);
        if (igeo::writeRefusal(folder.string()) || (exists && igeo::writeRefusal(file)))
            usageError(named + ": no permission to write there", "write elsewhere");
    }
}

void writeToStdout(const std::function<void(std::ostream&)>& write) {
    write(results());
    flushResults();
}

void writeDocument(const std::string& file, const std::string& content) {
    if (file != "-") return igeo::writeFile(file, content);
    writeToStdout([&](std::ostream& out) { out << content; });
}
