#include <igeo/io/detail/compression.h>

#include "support/catch.h"

using namespace igeo;

namespace {

std::string noise(std::size_t size) {
    std::string bytes;
    for (std::size_t k = 0; k < size; ++k) bytes += char((k * k * 2654435761u) >> 13 & 0xff);
    return bytes;
}

}  // namespace

TEST_CASE("base64 gives the bytes back", "[compression]") {
    CHECK(base64Encoded("Man") == "TWFu");
    CHECK(base64Encoded("Ma") == "TWE=");
    CHECK(base64Encoded("M") == "TQ==");
    CHECK(base64Encoded("").empty());
    for (const std::size_t size : {0u, 1u, 2u, 3u, 100u, 101u})
        CHECK(base64Decoded(base64Encoded(noise(size))) == noise(size));
}

TEST_CASE("base64 is read with blanks and without padding, and refused with anything else",
          "[compression]") {
    CHECK(base64Decoded(" TW\r\nE \t") == "Ma");
    CHECK(base64Decoded("TWE") == "Ma");
    CHECK_FALSE(base64Decoded("TW!E"));
    CHECK_FALSE(base64Decoded("TWE=TWE"));
    CHECK_FALSE(base64Decoded("T"));
}

TEST_CASE("zlib data are inflated up to a bound", "[compression]") {
    const std::string bytes = noise(200000), packed = deflated(bytes);
    CHECK(inflated(packed, bytes.size() + 1) == bytes);
    CHECK(inflated(packed, 1000) == bytes.substr(0, 1000));
    CHECK(inflated(deflated(""), 10) == "");
}

TEST_CASE("damaged and truncated zlib data are refused", "[compression]") {
    std::string packed = deflated(noise(5000));
    CHECK_FALSE(inflated(packed.substr(0, packed.size() / 2), 10000));
    CHECK_FALSE(inflated("", 10));
    CHECK_FALSE(inflated("no data of zlib", 10));
    packed[packed.size() / 2] = char(packed[packed.size() / 2] ^ 0x55);
    CHECK_FALSE(inflated(packed, 10000));
}
