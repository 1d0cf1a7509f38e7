#include <igeo/results/view_page.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace igeo {

namespace {

/// Twice the area.
double areaOf(const SurfaceMesh& mesh) {
    double sum = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        sum +=
            length(cross(mesh.position[b] - mesh.position[a], mesh.position[c] - mesh.position[a]));
    return sum;
}

/// A cube's coordinates, and the octant of a normal.
using Key = std::array<std::int64_t, 4>;

/// Numbers keys from 0 on, in the order of their first use: a hash table with open addressing.
class KeyNumbers {
public:
    explicit KeyNumbers(std::size_t most) {
        std::size_t size = 16;
        while (size < 2 * most) size *= 2;
        table_.assign(size, kFree);
    }
    std::uint32_t numberOf(const Key& key) {
        const std::size_t mask = table_.size() - 1;
        std::size_t at = hashOf(key) & mask;
        while (table_[at] != kFree && keys_[table_[at]] != key) at = (at + 1) & mask;
        if (table_[at] == kFree) {
            table_[at] = std::uint32_t(keys_.size());
            keys_.push_back(key);
        }
        return table_[at];
    }
    std::size_t size() const { return keys_.size(); }

private:
    static constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
    static std::size_t hashOf(const Key& key) {
        std::uint64_t hash = 0;
        for (const std::int64_t k : key)
            hash = (hash ^ std::uint64_t(k)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
        return std::size_t(hash);
    }
    std::vector<std::uint32_t> table_;
    std::vector<Key> keys_;
};

/// Per vertex the number of its cluster: vertices in one cube with normals in one octant, so that
/// the two sides of a thin wall stay separate.
std::size_t clusters(const SurfaceMesh& mesh, double side, std::vector<std::uint32_t>& clusterOf) {
    KeyNumbers numbers(mesh.position.size());
    clusterOf.resize(mesh.position.size());
    for (std::size_t v = 0; v < clusterOf.size(); ++v) {
        const Vec3d p = mesh.position[v] * (1 / side);
        const Vec3f n = mesh.normal[v];
        clusterOf[v] = numbers.numberOf(
            {std::int64_t(std::floor(p.x)), std::int64_t(std::floor(p.y)),
             std::int64_t(std::floor(p.z)), (n.x < 0) | (n.y < 0) << 1 | (n.z < 0) << 2});
    }
    return numbers.size();
}

/// Per cluster the vertex nearest to the mean of its vertices.
std::vector<std::uint32_t> middles(const SurfaceMesh& mesh,
                                   const std::vector<std::uint32_t>& clusterOf, std::size_t count) {
    std::vector<Vec3d> sum(count);
    std::vector<double> size(count), least(count, kInfinity);
    for (std::size_t v = 0; v < clusterOf.size(); ++v)
        sum[clusterOf[v]] += mesh.position[v], size[clusterOf[v]] += 1;
    std::vector<std::uint32_t> middle(count);
    for (std::size_t v = 0; v < clusterOf.size(); ++v) {
        const std::size_t c = clusterOf[v];
        const double away = length(mesh.position[v] - sum[c] * (1 / size[c]));
        if (away < least[c]) least[c] = away, middle[c] = std::uint32_t(v);
    }
    return middle;
}

/// The triangles between three different clusters, each once.
std::vector<SurfaceMesh::Triangle> between(const SurfaceMesh& mesh,
                                           const std::vector<std::uint32_t>& clusterOf) {
    std::vector<SurfaceMesh::Triangle> all;
    for (const auto& t : mesh.triangles) {
        std::array<std::uint32_t, 3> c{clusterOf[t[0]], clusterOf[t[1]], clusterOf[t[2]]};
        if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) continue;
        std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
        all.push_back(c);
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

template <typename T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
    if (values.empty()) return;
    std::vector<T> left;
    left.reserve(kept.size());
    for (const std::uint32_t v : kept) left.push_back(values[v]);
    values.swap(left);
}

}  // namespace

bool thinOut(SurfaceMesh& mesh, std::size_t most, std::vector<std::uint32_t>& kept) {
    kept.clear();
    for (std::uint32_t v = 0; v < mesh.position.size(); ++v) kept.push_back(v);
    if (mesh.triangles.size() <= most) return false;
    // About two triangles per cube, and some more where normals pass from octant to octant.
    double side = 1.27 * std::sqrt(areaOf(mesh) / double(std::max<std::size_t>(most, 1)));
    std::vector<std::uint32_t> clusterOf;
    std::vector<SurfaceMesh::Triangle> left;
    std::size_t count = 0;
    do {
        count = clusters(mesh, side, clusterOf);
        left = between(mesh, clusterOf);
        side *= 1.12;
    } while (left.size() > most);
    kept = middles(mesh, clusterOf, count);
    mesh.triangles = std::move(left);
    keep(mesh.position, kept);
    keep(mesh.normal, kept);
    keep(mesh.distance, kept);
    keep(mesh.label, kept);
    keep(mesh.gradient, kept);
    return true;
}

}  // namespace igeo
