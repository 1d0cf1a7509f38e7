/// What somebody may have meant.
#pragma once

#include <string>
#include <vector>

/// ", did you mean 'jet'?" for the candidate that takes the fewest changes of a letter, if they are
/// few; else empty.
std::string didYouMean(const std::string& word, const std::vector<std::string>& candidates);
