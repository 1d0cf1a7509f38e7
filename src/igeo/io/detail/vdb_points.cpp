#include <igeo/io/detail/vdb_points.h>

#include <igeo/base/error.h>
#include <igeo/io/vdb_read.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/PointDataGrid.h>

namespace igeo {

using openvdb::points::PointDataGrid;

PointCloud readVdbPoints(const std::string& source) {
    const GridSource named = parseGridSource(source);
    PointCloud cloud{named.file, {}, {}};
    const auto grid = openvdb::gridPtrCast<PointDataGrid>(readPointGrid(named, cloud.warnings));
    const openvdb::math::Transform& transform = grid->transform();
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        if (!leaf->hasAttribute("P"))
            throw Error(Error::Kind::BadInput, named.file + ": points of '" + grid->getName() +
                                                   "' have no positions (attribute P)");
        try {
            // The attribute handles below read without bounds checks.
            leaf->validateOffsets();
        } catch (const openvdb::Exception&) {
            throw Error(Error::Kind::BadInput,
                        named.file + ": voxels of '" + grid->getName() +
                            "' count other points than are there",
                        "the file is damaged: write it again");
        }
        const openvdb::points::AttributeHandle<openvdb::Vec3f> position(
            leaf->constAttributeArray("P"));
        const auto* array = leaf->hasAttribute("N") ? &leaf->constAttributeArray("N") : nullptr;
        using Normals = openvdb::points::AttributeHandle<openvdb::Vec3f>;
        const bool known = array && array->valueType() == "vec3s";
        const Normals::Ptr normal = known ? Normals::create(*array) : nullptr;
        for (auto i = leaf->beginIndexOn(); i; ++i) {
            const openvdb::Vec3d p =
                transform.indexToWorld(position.get(*i) + i.getCoord().asVec3d());
            cloud.points.push_back({p.x(), p.y(), p.z()});
            if (!normal) continue;
            const openvdb::Vec3f n = normal->get(*i);
            cloud.normals.push_back({n.x(), n.y(), n.z()});
        }
    }
    if (cloud.normals.size() != cloud.points.size()) cloud.normals.clear();
    return cloud;
}

}  // namespace igeo
