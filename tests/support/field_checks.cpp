#include "field_checks.h"

#include <igeo/march/detail/jet_core.h>

#include <algorithm>
#include <cmath>

namespace igeo::test {
namespace {

/// Marched nodes that touch, one by one, from a seed on, and the nodes of the band next to them.
std::vector<bool> connectedWithSeeds(const Field& field) {
    const Band& band = *field.band;
    std::vector<bool> connected(band.size());
    std::vector<NodeIndex> front;
    for (const SurfacePoint& s : field.seeds) front.push_back(s.node);
    for (const NodeIndex i : front) connected[i] = true;
    while (!front.empty()) {
        const NodeIndex i = front.back();
        front.pop_back();
        band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
            if (connected[j] || !band.linked(i, j) || !(wayBetween(band, i, j) < kInfinity)) return;
            connected[j] = true;
            if (band.inCore(j)) front.push_back(j);
        });
    }
    return connected;
}

bool isStuck(const Field& field, NodeIndex i) {
    const Band& band = *field.band;
    for (const SurfacePoint& s : field.seeds)
        if (length(band.footPoint(i) - s.pIndex) <= field.startRadius) return false;
    bool lower = false;
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        lower |= band.inCore(j) && field.distance[j] < field.distance[i];
    });
    return !lower;
}

}  // namespace

double wayBetween(const Band& band, NodeIndex i, NodeIndex j) {
    const Vec3f chord = Vec3f(band.footPoint(i) - band.footPoint(j));
    const float cosine = dot(band.normal[i], band.normal[j]);
    if (cosine < Band::kOtherSheet || band.stacked(i, j) ||
        (cosine < 0.5f && acrossGap(chord, band.normal[i], band.normal[j])))
        return kInfinity;
    return length(chord) * std::sqrt(2 / (1 + std::min(double(cosine), 1.0)));
}

void FieldChecks::keepWorst(const FieldChecks& other) {
    for (const auto number : {&FieldChecks::notNumbers, &FieldChecks::missed, &FieldChecks::stuck,
                              &FieldChecks::negative})
        this->*number = std::max(this->*number, other.*number);
    shortcut = std::max(shortcut, other.shortcut);
    jump = std::max(jump, other.jump);
}

void PathChecks::keepWorst(const PathChecks& other) {
    traced = std::max(traced, other.traced);
    lost = std::max(lost, other.lost);
    rise = std::max(rise, other.rise);
}

FieldChecks checkField(const Field& field, Nodes nodes) {
    const Band& band = *field.band;
    FieldChecks c;
    const std::vector<bool> connected = connectedWithSeeds(field);
    const auto counts = [&](NodeIndex i) {
        if (nodes == Nodes::Marched && !band.inCore(i)) return false;
        const PsiSample foot = samplePsi(band, band.footPoint(i));
        return field.distance[i] < kInfinity && foot.valid && std::abs(foot.psi) < 0.1;
    };
    for (std::size_t k = 0; k < band.size(); ++k) {
        const auto i = NodeIndex(k);
        const double d = field.distance[i];
        c.notNumbers += std::isnan(d) || !(length(field.gradient[i]) < 1.001f);
        c.missed += band.inCore(i) && connected[i] && !(d < kInfinity);
        c.negative += d < 0 && (nodes == Nodes::All || band.inCore(i));
        c.stuck += d < kInfinity && band.inCore(i) && isStuck(field, i);
        if (!counts(i)) continue;
        double straight = kInfinity;
        for (const SurfacePoint& s : field.seeds)
            straight = std::min(straight, length(band.footPoint(i) - s.pIndex));
        c.shortcut = std::max(c.shortcut, straight - d);
        for (const int side : {1, 3, 5}) {
            const NodeIndex j = band.neighbor(i, Band::faceStep(side));
            if (j != kNoNode && band.linked(i, j) && wayBetween(band, i, j) < kInfinity &&
                counts(j))
                c.jump = std::max(c.jump, std::abs(field.distance[i] - field.distance[j]) -
                                              wayBetween(band, i, j));
        }
    }
    return c;
}

std::vector<SurfacePoint> spreadPoints(const Field& field, std::size_t count) {
    const Band& band = *field.band;
    std::vector<NodeIndex> reached;
    for (std::size_t k = 0; k < band.size(); ++k)
        // Of other nodes some have a foot point in a gap between two sheets.
        if (field.distance[k] < kInfinity && band.inCore(NodeIndex(k)))
            reached.push_back(NodeIndex(k));
    std::vector<SurfacePoint> points;
    const std::size_t stride = std::max<std::size_t>(reached.size() / count, 1);
    // From the middle of each share: the first nodes are all at one end of the surface.
    for (std::size_t k = stride / 2; k < reached.size() && points.size() < count; k += stride)
        points.push_back(nearestSurfacePoint(band, band.footPoint(reached[k])));
    return points;
}

PathChecks checkPaths(const Field& field) {
    PathChecks c;
    for (const Path& path : tracePaths(field, spreadPoints(field, 40))) {
        ++c.traced;
        c.lost += path.status != PathStatus::Reached;
        double least = path.distance;
        for (const PathVertex& v : path.vertices) {
            c.rise = std::max(c.rise, v.distance - least);
            least = std::min(least, v.distance);
        }
    }
    return c;
}

}  // namespace igeo::test
