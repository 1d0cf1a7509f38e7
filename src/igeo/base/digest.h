/// A fingerprint of content: the same for the same bytes, and for no others in practice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace igeo {

/// MurmurHash3 by Appleby, the 128 bits of its x64 variant with seed 0, over bytes that come in
/// pieces. 128 bits, so that of a million files no two agree by chance (1e-27); not a cryptographic
/// hash, since nobody gains by forging a distance, and those are slower than the disks that files
/// of gigabytes come from.
class Digest {
public:
    void add(std::string_view bytes);
    /// Bytes with their number in front: lists of words that differ anywhere differ here.
    void addWord(std::string_view word);

    /// Of all bytes so far: its two halves.
    std::array<std::uint64_t, 2> value() const;
    /// The same as 32 hexadecimal digits.
    std::string hex() const;

private:
    static constexpr std::size_t kBlock = 16;
    void mix(const char* block);

    std::uint64_t a_ = 0, b_ = 0, length_ = 0;
    std::array<char, kBlock> rest_{};  ///< the last length_ % kBlock bytes
};

/// Of a file's bytes, about 3 GB/s from memory; "missing" where no regular file can be read, as who
/// is to use it will say better.
std::string digestOfFile(const std::string& path);

}  // namespace igeo
