// Numbers and points of the command line.
#include <igeo/io/point_list.h>

#include <cmath>
#include <cstdlib>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text(reinterpret_cast<const char*>(data), size);
    for (const double v : igeo::parseNumbers(text))
        if (!std::isfinite(v)) std::abort();
    igeo::test::mayRefuse([&] { igeo::parsePoint(text); });
    return 0;
}
