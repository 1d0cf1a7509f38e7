/// Checks and names of output files.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "file_ending.h"
#include "options/run_options.h"

/// A requested file, and its allowed endings, empty for any: ".json .obj".
struct OutputFile {
    const char* option;
    std::string file;
    const char* endings;
};
/// Refuses, before the work, files that could not be written after it: wrong endings, folders that
/// are missing or not writable, results that would overwrite an input or each other.
/// @throws igeo::Error  InvalidArgument
void checkOutputFiles(const std::vector<OutputFile>& outputs,
                      const std::vector<std::string>& inputs);

/// The absolute name of a file, with links resolved: equal for two names of one file.
/// @throws igeo::Error  Io for links that form a cycle, or without a working folder
std::string wholeName(const std::string& file);

/// Files that a run reads, without the grids in them; - is standard input.
std::vector<std::string> inputFiles(const RunOptions& options);

/// The file of distances. A grid from standard input gives it the last part of its name, which is
/// no path.
/// @param grid  name of the grid; null before it is read
/// @return empty where the name of the grid is needed
std::string distanceFile(const RunOptions& options, const std::string* grid);

/// The colors of picture, mesh and grid.
std::string colorMapOf(const RunOptions& options);

/// Writes a result completely or not at all; "-" is standard output.
void writeDocument(const std::string& file, const std::string& content);
/// Calls `write` with standard output.
void writeToStdout(const std::function<void(std::ostream&)>& write);
