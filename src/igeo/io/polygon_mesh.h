/// The vertices and faces of a mesh file.
#pragma once

#include <igeo/base/types.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace igeo {

/// Vertices and faces in the order of the file, with the file's numbers.
struct PolygonMesh {
    std::vector<Vec3d> vertices;
    std::vector<std::uint32_t> corners;  ///< of all faces, one face after another
    std::vector<std::size_t> faceEnd;    ///< per face: where its corners end

    std::size_t faces() const { return faceEnd.size(); }
    std::span<const std::uint32_t> face(std::size_t f) const {
        const std::size_t begin = f == 0 ? 0 : faceEnd[f - 1];
        return {corners.data() + begin, faceEnd[f] - begin};
    }
    void addFace(std::span<const std::uint32_t> face) {
        corners.insert(corners.end(), face.begin(), face.end());
        faceEnd.push_back(corners.size());
    }
};

}  // namespace igeo
