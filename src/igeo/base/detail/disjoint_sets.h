/// Sets of numbers that are joined two by two (union-find).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace igeo {

/// The name of a set is its least number, whatever the order of joins. Time O(log n) each,
/// amortized.
class DisjointSets {
public:
    using Index = std::uint32_t;
    explicit DisjointSets(std::size_t n) : parent_(n) {
        std::iota(parent_.begin(), parent_.end(), Index(0));
    }
    /// The least number of i's set.
    Index first(Index i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(Index i, Index j) {
        i = first(i), j = first(j);
        parent_[std::max(i, j)] = std::min(i, j);
    }

private:
    std::vector<Index> parent_;
};

/// The same, with members of a set on the same side or on opposite sides.
class SidedSets {
public:
    using Index = DisjointSets::Index;
    explicit SidedSets(std::size_t n) : parent_(n), turned_(n, 0) {
        std::iota(parent_.begin(), parent_.end(), Index(0));
    }
    struct Member {
        Index first;  ///< least number of its set
        bool turned;  ///< on the side opposite to `first`
    };
    Member find(Index i) {
        Index first = i;
        bool turned = false;
        while (parent_[first] != first) turned ^= turned_[first] != 0, first = parent_[first];
        const Member found{first, turned};
        // Path compression: all members passed point to the first from now on.
        while (parent_[i] != first) {
            const Index next = parent_[i];
            const bool here = turned;
            turned ^= turned_[i] != 0;
            parent_[i] = first, turned_[i] = here;
            i = next;
        }
        return found;
    }
    /// @return false where earlier joins say the opposite of i and j
    bool join(Index i, Index j, bool opposite) {
        const Member a = find(i), b = find(j);
        const bool turned = a.turned ^ b.turned;
        if (a.first == b.first) return turned == opposite;
        const Index last = std::max(a.first, b.first);
        parent_[last] = std::min(a.first, b.first);
        turned_[last] = turned ^ opposite;
        return true;
    }

private:
    std::vector<Index> parent_;
    std::vector<std::uint8_t> turned_;
};

}  // namespace igeo
