#include <igeo/vdb_points.h>

#include <igeo/error.h>
#include <igeo/vdb_io.h>
#include <openvdb/openvdb.h>
#include <openvdb/points/AttributeArray.h>
#include <openvdb/points/PointDataGrid.h>

#include <filesystem>

namespace igeo {

namespace {

using Kind = Error::Kind;
using openvdb::points::PointDataGrid;

PointDataGrid::Ptr readGrid(const GridSource& source) {
    openvdb::initialize();
    if (!std::filesystem::is_regular_file(source.file))
        throw Error(Kind::Io, "cannot read '" + source.file + "': there is no such file",
                    "check the name and the permissions");
    std::vector<PointDataGrid::Ptr> found;
    try {
        openvdb::io::File file(source.file);
        file.open(/*delayLoad=*/false);
        const openvdb::GridPtrVecPtr grids = file.getGrids();
        for (const openvdb::GridBase::Ptr& grid : *grids)
            if (auto points = openvdb::gridPtrCast<PointDataGrid>(grid))
                if (source.grid.empty() || points->getName() == source.grid)
                    found.push_back(points);
    } catch (const std::exception& e) {
        throw Error(Kind::BadInput, source.file + ": " + e.what(),
                    "it is no VDB file, or cut off; write it again");
    }
    if (found.size() != 1)
        throw Error(Kind::BadInput,
                    source.file + " holds " + std::to_string(found.size()) + " grids of points" +
                        (source.grid.empty() ? "" : " named '" + source.grid + "'") +
                        "; one is needed",
                    found.empty() ? "level sets are no clouds; list the grids with vdb_print -l"
                                  : "name it: FILE.vdb:GRID");
    return found.front();
}

}  // namespace

PointCloud readVdbPoints(const std::string& source) {
    const GridSource named = parseGridSource(source);
    const PointDataGrid::Ptr grid = readGrid(named);
    const openvdb::math::Transform& transform = grid->transform();
    PointCloud cloud{named.file, {}, {}};
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        if (!leaf->hasAttribute("P"))
            throw Error(Kind::BadInput, named.file + ": points of '" + grid->getName() +
                                            "' have no positions (attribute P)");
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
