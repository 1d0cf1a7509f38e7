/// The priority queue of Fast Marching: least value first, ties by node number.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <cstring>
#include <vector>

namespace igeo {

/// A 4-ary min-heap of nodes without decrease-key: push a node again with its smaller value, and
/// drop the older entry when it is popped (its node is then Accepted).
///
/// An entry is one 64-bit number: the value rounded to float, whose bits sort as the values do
/// (they are not negative), above the node number. So one comparison orders values and ties, and
/// the order does not depend on the heap's history. Values within a rounding of each other (6e-8)
/// may come out in the order of their nodes.
class MarchHeap {
public:
    bool empty() const { return entries_.empty(); }
    std::size_t size() const { return entries_.size(); }
    NodeIndex top() const { return NodeIndex(entries_.front()); }

    void push(double value, NodeIndex node) {
        const float rounded = static_cast<float>(value);
        std::uint32_t bits;
        std::memcpy(&bits, &rounded, sizeof bits);
        const std::uint64_t e = std::uint64_t(bits) << 32 | node;
        std::size_t i = entries_.size();
        entries_.push_back(e);
        while (i > 0) {
            const std::size_t parent = (i - 1) / 4;
            if (e >= entries_[parent]) break;
            entries_[i] = entries_[parent];
            i = parent;
        }
        entries_[i] = e;
    }

    NodeIndex pop() {
        const NodeIndex smallest = top();
        const std::uint64_t last = entries_.back();
        entries_.pop_back();
        const std::size_t n = entries_.size();
        if (n == 0) return smallest;
        std::uint64_t* const e = entries_.data();
        std::size_t i = 0;
        for (;;) {
            std::size_t child = 4 * i + 1;
            if (child + 4 <= n) {
                // Two pairs, then the lesser of each: conditional moves instead of unpredictable
                // branches.
                const std::size_t a = child + (e[child + 1] < e[child]);
                const std::size_t b = child + 2 + (e[child + 3] < e[child + 2]);
                child = e[b] < e[a] ? b : a;
            } else {
                if (child >= n) break;
                for (std::size_t k = child + 1; k < n; ++k)
                    if (e[k] < e[child]) child = k;
            }
            if (e[child] >= last) break;
            e[i] = e[child];
            i = child;
        }
        e[i] = last;
        return smallest;
    }

private:
    std::vector<std::uint64_t> entries_;
};

}  // namespace igeo
