/// What one march of scheme `jet` knows: its seeds, and the jets of the core so far. Changed by the
/// march (jet_march.cpp), read at points (jet_read.cpp) and by the extension to the rest of the
/// band (jet_extend.cpp).
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/march/seeds.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace igeo {

constexpr std::uint32_t kNoBucket = std::numeric_limits<std::uint32_t>::max();

/// The jet of a foot point.
struct Solved {
    double u = kInfinity;
    Vec2f g;                  ///< gradient over the weight, in the chart of the foot point
    std::uint32_t label = 0;  ///< the source whose front it is
};

/// A core node in a march. Values count from the start of a bucket, so that single precision is
/// enough for them.
struct alignas(16) JetState {
    std::uint32_t bucket = kNoBucket;  ///< in which the node waits, 0 once taken out (jet_queue.h);
                                       ///< of an accepted node that of its value
    float rest = float(kInfinity);  ///< value beyond the start of the bucket; +inf until accepted
    Vec2f g;                        ///< gradient over the weight, in the chart of the node

    bool accepted() const { return rest < float(kInfinity); }
};

struct JetSeeds {
    std::vector<SurfacePoint> points;
    std::vector<std::uint32_t> source;  ///< per seed (sourcesOf)
    SeedsNear near;                     ///< finds those whose start discs hold a point
    std::vector<PlaneMetric> plane;     ///< in the frames of their nodes; empty: isotropic
    double startRadius = 0;             ///< of the start discs, voxels
    double leastStart = kInfinity;      ///< the least start value
    double largestInDisc = 0;           ///< the largest value in a start disc
    StraightLines lines;                ///< below which no value is

    JetSeeds() = default;
    JetSeeds(const JetCore& core, const std::vector<SurfacePoint>& seeds, double startRadius);
};

/// Buckets of equal width of the distance, from the least start on. The first is number 1.
struct JetBuckets {
    double leastStart = 0, width = 1;

    double startOf(std::uint32_t bucket) const { return leastStart + beyondLeast(bucket); }
    double beyondLeast(std::uint32_t bucket) const { return (bucket - 1.0) * width; }
    std::uint32_t bucketOf(double u, std::uint32_t last) const {
        return std::uint32_t(
            std::clamp(1 + std::floor((u - leastStart) / width), 1.0, double(last)));
    }
};

/// Fronts that meet at a foot point.
struct MeetingFronts {
    static constexpr std::size_t kMost = 3;
    std::uint32_t count = 0;
    std::array<Vec2f, kMost> g{};  ///< their directions of travel, in its chart
};

/// Two fronts at a core node beside a cut locus along which they meet at a small angle
/// (jet_two_fronts.h). Values are over the weight, relative to the least start.
struct TwoFronts {
    struct Front {
        double u = kInfinity;  ///< +inf: it was not carried on to the node
        Vec2f g;               ///< direction of travel, in the chart of the node
    };
    NodeIndex node = kNoNode;
    std::uint32_t locus = 0;  ///< its number: fronts of one locus have one order
    double key = 0;           ///< nodes with a greater one were solved later
    std::array<Front, 2> front;
    double apart = 0;  ///< by how much the first front comes later than the second
    Vec2f turn;        ///< direction of the first less that of the second
};

struct CoreJets;

/// The core nodes across which fronts meet, once a march is over (findMeetings). Their jets are
/// found by rays (jet_rays.h) when they are first read. A ray reads what the march has left, so a
/// jet has the same bits whatever was read before. Several threads may read at a time.
class Meetings {
public:
    struct Meeting {
        NodeIndex node = kNoNode;
        MeetingFronts fronts{};
    };
    /// @param list  ascending
    /// @param near  per core node: whether it is one of these, or linked to one; kBoth beside too
    /// @param both  of the nodes with a mark kBoth, ascending
    Meetings(const CoreJets& jets, std::vector<Meeting> list, std::vector<std::uint8_t> near,
             std::vector<TwoFronts> both);
    /// Both fronts at a node beside a locus along which they meet at a small angle; else null.
    const TwoFronts* bothAt(NodeIndex k) const { return marks_[k] & kBoth ? &bothOf(k) : nullptr; }
    static constexpr std::uint8_t kBoth = 4;

    bool near(NodeIndex k) const { return marks_[k]; }
    bool at(NodeIndex k) const { return marks_[k] & kAt; }
    /// The jets of some of these nodes. 0.5 microseconds per ray that was not sent before, two to
    /// four for each front; else O(log n) per node.
    void find(const CoreJets& jets, std::span<const NodeIndex> nodes, JetState* to) const;
    /// Finds the jets of some of these nodes ahead: side by side they take less time than one after
    /// another.
    /// @param nodes  in any order, and more than once
    void findAhead(const CoreJets& jets, std::span<const NodeIndex> nodes) const;
    /// Finds all of them in parallel; then calls visit(k, state) for one after another.
    template <typename Visit>
    void findAll(const CoreJets& jets, const Visit& visit) const {
        solveAll(jets);
        for (std::size_t m = 0; m < list_.size(); ++m) visit(list_[m].node, state_[m]);
    }

private:
    static constexpr std::uint8_t kAt = 2;
    std::size_t indexOf(NodeIndex k) const;
    const TwoFronts& bothOf(NodeIndex k) const;
    bool isSolved(std::size_t m) const {
        return std::atomic_ref(solved_[m]).load(std::memory_order_acquire);
    }
    void solveAll(const CoreJets& jets) const;
    /// @param which  indices, in any order, and more than once
    void solve(const CoreJets& jets, std::vector<std::size_t> which) const;

    std::vector<Meeting> list_;
    std::vector<std::uint8_t> marks_;           ///< per core node
    mutable std::vector<JetState> state_;       ///< per meeting: by the march until it is solved
    mutable std::vector<std::uint8_t> solved_;  ///< per meeting
    mutable std::mutex publishing_;
    std::vector<TwoFronts> both_;  ///< ascending
};

/// The jets of a march on the core of a band.
struct CoreJets {
    std::shared_ptr<const JetCore> core;
    JetSeeds seeds;
    JetBuckets buckets;
    std::vector<JetState> state;               ///< per core node, as the march has left it
    std::vector<std::uint32_t> label;          ///< per core node; empty for one source
    std::shared_ptr<const Meetings> meetings;  ///< null: no fronts meet
    double limit = kInfinity;                  ///< larger distances are left out

    bool frontsMeetNear(NodeIndex k) const { return meetings && meetings->near(k); }
    bool accepted(NodeIndex k) const { return state[k].accepted(); }
    double marchedValueOf(NodeIndex k) const { return valueOf(state[k]); }
    /// By rays where fronts meet.
    double valueOf(NodeIndex k) const { return valueOf(stateOf(k)); }
    Vec3f gradientOf(NodeIndex k) const { return gradientOf(k, stateOf(k)); }
    Vec3f gradientOf(NodeIndex k, const JetState& s) const {
        return TangentFrame(core->nodes[k].normal).lift(s.g);
    }
    std::uint32_t labelOf(NodeIndex k) const { return label.empty() ? 0 : label[k]; }

private:
    JetState stateOf(NodeIndex k) const {
        JetState s = state[k];
        if (meetings && meetings->at(k)) meetings->find(*this, {&k, 1}, &s);
        return s;
    }
    double valueOf(const JetState& s) const { return buckets.startOf(s.bucket) + double(s.rest); }
};

}  // namespace igeo
