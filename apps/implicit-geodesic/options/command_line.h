/// Reads a command line into the fields of a command's options.
#pragma once

#include <string>
#include <vector>

#include "options/command.h"

/// Finds the command that the words name, `command` or one below it; then refuses incompatible
/// options, sets the fields and runs the command's check.
/// @return the command; null after printing help or version
/// @throws igeo::Error  InvalidArgument
const Command* readCommandLine(const Command& command, std::vector<std::string> words);
