#include <igeo/base/digest.h>

#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <vector>

// Compiled in, so that users of libigeo.a and the program need no libxxhash.
#define XXH_INLINE_ALL
#include <xxhash.h>

namespace igeo {

struct Digest::State {
    XXH3_state_t of;
};

void Digest::Free::operator()(State* state) const { delete state; }

Digest::Digest() : state_(new State) { XXH3_128bits_reset(&state_->of); }

void Digest::add(std::string_view bytes) {
    XXH3_128bits_update(&state_->of, bytes.data(), bytes.size());
}

void Digest::addWord(std::string_view word) {
    add(fmt::format("{}:", word.size()));
    add(word);
}

std::array<std::uint64_t, 2> Digest::value() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_->of);
    return {hash.high64, hash.low64};
}

std::string Digest::hex() const {
    const auto [high, low] = value();
    return fmt::format("{:016x}{:016x}", high, low);
}

std::string digestOfFile(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return "missing";
    std::ifstream file(path, std::ios::binary);
    std::vector<char> buffer(1 << 20);
    Digest digest;
    while (file.read(buffer.data(), std::streamsize(buffer.size())), file.gcount() > 0)
        digest.add({buffer.data(), std::size_t(file.gcount())});
    return file.eof() ? digest.hex() : "missing";
}

}  // namespace igeo
