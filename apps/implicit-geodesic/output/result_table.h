/// The table of results: for each its option, the endings of its file, its requirements, and the
/// function that writes it.
#pragma once

#include <string>
#include <vector>

#include "options/run_options.h"

struct RunResult;

struct ResultKind {
    const char* option;   ///< --isolines
    const char* name;     ///< in the report's list of outputs
    const char* endings;  ///< of its file, ".json .obj .ply"; empty: any
    /// Empty: not requested, or named after the grid later (distanceFile).
    std::string (*file)(const RunOptions&, const std::string* grid);
    /// The requirements on the run.
    struct Needs {
        bool seeds = false;       ///< distances from seeds
        bool jet = false;         ///< scheme jet
        bool points = false;      ///< seeds that are points only
        bool mesh = false;        ///< --mesh
        bool viewer = false;      ///< the program was built with three.js
        bool band = false;        ///< distances on the whole band
        bool bandOfMesh = false;  ///< the same where the surface is a mesh
    } needs;
    void (*write)(RunResult& result, const std::string& file);
};

/// In the order in which they are written.
const std::vector<ResultKind>& resultKinds();

/// Writes all requested results except the report, and enters them into it.
void writeResults(RunResult& result);
