/// Where results go.
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "options.h"

/// Refuses, before the work, files that can only fail after it: wrong endings, folders that are not
/// there or not ours, results that would overwrite an input or each other.
/// @throws igeo::Error  InvalidArgument
void checkOutputFiles(const Options& options);

/// Files that a run reads, without the grids in them; - is standard input.
std::vector<std::string> inputFiles(const Options& options);
/// Files that it writes, as far as the options tell; - is standard output.
std::vector<std::string> outputFiles(const Options& options);

/// The file of distances.
/// @param grid name of the level set, for one that came by standard input
std::string distanceFile(const Options& options, const std::string& grid);

/// The ending of a file's name, with its dot.
std::string endingOf(const std::string& file);

/// Writes a result whole or not at all; "-" is standard output.
void writeDocument(const std::string& file, const std::string& content);
void writeGrids(const std::string& file, const openvdb::GridCPtrVec& grids);
