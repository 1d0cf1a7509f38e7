#include "options/spelling.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace {

/// The least number of letters to insert, remove, replace or swap with the next one (optimal string
/// alignment).
std::size_t changesBetween(const std::string& a, const std::string& b) {
    std::vector<std::size_t> before, last, row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t(0));
    for (std::size_t i = 0; i < a.size(); ++i) {
        before = std::exchange(last, row);
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            row[j + 1] = std::min({last[j] + (a[i] != b[j]), last[j + 1] + 1, row[j] + 1});
            if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
                row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
        }
    }
    return row.back();
}

}  // namespace

std::string didYouMean(const std::string& word, const std::vector<std::string>& candidates) {
    constexpr std::size_t kLongest = 200;
    if (word.size() > kLongest) return "";
    std::string best;
    // Allowed changes: one in words of less than four letters, else two, and a third of a long
    // word.
    std::size_t least = word.size() < 4 ? 2 : std::max<std::size_t>(2, word.size() / 3) + 1;
    for (const std::string& candidate : candidates)
        if (const std::size_t changes = changesBetween(word, candidate); changes < least)
            least = changes, best = candidate;
    return best.empty() ? "" : ", did you mean '" + best + "'?";
}
