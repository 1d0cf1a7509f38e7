#include <igeo/results/curve_files.h>

#include <fmt/core.h>
#include <igeo/io/detail/little_endian.h>
#include <igeo/io/vtp_file.h>

#include <algorithm>
#include <cstdint>
#include <set>

namespace igeo {

namespace {

using Curves = std::vector<NamedCurve>;

/// The number of distinct vertices: of a closed curve all but the last.
std::size_t distinct(const NamedCurve& c) { return c.points.size() - (c.closed ? 1 : 0); }

/// Calls visit(begin, end) for runs of curves with the same name.
template <typename Visit>
void forObjects(const Curves& curves, const Visit& visit) {
    for (auto begin = curves.begin(); begin != curves.end();) {
        const auto end = std::find_if(begin, curves.end(),
                                      [&](const NamedCurve& c) { return c.name != begin->name; });
        visit(begin, end);
        begin = end;
    }
}

/// Calls visit(a, b) for the segments, with vertices counted from `first`.
template <typename Visit>
void forSegments(const NamedCurve& c, std::size_t first, const Visit& visit) {
    for (std::size_t k = 1; k < c.points.size(); ++k) visit(first + k - 1, first + k % distinct(c));
}

std::string csv(CurveKind kind, const Curves& curves) {
    const bool path = kind == CurveKind::Path;
    std::string text = path ? "path,vertex,x,y,z,arcLength,distance,nx,ny,nz\n"
                            : "line,level,vertex,x,y,z,arcLength,nx,ny,nz\n";
    for (const NamedCurve& c : curves)
        for (std::size_t k = 0; k < c.points.size(); ++k) {
            const Vec3d &p = c.points[k], &n = c.normals[k];
            if (path)
                text += fmt::format("{},{}", c.number, k);
            else
                text += fmt::format("{},{:.17g},{}", c.number, c.distance[k], k);
            text += fmt::format(",{:.17g},{:.17g},{:.17g},{:.17g}", p.x, p.y, p.z, c.arcLength[k]);
            if (path) text += fmt::format(",{:.17g}", c.distance[k]);
            text += fmt::format(",{:.17g},{:.17g},{:.17g}\n", n.x, n.y, n.z);
        }
    return text;
}

std::string obj(CurveKind kind, const Curves& curves) {
    std::string text = kind == CurveKind::Path
                           ? "# geodesics, world units; the normal vn of each vertex v\n"
                           : "# isolines of the geodesic distance, world units; the normal vn of "
                             "each vertex v\n";
    std::size_t first = 1;
    forObjects(curves, [&](auto begin, auto end) {
        text += fmt::format("o {}\n", begin->name);
        std::size_t next = first;
        for (auto c = begin; c != end; next += distinct(*c), ++c)
            for (std::size_t k = 0; k < distinct(*c); ++k) {
                const Vec3d &p = c->points[k], &n = c->normals[k];
                text += fmt::format("v {:.17g} {:.17g} {:.17g}\nvn {:.9g} {:.9g} {:.9g}\n", p.x,
                                    p.y, p.z, n.x, n.y, n.z);
            }
        for (auto c = begin; c != end; first += distinct(*c), ++c)
            forSegments(*c, first, [&](std::size_t a, std::size_t b) {
                text += fmt::format("l {} {}\n", a, b);
            });
    });
    return text;
}

std::string ply(CurveKind kind, const Curves& curves) {
    std::size_t vertices = 0, edges = 0;
    for (const NamedCurve& c : curves)
        vertices += distinct(c), edges += c.points.empty() ? 0 : c.points.size() - 1;
    std::string bytes = fmt::format(
        "ply\n"
        "format binary_little_endian 1.0\n"
        "comment {}, world units\n"
        "element vertex {}\n"
        "property double x\nproperty double y\nproperty double z\n"
        "property float nx\nproperty float ny\nproperty float nz\n"
        "property float distance\nproperty float arcLength\nproperty int {}\n"
        "element edge {}\n"
        "property int vertex1\nproperty int vertex2\n"
        "end_header\n",
        kind == CurveKind::Path ? "geodesics" : "isolines of the geodesic distance", vertices,
        kind == CurveKind::Path ? "path" : "line", edges);
    for (const NamedCurve& c : curves)
        for (std::size_t k = 0; k < distinct(c); ++k) {
            for (int a = 0; a < 3; ++a) putLittleEndian(bytes, c.points[k][a]);
            for (int a = 0; a < 3; ++a) putLittleEndian(bytes, float(c.normals[k][a]));
            putLittleEndian(bytes, float(c.distance[k]));
            putLittleEndian(bytes, float(c.arcLength[k]));
            putLittleEndian(bytes, std::int32_t(c.number));
        }
    std::size_t first = 0;
    for (const NamedCurve& c : curves) {
        forSegments(c, first, [&](std::size_t a, std::size_t b) {
            putLittleEndian(bytes, std::int32_t(a));
            putLittleEndian(bytes, std::int32_t(b));
        });
        first += distinct(c);
    }
    return bytes;
}

/// A unique USD name: letters, digits and underscores.
std::string primName(std::string name, std::set<std::string>& taken) {
    for (char& c : name)
        if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
    const std::string wanted = name;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", wanted, k);
    return name;
}

/// One object of a USD stage.
/// @param width  of the curves when drawn
std::string basisCurves(const std::string& name, Curves::const_iterator begin,
                        Curves::const_iterator end, double width) {
    std::string text = fmt::format("    def BasisCurves \"{}\"\n    {{\n", name);
    auto list = [&](const char* declaration, const char* after, const auto& item) {
        text += fmt::format("        {} = [", declaration);
        const char* separator = "";
        for (auto c = begin; c != end; ++c)
            for (std::size_t k = 0; k < c->points.size(); ++k, separator = ", ") {
                text += separator;
                item(*c, k);
            }
        text += fmt::format("]{}\n", after);
    };
    auto triple = [&](const Vec3d& v) {
        text += fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z);
    };
    const char* const perVertex = " (\n            interpolation = \"vertex\"\n        )";
    text += "        uniform token type = \"linear\"\n        int[] curveVertexCounts = [";
    for (auto c = begin; c != end; ++c)
        text += fmt::format("{}{}", c == begin ? "" : ", ", c->points.size());
    text += "]\n";
    Vec3d low{kInfinity, kInfinity, kInfinity}, high = -low;
    for (auto c = begin; c != end; ++c)
        for (const Vec3d& p : c->points)
            for (int a = 0; a < 3; ++a)
                low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    text += "        float3[] extent = [";
    triple(low), text += ", ", triple(high), text += "]\n";
    list("point3f[] points", "", [&](const NamedCurve& c, std::size_t k) { triple(c.points[k]); });
    list("normal3f[] normals", perVertex,
         [&](const NamedCurve& c, std::size_t k) { triple(c.normals[k]); });
    text += fmt::format(
        "        float[] widths = [{:.9g}] (\n            interpolation = "
        "\"constant\"\n        )\n",
        width);
    list("float[] primvars:distance", perVertex,
         [&](const NamedCurve& c, std::size_t k) { text += fmt::format("{:.9g}", c.distance[k]); });
    list("float[] primvars:arcLength", perVertex, [&](const NamedCurve& c, std::size_t k) {
        text += fmt::format("{:.9g}", c.arcLength[k]);
    });
    return text + "    }\n";
}

std::string usda(CurveKind kind, const Curves& curves) {
    constexpr double kWidth = 1.0 / 500;  // of the longest curve
    const char* const root = kind == CurveKind::Path ? "paths" : "isolines";
    double longest = 0;
    for (const NamedCurve& c : curves)
        if (!c.points.empty()) longest = std::max(longest, c.arcLength.back());
    std::string text =
        fmt::format("#usda 1.0\n(\n    defaultPrim = \"{0}\"\n)\n\ndef Xform \"{0}\"\n{{\n", root);
    std::set<std::string> taken;
    forObjects(curves, [&](auto begin, auto end) {
        text += basisCurves(primName(begin->name, taken), begin, end, kWidth * longest);
    });
    return text + "}\n";
}

PolyData polyData(CurveKind kind, const Curves& curves) {
    PolyData shape;
    PointData distance{"distance", {}}, arcLength{"arcLength", {}}, normal{"normal", {}, 3};
    PointData number{kind == CurveKind::Path ? "path" : "line", {}, 1, PointData::Type::Int32};
    for (const NamedCurve& c : curves) {
        std::vector<std::uint32_t> line;
        for (std::size_t k = 0; k < c.points.size(); ++k) {
            line.push_back(std::uint32_t(shape.points.size()));
            shape.points.push_back(c.points[k]);
            distance.values.push_back(c.distance[k]);
            arcLength.values.push_back(c.arcLength[k]);
            for (int a = 0; a < 3; ++a) normal.values.push_back(c.normals[k][a]);
        }
        shape.lines.add(line);
        number.values.push_back(double(c.number));
    }
    shape.data = {std::move(distance), std::move(arcLength), std::move(normal)};
    shape.lineData = {std::move(number)};
    return shape;
}

}  // namespace

std::vector<NamedCurve> namedCurves(const std::vector<Isoline>& lines,
                                    const Similarity& transform) {
    Curves curves;
    for (const Isoline& line : lines) {
        const double level = line.level * transform.dx;
        NamedCurve c{
            fmt::format("isoline_{:.9g}", level), curves.size(), line.closed, {}, {}, {}, {}};
        auto add = [&](std::size_t k) {
            const Vec3d p = transform.worldFromIndex(line.points[k]);
            c.arcLength.push_back(
                c.points.empty() ? 0 : c.arcLength.back() + length(p - c.points.back()));
            c.points.push_back(p);
            c.normals.push_back(transform.worldFromIndexDirection(line.normals[k]));
            c.distance.push_back(level);
        };
        for (std::size_t k = 0; k < line.points.size(); ++k) add(k);
        if (line.closed) add(0);
        curves.push_back(std::move(c));
    }
    return curves;
}

std::string curveFile(const std::string& ending, CurveKind kind, const Curves& all) {
    Curves curves;
    // A curve without length is dropped.
    for (const NamedCurve& c : all)
        if (c.points.size() > 1 || ending == ".csv") curves.push_back(c);
    if (ending == ".csv") return csv(kind, curves);
    if (ending == ".obj") return obj(kind, curves);
    if (ending == ".ply") return ply(kind, curves);
    if (ending == ".usda") return usda(kind, curves);
    return vtp(polyData(kind, curves));
}

}  // namespace igeo
