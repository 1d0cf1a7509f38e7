#include <igeo/march/detail/march_heap.h>
#include <support/catch.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <random>
#include <utility>

namespace igeo::test {
namespace {

/// The heap sorts values rounded to float, ties by node.
using Entry = std::pair<float, NodeIndex>;
using Reference = std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>>;

}  // namespace

TEST_CASE("heap: agrees with std::priority_queue under random pushes and pops") {
    for (unsigned seed = 0; seed < 60; ++seed) {
        std::mt19937 random(seed);
        // Few different values make many ties; few nodes make repeated entries.
        std::uniform_int_distribution<int> value(0, seed % 2 ? 20 : 1000000);
        std::uniform_int_distribution<NodeIndex> node(0, seed % 3 ? 100 : kNoNode - 1);
        std::uniform_real_distribution<double> coin(0, 1);
        const double scale = std::pow(10.0, int(seed % 20) - 10);
        MarchHeap heap;
        Reference reference;
        for (int step = 0; step < 5000; ++step) {
            // Grows first, then shrinks to nothing.
            if (coin(random) < (step < 2500 ? 0.7 : 0.2)) {
                const double v = scale * value(random);
                const NodeIndex i = node(random);
                heap.push(v, i);
                reference.emplace(float(v), i);
            } else if (!reference.empty()) {
                INFO("seed " << seed << ", step " << step);
                REQUIRE(heap.top() == reference.top().second);
                REQUIRE(heap.pop() == reference.top().second);
                reference.pop();
            }
            REQUIRE(heap.size() == reference.size());
            REQUIRE(heap.empty() == reference.empty());
        }
    }
}

TEST_CASE("heap: equal values come out by node number, whatever the order of arrival") {
    std::vector<NodeIndex> nodes(1000);
    for (std::size_t k = 0; k < nodes.size(); ++k) nodes[k] = NodeIndex(3 * k);
    for (unsigned seed = 0; seed < 5; ++seed) {
        std::shuffle(nodes.begin(), nodes.end(), std::mt19937(seed));
        MarchHeap heap;
        for (const NodeIndex i : nodes) heap.push(1.5, i);
        for (std::size_t k = 0; k < nodes.size(); ++k) REQUIRE(heap.pop() == NodeIndex(3 * k));
        CHECK(heap.empty());
    }
}

TEST_CASE("heap: zero comes first, infinity last") {
    MarchHeap heap;
    heap.push(kInfinity, 1);
    heap.push(1e-30, 2);
    heap.push(0, 3);
    heap.push(1e30, 4);
    for (const NodeIndex expected : {3u, 2u, 4u, 1u}) CHECK(heap.pop() == expected);
}

}  // namespace igeo::test
