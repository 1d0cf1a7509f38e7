#include "options/spelling.h"

#include <algorithm>
#include <numeric>

namespace {

/// Letters to insert, leave out or replace (Levenshtein).
std::size_t changesBetween(const std::string& a, const std::string& b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0]++;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string didYouMean(const std::string& word, const std::vector<std::string>& candidates) {
    constexpr std::size_t kLongest = 40;
    if (word.size() > kLongest) return "";
    std::string best;
    std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
    for (const std::string& candidate : candidates)
        if (const std::size_t changes = changesBetween(word, candidate); changes < least)
            least = changes, best = candidate;
    return best.empty() ? "" : ", did you mean '" + best + "'?";
}
