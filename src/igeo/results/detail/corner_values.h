/// Normals and distances at the corners of visible triangles. Internal to the pictures.
#pragma once

#include <igeo/base/detail/registers.h>
#include <igeo/results/detail/drawn_surface.h>
#include <igeo/results/detail/shader.h>

#include <cstdint>
#include <span>
#include <vector>

namespace igeo {

/// Distances are read once per corner, and are linear in a triangle where that is exact to a part
/// of a pixel: its gradient is then as long as that of a distance, and the seeds are not close.
class CornerValues {
public:
    /// @param shown      the visible triangles
    /// @param pixels     of the surface; if they are fewer than the corners, no corner is read
    /// @param tolerance  the largest error of distances, voxels
    CornerValues(const DrawnSurface& surface, const Frame& frame, const Shader& shader,
                 const std::vector<std::uint32_t>& shown, std::size_t pixels, double tolerance);

    /// At points of triangles, in camera coordinates.
    struct Values {
        using Four = Registers<4>::Vector;
        Four nx, ny, nz;  ///< unit; on the same side of the ray as that of the triangle
        Four distance;    ///< +infinity where that of a corner is
    };
    /// Where nothing is covered, values have no meaning.
    /// @param towardX, towardY  the rays of the samples
    Values at(const FourSamples& samples, const Values::Four& towardX,
              const Values::Four& towardY) const;

    /// How distances in a triangle follow from those of its corners.
    enum Trust : std::uint8_t {
        Linear,
        Rough,  ///< with an error of more than the tolerance, but less than eight times that
        None
    };
    Trust trust(std::uint32_t triangle) const { return triangles_[triangle].trust; }

private:
    struct Corner {
        float nx = 0, ny = 0, nz = 0, distance = std::numeric_limits<float>::infinity();
    };
    struct Triangle {
        Trust trust = None;
        bool away = false;  ///< it turns its back to the eye
    };
    std::size_t slot(std::uint32_t triangle, unsigned corner) const {
        return surface_.isCreased() ? 3 * std::size_t(triangle) + corner
                                    : surface_.triangles()[triangle][corner];
    }
    /// @param each       corners, as 3 * triangle + corner, each of another vertex
    /// @param areRead    whether distances are read there
    /// @param distances  per vertex
    void findCorners(std::span<const std::uint32_t> each, bool areRead,
                     std::vector<float>& distances);
    Corner cornerOf(const Vec3f& normal, float distance) const;
    Trust trustIn(std::uint32_t triangle) const;
    bool turnsAway(std::uint32_t triangle) const;

    const DrawnSurface& surface_;
    const Frame& frame_;
    const Shader& shader_;
    const double tolerance_;
    std::vector<std::uint8_t> isSmooth_;  ///< per vertex: one smooth front passes it
    std::vector<Corner> corners_;
    std::vector<Triangle> triangles_;
};

}  // namespace igeo
