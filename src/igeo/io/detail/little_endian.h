/// Little-endian bytes for binary PLY files.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace igeo {

/// Appends the bytes of a number, lowest first, whatever the order of the machine.
template <typename T>
void putLittleEndian(std::string& bytes, T value) {
    static_assert(sizeof(T) == 1 || sizeof(T) == 4, "what PLY files here hold");
    if constexpr (sizeof(T) == 1) {
        bytes += char(value);
    } else {
        std::uint32_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        for (int shift = 0; shift < 32; shift += 8) bytes += char(bits >> shift & 0xff);
    }
}

}  // namespace igeo
