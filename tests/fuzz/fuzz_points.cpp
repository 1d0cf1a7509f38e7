// Seeds, curves and pairs, as JSON and as text; the first byte says which.
#include <igeo/io/point_list.h>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string file = igeo::test::asFile(data + 1, size - 1, data[0] & 1 ? ".json" : ".csv");
    igeo::test::mayRefuse([&] { igeo::readSeeds(file); });
    igeo::test::mayRefuse([&] { igeo::readCurves(file); });
    igeo::test::mayRefuse([&] { igeo::readAskedCurves(file); });
    igeo::test::mayRefuse([&] { igeo::readPairs(file); });
    return 0;
}
