/// The text of --version.
#pragma once

#include <string>

/// The program with its version; then its commit, the libraries that results depend on, and its
/// build settings, one per line.
std::string versionText();
