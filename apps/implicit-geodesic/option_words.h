/// Remedies of the library in the words of the command line.
#pragma once

#include <string>

/// Names of the library's functions and parameters become the options that stand for them.
std::string inOptionWords(std::string text);
