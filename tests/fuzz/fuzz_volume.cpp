// Volumes: NIfTI in one file and as a pair, MGH, and NRRD.
#include <igeo/io/detail/mgh_reader.h>
#include <igeo/io/detail/nifti_reader.h>
#include <igeo/io/detail/nrrd_reader.h>

#include <algorithm>

#include "fuzz.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    igeo::test::mayRefuse([&] { igeo::niftiFrom("f.nii", bytes, ""); });
    igeo::test::mayRefuse([&] { igeo::mghFrom("f.mgz", bytes); });
    igeo::test::mayRefuse([&] { igeo::readNrrd("f.nrrd", bytes); });
    const std::size_t header = std::min<std::size_t>(size, 348);
    igeo::test::mayRefuse(
        [&] { igeo::niftiFrom("f.hdr", bytes.substr(0, header), bytes.substr(header)); });
    return 0;
}
