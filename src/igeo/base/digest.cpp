#include <igeo/base/digest.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

namespace igeo {

namespace {

constexpr std::uint64_t kFirst = 0x87c37b91114253d5, kSecond = 0x4cf5ad432745937f;

std::uint64_t rotated(std::uint64_t v, int bits) { return v << bits | v >> (64 - bits); }

/// On a little-endian machine; elsewhere digests would be others, as good as these.
std::uint64_t wordAt(const char* bytes, std::size_t count) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, count);
    return word;
}

std::uint64_t scrambledFirst(std::uint64_t k) { return rotated(k * kFirst, 31) * kSecond; }
std::uint64_t scrambledSecond(std::uint64_t k) { return rotated(k * kSecond, 33) * kFirst; }

/// Every bit of the result depends on every bit of `v`.
std::uint64_t finished(std::uint64_t v) {
    v = (v ^ v >> 33) * 0xff51afd7ed558ccd;
    v = (v ^ v >> 33) * 0xc4ceb9fe1a85ec53;
    return v ^ v >> 33;
}

}  // namespace

void Digest::mix(const char* block) {
    a_ ^= scrambledFirst(wordAt(block, 8));
    a_ = (rotated(a_, 27) + b_) * 5 + 0x52dce729;
    b_ ^= scrambledSecond(wordAt(block + 8, 8));
    b_ = (rotated(b_, 31) + a_) * 5 + 0x38495ab5;
}

void Digest::add(std::string_view bytes) {
    const std::size_t held = length_ % kBlock;
    length_ += bytes.size();
    if (held > 0) {
        const std::size_t taken = std::min(bytes.size(), kBlock - held);
        std::memcpy(rest_.data() + held, bytes.data(), taken);
        bytes.remove_prefix(taken);
        if (held + taken < kBlock) return;
        mix(rest_.data());
    }
    for (; bytes.size() >= kBlock; bytes.remove_prefix(kBlock)) mix(bytes.data());
    std::copy(bytes.begin(), bytes.end(), rest_.begin());
}

void Digest::addWord(std::string_view word) {
    add(std::to_string(word.size()) + ":");
    add(word);
}

std::array<std::uint64_t, 2> Digest::value() const {
    std::uint64_t a = a_, b = b_;
    const std::size_t held = length_ % kBlock;
    if (held > 8) b ^= scrambledSecond(wordAt(rest_.data() + 8, held - 8));
    if (held > 0) a ^= scrambledFirst(wordAt(rest_.data(), std::min<std::size_t>(held, 8)));
    a ^= length_, b ^= length_;
    a += b, b += a;
    a = finished(a), b = finished(b);
    a += b, b += a;
    return {a, b};
}

std::string Digest::hex() const {
    const auto [a, b] = value();
    std::array<char, 33> text{};
    std::snprintf(text.data(), text.size(), "%016llx%016llx", static_cast<unsigned long long>(a),
                  static_cast<unsigned long long>(b));
    return text.data();
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
