/// Suggestions for misspelled words.
#pragma once

#include <string>
#include <vector>

/// ", did you mean 'jet'?" for the candidate with the fewest changed letters, if they are few; else
/// empty.
std::string didYouMean(const std::string& word, const std::vector<std::string>& candidates);
