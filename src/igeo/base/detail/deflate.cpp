#include <igeo/base/detail/deflate.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <zlib.h>

#include <algorithm>
#include <limits>

namespace igeo {

namespace {

/// The number of bytes that one call of zlib can take.
uInt chunkOf(std::size_t bytes) {
    return uInt(std::min<std::size_t>(bytes, std::numeric_limits<uInt>::max()));
}

// zlib reads through pointers that are not const.
Bytef* bytesOf(std::string_view text) {
    return reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
}

struct Inflater {
    z_stream stream{};
    Inflater() {
        constexpr int kZlibOrGzip = 15 + 32;
        if (inflateInit2(&stream, kZlibOrGzip) != Z_OK) throw std::bad_alloc();
    }
    ~Inflater() { inflateEnd(&stream); }
    Inflater(const Inflater&) = delete;
    Inflater& operator=(const Inflater&) = delete;
};

}  // namespace

std::string deflated(std::string_view bytes, int level) {
    uLongf size = compressBound(uLong(bytes.size()));
    std::string out(size, '\0');
    if (compress2(bytesOf(out), &size, bytesOf(bytes), uLong(bytes.size()), level) != Z_OK)
        throw std::bad_alloc();
    out.resize(size);
    return out;
}

namespace {

/// @param isStart  cuts the result at the limit, instead of throwing an error
std::string inflatedUpTo(std::string_view bytes, std::size_t limit, bool isStart) {
    Inflater inflater;
    z_stream& z = inflater.stream;
    std::string out;
    constexpr std::size_t kStep = 1 << 20;
    while (true) {
        const std::size_t old = out.size();
        out.resize(
            old +
            std::min(kStep, limit - old + 1));  // one byte more shows that the result is too long
        z.next_in = bytesOf(bytes), z.avail_in = chunkOf(bytes.size());
        z.next_out = bytesOf(out) + old, z.avail_out = uInt(out.size() - old);
        const std::size_t given = z.avail_in;
        const int status = inflate(&z, Z_NO_FLUSH);
        bytes.remove_prefix(given - z.avail_in);
        out.resize(out.size() - z.avail_out);
        if (out.size() > limit && isStart) {
            out.resize(limit);
            return out;
        }
        if (out.size() > limit)
            throw Error(Error::Kind::BadInput,
                        fmt::format("the compressed data holds more than {} bytes", limit));
        if (status == Z_STREAM_END) {
            const bool member = bytes.substr(0, 2) == "\x1f\x8b";
            if (!member) return out;
            inflateReset(&z);
        } else if (status == Z_MEM_ERROR) {
            throw std::bad_alloc();
        } else if (status != Z_OK) {
            throw Error(Error::Kind::BadInput,
                        status == Z_BUF_ERROR && bytes.empty() ? "the compressed data is cut off"
                                                               : "the compressed data is damaged",
                        "get the file again");
        }
    }
}

}  // namespace

std::string inflated(std::string_view bytes, std::size_t limit) {
    return inflatedUpTo(bytes, limit, false);
}

std::string inflatedStart(std::string_view bytes, std::size_t most) {
    return inflatedUpTo(bytes, most, true);
}

unsigned long crc32Of(std::string_view bytes) {
    uLong crc = crc32(0, nullptr, 0);
    while (!bytes.empty()) {
        const uInt n = chunkOf(bytes.size());
        crc = crc32(crc, bytesOf(bytes), n);
        bytes.remove_prefix(n);
    }
    return crc;
}

}  // namespace igeo
