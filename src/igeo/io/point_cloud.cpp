#include <igeo/io/point_cloud.h>

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>

namespace igeo {

namespace {
using Kind = Error::Kind;
}  // namespace

void requireUsable(const PointCloud& cloud) {
    auto isFinite = [](const auto& v) {
        return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    };
    auto fail = [&](std::size_t i, const std::string& what) {
        throw Error(
            Kind::BadInput,
            fmt::format("{}: point {} of {} {}", cloud.file, i + 1, cloud.points.size(), what),
            "take such points or all normals out of the file");
    };
    if (cloud.points.empty())
        throw Error(Kind::BadInput, cloud.file + " holds no points", "give a file with points");
    if (!cloud.normals.empty() && cloud.normals.size() != cloud.points.size())
        throw Error(Kind::InvalidArgument, fmt::format("{}: {} normals for {} points", cloud.file,
                                                       cloud.normals.size(), cloud.points.size()));
    for (std::size_t i = 0; i < cloud.points.size(); ++i)
        if (!isFinite(cloud.points[i])) fail(i, "has a coordinate that is not finite");
    for (std::size_t i = 0; i < cloud.normals.size(); ++i)
        if (!isFinite(cloud.normals[i]) || !(length(cloud.normals[i]) > 0))
            fail(i, "has a normal that is zero or not finite");
}

PointCloud distinctPoints(const PointCloud& cloud) {
    std::vector<std::size_t> order(cloud.points.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    auto position = [&](std::size_t i) {
        const Vec3d& p = cloud.points[i];
        return std::make_tuple(p.x, p.y, p.z);
    };
    auto normal = [&](std::size_t i) {
        const Vec3f n = cloud.normals.empty() ? Vec3f{} : cloud.normals[i];
        return std::make_tuple(n.x, n.y, n.z);
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::make_pair(position(a), normal(a)) < std::make_pair(position(b), normal(b));
    });
    order.erase(
        std::unique(order.begin(), order.end(),
                    [&](std::size_t a, std::size_t b) { return position(a) == position(b); }),
        order.end());
    PointCloud kept{cloud.file, {}, {}};
    for (const std::size_t i : order) {
        kept.points.push_back(cloud.points[i]);
        if (!cloud.normals.empty()) kept.normals.push_back(cloud.normals[i]);
    }
    return kept;
}

}  // namespace igeo
