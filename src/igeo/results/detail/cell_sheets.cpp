#include <igeo/results/detail/cell_sheets.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace igeo {

namespace {

/// A face of a cell: its corners in a circle, and edge k between corners k and k + 1.
struct Face {
    std::array<unsigned, 4> corner;
    std::array<std::size_t, 4> edge;

    explicit Face(int number) {
        const int axis = number / 2, b = (axis + 1) % 3, c = (axis + 2) % 3;
        const unsigned at = number % 2 ? CellSheets::bitOf(axis) : 0, inB = CellSheets::bitOf(b),
                       inC = CellSheets::bitOf(c);
        corner = {at, at | inB, at | inB | inC, at | inC};
        edge = {CellSheets::edgeOf(b, at), CellSheets::edgeOf(c, at | inB),
                CellSheets::edgeOf(b, at | inC), CellSheets::edgeOf(c, at)};
    }
};

/// Edges that one sheet crosses, as sets.
class EdgeSets {
public:
    EdgeSets() {
        for (std::size_t e = 0; e < parent_.size(); ++e) parent_[e] = e;
    }
    std::size_t of(std::size_t edge) const {
        while (parent_[edge] != edge) edge = parent_[edge];
        return edge;
    }
    void join(std::size_t a, std::size_t b) {
        parent_[std::max(of(a), of(b))] = std::min(of(a), of(b));
    }

private:
    std::array<std::size_t, 24> parent_;
};

}  // namespace

CellSheets::CellSheets(unsigned inside, unsigned parted) {
    EdgeSets sets;
    auto isInside = [&](unsigned corner) { return (inside >> corner & 1) != 0; };
    unsigned doubtful = 0;
    for (int f = 0; f < 6; ++f) {
        const Face face(f);
        std::array<std::size_t, 4> crossed;
        std::size_t n = 0;
        for (std::size_t k = 0; k < 4; ++k)
            if (isInside(face.corner[k]) != isInside(face.corner[(k + 1) % 4]))
                crossed[n++] = face.edge[k];
        if (n == 2) sets.join(crossed[0], crossed[1]);
        if (n < 4) continue;
        doubtful |= 1u << f;
        const bool cutOff = !(parted >> f & 1);
        for (std::size_t k = 0; k < 4; ++k)
            if (isInside(face.corner[k]) == cutOff) sets.join(face.edge[(k + 3) % 4], face.edge[k]);
    }
    std::vector<std::size_t> first;  // edge of each sheet
    for (int axis = 0; axis < 3; ++axis)
        for (unsigned k = 0; k < 8; ++k) {
            if (k & bitOf(axis) || isInside(k) == isInside(k | bitOf(axis))) continue;
            const std::size_t e = edgeOf(axis, k), set = sets.of(e);
            const auto known = std::find(first.begin(), first.end(), set);
            sheet[e] = std::uint8_t(known - first.begin());
            if (known == first.end()) first.push_back(set);
            edge[edges++] = {std::uint8_t(axis), std::uint8_t(k), sheet[e]};
        }
    count = std::uint8_t(first.size());
    for (int f = 0; f < 6; ++f) {
        const Face face(f);
        if (doubtful >> f & 1 && sets.of(face.edge[0]) == sets.of(face.edge[2])) twice |= 1u << f;
    }
}

const CellSheets& CellSheets::of(unsigned inside) {
    static const std::vector<CellSheets> table = [] {
        std::vector<CellSheets> all;
        for (unsigned k = 0; k < 256; ++k) all.emplace_back(k, 0);
        return all;
    }();
    return table[inside];
}

}  // namespace igeo
