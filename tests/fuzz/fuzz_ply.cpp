// PLY files, as meshes and as points.
#include <igeo/io/detail/ply_reader.h>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    igeo::test::mayRefuse([&] { igeo::readPlyFaces("f.ply", bytes); });
    igeo::test::mayRefuse([&] { igeo::readPlyPoints("f.ply", bytes); });
    return 0;
}
