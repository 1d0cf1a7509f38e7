/// The table of results: for each its option, the endings of its file, what it needs, and how it is
/// written.
#pragma once

#include <string>
#include <vector>

#include "options/run_options.h"

struct RunResult;

struct ResultKind {
    const char* option;   ///< --isolines
    const char* name;     ///< in the report's list of outputs
    const char* endings;  ///< of its file, ".json .obj .ply"; empty: any
    /// Empty: not asked for, or still to be named by the grid (distanceFile).
    std::string (*file)(const RunOptions&, const std::string* grid);
    /// What a run has to have for it.
    struct Needs {
        bool seeds = false;   ///< that distances begin from
        bool jet = false;     ///< the scheme
        bool points = false;  ///< no seeds but points
        bool mesh = false;    ///< --mesh
        bool viewer = false;  ///< three.js in the program
        bool band = false;    ///< the distance on the whole band
    } needs;
    void (*write)(RunResult& result, const std::string& file);
};

/// In the order in which they are written.
const std::vector<ResultKind>& resultKinds();

/// Writes all results that are asked for, but the report, and enters them into it.
void writeResults(RunResult& result);
