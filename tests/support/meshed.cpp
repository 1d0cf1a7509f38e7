#include <igeo/surface/level_set_band.h>
#include <support/errors.h>
#include <support/meshed.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace igeo::test {

openvdb::Vec3d Meshed::world(const Vec3d& pIndex) const { return worldOf(band, pIndex); }

Meshed::Meshed(const openvdb::FloatGrid::Ptr& grid, const std::vector<openvdb::Vec3d>& seeds,
               const JetOptions& options)
    : levelSet(checkedLevelSet(grid)), band(bandFromLevelSet(levelSet, std::sqrt(3.0))) {
    std::vector<SurfacePoint> points;
    for (const auto& seed : seeds) points.push_back(pointOn(band, seed));
    field = marchJet(band, {}, points, options);
    mesh = surfaceMesh(levelSet, field);
}

Meshed meshed(const openvdb::FloatGrid::Ptr& grid, const std::vector<openvdb::Vec3d>& seeds,
              const JetOptions& options) {
    return {grid, seeds, options};
}

Meshed meshed(const Shape& shape, const openvdb::math::Transform& transform,
              const std::vector<openvdb::Vec3d>& seeds, const JetOptions& options) {
    return meshed(makeLevelSet(shape, transform, 3), seeds, options);
}

Meshed meshed(const Shape& shape, double dx, const std::vector<openvdb::Vec3d>& seeds,
              const JetOptions& options) {
    return meshed(makeLevelSet(shape, dx, 3), seeds, options);
}

Topology topologyOf(const SurfaceMesh& mesh) {
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    std::map<Edge, std::pair<std::size_t, std::size_t>> ways;  // up, down
    for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = t[k], b = t[(k + 1) % 3];
            auto& way = ways[{std::min(a, b), std::max(a, b)}];
            ++(a < b ? way.first : way.second);
        }
    Topology topology;
    std::map<std::uint32_t, std::vector<std::uint32_t>> rim;
    for (const auto& [edge, way] : ways) {
        ++topology.edgesByTriangles[way.first + way.second];
        if (way.first + way.second == 2 && way.first != 1) ++topology.sameWay;
        if (way.first + way.second == 1) {
            rim[edge.first].push_back(edge.second);
            rim[edge.second].push_back(edge.first);
        }
    }
    topology.euler = int(mesh.position.size()) - int(ways.size()) + int(mesh.triangles.size());
    while (!rim.empty()) {
        ++topology.rimLoops;
        std::vector<std::uint32_t> stack{rim.begin()->first};
        while (!stack.empty()) {
            const auto at = rim.find(stack.back());
            stack.pop_back();
            if (at == rim.end()) continue;
            stack.insert(stack.end(), at->second.begin(), at->second.end());
            rim.erase(at);
        }
    }
    return topology;
}

double meshArea(const SurfaceMesh& mesh) {
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        area += length(cross(mesh.position[b] - mesh.position[a],
                             mesh.position[c] - mesh.position[a])) /
                2;
    return area;
}

double Ply::value(const std::string& element, std::size_t row, const std::string& property) const {
    const auto& names = properties.at(element);
    const auto at = std::find(names.begin(), names.end(), property);
    if (at == names.end()) throw std::runtime_error("no property " + property);
    return rows.at(element).at(row).at(std::size_t(at - names.begin()));
}

namespace {

double readNumber(const std::string& bytes, std::size_t& at, const std::string& type) {
    const std::size_t size = type == "uchar" ? 1 : type == "double" ? 8 : 4;
    if (at + size > bytes.size()) throw std::runtime_error("the file ends early");
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < size; ++k)
        bits |= std::uint64_t(static_cast<unsigned char>(bytes[at + k])) << 8 * k;
    at += size;
    if (type == "uchar") return double(bits);
    if (type == "int") return std::int32_t(bits);
    if (type == "double") {
        double value;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    }
    if (type != "float") throw std::runtime_error("type " + type);
    const auto half = std::uint32_t(bits);
    float value;
    std::memcpy(&value, &half, sizeof value);
    return double(value);
}

}  // namespace

Ply parsePly(const std::string& bytes) {
    Ply ply;
    struct Element {
        std::string name;
        std::size_t count;
        std::vector<std::vector<std::string>> types;  // one word, or list, count and item type
    };
    std::vector<Element> elements;
    std::size_t at = 0;
    do {
        const std::size_t end = bytes.find('\n', at);
        if (end == std::string::npos) throw std::runtime_error("no end of the header");
        ply.header.push_back(bytes.substr(at, end - at));
        at = end + 1;
        std::istringstream line(ply.header.back());
        std::vector<std::string> words;
        for (std::string word; line >> word;) words.push_back(word);
        if (words.at(0) == "element") {
            elements.push_back({words.at(1), std::stoul(words.at(2)), {}});
            ply.rows[words[1]];
        } else if (words[0] == "property") {
            ply.properties[elements.at(elements.size() - 1).name].push_back(words.back());
            elements.back().types.emplace_back(words.begin() + 1, words.end() - 1);
        }
    } while (ply.header.back() != "end_header");
    if (ply.header[0] != "ply" || ply.header.at(1) != "format binary_little_endian 1.0")
        throw std::runtime_error("another kind of file");
    for (const Element& element : elements)
        for (std::size_t i = 0; i < element.count; ++i) {
            std::vector<double> row;
            for (const auto& type : element.types) {
                if (type.at(0) != "list") {
                    row.push_back(readNumber(bytes, at, type[0]));
                    continue;
                }
                const double items = readNumber(bytes, at, type.at(1));
                for (int k = 0; k < items; ++k) row.push_back(readNumber(bytes, at, type.at(2)));
            }
            ply.rows[element.name].push_back(std::move(row));
        }
    if (at != bytes.size()) throw std::runtime_error("bytes left at the end");
    return ply;
}

}  // namespace igeo::test
