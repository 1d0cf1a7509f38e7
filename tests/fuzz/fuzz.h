// What the fuzz targets share.
#pragma once

#include <igeo/base/error.h>

#include <unistd.h>
#include <cstdint>
#include <fstream>
#include <string>

namespace igeo::test {

/// Calls f, which may refuse; anything else it throws is found by the fuzzer.
template <typename F>
void mayRefuse(const F& f) {
    try {
        f();
    } catch (const Error&) {
    }
}

/// The bytes as a file whose name has an ending: one per process, written again each time.
inline std::string asFile(const std::uint8_t* data, std::size_t size, const std::string& ending) {
    const std::string name = "/dev/shm/igeo-fuzz-" + std::to_string(::getpid()) + ending;
    std::ofstream(name, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), std::streamsize(size));
    return name;
}

}  // namespace igeo::test
