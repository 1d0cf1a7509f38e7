#include <igeo/results/log_map.h>

#include <igeo/base/error.h>
#include <igeo/results/detail/seed_directions.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace igeo {

LogMap logMap(const Field& field, const Vec3d& reference, Progress& progress) {
    if (!field.jets || field.gradient.size() != field.distance.size())
        throw Error(Error::Kind::InvalidArgument,
                    "the logarithmic map needs a field that has a gradient at foot points",
                    "march with the scheme jet");
    if (field.metric->anisotropic())
        throw Error(Error::Kind::InvalidArgument,
                    "the logarithmic map is not known for tensor metrics",
                    "leave the tensor out, or use weights");
    for (const SurfacePoint& seed : field.seeds)
        if (seed.joined || seed.segment != Vec3d{})
            throw Error(
                Error::Kind::InvalidArgument,
                "the logarithmic map is known about points, and a seed is a curve, a region "
                "or a group",
                "give the seeds as points");
    SeedDirections directions(field, reference);
    LogMap map;
    for (const auto& [u, v] : directions.axesAtSeeds()) map.frames.push_back({u, v});
    map.position = directions.positions(progress);
    if (field.band->transform.mirrors()) {
        for (LogMap::Frame& frame : map.frames) frame.v = -frame.v;
        for (Vec2f& at : map.position) at.y = -at.y;
    }
    return map;
}

Vec2f positionAt(const Field& field, const LogMap& map, const SurfacePoint& p) {
    const Vec3d normal(field.band->normal[p.node]);
    const Arrival arrival = arrivalAt(field, p.pIndex, normal);
    if (!(arrival.distance < kInfinity)) return kNoPosition;
    const SurfaceCell cell(*field.band, *field.metric, p.pIndex, normal);
    auto known = [&](std::size_t k, std::optional<std::uint32_t> source) {
        const NodeIndex i = cell.node[k];
        return i != kNoNode && cell.weight[k] > 0 && !std::isnan(map.position[i].x) &&
               (!source || field.label.empty() || field.label[i] == *source);
    };
    auto leadOf = [&](std::optional<std::uint32_t> wanted) {
        std::size_t lead = 8;
        for (std::size_t k = 0; k < 8; ++k)
            if (known(k, wanted) && (lead == 8 || cell.weight[k] > cell.weight[lead])) lead = k;
        return lead;
    };
    std::uint32_t source = arrival.source;
    std::size_t lead = leadOf(source);
    // Where two seeds are equally far, all nodes around may belong to the other.
    if (lead == 8) lead = leadOf({});
    if (lead == 8) return kNoPosition;
    if (!field.label.empty()) source = field.label[cell.node[lead]];
    const double radius = arrival.distance - field.seeds[source].start;
    if (!(radius > 0)) return {0, 0};
    // Beyond the cut locus geodesics arrive from another side.
    constexpr double kNear = 4, kTurn = 0.5;  // voxels, radians
    const Vec2f first = map.position[cell.node[lead]];
    const double within = std::max(kNear * field.metric->largest(), kTurn * double(length(first)));
    Vec2f sum{};
    for (std::size_t k = 0; k < 8; ++k)
        if (known(k, source) && double(length(map.position[cell.node[k]] - first)) <= within)
            sum = sum + float(cell.weight[k]) * map.position[cell.node[k]];
    const float len = length(sum);
    return len > 0 ? float(radius) / len * sum : kNoPosition;
}

}  // namespace igeo
