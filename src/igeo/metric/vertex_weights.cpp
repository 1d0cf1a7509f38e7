#include <igeo/metric/vertex_weights.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>

#include <algorithm>

namespace igeo {

namespace {

[[noreturn]] void refuse(const std::string& what) {
    throw Error(Error::Kind::InvalidArgument, what, "give values that belong to this mesh");
}

/// Barycentric coordinates of a point of a triangle.
std::array<double, 3> sharesAt(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d normal = cross(b - a, c - a);
    const double area = dot(normal, normal);
    // On a triangle without area all corners are close together or on a line.
    if (!(area > 0)) return {1, 0, 0};
    const double ofB = dot(cross(p - a, c - a), normal) / area,
                 ofC = dot(cross(b - a, p - a), normal) / area;
    return {std::clamp(1 - ofB - ofC, 0.0, 1.0), std::clamp(ofB, 0.0, 1.0),
            std::clamp(ofC, 0.0, 1.0)};
}

}  // namespace

std::vector<double> valuesAtPoints(const TriangleMesh& mesh, const std::vector<double>& ofVertex) {
    const std::size_t vertices = mesh.source ? mesh.source->vertices.size() : mesh.points.size();
    if (ofVertex.size() != vertices)
        refuse(
            fmt::format("{} values for {} vertices of '{}'", ofVertex.size(), vertices, mesh.file));
    if (!mesh.source) return ofVertex;
    std::vector<double> values(mesh.points.size(), -kInfinity);
    for (std::size_t v = 0; v < vertices; ++v)
        if (const std::uint32_t p = mesh.pointOfVertex[v]; p != TriangleMesh::kNoPoint)
            values[p] = std::max(values[p], ofVertex[v]);
    return values;
}

std::vector<float> sampleVertexWeights(const std::vector<double>& ofPoint, const Band& band,
                                       Progress& progress) {
    if (!band.triangles || band.triangles->points().size() != ofPoint.size())
        refuse(fmt::format("weights at {} vertices are not for this surface", ofPoint.size()));
    progress.throwIfCancelled();
    const SurfaceTriangles& triangles = *band.triangles;
    std::vector<float> weights(band.size());
    parallelFor(band.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const Vec3d foot = band.footPoint(NodeIndex(k));
            const auto place = triangles.nearest(foot, kInfinity, Vec3d(band.normal[k]));
            const auto& corners = triangles[place.triangle];
            const auto shares =
                sharesAt(place.point, triangles.corner(place.triangle, 0),
                         triangles.corner(place.triangle, 1), triangles.corner(place.triangle, 2));
            double sum = 0, total = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                sum += shares[c] * ofPoint[corners[c]];
                total += shares[c];
            }
            weights[k] = float(sum / total);
        }
    });
    return weights;
}

}  // namespace igeo
