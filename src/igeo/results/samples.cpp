#include <igeo/results/samples.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/parallel.h>
#include <igeo/results/detail/npy.h>
#include <igeo/results/detail/ply_writer.h>

#include <utility>

namespace igeo {

namespace {

/// Whether an earlier node has the same foot point, to the precision of both.
bool isRepeated(const Band& band, NodeIndex i) {
    constexpr double kSame = 1e-5;  // voxels
    bool found = false;
    const Vec3d p = band.footPoint(i);
    band.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        found = found || (j < i && length(band.footPoint(j) - p) < kSame && band.inCore(j) &&
                          band.linked(i, j));
    });
    return found;
}

std::vector<NodeIndex> sampledNodes(const Band& band) {
    std::vector<std::uint8_t> isSample(band.size());
    parallelFor(band.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            isSample[i] = band.inCore(NodeIndex(i)) && !isRepeated(band, NodeIndex(i));
    });
    std::vector<NodeIndex> nodes;
    for (std::size_t i = 0; i < isSample.size(); ++i)
        if (isSample[i]) nodes.push_back(NodeIndex(i));
    return nodes;
}

template <typename T>
std::string npyOfVectors(const std::vector<Vec3<T>>& vectors) {
    std::vector<double> numbers;
    numbers.reserve(3 * vectors.size());
    for (const Vec3<T>& v : vectors)
        numbers.insert(numbers.end(), {double(v.x), double(v.y), double(v.z)});
    return npy(numbers, fmt::format("({}, 3)", vectors.size()));
}

}  // namespace

Samples samplesOf(const Field& field) {
    if (!field.atFootPoints)
        throw Error(Error::Kind::InvalidArgument,
                    "samples are what jet finds at foot points, and the scheme is " + field.scheme,
                    "march with jet");
    const Band& band = *field.band;
    const Similarity& t = band.transform;
    const std::vector<NodeIndex> nodes = sampledNodes(band);
    Samples s;
    s.position.resize(nodes.size()), s.normal.resize(nodes.size());
    s.distance.assign(nodes.size(), kInfinity), s.gradient.resize(nodes.size());
    s.label.assign(nodes.size(), -1);
    parallelFor(nodes.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            const NodeIndex i = nodes[k];
            s.position[k] = t.worldFromIndex(band.footPoint(i));
            s.normal[k] = Vec3f(t.worldFromIndexDirection(Vec3d(band.normal[i])));
            const NodeJet jet = field.at(i);
            if (!(jet.distance < kInfinity)) continue;
            const bool isNegative = !field.sign.empty() && field.sign[i] < 0;
            s.distance[k] = (isNegative ? -t.dx : t.dx) * jet.distance;
            s.gradient[k] = Vec3f(t.worldFromIndexDirection(Vec3d(jet.gradient)));
            s.label[k] = std::int32_t(jet.label);
        }
    });
    return s;
}

std::string samplesCsv(const Samples& s) {
    std::string text = "x,y,z,nx,ny,nz,distance,gx,gy,gz,label\n";
    for (std::size_t k = 0; k < s.position.size(); ++k) {
        const Vec3d& p = s.position[k];
        const Vec3f &n = s.normal[k], &g = s.gradient[k];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", p.x, p.y, p.z, n.x, n.y, n.z,
                            s.distance[k], g.x, g.y, g.z, s.label[k]);
    }
    return text;
}

std::string samplesNpz(const Samples& s) {
    const std::string shape = fmt::format("({},)", s.position.size());
    return npz({{"position", npyOfVectors(s.position)},
                {"normal", npyOfVectors(s.normal)},
                {"distance", npy(s.distance, shape)},
                {"gradient", npyOfVectors(s.gradient)},
                {"label", npy(s.label, shape)}});
}

std::string samplesPly(const Samples& s) {
    using Type = PlyProperty::Type;
    PlyWriter ply("foot points, world units; distance -1: not reached", s.position.size());
    auto distance = [&](std::size_t k) { return s.label[k] < 0 ? -1 : s.distance[k]; };
    ply.addVector(Type::Double, {"x", "y", "z"}, [&](std::size_t k) { return s.position[k]; });
    ply.addVector(Type::Float, {"nx", "ny", "nz"},
                  [&](std::size_t k) { return Vec3d(s.normal[k]); });
    ply.add(Type::Double, "distance", distance);
    ply.add(Type::Float, "quality", distance);
    ply.addVector(Type::Float, {"gx", "gy", "gz"},
                  [&](std::size_t k) { return Vec3d(s.gradient[k]); });
    ply.add(Type::Int, "label", [&](std::size_t k) { return s.label[k]; });
    return ply.bytes();
}

}  // namespace igeo
