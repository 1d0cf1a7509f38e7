/// One sheet of S beside a crease, extended beyond it. Internal to the paths.
#pragma once

#include <igeo/path/detail/walker.h>

#include <array>
#include <vector>

namespace igeo {

/// A node near a crease, as the fits see it.
struct SheetNode {
    Vec3d at, foot, normal;
    double psi = 0;
    bool mixed = false;  ///< central differences of psi mix sheets here
};

/// The nodes within 1.3 voxels of S whose foot points are within 6 voxels of a point, in the order
/// of their voxels.
std::vector<SheetNode> nodesForSheets(const Band& band, const Vec3d& center);

/// A sheet at one side of a crease, as nodes show it that no other sheet disturbs.
///
/// Around a crease foot points and normals are those of a rounded edge. Nodes of a plane agree with
/// each other, to rounding where psi is exact, and these nodes alone give the plane. Any other
/// sheet is fitted to the nodes on the side of S where psi has the kink, as differences stay on one
/// side of it: a normal whose part along the sheet is linear, and the height by it. That is
/// accurate for cylinders and spheres.
class SheetFit {
public:
    /// @param center  near the crease
    /// @param n       normal of the sheet there
    /// @param side    of S on which psi has the kink: -1 inside, 1 outside
    SheetFit(const std::vector<SheetNode>& nodes, const Vec3d& center, const Vec3d& n, int side);

    SheetFit() = default;  ///< not valid

    bool valid() const { return valid_; }
    bool isPlane() const { return plane_; }
    const Vec3d& center() const { return center_; }
    Vec3d normal(const Vec3d& q) const {
        if (plane_) return constant_;
        // Along the sheet the normal of spheres and cylinders is linear; across it, it is not.
        const Vec3d r = q - center_,
                    linear =
                        constant_ + dot(r, along_[0]) * slope_[0] + dot(r, along_[1]) * slope_[1],
                    along = linear - dot(linear, up_) * up_;
        return normalized(along + std::sqrt(std::max(1 - dot(along, along), 0.0)) * up_);
    }
    /// Whether the sheet turns little enough from the center to q to be known there.
    bool reaches(const Vec3d& q) const {
        constexpr double kMost = 0.6;
        const Vec3d r = q - center_;
        return plane_ ||
               length(dot(r, along_[0]) * slope_[0] + dot(r, along_[1]) * slope_[1]) < kMost;
    }
    /// The height of q above the sheet.
    double height(const Vec3d& q) const {
        if (plane_) return dot(q, constant_) - offset_;
        const Vec3d n = normal(q);
        double sum = 0;
        for (const Vec3d& foot : feet_) sum += dot(q - foot, 0.5 * (normal(foot) + n));
        return sum / double(feet_.size());
    }
    Local operator()(const Vec3d& q, const Vec3d&) const { return {true, height(q), normal(q)}; }

private:
    bool findPlane();
    void fit();
    bool dropOutliers();

    Vec3d center_, up_;
    std::array<Vec3d, 2> along_;
    std::vector<Vec3d> feet_, normals_;
    Vec3d constant_;
    std::array<Vec3d, 2> slope_;
    double offset_ = 0;  ///< of a plane
    bool plane_ = false, valid_ = false;
};

}  // namespace igeo
