/// Little-endian bytes for binary files.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

namespace igeo {

/// Appends the bytes of a number, lowest first, whatever the order of the machine.
template <typename T>
void putLittleEndian(std::string& bytes, T value) {
    static_assert(sizeof(T) == 1 || sizeof(T) == 2 || sizeof(T) == 4 || sizeof(T) == 8);
    if constexpr (sizeof(T) == 1) {
        bytes += char(value);
    } else {
        std::conditional_t<sizeof(T) == 8, std::uint64_t,
                           std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint16_t>>
            bits;
        std::memcpy(&bits, &value, sizeof bits);
        for (unsigned shift = 0; shift < 8 * sizeof bits; shift += 8)
            bytes += char(bits >> shift & 0xff);
    }
}

}  // namespace igeo
