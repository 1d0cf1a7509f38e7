/// Obstacles that are functions of points.
#pragma once

#include <igeo/base/parallel.h>
#include <igeo/igeo.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "arrays.h"

/// The rim of an obstacle that is a function of points of S: where it changes between the foot
/// points of neighbors in the band. Halving the intervals between these finds it.
class ObstacleRim {
public:
    ObstacleRim(const igeo::GeodesicSolver& plain, const Array<bool>& blocked)
        : surface_(plain.surface()),
          band_(plain.wholeBand()),
          blocked_(blocked.data(), blocked.data() + blocked.size()) {
        for (igeo::NodeIndex i = 0; i < band_->size(); ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const igeo::NodeIndex j = band_->neighbor(i, igeo::Band::faceStep(2 * axis + 1));
                if (j == igeo::kNoNode || blocked_[i] == blocked_[j] || !band_->linked(i, j))
                    continue;
                if (blocked_[i])
                    edges_.push_back({j, i, axis, -1});
                else
                    edges_.push_back({i, j, axis, 1});
            }
    }

    /// The middle of every interval, on S.
    Array<double> middles() const {
        std::vector<igeo::Vec3d> points(edges_.size());
        {
            const py::gil_scoped_release released;
            igeo::parallelFor(edges_.size(), 64, [&](std::size_t begin, std::size_t end) {
                for (std::size_t k = begin; k < end; ++k) {
                    const Edge& e = edges_[k];
                    const igeo::Vec3d from = band_->footPoint(e.free),
                                      p = from + e.middle() * (band_->footPoint(e.blocked) - from);
                    points[k] = band_->transform.worldFromIndex(surface_.nearest(*band_, p).pIndex);
                }
            });
        }
        return arrayOf(std::move(points));
    }

    /// @param blocked  per middle
    void halve(const Array<bool>& blocked) {
        for (std::size_t k = 0; k < edges_.size(); ++k)
            (blocked.data()[k] ? edges_[k].high : edges_[k].low) = edges_[k].middle();
    }

    /// A level set of the obstacle, constant along normals: its trilinear interpolant is 0 at the
    /// rim. Voxels that are farther from the rim are +-kFar.
    openvdb::FloatGrid::Ptr levelSet() const {
        auto grid = openvdb::FloatGrid::create(kFar);
        grid->setTransform(surface_.gridTransform()->copy());
        grid->setGridClass(openvdb::GRID_LEVEL_SET);
        auto accessor = grid->getAccessor();
        const auto set = [&](const igeo::Ijk& v, float value) {
            if (value < kFar) accessor.setValueOn({v.x, v.y, v.z}, value);
        };
        const std::vector<igeo::Vec3f> slope = slopes();
        std::vector<float> value(band_->size());
        igeo::parallelFor(value.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) value[i] = valueAt(slope, igeo::NodeIndex(i));
        });
        for (igeo::NodeIndex i = 0; i < value.size(); ++i) {
            const igeo::Ijk v = band_->ijk(i);
            set(v, value[i]);
            if (std::abs(band_->psi[i]) > kHalfCell || value[i] == kFar) continue;
            // Beyond the edge of an open surface, cells that it passes have corners without nodes.
            for (int x = -1; x <= 1; ++x)
                for (int y = -1; y <= 1; ++y)
                    for (int z = -1; z <= 1; ++z) {
                        const igeo::Ijk step{x, y, z}, w = v + step;
                        if (band_->neighbor(i, step) != igeo::kNoNode) continue;
                        if (value[i] > -kFar)
                            set(w, fromNeighbors(slope, i, step));
                        else if (!accessor.isValueOn({w.x, w.y, w.z}))
                            set(w, -kFar);
                    }
        }
        return grid;
    }

private:
    static constexpr float kFar = 2;           ///< voxels
    static constexpr float kThin = 0.3f;       ///< least depth of walls one voxel thick
    static constexpr float kLeast = 0.02f;     ///< of what neighbors give, which keeps the sign
    static constexpr float kHalfCell = 0.87f;  ///< of the diagonal: all points have a voxel so near
    /// A free and a blocked neighbor, the axis and sign of the step between them, and the part of
    /// it in which the function changes.
    struct Edge {
        igeo::NodeIndex free, blocked;
        int axis, sign;
        float low = 0, high = 1;
        float middle() const { return (low + high) / 2; }
    };

    /// Per node and axis 1 / the distance of the rim along the axis, toward the rim; 0 where it is
    /// farther than the neighbor.
    std::vector<igeo::Vec3f> slopes() const {
        std::vector<igeo::Vec3f> slope(band_->size());
        const auto add = [&](igeo::NodeIndex i, int axis, float s) {
            if (std::abs(s) > std::abs(slope[i][axis])) slope[i][axis] = s;
        };
        for (const Edge& e : edges_) {
            add(e.free, e.axis, float(e.sign) / e.middle());
            add(e.blocked, e.axis, float(-e.sign) / (1 - e.middle()));
        }
        return slope;
    }

    /// Whether a blocked node lies between free ones, so that without kThin a wall could leak.
    bool isThin(igeo::NodeIndex i) const {
        const auto isFree = [&](int face) {
            const igeo::NodeIndex j = band_->neighbor(i, igeo::Band::faceStep(face));
            return j != igeo::kNoNode && !blocked_[j] && band_->linked(i, j);
        };
        if (!blocked_[i]) return false;
        return (isFree(0) && isFree(1)) || (isFree(2) && isFree(3)) || (isFree(4) && isFree(5));
    }

    /// Whether a node has all its neighbors along the axes, so that it knows the rim along each.
    bool complete(igeo::NodeIndex i) const {
        for (int face = 0; face < 6; ++face)
            if (band_->neighbor(i, igeo::Band::faceStep(face)) == igeo::kNoNode) return false;
        return true;
    }

    /// The signed distance of the rim from a node, < 0 in the obstacle.
    ///
    /// With the rim at a, b, c along the axes: 1 / sqrt(1/a^2 + 1/b^2 + 1/c^2). Nodes farther from
    /// the rim and those at the edge of the band take it from their neighbors.
    float valueAt(const std::vector<igeo::Vec3f>& slope, igeo::NodeIndex i) const {
        const float sign = blocked_[i] ? -1 : 1, steep = length(slope[i]);
        if (isThin(i)) return -std::max(1 / steep, kThin);
        if (steep > 0 && complete(i)) return sign / steep;
        return sign * std::clamp(sign * fromNeighbors(slope, i, {}), kLeast, kFar);
    }

    /// The mean of the distances that nodes up to a step from a voxel, at `step` from node i, give
    /// for it; where there are none that of a voxel far from the rim.
    float fromNeighbors(const std::vector<igeo::Vec3f>& slope, igeo::NodeIndex i,
                        const igeo::Ijk& step) const {
        float sum = 0, weights = 0;
        band_->forBox(
            &igeo::BandLeaf::band, i, step, 1, [&](igeo::NodeIndex j, const igeo::Ijk& at) {
                const float steep = length(slope[j]);
                if (steep == 0 || !band_->linked(i, j)) return;
                const float value = (blocked_[j] ? -1 : 1) / steep;
                const float weight = (complete(j) ? 1.0f : 0.01f) / (0.05f + value * value);
                sum += weight * value * (1 - dot(slope[j], igeo::Vec3f(step - at)));
                weights += weight;
            });
        if (weights == 0) return blocked_[i] ? -kFar : kFar;
        return sum / weights;
    }

    igeo::Surface surface_;
    std::shared_ptr<const igeo::Band> band_;
    std::vector<bool> blocked_;  ///< per node
    std::vector<Edge> edges_;
};
