#include <support/mesh_shapes.h>

#include <igeo/io/detail/little_endian.h>

#include <fstream>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace igeo::test {

TriangleMesh sheet(std::size_t nu, std::size_t nv, const std::function<Vec3d(double, double)>& f,
                   const std::function<bool(double, double)>& keep) {
    TriangleMesh mesh;
    mesh.file = "sheet";
    for (std::size_t i = 0; i <= nu; ++i)
        for (std::size_t j = 0; j <= nv; ++j)
            mesh.points.push_back(f(double(i) / double(nu), double(j) / double(nv)));
    for (std::size_t i = 0; i < nu; ++i)
        for (std::size_t j = 0; j < nv; ++j) {
            if (keep && !keep((double(i) + 0.5) / double(nu), (double(j) + 0.5) / double(nv)))
                continue;
            const auto a = std::uint32_t(i * (nv + 1) + j), b = std::uint32_t(a + nv + 1);
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    weld(mesh);
    return mesh;
}

TriangleMesh sphereMesh(const Vec3d& center, double radius, int rounds) {
    TriangleMesh mesh;
    mesh.file = "sphere";
    const double g = (1 + std::sqrt(5.0)) / 2;
    mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int round = 0; round < rounds; ++round) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, isNew] = middles.try_emplace(std::minmax(a, b), mesh.points.size());
            if (isNew) mesh.points.push_back(0.5 * (mesh.points[a] + mesh.points[b]));
            return at->second;
        };
        std::vector<TriangleMesh::Triangle> finer;
        for (const auto& [a, b, c] : mesh.triangles) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.triangles = finer;
    }
    // Turned, so that nothing lies on lattice planes.
    const Vec3d x = normalized(Vec3d{0.8, 0.31, -0.52}),
                y = normalized(cross(x, Vec3d{0.2, 0.9, 0.4})), z = cross(x, y);
    for (Vec3d& p : mesh.points) {
        const Vec3d n = normalized(p);
        p = center + radius * (n.x * x + n.y * y + n.z * z);
    }
    return mesh;
}

TriangleMesh boxMesh(const Vec3d& size) {
    TriangleMesh mesh;
    for (unsigned k = 0; k < 8; ++k)
        mesh.points.push_back({k & 4 ? size.x : 0, k & 2 ? size.y : 0, k & 1 ? size.z : 0});
    using Quad = std::array<std::uint32_t, 4>;
    for (const auto& [a, b, c, d] : {Quad{0, 1, 3, 2}, Quad{4, 6, 7, 5}, Quad{0, 4, 5, 1},
                                     Quad{2, 3, 7, 6}, Quad{0, 2, 6, 4}, Quad{1, 5, 7, 3}}) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    }
    return mesh;
}

TriangleMesh plateWithTunnel(double width) {
    TriangleMesh mesh;
    for (const double z : {-3.0, 3.0})
        for (const double half : {10.0, width / 2})
            for (const auto& [x, y] :
                 {std::pair(-half, -half), {half, -half}, {half, half}, {-half, half}})
                mesh.points.push_back({x, y, z});
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (std::uint32_t k = 0; k < 4; ++k) {
        const std::uint32_t n = (k + 1) % 4;
        quad(8 + k, 8 + n, 12 + n, 12 + k);  // above
        quad(n, k, 4 + k, 4 + n);            // below
        quad(k, n, 8 + n, 8 + k);            // around
        quad(4 + n, 4 + k, 12 + k, 12 + n);  // inside
    }
    return mesh;
}

TriangleMesh prismMesh(const std::vector<std::array<double, 2>>& outline, double width,
                       const std::function<Vec3d(double, double, double)>& at) {
    TriangleMesh mesh;
    const auto n = std::uint32_t(outline.size());
    for (const auto& [x, z] : outline)
        for (const double y : {0.0, width}) mesh.points.push_back(at(x, y, z));
    for (std::uint32_t k = 0; k < n; ++k) {
        const std::uint32_t next = (k + 1) % n;
        mesh.triangles.push_back({2 * k, 2 * k + 1, 2 * next + 1});
        mesh.triangles.push_back({2 * k, 2 * next + 1, 2 * next});
    }
    return mesh;
}

TriangleMesh moebius(double radius, double width, std::size_t n) {
    const double pi = std::acos(-1.0);
    TriangleMesh mesh = sheet(n, std::max<std::size_t>(2, n / 8), [&](double u, double v) {
        const double a = 2 * pi * u, w = (v - 0.5) * width;
        const double r = radius + w * std::cos(a / 2);
        return Vec3d{r * std::cos(a), r * std::sin(a), w * std::sin(a / 2)};
    });
    mesh.file = "moebius";
    return mesh;
}

TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
    const auto first = std::uint32_t(a.points.size());
    a.points.insert(a.points.end(), b.points.begin(), b.points.end());
    for (const auto& [i, j, k] : b.triangles)
        a.triangles.push_back({first + i, first + j, first + k});
    return a;
}

TriangleMesh moved(TriangleMesh mesh, const std::function<Vec3d(const Vec3d&)>& place) {
    for (Vec3d& p : mesh.points) p = place(p);
    return mesh;
}

namespace {

std::string base64(const std::string& bytes) {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
    return text;
}

std::string gltf(const TriangleMesh& mesh) {
    std::string bytes;
    Vec3d low = mesh.points.front(), high = low;
    for (const Vec3d& p : mesh.points)
        for (int a = 0; a < 3; ++a) {
            putLittleEndian(bytes, float(p[a]));
            low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
        }
    const std::size_t points = bytes.size();
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) putLittleEndian(bytes, v);
    std::ostringstream out;
    out << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
        << R"("nodes":[{"translation":[1,2,3],"children":[1]},{"scale":[2,2,2],"mesh":0}],)"
        << R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
        << R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)"
        << mesh.points.size() << ",\"min\":[" << low.x << ',' << low.y << ',' << low.z
        << "],\"max\":[" << high.x << ',' << high.y << ',' << high.z
        << R"(]},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)"
        << 3 * mesh.triangles.size() << R"(}],"bufferViews":[{"buffer":0,"byteLength":)" << points
        << R"(},{"buffer":0,"byteOffset":)" << points << ",\"byteLength\":" << bytes.size() - points
        << "}],\"buffers\":[{\"byteLength\":" << bytes.size()
        << R"(,"uri":"data:application/octet-stream;base64,)" << base64(bytes) << "\"}]}";
    return out.str();
}

std::string stl(const TriangleMesh& mesh, bool text) {
    std::ostringstream out;
    out << std::setprecision(9) << "solid mesh\n";
    std::string bytes(80, ' ');
    putLittleEndian(bytes, std::uint32_t(mesh.triangles.size()));
    for (const auto& t : mesh.triangles) {
        out << "facet normal 0 0 0\nouter loop\n";
        for (int a = 0; a < 3; ++a) putLittleEndian(bytes, 0.0f);
        for (const std::uint32_t v : t) {
            const Vec3d& p = mesh.points[v];
            out << "vertex " << p.x << ' ' << p.y << ' ' << p.z << '\n';
            for (int a = 0; a < 3; ++a) putLittleEndian(bytes, float(p[a]));
        }
        out << "endloop\nendfacet\n";
        bytes += std::string(2, '\0');
    }
    out << "endsolid mesh\n";
    return text ? out.str() : bytes;
}

std::string ply(const TriangleMesh& mesh, bool text) {
    std::ostringstream head, body;
    head << "ply\nformat " << (text ? "ascii" : "binary_little_endian") << " 1.0\nelement vertex "
         << mesh.points.size() << "\nproperty float x\nproperty float y\nproperty float z\n"
         << "element face " << mesh.triangles.size()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
    std::string bytes;
    body << std::setprecision(9);
    for (const Vec3d& p : mesh.points) {
        body << p.x << ' ' << p.y << ' ' << p.z << '\n';
        for (int a = 0; a < 3; ++a) putLittleEndian(bytes, float(p[a]));
    }
    for (const auto& t : mesh.triangles) {
        body << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
        putLittleEndian(bytes, std::uint8_t(3));
        for (const std::uint32_t v : t) putLittleEndian(bytes, std::int32_t(v));
    }
    return head.str() + (text ? body.str() : bytes);
}

/// .obj and .off, by the letters in front of points and faces.
std::string lines(const TriangleMesh& mesh, bool obj) {
    std::ostringstream out;
    out << std::setprecision(9);
    if (!obj) out << "OFF\n" << mesh.points.size() << ' ' << mesh.triangles.size() << " 0\n";
    for (const Vec3d& p : mesh.points)
        out << (obj ? "v " : "") << p.x << ' ' << p.y << ' ' << p.z << '\n';
    for (const auto& t : mesh.triangles)
        out << (obj ? "f " : "3 ") << t[0] + obj << ' ' << t[1] + obj << ' ' << t[2] + obj << '\n';
    return out.str();
}

}  // namespace

std::size_t turnedEdges(const TriangleMesh& mesh) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    std::size_t count = 0;
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) count += !edges.insert({t[k], t[(k + 1) % 3]}).second;
    return count;
}

void writeMesh(const TriangleMesh& mesh, const std::string& file, bool text) {
    const std::string ending = file.substr(file.rfind('.'));
    std::ofstream out(file, std::ios::binary);
    if (ending == ".obj" || ending == ".off")
        out << lines(mesh, ending == ".obj");
    else if (ending == ".stl")
        out << stl(mesh, text);
    else if (ending == ".ply")
        out << ply(mesh, text);
    else if (ending == ".gltf")
        out << gltf(mesh);
    else
        throw std::invalid_argument(file);
    out.close();
    if (!out) throw std::runtime_error("cannot write " + file);
}

}  // namespace igeo::test
