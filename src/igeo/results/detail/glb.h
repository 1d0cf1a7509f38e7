/// One mesh as binary glTF 2.0. Internal.
#pragma once

#include <igeo/base/types.h>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace igeo {

/// Collects the vertex attributes, all float32, one after another in one buffer.
class GlbWriter {
public:
    explicit GlbWriter(std::size_t vertices) : vertices_(vertices) {}

    void addVectors(const char* name, const std::function<Vec3f(std::size_t)>& value);
    void addPairs(const char* name, const std::function<Vec2f(std::size_t)>& value);
    void addNumbers(const char* name, const std::function<float(std::size_t)>& value);

    /// @param up     the direction that the mesh's rotation takes to y, which is up in glTF
    /// @param place  where the origin of the positions is; the node of the mesh holds it in double
    ///               precision
    /// @throws Error  InvalidArgument for 4 GiB and more
    std::string bytes(const std::vector<std::array<std::uint32_t, 3>>& triangles, const Vec3d& up,
                      const Vec3d& place) const;

private:
    /// @param bounds  JSON of the least and largest numbers, if they are to be written
    void addAccessor(const char* name, const char* type, std::size_t begin,
                     const std::string& bounds);

    std::size_t vertices_;
    std::string buffer_, views_, accessors_, attributes_;
    std::size_t count_ = 0;
};

}  // namespace igeo
