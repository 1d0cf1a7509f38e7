/// What --version prints.
#pragma once

#include <string>

/// The program with its version; then its commit, the libraries that results depend on, and how it
/// was compiled, one per line.
std::string versionText();
