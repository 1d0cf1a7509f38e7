/// A command in words: the help, and the JSON that the manual page, the completions and tables of
/// the docs are made from (scripts/make_pages.py, scripts/make_tables.py).
#pragma once

#include <string>

#include "options/command.h"

/// In lines of the terminal's width, else of 80 columns; an example stays in one line, for a shell
/// to take.
/// @param brief  one screen of what is used most, where the command has such a choice
std::string helpText(const Command& command, bool brief = false);

/// Of a command and those below it, and the files that a run writes.
std::string descriptionJson(const Command& command);
