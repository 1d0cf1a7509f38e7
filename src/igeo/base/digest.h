/// A fingerprint of content: equal for equal bytes, and in practice different for all others.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace igeo {

/// The 128 bits of XXH3 by Collet with seed 0, over bytes added in parts: the chance that two of a
/// million files agree is 1e-27. It is not a cryptographic hash. Those are slower than disks, and
/// forged distances are no threat.
class Digest {
public:
    Digest();

    void add(std::string_view bytes);
    /// Adds bytes preceded by their number, so that different lists of words have different
    /// digests.
    void addWord(std::string_view word);

    /// The digest of all bytes so far: its two halves, the higher first.
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

/// The digest of a file's bytes, at the speed of memory; "missing" where no regular file can be
/// read, because the reader of the file reports that better.
std::string digestOfFile(const std::string& path);

}  // namespace igeo
