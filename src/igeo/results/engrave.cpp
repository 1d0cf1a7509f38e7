#include <igeo/results/engrave.h>

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/Composite.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace igeo {

namespace {

/// A level set of round tubes around segments: per voxel the least distance to any.
class Tubes {
public:
    /// @param radius, halfWidth  voxels
    Tubes(double radius, double halfWidth, double dx, float background)
        : radius_(radius),
          dx_(dx),
          halfWidth_(halfWidth),
          grid_(openvdb::FloatGrid::create(background)),
          accessor_(grid_->getAccessor()) {}

    void add(const Vec3d& a, const Vec3d& b) {
        const double reach = radius_ + halfWidth_;
        openvdb::Coord low, high;
        for (int k = 0; k < 3; ++k) {
            low[std::size_t(k)] = int(std::ceil(std::min(a[k], b[k]) - reach));
            high[std::size_t(k)] = int(std::floor(std::max(a[k], b[k]) + reach));
        }
        const Vec3d way = b - a;
        const double way2 = std::max(dot(way, way), 1e-30);
        for (openvdb::CoordBBox::ZYXIterator it(openvdb::CoordBBox(low, high)); it; ++it) {
            const Vec3d r = Vec3d((*it).x(), (*it).y(), (*it).z()) - a;
            const double along = std::clamp(dot(r, way) / way2, 0.0, 1.0);
            lower(*it, length(r - along * way) - radius_);
        }
    }
    const openvdb::FloatGrid& grid() const { return *grid_; }

private:
    /// @param distance from the tube's surface, voxels
    void lower(const openvdb::Coord& ijk, double distance) {
        if (distance >= halfWidth_) return;
        const auto value = float(distance * dx_);
        if (value >= accessor_.getValue(ijk)) return;
        if (distance > -halfWidth_)
            accessor_.setValueOn(ijk, value);
        else
            accessor_.setValueOff(ijk, -grid_->background());
    }

    double radius_, dx_, halfWidth_;
    openvdb::FloatGrid::Ptr grid_;
    openvdb::FloatGrid::Accessor accessor_;
};

/// psi, active only below a half-width (voxels).
openvdb::FloatTree::ConstPtr narrowed(const LevelSet& levelSet, double halfWidth) {
    if (levelSet.stats.halfWidth <= halfWidth) return levelSet.psi->constTreePtr();
    const auto psi = std::make_shared<openvdb::FloatTree>(levelSet.psi->tree());
    const auto width = float(halfWidth * levelSet.transform.dx);
    openvdb::tools::changeLevelSetBackground(*psi, width);
    for (auto leaf = psi->beginLeaf(); leaf; ++leaf)
        for (auto it = leaf->beginValueOn(); it; ++it)
            if (std::abs(*it) >= width) leaf->setValueOff(it.pos(), std::copysign(width, *it));
    return psi;
}

}  // namespace

openvdb::FloatGrid::Ptr engraved(const LevelSet& levelSet, const std::vector<Isoline>& lines,
                                 const std::vector<Path>& paths, double radius,
                                 Progress& progress) {
    if (!(radius >= 0.5 && radius <= 10))
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("a groove of radius {:g} voxels; allowed are 0.5 to 10", radius));
    const double halfWidth = std::min(levelSet.stats.halfWidth, kEngravedWidth);
    const openvdb::FloatTree::ConstPtr psi = narrowed(levelSet, halfWidth);
    Tubes tubes(radius, halfWidth, levelSet.transform.dx, psi->background());
    for (const Isoline& line : lines) {
        progress.throwIfCancelled();
        for (std::size_t i = 1; i < line.points.size(); ++i)
            tubes.add(line.points[i - 1], line.points[i]);
        if (line.closed) tubes.add(line.points.back(), line.points.front());
    }
    for (const Path& path : paths)
        for (std::size_t i = 1; i < path.vertices.size(); ++i)
            tubes.add(path.vertices[i - 1].pIndex, path.vertices[i].pIndex);

    const auto grid =
        openvdb::FloatGrid::create(openvdb::tools::csgDifferenceCopy(*psi, tubes.grid().tree()));
    grid->setTransform(levelSet.psi->transform().copy());
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName(levelSet.name + "_engraved");
    return grid;
}

}  // namespace igeo
