/// The queue of scheme `jet`: the nodes that wait, in buckets of equal width of the distance.
#pragma once

#include <igeo/march/detail/jet_core.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <vector>

namespace igeo {

/// Values beyond this bucket do not fit: 2e9 voxels of the least weight.
constexpr std::uint32_t kLastBucket = kNoBucket - 2;

/// Buckets that are taken out together, and the nodes found in them.
struct Batch {
    std::uint32_t first, last;
    std::vector<NodeIndex> nodes;
};

/// Bucket of each waiting node (JetNode::bucket) and, per bucket, a list of nodes.
///
/// The bucket of a node is the least that any front has asked for. A list also holds nodes that an
/// earlier front has put into another bucket since, and may hold a node twice: which of these there
/// are depends on the order of the threads, so that nothing is decided by them. isIn() tells them
/// from those that wait.
///
/// **Memory order.** A batch has three phases, and JetNode::bucket is the only thing that two
/// threads may write at the same time, in the first.
///
/// 1. *Solve*, in parallel. take() removes a node from its bucket (to 0), one thread of those that
///    find it in a list; lower() puts a waiting node into an earlier bucket. Both are atomic, and
///    both use relaxed order: the final value, a minimum, is the same for every order of the
///    threads, and it carries no other data. Jets (u, g, label) are read in this phase and not
///    written. So are all other fields of a node.
/// 2. *Accept*, in parallel. Jets of accepted nodes and buckets of deferred ones are written, each
///    by the one thread that has its chunk. No thread reads them.
/// 3. *Collect*, on one thread: add() and requeue() fill the lists.
///
/// The end of a parallelFor orders each phase before the next, so plain reads and writes are enough
/// in phases 2 and 3, and before the first batch, where start discs are enqueued.
class BucketQueue {
public:
    explicit BucketQueue(std::vector<JetNode>& nodes) : nodes_(nodes) {}

    bool isIn(std::uint32_t bucket, NodeIndex i) const { return nodes_[i].bucket == bucket; }

    /// Phase 1: takes a node out, unless another thread has, or a front has put it elsewhere.
    bool take(NodeIndex i, std::uint32_t first, std::uint32_t last) {
        const std::atomic_ref bucket(nodes_[i].bucket);
        std::uint32_t expected = bucket.load(std::memory_order_relaxed);
        return expected >= first && expected <= last &&
               bucket.compare_exchange_strong(expected, 0, std::memory_order_relaxed);
    }
    /// Phase 1: the bucket of a node as it is now.
    std::uint32_t bucketOf(NodeIndex i) const {
        return std::atomic_ref(nodes_[i].bucket).load(std::memory_order_relaxed);
    }
    /// Phase 1: puts a node into a bucket if that is earlier than its own.
    /// @param expected  what bucketOf() gave
    /// @return whether it was; then add() has to follow in phase 3
    bool lower(NodeIndex i, std::uint32_t to, std::uint32_t expected) {
        const std::atomic_ref bucket(nodes_[i].bucket);
        while (to < expected &&
               !bucket.compare_exchange_weak(expected, to, std::memory_order_relaxed)) {
        }
        return to < expected;
    }

    /// Phase 3: lists a node whose bucket is set already.
    void add(NodeIndex i, std::uint32_t bucket) { lists_[bucket].push_back(i); }
    /// Phase 3: puts a node into a bucket unless it is accepted or in an earlier one.
    void requeue(NodeIndex i, std::uint32_t bucket) {
        JetNode& node = nodes_[i];
        if (node.u < kInfinity || node.bucket <= bucket) return;
        node.bucket = bucket;
        add(i, bucket);
    }

    /// Whether a node waits; drops leading buckets in which none does.
    bool anyWaits() {
        for (; !lists_.empty(); lists_.erase(lists_.begin())) {
            const auto& [bucket, list] = *lists_.begin();
            for (const NodeIndex i : list)
                if (isIn(bucket, i)) return true;
        }
        return false;
    }
    std::uint32_t firstBucket() const { return lists_.begin()->first; }

    /// Takes the list of the first bucket out of the queue; isIn() still has to be asked.
    Batch popFirst() {
        const auto at = lists_.begin();
        Batch batch{at->first, at->first, std::move(at->second)};
        lists_.erase(at);
        return batch;
    }
    /// Takes the nodes of the first bucket out, and those of buckets behind it that need not wait
    /// for its values: as long as all lie within the least slack of the nodes so far.
    /// @param slackOf(i)  how far beyond the start of the batch a value of node i may lie and still
    ///                    be final
    template <typename SlackOf>
    Batch popTogether(double bucketWidth, const SlackOf& slackOf) {
        Batch batch{firstBucket(), firstBucket(), {}};
        double slack = kInfinity;
        do {
            const auto& [bucket, list] = *lists_.begin();
            const std::size_t before = batch.nodes.size();
            for (const NodeIndex i : list)
                if (isIn(bucket, i)) {
                    batch.nodes.push_back(i);
                    slack = std::min(slack, slackOf(i));
                }
            if (bucket > batch.first && (bucket - batch.first + 1) * bucketWidth > slack) {
                batch.nodes.resize(before);
                break;
            }
            batch.last = bucket;
            lists_.erase(lists_.begin());
        } while (anyWaits());
        return batch;
    }

private:
    std::vector<JetNode>& nodes_;
    std::map<std::uint32_t, std::vector<NodeIndex>> lists_;
};

}  // namespace igeo
