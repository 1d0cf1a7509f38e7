/// Numbers in binary files. Internal.
#pragma once

#include <fmt/core.h>
#include <igeo/base/error.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace igeo {

/// The types of numbers in files.
enum class NumberType { U8, I8, U16, I16, U32, I32, U64, I64, F32, F64 };

inline std::size_t sizeOf(NumberType type) {
    constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return kSizes[std::size_t(type)];
}

/// Reads the bytes of a file from front to back.
class ByteReader {
public:
    /// @param file  its name, for messages; must outlive this, as must the bytes
    ByteReader(const std::string& file, std::string_view bytes, bool bigEndian)
        : file_(file), bytes_(bytes), bigEndian_(bigEndian) {}

    std::size_t left() const { return bytes_.size() - at_; }
    /// @throws Error  BadInput unless `count` items of `size` bytes are left
    void require(std::size_t count, std::size_t size, const char* what) const {
        if (count > left() / size)
            fail(fmt::format("{} {} are announced, and {} bytes are left", count, what, left()));
    }
    void skip(std::size_t count) {
        require(count, 1, "bytes");
        at_ += count;
    }
    /// Skips all up to the next line feed, and the line feed.
    void skipLine() {
        const std::size_t end = bytes_.find('\n', at_);
        if (end == bytes_.npos) fail("a line does not end");
        at_ = end + 1;
    }

    /// The next number, an integer or a floating-point number.
    template <typename T>
    T next() {
        static_assert(sizeof(T) <= 8);
        require(1, sizeof(T), "numbers");
        constexpr bool isBigEndianMachine = std::endian::native == std::endian::big;
        unsigned char raw[sizeof(T)];
        for (std::size_t k = 0; k < sizeof(T); ++k)
            raw[bigEndian_ == isBigEndianMachine ? k : sizeof(T) - 1 - k] =
                static_cast<unsigned char>(bytes_[at_ + k]);
        at_ += sizeof(T);
        T value;
        std::memcpy(&value, raw, sizeof(T));
        return value;
    }
    double next(NumberType type) {
        switch (type) {
            case NumberType::U8:
                return next<std::uint8_t>();
            case NumberType::I8:
                return next<std::int8_t>();
            case NumberType::U16:
                return next<std::uint16_t>();
            case NumberType::I16:
                return next<std::int16_t>();
            case NumberType::U32:
                return next<std::uint32_t>();
            case NumberType::I32:
                return next<std::int32_t>();
            case NumberType::U64:
                return double(next<std::uint64_t>());
            case NumberType::I64:
                return double(next<std::int64_t>());
            case NumberType::F32:
                return double(next<float>());
            case NumberType::F64:
                break;
        }
        return next<double>();
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(Error::Kind::BadInput, fmt::format("{}, byte {}: {}", file_, at_, what),
                    "the file is cut off or broken: write it again");
    }

private:
    const std::string& file_;
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool bigEndian_;
};

}  // namespace igeo
