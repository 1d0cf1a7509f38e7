/// Points with properties, and faces, as PLY. Internal.
#pragma once

#include <igeo/base/types.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace igeo {

/// A column of numbers at the vertices.
struct PlyProperty {
    enum class Type { Float, Double, Int, Byte };
    Type type = Type::Float;
    std::string name;
    std::function<double(std::size_t)> value;  ///< at a vertex
};

/// The bytes of a binary, little-endian PLY file.
class PlyWriter {
public:
    PlyWriter(std::string comment, std::size_t vertices)
        : comment_(std::move(comment)), vertices_(vertices) {}

    void add(PlyProperty::Type type, const std::string& name,
             std::function<double(std::size_t)> value);
    /// Three columns, the components of a vector.
    void addVector(PlyProperty::Type type, const std::array<const char*, 3>& names,
                   std::function<Vec3d(std::size_t)> value);
    /// Colors from 0 to 1 as red, green and blue.
    void addColors(const std::vector<Vec3f>& colors);
    /// x, y and z: double where single precision would move a point by more than `noticed`.
    void addPositions(std::function<Vec3d(std::size_t)> position, double noticed = 0);
    /// `distance`; `quality`, the same for MeshLab; `label`; and the share of the largest distance
    /// as texture coordinates, under the names that Blender (s, t) and MeshLab (texture_u,
    /// texture_v) read: (distance / largest, 0), or (0, 1) where unreached.
    /// @param distance  +infinity or NaN: unreached, written as -1
    /// @param label     -1: none
    void addDistances(const std::vector<double>& distance, std::vector<std::int32_t> label);

    /// @param face  the corners of each face
    std::string bytes(
        std::size_t faces = 0,
        const std::function<std::span<const std::uint32_t>(std::size_t)>& face = {}) const;

private:
    std::string comment_;
    std::size_t vertices_;
    std::vector<PlyProperty> properties_;
};

/// Whether single precision moves no point by more than `noticed` along an axis.
bool isSingle(std::size_t points, const std::function<Vec3d(std::size_t)>& position,
              double noticed);

/// The largest finite number; 0 if there is none.
double largestOf(const std::vector<double>& distance);

/// The color for each share of the largest distance; gray where unreached.
std::vector<Vec3f> colorsOf(const std::vector<double>& distance,
                            const std::function<Vec3f(double)>& color);

}  // namespace igeo
