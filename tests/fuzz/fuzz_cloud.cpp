// Clouds of points as text, as .pwn and as lines of .obj; the first byte says which.
#include <igeo/io/point_cloud_file.h>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string file = igeo::test::asFile(data + 1, size - 1,
                                                data[0] % 3 == 0   ? ".pwn"
                                                : data[0] % 3 == 1 ? ".obj"
                                                                   : ".xyz");
    igeo::test::mayRefuse([&] { igeo::readPointCloud(file); });
    return 0;
}
