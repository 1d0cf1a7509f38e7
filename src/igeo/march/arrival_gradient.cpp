// Gradients of a field at points of S.
#include <igeo/march/field.h>

#include <igeo/march/detail/mesh_read.h>

namespace igeo {

Vec3d gradientOfFirst(const Field& field, const Vec3d& pIndex, const SurfaceCell& cell,
                      std::uint32_t source) {
    constexpr double kSameFront = 0.7, kSmooth = 0.9, kCancels = 0.1;
    struct Corner {
        Vec3d g, normal;
        double weight, value;  ///< value: at the point, by a plane front
    };
    std::array<Corner, 8> corners;
    std::size_t count = 0, first = 0;
    const std::array<NodeJet, 8> jets = field.at(cell.node);
    for (std::size_t k = 0; k < 8; ++k) {
        const NodeJet& jet = jets[k];
        if (!(jet.distance < kInfinity) || (source != kAnySource && jet.label != source)) continue;
        const NodeIndex i = cell.node[k];
        const Vec3d g(jet.gradient);
        corners[count] = {g, Vec3d(field.band->normal[i]), cell.weight[k],
                          jet.distance + dot(g, pIndex - field.band->footPoint(i))};
        if (corners[count].value < corners[first].value) first = count;
        ++count;
    }
    const Corner& lead = corners[first];
    Vec3d sum{};
    double weights = 0, lengths = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const Corner& c = corners[k];
        // Gradients of godunov are differences over all fronts; over a crease one front turns.
        const bool ofOther = field.atFootPoints && dot(c.normal, lead.normal) >= kSmooth &&
                             dot(c.g, lead.g) < kSameFront * length(c.g) * length(lead.g);
        if (ofOther) continue;
        sum += c.weight * turned(c.g, c.normal, cell.normal), weights += c.weight,
            lengths += c.weight * length(c.g);
    }
    const Vec3d g = tangential(sum, cell.normal);
    return length(g) > kCancels * lengths ? (1 / weights) * g : Vec3d{};
}

Vec3d gradientAt(const Field& field, const Arrival& arrival, const Vec3d& pIndex,
                 const SurfaceCell& cell) {
    if (!(arrival.distance < kInfinity) || (field.gradient.empty() && !field.core)) return {};
    const bool isotropic = !field.metric->anisotropic();
    const double here = isotropic ? field.metric->at(cell) : 1;
    if (arrival.seed && isotropic)
        return here * normalized(tangential(pIndex - arrival.seed->nearestTo(pIndex), cell.normal));
    Vec3d g = gradientOfFirst(field, pIndex, cell, arrival.source);
    if (!(length(g) > 0)) {  // that of the nearest corner
        double most = 0;
        const std::array<NodeJet, 8> jets = field.at(cell.node);
        for (std::size_t k = 0; k < 8; ++k)
            if (jets[k].distance < kInfinity && jets[k].label == arrival.source &&
                cell.weight[k] > most)
                most = cell.weight[k], g = tangential(Vec3d(jets[k].gradient), cell.normal);
    }
    return isotropic ? here * normalized(g) : g;
}

}  // namespace igeo
