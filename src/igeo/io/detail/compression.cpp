#include <igeo/io/detail/compression.h>

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <new>

namespace igeo {

namespace {

constexpr std::string_view kDigits =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::string_view kBlank = " \t\r\n";

/// zlib counts input in 32 bits.
constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max();

const Bytef* bytesOf(std::string_view text) { return reinterpret_cast<const Bytef*>(text.data()); }

/// A stream of zlib's that ends with its block.
class Inflation {
public:
    Inflation() {
        constexpr int kZlibOrGzip = 15 + 32;
        if (inflateInit2(&stream_, kZlibOrGzip) != Z_OK) throw std::bad_alloc();
    }
    ~Inflation() { inflateEnd(&stream_); }
    Inflation(const Inflation&) = delete;
    Inflation& operator=(const Inflation&) = delete;

    /// Takes bytes from the front of `in` and appends what they hold, up to `most` bytes in all.
    /// @return zlib's code
    int step(std::string_view& in, std::string& out, std::size_t most) {
        std::array<char, 1 << 16> part{};
        const std::size_t taken = std::min(in.size(), kMostAtOnce);
        stream_.next_in = const_cast<Bytef*>(bytesOf(in));
        stream_.avail_in = uInt(taken);
        stream_.next_out = reinterpret_cast<Bytef*>(part.data());
        stream_.avail_out = uInt(std::min(part.size(), most - out.size()));
        const uInt room = stream_.avail_out;
        const int code = inflate(&stream_, Z_NO_FLUSH);
        if (code == Z_MEM_ERROR) throw std::bad_alloc();
        in.remove_prefix(taken - stream_.avail_in);
        out.append(part.data(), room - stream_.avail_out);
        return code;
    }
    void restart() { inflateReset(&stream_); }

private:
    z_stream stream_{};
};

}  // namespace

std::optional<std::string> base64Decoded(std::string_view text) {
    std::array<std::int8_t, 256> valueOf{};
    valueOf.fill(-1);
    for (std::size_t k = 0; k < kDigits.size(); ++k)
        valueOf[static_cast<unsigned char>(kDigits[k])] = std::int8_t(k);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    unsigned count = 0;
    bool ended = false;
    for (const char c : text) {
        if (kBlank.find(c) != kBlank.npos) continue;
        const std::int8_t value = valueOf[static_cast<unsigned char>(c)];
        ended |= c == '=';
        if ((value < 0 && c != '=') || (ended && c != '=')) return std::nullopt;
        if (ended) continue;
        bits = bits << 6 | std::uint32_t(value);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += char(bits >> count & 0xff);
    }
    // A single digit left over holds no byte.
    if (count == 6) return std::nullopt;
    return bytes;
}

std::string base64Encoded(std::string_view bytes) {
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t k = 0; k < bytes.size(); k += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - k);
        std::uint32_t bits = 0;
        for (std::size_t b = 0; b < 3; ++b)
            bits = bits << 8 | (b < count ? static_cast<unsigned char>(bytes[k + b]) : 0u);
        for (std::size_t d = 0; d < 4; ++d)
            text += d <= count ? kDigits[bits >> (18 - 6 * d) & 63] : '=';
    }
    return text;
}

bool isGzip(std::string_view bytes) { return bytes.substr(0, 2) == "\x1f\x8b"; }

std::optional<std::string> inflated(std::string_view bytes, std::size_t most) {
    std::string out;
    Inflation inflation;
    while (out.size() < most) {
        const std::size_t left = bytes.size(), made = out.size();
        const int code = inflation.step(bytes, out, most);
        if (code == Z_STREAM_END) {
            // gzip files may hold several members; what follows the last is filling.
            if (!isGzip(bytes)) return out;
            inflation.restart();
        } else if (code != Z_OK || (bytes.size() == left && out.size() == made)) {
            return std::nullopt;
        }
    }
    return out;
}

std::string deflated(std::string_view bytes) {
    z_stream stream{};
    if (deflateInit(&stream, Z_DEFAULT_COMPRESSION) != Z_OK) throw std::bad_alloc();
    std::string out;
    std::array<char, 1 << 16> part{};
    for (int code = Z_OK; code != Z_STREAM_END;) {
        const std::size_t taken = std::min(bytes.size(), kMostAtOnce);
        stream.next_in = const_cast<Bytef*>(bytesOf(bytes));
        stream.avail_in = uInt(taken);
        stream.next_out = reinterpret_cast<Bytef*>(part.data());
        stream.avail_out = uInt(part.size());
        code = deflate(&stream, taken == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
        bytes.remove_prefix(taken - stream.avail_in);
        out.append(part.data(), part.size() - stream.avail_out);
    }
    deflateEnd(&stream);
    return out;
}

}  // namespace igeo
