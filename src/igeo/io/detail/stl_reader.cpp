#include <igeo/io/detail/stl_reader.h>

#include <igeo/io/detail/byte_reader.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/text_mesh_reader.h>

namespace igeo {

std::vector<Vec3d> readStlCorners(const std::string& file, const std::string& bytes) {
    constexpr std::size_t kHeader = 80, kTriangle = 50;
    ByteReader reader(file, bytes, /*bigEndian=*/false);
    std::size_t triangles = 0;
    const bool hasHeader = bytes.size() >= kHeader + sizeof(std::uint32_t);
    if (hasHeader) {
        reader.skip(kHeader);
        triangles = reader.next<std::uint32_t>();
    }
    // Read as a count, four letters would announce more triangles than a text file could hold.
    const bool isWhole = hasHeader && triangles <= reader.left() / kTriangle;
    if (!isWhole && bytes.find('\0') == bytes.npos) return readTextStlCorners(file, bytes);
    if (!hasHeader) reader.fail("this is no STL file");
    reader.require(triangles, kTriangle, "triangles");
    std::vector<Vec3d> corners;
    corners.reserve(3 * triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
        reader.skip(3 * sizeof(float));  // the normal
        for (int k = 0; k < 3; ++k) {
            Vec3d p;
            for (int a = 0; a < 3; ++a) p[a] = double(reader.next<float>());
            corners.push_back(p);
        }
        reader.skip(2);  // attributes
    }
    return corners;
}

}  // namespace igeo
