/// Sheets of a cloud one on top of the other, as in a roll or a stack. Internal.
#pragma once

#include <igeo/base/point_tree.h>

#include <vector>

namespace igeo {

/// Tells sheets of a cloud apart whose normals are alike, up to their signs.
///
/// Two points lie one above the other if they are farther apart along both their normals than a
/// spacing, and than three tenths of what they are apart along S. On a curve the normals of two
/// points see each other on opposite sides, so a bend does not count. Scatter and steps of one
/// sheet do, but neighbors that are not one above the other join them to it.
class StackedSheets {
public:
    using Neighbors = std::vector<PointTree::Found>;

    /// All must outlive it.
    /// @param spacing, normal  per point; of either sign
    StackedSheets(const PointTree& points, const std::vector<double>& spacing,
                  const std::vector<Vec3d>& normal)
        : points_(points), spacing_(spacing), normal_(normal) {}

    /// Removes the points on sheets above and below that of the first, unless that is a stray.
    /// @param near  nearest first, the first at distance 0
    /// @return the squared distance of the nearest one removed; infinite for none
    /// Time O(k) for k neighbors, O(k^2) where some are above or below.
    double keepOwn(Neighbors& near) const;

private:
    /// How far a point is above another, and how far along S: the lesser of the heights over both
    /// planes, 0 where these differ in sign.
    struct Offset {
        double above, along, cosine;
    };
    Offset offset(PointTree::Index i, PointTree::Index j) const;

    const PointTree& points_;
    const std::vector<double>& spacing_;
    const std::vector<Vec3d>& normal_;
};

}  // namespace igeo
