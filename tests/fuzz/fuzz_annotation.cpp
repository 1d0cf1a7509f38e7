// Regions of FreeSurfer's .annot files.
#include <igeo/io/annotation_file.h>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    igeo::test::mayRefuse([&] { igeo::annotationFrom("lh.annot", bytes); });
    return 0;
}
