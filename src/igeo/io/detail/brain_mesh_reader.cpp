#include <igeo/io/detail/brain_mesh_reader.h>

#include <fmt/core.h>
#include <igeo/io/detail/byte_reader.h>

#include <array>

namespace igeo {

namespace {

using namespace std::string_view_literals;
constexpr std::string_view kQuads = "\xff\xff\xfd"sv, kTriangles = "\xff\xff\xfe"sv,
                           kOldQuads = "\xff\xff\xff"sv;

constexpr std::size_t kTriple = 12;  // bytes of three numbers

Vec3d position(ByteReader& reader) {
    Vec3d p;
    for (int a = 0; a < 3; ++a) p[a] = double(reader.next<float>());
    return p;
}

std::uint32_t next24(ByteReader& reader) {
    const std::uint32_t high = reader.next<std::uint8_t>();
    return high << 16 | reader.next<std::uint16_t>();
}

/// Reads the part of a quadrangle file after its first bytes.
/// @param isOld  positions are whole hundredths of a millimeter
PolygonMesh readQuads(ByteReader& reader, bool isOld) {
    const std::size_t vertices = next24(reader), faces = next24(reader);
    constexpr std::size_t kCornerBytes = 3;
    const std::size_t each = isOld ? 3 * sizeof(std::int16_t) : kTriple;
    if (reader.left() / each < vertices ||
        (reader.left() - each * vertices) / (4 * kCornerBytes) < faces)
        reader.fail(
            fmt::format("{} vertices and {} quadrangles do not fit: this is cut off, or no "
                        "surface, as values per vertex are none",
                        vertices, faces));
    PolygonMesh mesh;
    for (std::size_t v = 0; v < vertices; ++v) {
        mesh.vertices.emplace_back();
        for (int a = 0; a < 3; ++a)
            mesh.vertices.back()[a] =
                isOld ? reader.next<std::int16_t>() / 100.0 : double(reader.next<float>());
    }
    for (std::size_t f = 0; f < faces; ++f) {
        std::array<std::uint32_t, 4> face{};
        for (std::uint32_t& corner : face) {
            corner = next24(reader);
            if (corner >= vertices)
                reader.fail(fmt::format("a face names vertex {} of {}", corner, vertices));
        }
        mesh.addFace(face);
    }
    return mesh;
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

bool isFreeSurferSurface(std::string_view bytes) {
    return bytes.starts_with(kTriangles) || bytes.starts_with(kQuads) ||
           bytes.starts_with(kOldQuads);
}

PolygonMesh readFreeSurferMesh(const std::string& file, const std::string& bytes) {
    ByteReader reader(file, bytes, /*bigEndian=*/true);
    if (!isFreeSurferSurface(bytes))
        reader.fail("this is no surface of FreeSurfer, which begins with ff ff fd, fe or ff");
    reader.skip(kTriangles.size());
    if (!bytes.starts_with(kTriangles)) return readQuads(reader, bytes.starts_with(kOldQuads));
    // Author and date.
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
    // Faces precede vertices.
    PolygonMesh mesh;
    readFaces(reader, faces, vertices, mesh);
    readVertices(reader, vertices, mesh);
    return mesh;
}

}  // namespace igeo
