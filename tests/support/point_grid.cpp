#include "point_grid.h"

#include <openvdb/points/PointConversion.h>

#include <vector>

namespace igeo::test {

openvdb::GridBase::Ptr pointGrid(const PointCloud& cloud, const std::string& name) {
    std::vector<openvdb::Vec3d> positions;
    for (const Vec3d& p : cloud.points) positions.emplace_back(p.x, p.y, p.z);
    const auto transform = openvdb::math::Transform::createLinearTransform(0.1);
    const auto grid =
        openvdb::points::createPointDataGrid<openvdb::points::NullCodec,
                                             openvdb::points::PointDataGrid>(positions, *transform);
    grid->setName(name);
    return grid;
}

}  // namespace igeo::test
