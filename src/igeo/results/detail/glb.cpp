#include <igeo/results/detail/glb.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/version.h>
#include <igeo/io/detail/little_endian.h>

#include <algorithm>
#include <limits>

namespace igeo {

namespace {

constexpr int kFloat = 5126, kUint32 = 5125, kVertices = 34962, kIndices = 34963;

std::string viewJson(std::size_t begin, std::size_t length, int target) {
    return fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{},"target":{}}})", begin,
                       length, target);
}

std::string chunk(const char* kind, std::string content, char filler) {
    content.resize((content.size() + 3) / 4 * 4, filler);
    std::string bytes;
    putLittleEndian(bytes, std::uint32_t(content.size()));
    bytes.append(kind, 4);
    return bytes + content;
}

/// The node of the mesh, moved to `place`, then rotated by the least angle that takes `up` to y.
std::string nodeJson(const Vec3d& up, Vec3d place) {
    std::string json = R"({"mesh":0)";
    const Vec3d from = normalized(up), y{0, 1, 0};
    if (from != y) {
        Vec3d axis = cross(from, y);
        double w = 1 + dot(from, y);
        if (w < 1e-12) axis = {1, 0, 0}, w = 0;
        const double scale = 1 / std::sqrt(dot(axis, axis) + w * w);
        axis = scale * axis, w *= scale;
        json += fmt::format(R"(,"rotation":[{:.17g},{:.17g},{:.17g},{:.17g}])", axis.x + 0.0,
                            axis.y + 0.0, axis.z + 0.0, w);
        const Vec3d across = cross(axis, place);
        place += 2 * (w * across + cross(axis, across));
    }
    if (place != Vec3d{})
        json += fmt::format(R"(,"translation":[{:.17g},{:.17g},{:.17g}])", place.x + 0.0,
                            place.y + 0.0, place.z + 0.0);
    return json + "}";
}

}  // namespace

void GlbWriter::addAccessor(const char* name, const char* type, std::size_t begin,
                            const std::string& bounds) {
    views_ += viewJson(begin, buffer_.size() - begin, kVertices) + ",";
    accessors_ += fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}},)",
                              count_, kFloat, vertices_, type, bounds);
    attributes_ += fmt::format(R"({}"{}":{})", count_ > 0 ? "," : "", name, count_);
    ++count_;
}

void GlbWriter::addVectors(const char* name, const std::function<Vec3f(std::size_t)>& value) {
    const std::size_t begin = buffer_.size();
    constexpr float kMost = std::numeric_limits<float>::max();
    Vec3f low{kMost, kMost, kMost}, high{-kMost, -kMost, -kMost};
    for (std::size_t v = 0; v < vertices_; ++v) {
        const Vec3f p = value(v);
        for (int k = 0; k < 3; ++k) {
            putLittleEndian(buffer_, p[k]);
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    }
    addAccessor(name, "VEC3", begin,
                fmt::format(R"(,"min":[{:.9g},{:.9g},{:.9g}],"max":[{:.9g},{:.9g},{:.9g}])", low.x,
                            low.y, low.z, high.x, high.y, high.z));
}

void GlbWriter::addPairs(const char* name, const std::function<Vec2f(std::size_t)>& value) {
    const std::size_t begin = buffer_.size();
    for (std::size_t v = 0; v < vertices_; ++v) {
        const Vec2f p = value(v);
        putLittleEndian(buffer_, p.x);
        putLittleEndian(buffer_, p.y);
    }
    addAccessor(name, "VEC2", begin, "");
}

void GlbWriter::addNumbers(const char* name, const std::function<float(std::size_t)>& value) {
    const std::size_t begin = buffer_.size();
    for (std::size_t v = 0; v < vertices_; ++v) putLittleEndian(buffer_, value(v));
    addAccessor(name, "SCALAR", begin, "");
}

std::string GlbWriter::bytes(const std::vector<std::array<std::uint32_t, 3>>& triangles,
                             const Vec3d& up, const Vec3d& place) const {
    std::string buffer = buffer_;
    for (const auto& t : triangles)
        for (const std::uint32_t v : t) putLittleEndian(buffer, v);
    std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0","generator":"implicit-geodesic {}"}},"scene":0,)"
        R"("scenes":[{{"nodes":[0]}}],"nodes":[{}],)"
        R"("meshes":[{{"primitives":[{{"attributes":{{{}}},"indices":{},"material":0}}]}}],)",
        kVersion, nodeJson(up, place), attributes_, count_);
    // Open surfaces are visible from both sides; colors show the distance, without lighting.
    json += R"("materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":1},)"
            R"("doubleSided":true}],)";
    json += fmt::format(
        R"("accessors":[{}{{"bufferView":{},"componentType":{},"count":{},"type":"SCALAR"}}],)",
        accessors_, count_, kUint32, 3 * triangles.size());
    json += fmt::format(R"("bufferViews":[{}{}],"buffers":[{{"byteLength":{}}}]}})", views_,
                        viewJson(buffer_.size(), buffer.size() - buffer_.size(), kIndices),
                        buffer.size());
    if (buffer.size() + json.size() > std::numeric_limits<std::uint32_t>::max() - 64)
        throw Error(Error::Kind::InvalidArgument,
                    fmt::format("a mesh of {:.1f} GB in one .glb file, which holds 4",
                                double(buffer.size()) / 1e9),
                    "write .vtp or .ply");
    const std::string content = chunk("JSON", json, ' ') + chunk("BIN\0", buffer, '\0');
    constexpr std::uint32_t kMagic = 0x46546c67, kFormat = 2, kHeader = 12;
    std::string bytes;
    for (const std::uint32_t word : {kMagic, kFormat, std::uint32_t(kHeader + content.size())})
        putLittleEndian(bytes, word);
    return bytes + content;
}

}  // namespace igeo
