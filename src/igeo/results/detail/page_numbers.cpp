#include <igeo/results/detail/page_numbers.h>

#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/base64.h>

#include <algorithm>
#include <array>
#include <utility>

namespace igeo {

std::string packed(const Numbers& numbers, bool differences) {
    const std::size_t n = numbers.size();
    Numbers codes = numbers;
    if (differences)
        for (std::size_t k = n; k-- > 0;) {
            const std::uint32_t difference = numbers[k] - (k > 0 ? numbers[k - 1] : 0);
            codes[k] = difference << 1 ^ (difference >> 31 ? ~0u : 0u);
        }
    std::uint32_t all = 0;
    for (const std::uint32_t code : codes) all |= code;
    std::size_t planes = 1;
    while (planes < 4 && all >> 8 * planes) ++planes;
    std::string bytes(1 + planes * n, char(planes));
    for (std::size_t plane = 0; plane < planes; ++plane)
        for (std::size_t k = 0; k < n; ++k)
            bytes[1 + plane * n + k] = char(codes[k] >> 8 * plane & 0xff);
    // More effort takes twice the time and saves 2 %.
    return base64(deflated(bytes, 1));
}

namespace {

/// The corners of a triangle after its least.
using Side = std::pair<std::uint32_t, std::uint32_t>;

/// Takes sides that continue each other, at either end, out of a list.
std::vector<std::uint32_t> takeRow(std::vector<Side>& sides) {
    std::vector<std::uint32_t> row{sides.front().first, sides.front().second};
    sides.erase(sides.begin());
    for (auto next = sides.begin(); next != sides.end();) {
        if (next->first == row.back())
            row.push_back(next->second);
        else if (next->second == row.front())
            row.insert(row.begin(), next->first);
        else {
            ++next;
            continue;
        }
        sides.erase(next);
        next = sides.begin();
    }
    return row;
}

}  // namespace

TriangleFans::TriangleFans(const std::vector<SurfaceMesh::Triangle>& triangles,
                           std::size_t vertices) {
    // Sorted by the least corner.
    std::vector<std::uint32_t> first(vertices + 1);
    for (const auto& t : triangles) ++first[*std::min_element(t.begin(), t.end()) + 1];
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<Side> all(triangles.size());
    std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
    for (const auto& t : triangles) {
        const std::size_t k = std::size_t(std::min_element(t.begin(), t.end()) - t.begin());
        all[next[t[k]]++] = {t[(k + 1) % 3], t[(k + 2) % 3]};
    }
    constexpr std::uint32_t kMost = 16;  // at a time, since rows are found by trying all
    std::vector<Side> sides;
    for (std::uint32_t v = 0; v < vertices; ++v)
        for (std::uint32_t begin = first[v]; begin < first[v + 1]; begin += kMost) {
            const std::uint32_t end = std::min(first[v + 1], begin + kMost);
            sides.assign(all.begin() + begin, all.begin() + end);
            while (!sides.empty()) {
                const std::vector<std::uint32_t> row = takeRow(sides);
                middle.push_back(v);
                count.push_back(std::uint32_t(row.size() - 1));
                for (const std::uint32_t u : row) rim.push_back(u - v);
            }
        }
}

}  // namespace igeo
