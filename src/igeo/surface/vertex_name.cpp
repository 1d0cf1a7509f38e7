#include <igeo/surface/vertex_name.h>

#include <fmt/core.h>
#include <igeo/base/detail/box.h>
#include <igeo/base/error.h>

#include <charconv>
#include <optional>

namespace igeo {

namespace {

/// Empty for another name.
std::optional<std::size_t> numberNamed(const std::string& name, const std::vector<Vec3d>& points,
                                       const TriangleMesh* mesh) {
    auto isUsed = [&](std::size_t v) {
        return !mesh || v >= mesh->pointOfVertex.size() ||
               mesh->pointOfVertex[v] != TriangleMesh::kNoPoint;
    };
    Box box;
    for (std::size_t v = 0; v < points.size(); ++v)
        if (isUsed(v)) box.include(points[v]);
    const Vec3d middle = 0.5 * (box.low + box.high);
    auto leastBy = [&](const auto& value) -> std::size_t {
        std::size_t least = points.size();
        for (std::size_t v = 0; v < points.size(); ++v)
            if (isUsed(v) && (least == points.size() || value(points[v]) < value(points[least])))
                least = v;
        return least;
    };
    if (name == "center") return leastBy([&](const Vec3d& p) { return length(p - middle); });
    if (name.size() == 2 && (name[0] == '+' || name[0] == '-') && name[1] >= 'x' && name[1] <= 'z')
        return leastBy(
            [&](const Vec3d& p) { return (name[0] == '+' ? -1 : 1) * p[name[1] - 'x']; });
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error != std::errc() || end != name.data() + name.size()) return {};
    return number;
}

}  // namespace

std::size_t vertexNamed(const std::string& name, const std::vector<Vec3d>& vertices,
                        const std::string& of, const TriangleMesh* mesh) {
    using Kind = Error::Kind;
    const std::optional<std::size_t> number = numberNamed(name, vertices, mesh);
    if (!number)
        throw Error(Kind::InvalidArgument, "'" + name + "' is no vertex",
                    "give a number from 0 on, +x, -x, +y, -y, +z, -z or center");
    if (*number >= vertices.size())
        throw Error(Kind::InvalidArgument,
                    fmt::format("vertex {} of {}, which has {}", name, of, vertices.size()),
                    fmt::format("give a number from 0 to {}", vertices.size() - 1));
    return *number;
}

}  // namespace igeo
