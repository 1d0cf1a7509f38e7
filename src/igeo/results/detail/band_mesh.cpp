#include <igeo/results/detail/band_mesh.h>

#include <igeo/base/parallel.h>
#include <igeo/results/detail/cell_sheets.h>

#include <algorithm>
#include <unordered_map>

namespace igeo {

namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();
constexpr float kMostPerVoxel = 2.5f;  ///< change of a distance, with a margin for its error

bool crosses(float a, float b) { return (a < 0) != (b < 0) && std::abs(a - b) < kMostPerVoxel; }

/// The mean of the points where psi crosses the edges of a cell, projected to psi = 0. False
/// without crossings.
/// @param low  the cell's lowest corner, relative to node i
bool vertexIn(const Band& band, NodeIndex i, const Ijk& low, Vec3d& vertex) {
    std::array<float, 8> psi;
    psi.fill(std::numeric_limits<float>::quiet_NaN());  // NaN crosses nothing
    band.forCorners(&BandLeaf::band, i, low,
                    [&](NodeIndex j, unsigned k) { psi[k] = band.psi[j]; });
    Vec3d sum;
    int count = 0;
    for (unsigned k = 0; k < 8; ++k)
        for (unsigned bit = 1; bit < 8; bit *= 2) {
            if (k & bit || !crosses(psi[k], psi[k | bit])) continue;
            Vec3d p(cornerOf(k));
            p[bit == 4 ? 0 : bit == 2 ? 1 : 2] += double(psi[k] / (psi[k] - psi[k | bit]));
            sum += p;
            ++count;
        }
    if (count == 0) return false;
    vertex = ontoSurface(band, Vec3d(band.ijk(i) + low) + sum * (1.0 / count));
    return true;
}

/// The vertices of cells. A cell belongs to the first of its corners in the band, usually its
/// lowest.
class CellVertices {
public:
    CellVertices(const Band& band, std::vector<Vec3d>& points)
        : band_(band), number_(band.size(), kNoVertex) {
        constexpr std::size_t kChunk = 4096;
        const std::size_t n = band.size();
        struct Made {
            NodeIndex node;
            unsigned corner;
            Vec3d point;
        };
        std::vector<std::vector<Made>> parts((n + kChunk - 1) / kChunk);
        parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t c = begin; c < end; ++c)
                for (std::size_t i = c * kChunk; i < std::min(n, (c + 1) * kChunk); ++i)
                    for (unsigned k = 0; k < 8; ++k) {
                        Vec3d p;
                        if (owns(NodeIndex(i), k) && vertexIn(band, NodeIndex(i), -cornerOf(k), p))
                            parts[c].push_back({NodeIndex(i), k, p});
                    }
        });
        for (const auto& part : parts)
            for (const Made& made : part) {
                (made.corner == 0 ? number_[made.node] : others_[keyOf(made.node, made.corner)]) =
                    std::uint32_t(points.size());
                points.push_back(made.point);
            }
    }

    /// The vertex of the cell whose lowest corner is at a step from node i.
    std::uint32_t at(NodeIndex i, const Ijk& low) const {
        for (unsigned k = 0; k < 8; ++k) {
            const NodeIndex j = band_.neighbor(i, low + cornerOf(k));
            if (j == kNoNode) continue;
            if (k == 0) return number_[j];
            const auto other = others_.find(keyOf(j, k));
            return other == others_.end() ? kNoVertex : other->second;
        }
        return kNoVertex;
    }

private:
    static std::uint64_t keyOf(NodeIndex i, unsigned corner) {
        return std::uint64_t(i) << 3 | corner;
    }
    /// Whether node i is corner k of a cell, and no corner before k is in the band.
    bool owns(NodeIndex i, unsigned k) const {
        for (unsigned j = 0; j < k; ++j)
            if (band_.neighbor(i, cornerOf(j) - cornerOf(k)) != kNoNode) return false;
        return true;
    }

    const Band& band_;
    std::vector<std::uint32_t> number_;  ///< per node, of the cell above it
    std::unordered_map<std::uint64_t, std::uint32_t> others_;
};

}  // namespace

SurfaceMesh bandMesh(const Band& band) {
    SurfaceMesh mesh;
    const CellVertices vertices(band, mesh.position);
    const std::vector<Vec3d>& p = mesh.position;
    for (std::size_t k = 0; k < band.size(); ++k)
        for (int axis = 0; axis < 3; ++axis) {
            const auto i = NodeIndex(k);
            Ijk ahead{}, b{}, c{};
            ahead[axis] = 1, b[(axis + 1) % 3] = -1, c[(axis + 2) % 3] = -1;
            const NodeIndex j = band.neighbor(i, ahead);
            if (j == kNoNode || !crosses(band.psi[i], band.psi[j])) continue;
            // Counter-clockwise seen from the positive end of the axis.
            std::array<std::uint32_t, 4> q{vertices.at(i, b + c), vertices.at(i, c),
                                           vertices.at(i, {}), vertices.at(i, b)};
            if (band.psi[i] >= 0) std::swap(q[1], q[3]);
            if (length(p[q[2]] - p[q[0]]) > length(p[q[3]] - p[q[1]]))
                std::rotate(q.begin(), q.begin() + 1, q.end());
            mesh.triangles.push_back({q[0], q[1], q[2]});
            mesh.triangles.push_back({q[0], q[2], q[3]});
        }
    std::vector<Vec3d> sum(p.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3d n = cross(p[b] - p[a], p[c] - p[a]);
        sum[a] += n, sum[b] += n, sum[c] += n;
    }
    for (const Vec3d& n : sum) mesh.normal.emplace_back(normalized(n));
    return mesh;
}

}  // namespace igeo
