// Values per vertex; the first byte says of which kind of file.
#include <igeo/io/vertex_data_file.h>

#include <array>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    constexpr std::array<const char*, 5> kEndings{".gii", ".csv", ".npy", ".label", ".curv"};
    const std::string file =
        igeo::test::asFile(data + 1, size - 1, kEndings[data[0] % kEndings.size()]);
    igeo::test::mayRefuse([&] { igeo::readVertexData(file, 4); });
    return 0;
}
