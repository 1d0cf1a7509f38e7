// Meshes as text: OBJ, OFF and STL.
#include <igeo/io/detail/text_mesh_reader.h>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    igeo::test::mayRefuse([&] { igeo::readObjMesh("f.obj", bytes); });
    igeo::test::mayRefuse([&] { igeo::readOffMesh("f.off", bytes); });
    igeo::test::mayRefuse([&] { igeo::readTextStlCorners("f.stl", bytes); });
    return 0;
}
