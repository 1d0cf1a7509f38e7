/// What one march of scheme `jet` knows, as plain data: its seeds, and the jets of the core so far.
/// Changed by the march (jet.cpp), read by the extension to the rest of the band (jet_extend.cpp).
#pragma once

#include <igeo/band/surface_point.h>
#include <igeo/march/detail/jet_core.h>
#include <igeo/march/seeds.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
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
    std::vector<Vec3f> normal;          ///< of S at the seed
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

    double startOf(std::uint32_t bucket) const { return leastStart + (bucket - 1.0) * width; }
    std::uint32_t bucketOf(double u, std::uint32_t last) const {
        return std::uint32_t(
            std::clamp(1 + std::floor((u - leastStart) / width), 1.0, double(last)));
    }
};

/// The jets of a march on the core of a band.
struct CoreJets {
    std::shared_ptr<const JetCore> core;
    JetSeeds seeds;
    JetBuckets buckets;
    std::vector<JetState> state;         ///< per core node
    std::vector<std::uint32_t> label;    ///< per core node; empty for one source
    std::vector<std::uint8_t> meetings;  ///< per core node: whether fronts meet there or at a node
                                         ///< that is linked to it; empty: none meet
    double limit = kInfinity;            ///< larger distances are left out

    bool frontsMeetNear(NodeIndex k) const { return !meetings.empty() && meetings[k]; }
    bool accepted(NodeIndex k) const { return state[k].accepted(); }
    double valueOf(NodeIndex k) const {
        return buckets.startOf(state[k].bucket) + double(state[k].rest);
    }
    Vec3f gradientOf(NodeIndex k) const {
        return TangentFrame(core->nodes[k].normal).lift(state[k].g);
    }
    std::uint32_t labelOf(NodeIndex k) const { return label.empty() ? 0 : label[k]; }
};

}  // namespace igeo
