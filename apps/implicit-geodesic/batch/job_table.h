/// Jobs from a table, and from the names of files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "json_file.h"

/// The rows of a .csv file as jobs of a manifest: an object per row, with a value for each cell
/// that is not empty, under the names of the first line; true and false are flags. Cells may be
/// quoted; a quote within is written twice.
/// @throws igeo::Error  Io; BadInput, with the line, for rows of another length
Json jobsOfTable(const std::string& file);

/// The files of a folder whose names are like the last part of `pattern`, in which * stands for any
/// letters and ? for one; sorted, and named as the pattern names its folder.
/// @param from  folder of patterns that are not absolute
std::vector<std::filesystem::path> filesLike(const std::filesystem::path& pattern,
                                             const std::filesystem::path& from);
