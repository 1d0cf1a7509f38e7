/// The origin and the cost of a result, in every JSON document of the program.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "json_file.h"

struct Provenance {
    /// Words after the program's name, without those of ProcessOptions, which change no result.
    std::vector<std::string> command;
    std::vector<std::pair<std::string, std::string>> inputs;  ///< file, digest (digestOfFile)
    std::vector<std::pair<std::string, double>> seconds;      ///< wall time per stage, in order
    std::uint64_t peakMemory = 0;                             ///< bytes
};

/// `command`, `versions` and `inputs`.
Json originJson(const Provenance& p);

/// `seconds` and `peakMemoryBytes`. Both are null if the environment has SOURCE_DATE_EPOCH, by
/// which reproducible builds ask for the same bytes at any time
/// (https://reproducible-builds.org/specs/source-date-epoch).
Json costJson(const Provenance& p);
