// Output files, read back.
#pragma once

#include <openvdb/openvdb.h>
#include <support/openvdb.h>

#include <string>

namespace igeo::test {

/// What a VDB file holds.
struct VdbFile {
    openvdb::GridPtrVec grids;  ///< in the order of the file
    openvdb::MetaMap metadata;  ///< of the file itself

    /// The grid of this name; fails the test if there is none of the type.
    template <typename GridT>
    typename GridT::Ptr get(const std::string& name) const {
        for (const auto& grid : grids)
            if (grid->getName() == name)
                if (auto typed = openvdb::gridPtrCast<GridT>(grid)) return typed;
        throw std::runtime_error("no grid '" + name + "' of type " + GridT::gridType());
    }
};

VdbFile readVdb(const std::string& path);

/// The same from bytes, as they come through a pipe.
VdbFile readVdbBytes(const std::string& bytes);

openvdb::FloatGrid::Ptr readDistance(const std::string& path,
                                     const std::string& name = "psi_geodesic");

/// Largest difference at the voxels that are active in both grids.
double largestDifference(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b);

}  // namespace igeo::test
