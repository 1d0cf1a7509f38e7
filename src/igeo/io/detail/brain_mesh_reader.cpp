#include <igeo/io/detail/brain_mesh_reader.h>

#include <fmt/core.h>
#include <igeo/io/detail/byte_reader.h>

#include <array>

namespace igeo {

namespace {

constexpr std::size_t kTriple = 12;  // bytes of three numbers

Vec3d position(ByteReader& reader) {
    Vec3d p;
    for (int a = 0; a < 3; ++a) p[a] = double(reader.next<float>());
    return p;
}

void readVertices(ByteReader& reader, std::size_t count, PolygonMesh& mesh) {
    reader.require(count, kTriple, "vertices");
    for (std::size_t v = 0; v < count; ++v) mesh.vertices.push_back(position(reader));
}

void readFaces(ByteReader& reader, std::size_t count, std::size_t vertices, PolygonMesh& mesh) {
    reader.require(count, kTriple, "faces");
    for (std::size_t f = 0; f < count; ++f) {
        std::array<std::uint32_t, 3> face{};
        for (std::uint32_t& corner : face) {
            corner = reader.next<std::uint32_t>();
            if (corner >= vertices)
                reader.fail(fmt::format("a face names vertex {} of {}", corner, vertices));
        }
        mesh.addFace(face);
    }
}

}  // namespace

bool isFreeSurferSurface(std::string_view bytes) { return bytes.starts_with("\xff\xff\xfe"); }

PolygonMesh readFreeSurferMesh(const std::string& file, const std::string& bytes) {
    ByteReader reader(file, bytes, /*bigEndian=*/true);
    if (!isFreeSurferSurface(bytes))
        reader.fail("this is no triangle file of FreeSurfer, which begins with ff ff fe");
    reader.skip(3);
    // Who made it and when.
    reader.skipLine();
    reader.skipLine();
    const auto vertices = reader.next<std::uint32_t>(), faces = reader.next<std::uint32_t>();
    PolygonMesh mesh;
    readVertices(reader, vertices, mesh);
    readFaces(reader, faces, vertices, mesh);
    return mesh;
}

PolygonMesh readMz3Mesh(const std::string& file, const std::string& bytes) {
    constexpr std::uint16_t kMagic = 0x5A4D, kHasFaces = 1, kHasVertices = 2;
    ByteReader reader(file, bytes, /*bigEndian=*/false);
    if (reader.next<std::uint16_t>() != kMagic)
        reader.fail("this is no .mz3 file, which begins with MZ");
    const auto holds = reader.next<std::uint16_t>();
    const auto faces = reader.next<std::uint32_t>(), vertices = reader.next<std::uint32_t>();
    reader.skip(reader.next<std::uint32_t>());
    if (!(holds & kHasFaces) || !(holds & kHasVertices))
        reader.fail(fmt::format("the file holds no {}; give the one that has vertices and faces",
                                holds & kHasFaces ? "vertices" : "faces"));
    // Faces come first.
    PolygonMesh mesh;
    readFaces(reader, faces, vertices, mesh);
    readVertices(reader, vertices, mesh);
    return mesh;
}

}  // namespace igeo
