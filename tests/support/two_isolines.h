/// Isolines for the tests of their files.
#pragma once

#include <igeo/results/isolines.h>

#include <vector>

namespace igeo::test {

/// A closed triangle and an open segment.
inline std::vector<Isoline> twoLines() {
    Isoline closed, open;
    closed.level = 4, closed.closed = true, closed.length = 3;
    closed.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    closed.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    open.level = 6, open.length = 1;
    open.points = {{0, 0, 1}, {0, 0, 2}};
    open.normals = {{1, 0, 0}, {1, 0, 0}};
    return {closed, open};
}

}  // namespace igeo::test
