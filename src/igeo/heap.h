/// The priority queue of Fast Marching: smallest value first, ties by node number.
#pragma once

#include <igeo/types.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// A 4-ary min-heap of (value, node) pairs, without decrease-key: push a node again with its
/// smaller value and drop the older pair when it comes out (its node is Accepted by then). The
/// order of equal values is by node number, so it does not depend on the history of the heap.
class MarchHeap {
public:
    struct Entry {
        double value;
        NodeIndex node;
        friend bool operator<(const Entry& a, const Entry& b) {
            return a.value < b.value || (a.value == b.value && a.node < b.node);
        }
    };

    bool empty() const { return entries_.empty(); }
    std::size_t size() const { return entries_.size(); }
    const Entry& top() const { return entries_.front(); }

    void push(double value, NodeIndex node) {
        std::size_t i = entries_.size();
        const Entry e{value, node};
        entries_.push_back(e);
        while (i > 0) {
            const std::size_t parent = (i - 1) / 4;
            if (!(e < entries_[parent])) break;
            entries_[i] = entries_[parent];
            i = parent;
        }
        entries_[i] = e;
    }

    Entry pop() {
        const Entry smallest = entries_.front(), last = entries_.back();
        entries_.pop_back();
        const std::size_t n = entries_.size();
        if (n == 0) return smallest;
        std::size_t i = 0;
        for (std::size_t child; (child = 4 * i + 1) < n; i = child) {
            const std::size_t end = child + 4 < n ? child + 4 : n;
            for (std::size_t k = child + 1; k < end; ++k)
                if (entries_[k] < entries_[child]) child = k;
            if (!(entries_[child] < last)) break;
            entries_[i] = entries_[child];
        }
        entries_[i] = last;
        return smallest;
    }

private:
    std::vector<Entry> entries_;
};

}  // namespace igeo
