/// A fingerprint of content: the same for the same bytes, and for no others in practice.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace igeo {

/// The 128 bits of XXH3 by Collet with seed 0, over bytes that come in pieces: of a million files
/// no two agree by chance (1e-27). Not a cryptographic hash, since no one gains by forging a
/// distance, and those are slower than the disks that files of gigabytes come from.
class Digest {
public:
    Digest();

    void add(std::string_view bytes);
    /// Bytes with their number in front: lists of words that differ anywhere differ here.
    void addWord(std::string_view word);

    /// Of all bytes so far: its two halves, the higher first.
    std::array<std::uint64_t, 2> value() const;
    /// The same as 32 hexadecimal digits, as `xxhsum -H2` prints them.
    std::string hex() const;

private:
    struct State;
    struct Free {
        void operator()(State* state) const;
    };
    std::unique_ptr<State, Free> state_;
};

/// Of a file's bytes, as fast as memory gives them; "missing" where no regular file can be read, as
/// who is to use it will say better.
std::string digestOfFile(const std::string& path);

}  // namespace igeo
