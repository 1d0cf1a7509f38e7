/// The jobs of a batch.
#pragma once

#include <string>
#include <vector>

#include "options.h"

struct BatchJob {
    std::string name;
    /// Of an ordinary run: --option=value, in alphabetical order.
    std::vector<std::string> arguments;
    Options options;  ///< the same as parsed

    std::string quoted() const { return "job '" + name + "'"; }
};

/// Reads docs/batch.schema.json. Each job becomes the arguments of an ordinary run and is parsed as
/// one, so it takes every option that a run takes, and is refused in the same words.
/// @throws igeo::Error  Io, BadInput; InvalidArgument for options, naming the job
std::vector<BatchJob> readManifest(const std::string& file);
