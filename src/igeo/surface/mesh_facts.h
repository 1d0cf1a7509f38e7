/// Facts about a triangle mesh, before a band is made from it.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// A triangle mesh in numbers.
struct MeshFacts {
    std::size_t points = 0, triangles = 0, dropped = 0, repeated = 0,
                junctions = 0;  ///< as in TriangleMesh
    std::size_t components = 0, boundaryEdges = 0, nonManifoldEdges = 0,
                nonOrientable = 0;  ///< as in MeshTopology
    std::size_t holes = 0;          ///< closed lines of boundary edges
    std::size_t crossingPairs = 0;  ///< of triangles that cross, or overlap in one plane; a million
                                    ///< stands for more as well
    std::vector<MeshContact> contacts;  ///< as meshCrossings()
    std::size_t pinches = 0;            ///< points at which parts meet that share no edge there
    bool closed = false;                ///< every edge has two triangles
    int euler = 0;                      ///< of a closed mesh: points - edges + triangles
};

/// Facts about a mesh. Crossings of less than 1e-6 of the bounding box's diagonal, the tolerance of
/// weld(), count as contacts.
/// @throws Error  Cancelled through `progress`
/// Time O(n log n).
MeshFacts meshFacts(const TriangleMesh& mesh, const Progress& progress = Progress::none());

/// "3 pairs of faces cross".
std::string crossingsOf(const MeshFacts& facts);

/// "edges split at 84 points in them".
std::string splitsOf(const MeshFacts& facts);

/// Warnings about a mesh, a sentence each; empty for a good one.
std::vector<std::string> meshWarnings(const MeshFacts& facts);

/// "open: 80 boundary edges in 1 hole", or empty. An open mesh is valid; but paths go around holes
/// that were not intended.
std::string openness(const MeshFacts& facts);

}  // namespace igeo
