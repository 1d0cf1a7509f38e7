/// Messages of the library with the names of the command line.
#pragma once

#include <string>

/// Replaces names of the library's functions and parameters by the corresponding options.
std::string inOptionWords(std::string text);
