// Meshes of brains: GIFTI, FreeSurfer and mz3.
#include <igeo/io/detail/brain_mesh_reader.h>
#include <igeo/io/detail/gifti_reader.h>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    igeo::test::mayRefuse([&] { igeo::readGiftiMesh("f.gii", bytes); });
    igeo::test::mayRefuse([&] { igeo::readFreeSurferMesh("lh.f", bytes); });
    igeo::test::mayRefuse([&] { igeo::readMz3Mesh("f.mz3", bytes); });
    return 0;
}
