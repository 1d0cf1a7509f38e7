/// The queue of scheme `jet`: the nodes that wait, in buckets of equal width of the distance.
#pragma once

#include <igeo/march/detail/jet_state.h>

#include <algorithm>
#include <array>
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

/// Bucket of each waiting node (JetState::bucket) and, per bucket, a list of nodes.
///
/// The bucket of a node is the least that any front has asked for. A list also holds nodes that an
/// earlier front has put into another bucket since, and may hold a node twice: which of these there
/// are depends on the order of the threads, so that nothing is decided by them. isIn() tells them
/// from those that wait.
///
/// **Memory order.** A batch has three phases, and JetState::bucket is the only thing that two
/// threads may write at the same time, in the first.
///
/// 1. *Solve*, in parallel. take() removes a node from its bucket (to 0), one thread of those that
///    find it in a list; lower() puts a waiting node into an earlier bucket. Both are atomic, and
///    both use relaxed order: the final value, a minimum, is the same for every order of the
///    threads, and it carries no other data. Jets (rest, g, label) are read in this phase and not
///    written. So are all other fields of a node.
/// 2. *Accept*, in parallel. Jets of accepted nodes and buckets of deferred ones are written, each
///    by the one thread that has its chunk. No thread reads them.
/// 3. *Collect*, on one thread: add() and requeue() fill the lists.
///
/// The end of a parallelFor orders each phase before the next, so plain reads and writes are enough
/// in phases 2 and 3, and before the first batch, where start discs are enqueued.
class BucketQueue {
public:
    explicit BucketQueue(std::vector<JetState>& nodes) : nodes_(nodes) {}

    bool isIn(std::uint32_t bucket, NodeIndex i) const {
        return nodes_[i].bucket == bucket && !nodes_[i].accepted();
    }

    /// Phase 1: takes a node out, unless another thread has, or a front has put it elsewhere.
    bool take(NodeIndex i, std::uint32_t first, std::uint32_t last) {
        if (nodes_[i].accepted()) return false;
        const std::atomic_ref bucket(nodes_[i].bucket);
        std::uint32_t expected = bucket.load(std::memory_order_relaxed);
        return expected >= first && expected <= last &&
               bucket.compare_exchange_strong(expected, 0, std::memory_order_relaxed);
    }
    /// Phase 1: the bucket of a node as it is now.
    std::uint32_t bucketOf(NodeIndex i) const { return bucketOf(nodes_[i]); }
    static std::uint32_t bucketOf(const JetState& node) {
        // A reference to what is const takes C++26.
        return std::atomic_ref(const_cast<std::uint32_t&>(node.bucket))
            .load(std::memory_order_relaxed);
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
    void add(NodeIndex i, std::uint32_t bucket) {
        (bucket - first_ < kRing ? ring_[bucket % kRing] : later_[bucket]).push_back(i);
    }
    /// Phase 3: puts a node into a bucket unless it is accepted or in an earlier one.
    void requeue(NodeIndex i, std::uint32_t bucket) {
        JetState& node = nodes_[i];
        if (node.accepted() || node.bucket <= bucket) return;
        node.bucket = bucket;
        add(i, bucket);
    }

    /// Whether a node waits; drops the lists before firstBucket().
    bool anyWaits() {
        for (std::uint32_t k = 0; k < kRing; ++k) {
            const std::uint32_t bucket = first_ + k;
            if (waitsIn(bucket, ring_[bucket % kRing])) return true;
            ring_[bucket % kRing].clear();
        }
        for (; !later_.empty(); later_.erase(later_.begin()))
            if (waitsIn(later_.begin()->first, later_.begin()->second)) return true;
        return false;
    }
    /// The first bucket in which a node waits, after anyWaits().
    std::uint32_t firstBucket() const { return waiting_; }

    /// Takes the list of the first bucket out of the queue; isIn() still has to be asked.
    Batch popFirst() {
        Batch batch{waiting_, waiting_, std::move(listOf(waiting_))};
        drop();
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
            const std::uint32_t bucket = waiting_;
            const std::size_t before = batch.nodes.size();
            for (const NodeIndex i : listOf(bucket))
                if (isIn(bucket, i)) {
                    batch.nodes.push_back(i);
                    slack = std::min(slack, slackOf(i));
                }
            if (bucket > batch.first && (bucket - batch.first + 1) * bucketWidth > slack) {
                batch.nodes.resize(before);
                break;
            }
            batch.last = bucket;
            drop();
        } while (anyWaits());
        return batch;
    }

private:
    /// Buckets that have a list at hand; a step of a front hardly ever leads further.
    static constexpr std::uint32_t kRing = 64;

    bool waitsIn(std::uint32_t bucket, const std::vector<NodeIndex>& list) {
        waiting_ = bucket;
        return std::any_of(list.begin(), list.end(), [&](NodeIndex i) { return isIn(bucket, i); });
    }
    std::vector<NodeIndex>& listOf(std::uint32_t bucket) {
        return bucket - first_ < kRing ? ring_[bucket % kRing] : later_.begin()->second;
    }
    /// Drops the first bucket; lists of buckets further on come to hand.
    void drop() {
        listOf(waiting_).clear();
        if (waiting_ - first_ >= kRing) later_.erase(later_.begin());
        first_ = waiting_ + 1;
        for (; !later_.empty() && later_.begin()->first - first_ < kRing;
             later_.erase(later_.begin()))
            ring_[later_.begin()->first % kRing] = std::move(later_.begin()->second);
    }

    std::vector<JetState>& nodes_;
    std::uint32_t first_ = 1, waiting_ = 0;  ///< no list lies before the first
    std::array<std::vector<NodeIndex>, kRing> ring_;
    std::map<std::uint32_t, std::vector<NodeIndex>> later_;
};

}  // namespace igeo
