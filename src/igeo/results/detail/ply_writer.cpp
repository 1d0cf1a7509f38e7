#include <igeo/results/detail/ply_writer.h>

#include <fmt/core.h>
#include <igeo/base/detail/single.h>
#include <igeo/io/detail/little_endian.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace igeo {

namespace {

using Type = PlyProperty::Type;

const char* nameOf(Type type) {
    switch (type) {
        case Type::Float:
            return "float";
        case Type::Double:
            return "double";
        case Type::Int:
            return "int";
        case Type::Byte:
            break;
    }
    return "uchar";
}

void put(std::string& bytes, Type type, double value) {
    switch (type) {
        case Type::Float:
            return putLittleEndian(bytes, float(value));
        case Type::Double:
            return putLittleEndian(bytes, value);
        case Type::Int:
            return putLittleEndian(bytes, std::int32_t(value));
        case Type::Byte:
            return putLittleEndian(bytes, std::uint8_t(value));
    }
}

bool isReached(double distance) { return distance < kInfinity; }

}  // namespace

bool isSingle(std::size_t points, const std::function<Vec3d(std::size_t)>& position,
              double noticed) {
    for (std::size_t v = 0; v < points; ++v) {
        const Vec3d exact = position(v), off = inSingle(exact) - exact;
        for (int a = 0; a < 3; ++a)
            if (!(std::abs(off[a]) <= noticed)) return false;
    }
    return true;
}

double largestOf(const std::vector<double>& distance) {
    double largest = 0;
    for (const double d : distance)
        if (isReached(d)) largest = std::max(largest, d);
    return largest;
}

std::vector<Vec3f> colorsOf(const std::vector<double>& distance,
                            const std::function<Vec3f(double)>& color) {
    const double largest = largestOf(distance);
    std::vector<Vec3f> colors(distance.size(), Vec3f{0.5f, 0.5f, 0.5f});
    for (std::size_t v = 0; v < colors.size(); ++v)
        if (const double d = distance[v]; isReached(d))
            colors[v] = color(largest > 0 ? std::max(d, 0.0) / largest : 0.0);
    return colors;
}

void PlyWriter::add(Type type, const std::string& name, std::function<double(std::size_t)> value) {
    properties_.push_back({type, name, std::move(value)});
}

void PlyWriter::addVector(Type type, const std::array<const char*, 3>& names,
                          std::function<Vec3d(std::size_t)> value) {
    for (int k = 0; k < 3; ++k)
        add(type, names[std::size_t(k)], [value, k](std::size_t v) { return value(v)[k]; });
}

void PlyWriter::addColors(const std::vector<Vec3f>& colors) {
    const auto shared = std::make_shared<const std::vector<Vec3f>>(colors);
    addVector(Type::Byte, {"red", "green", "blue"}, [shared](std::size_t v) {
        const Vec3f& c = (*shared)[v];
        auto byte = [](float x) { return double(std::clamp(x, 0.0f, 1.0f) * 255 + 0.5f); };
        return Vec3d{byte(c.x), byte(c.y), byte(c.z)};
    });
}

void PlyWriter::addPositions(std::function<Vec3d(std::size_t)> position, double noticed) {
    const Type type = isSingle(vertices_, position, noticed) ? Type::Float : Type::Double;
    addVector(type, {"x", "y", "z"}, std::move(position));
}

void PlyWriter::addDistances(const std::vector<double>& distance, std::vector<std::int32_t> label) {
    const double largest = largestOf(distance);
    auto known = [&distance](std::size_t v) { return isReached(distance[v]) ? distance[v] : -1; };
    add(Type::Float, "distance", known);
    add(Type::Float, "quality", known);
    const auto labels = std::make_shared<const std::vector<std::int32_t>>(std::move(label));
    add(Type::Int, "label", [labels](std::size_t v) { return (*labels)[v]; });
    auto share = [&distance, largest](std::size_t v) {
        return isReached(distance[v]) && largest > 0 ? std::max(distance[v], 0.0) / largest : 0.0;
    };
    auto isGray = [&distance](std::size_t v) { return isReached(distance[v]) ? 0.0 : 1.0; };
    add(Type::Float, "s", share);
    add(Type::Float, "t", isGray);
    add(Type::Float, "texture_u", share);
    add(Type::Float, "texture_v", isGray);
}

std::string PlyWriter::bytes(
    std::size_t faces,
    const std::function<std::span<const std::uint32_t>(std::size_t)>& face) const {
    std::string out = "ply\nformat binary_little_endian 1.0\n";
    if (!comment_.empty()) out += "comment " + comment_ + "\n";
    out += fmt::format("element vertex {}\n", vertices_);
    for (const PlyProperty& p : properties_)
        out += fmt::format("property {} {}\n", nameOf(p.type), p.name);
    std::size_t most = 0;
    for (std::size_t f = 0; f < faces; ++f) most = std::max(most, face(f).size());
    const Type count = most < 256 ? Type::Byte : Type::Int;
    if (face)
        out += fmt::format("element face {}\nproperty list {} int vertex_indices\n", faces,
                           nameOf(count));
    out += "end_header\n";
    for (std::size_t v = 0; v < vertices_; ++v)
        for (const PlyProperty& p : properties_) put(out, p.type, p.value(v));
    for (std::size_t f = 0; f < faces; ++f) {
        put(out, count, double(face(f).size()));
        for (const std::uint32_t v : face(f)) putLittleEndian(out, std::int32_t(v));
    }
    return out;
}

}  // namespace igeo
