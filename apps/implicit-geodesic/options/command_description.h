/// A command in words: the help, and the JSON that the manual page and the completions are made
/// from (scripts/make_pages.py).
#pragma once

#include <string>

#include "options/command.h"

/// In lines of 80 columns; an example stays in one line, for a shell to take.
std::string helpText(const Command& command);

/// Of a command and those below it.
std::string descriptionJson(const Command& command);
