/// Points as OpenVDB holds them.
#pragma once

#include <igeo/io/point_cloud.h>
#include <openvdb/openvdb.h>

#include <string>

namespace igeo::test {

/// A grid of points with voxels of 0.1, as other programs write it. Apart, because OpenVDB's
/// headers of points take longer to compile than a file of tests.
openvdb::GridBase::Ptr pointGrid(const PointCloud& cloud, const std::string& name);

}  // namespace igeo::test
