#include <igeo/metric/index_map.h>

#include <igeo/base/error.h>

namespace igeo {

namespace {

Vec3d fromOpenVdb(const openvdb::Vec3d& v) { return {v.x(), v.y(), v.z()}; }
openvdb::Vec3d toOpenVdb(const Vec3d& v) { return {v.x, v.y, v.z}; }

/// Rounds numbers that are whole but for rounding. The bound is far below a voxel across any grid,
/// and far above the rounding of a position in the world.
Vec3d wholeIfNearly(Vec3d v) {
    constexpr double kNearly = 1e-9;
    for (int a = 0; a < 3; ++a)
        if (std::abs(v[a] - std::round(v[a])) < kNearly) v[a] = std::round(v[a]);
    return v;
}

}  // namespace

IndexMap IndexMap::inverse() const {
    const double volume = dot(axis[0], cross(axis[1], axis[2]));
    // Rows of the inverse, then its columns.
    const std::array<Vec3d, 3> row{cross(axis[1], axis[2]) * (1 / volume),
                                   cross(axis[2], axis[0]) * (1 / volume),
                                   cross(axis[0], axis[1]) * (1 / volume)};
    IndexMap back;
    for (int a = 0; a < 3; ++a) back.axis[std::size_t(a)] = {row[0][a], row[1][a], row[2][a]};
    back.origin = -back.direction(origin);
    return back;
}

IndexMap indexMap(const Similarity& from, const openvdb::math::Transform& to,
                  const std::string& where) {
    if (!to.isLinear())
        throw Error(Error::Kind::BadInput,
                    "the transform is a " + to.mapType() + " (not linear)" + where,
                    "resample the grid to voxels of one shape first, for instance with OpenVDB's "
                    "tools::resampleToMatch");
    const auto place = [&](const Vec3d& pIndex) {
        return fromOpenVdb(to.worldToIndex(toOpenVdb(from.worldFromIndex(pIndex))));
    };
    const auto matrix = to.baseMap()->getAffineMap()->getMat4().getMat3().inverse();
    IndexMap map;
    map.origin = wholeIfNearly(place({}));
    for (std::size_t a = 0; a < 3; ++a)  // OpenVDB multiplies row vectors.
        map.axis[a] = wholeIfNearly(fromOpenVdb(toOpenVdb(from.dx * from.axis[a]) * matrix));
    return map;
}

}  // namespace igeo
