/// Jobs from a table, or one for each of several files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "json_file.h"

/// The rows of a .csv file as jobs of a manifest: an object per row, with a value for each nonempty
/// cell, under the names of the first line; true and false are flags. Cells may be quoted; a quote
/// inside is doubled.
/// @throws igeo::Error  Io; BadInput, with the line, for rows of another length
Json jobsOfTable(const std::string& file);

/// The files of a folder whose names match the last part of `pattern`, in which * matches any
/// characters and ? one; sorted, and named with the folder as in the pattern.
/// @param from  folder of relative patterns
std::vector<std::filesystem::path> filesLike(const std::filesystem::path& pattern,
                                             const std::filesystem::path& from);
