/// Where results go.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "file_ending.h"
#include "options/run_options.h"

/// A file asked for, and the endings that it may have, if not any: ".json .obj".
struct OutputFile {
    const char* option;
    std::string file;
    const char* endings;
};
/// Refuses, before the work, files that can only fail after it: wrong endings, folders that are not
/// there or not ours, results that would overwrite an input or each other.
/// @throws igeo::Error  InvalidArgument
void checkOutputFiles(const std::vector<OutputFile>& outputs,
                      const std::vector<std::string>& inputs);

/// The file that a name stands for, from the root on and behind all links: two names of one file
/// are the same.
/// @throws igeo::Error  Io for links that run in a circle, or without a working folder
std::string wholeName(const std::string& file);

/// Files that a run reads, without the grids in them; - is standard input.
std::vector<std::string> inputFiles(const RunOptions& options);

/// The file of distances. A grid that came by standard input names it.
/// @param grid  name of the grid; null before it is read
/// @return empty where only the grid can tell
std::string distanceFile(const RunOptions& options, const std::string* grid);

/// The colors of picture, mesh and grid.
std::string colorMapOf(const RunOptions& options);

/// Writes a result whole or not at all; "-" is standard output.
void writeDocument(const std::string& file, const std::string& content);
/// What `write` writes, to standard output.
void writeToStdout(const std::function<void(std::ostream&)>& write);
