/// Words of a command line, read into the fields of a command's options.
#pragma once

#include <string>
#include <vector>

#include "options/command.h"

/// Finds the command that the words name, `command` or one below it; then refuses options that do
/// not go together, sets the fields and runs the command's check.
/// @return the command; null where help or version was asked for and is printed
/// @throws igeo::Error  InvalidArgument
const Command* readCommandLine(const Command& command, std::vector<std::string> words);
