/// Faces of a triangle mesh that pass through each other or touch.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

#include <cstddef>
#include <vector>

namespace igeo {

/// What is counted at most: a polygon of 10,000 corners may have a hundred million crossings.
constexpr std::size_t kMostCrossingPairs = 1'000'000;

struct MeshCrossings {
    std::size_t pairs = 0;  ///< kMostCrossingPairs where there are that many or more
    /// Points within 0.01 of the tolerance of a triangle; not in the edges that splitAtJunctions()
    /// split.
    std::vector<MeshContact> contacts;
};

/// The pairs of triangles, as they were before splitAtJunctions(), that cross, or overlap in one
/// plane, and contacts.
///
/// Two triangles cross where no axis separates them: along each of the normals and the products of
/// two edges (separating axes) they overlap by more than `tolerance`. So triangles that only touch
/// do not cross, such as neighbors along an edge or around a point. Triangles without area are
/// ignored.
/// @param tolerance  in the file's units; smaller crossings may be missed
/// @throws Error  Cancelled through `progress`
/// Time O(n log n + pairs whose boxes meet), in parallel; 40 bytes per triangle. The order of
/// contacts does not depend on the number of threads.
MeshCrossings meshCrossings(const TriangleMesh& mesh, double tolerance,
                            const Progress& progress = Progress::none());

/// Moves points off the triangles on which they lie, toward their own triangles, by `by` along the
/// normals: so the nearest triangle of each is one of its own.
void separate(TriangleMesh& mesh, const std::vector<MeshContact>& contacts, double by);

}  // namespace igeo
