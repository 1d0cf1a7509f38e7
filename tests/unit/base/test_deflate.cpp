#include <igeo/base/detail/deflate.h>
#include <igeo/io/detail/base64.h>
#include <support/catch.h>
#include <support/expect_error.h>

namespace igeo {
namespace {

using Kind = Error::Kind;

std::string noise(std::size_t size) {
    std::string bytes;
    for (std::size_t k = 0; k < size; ++k) bytes += char((k * k * 2654435761u) >> 13 & 0xff);
    return bytes;
}

TEST_CASE("base64 gives the bytes back", "[deflate]") {
    CHECK(base64("Man") == "TWFu");
    CHECK(base64("Ma") == "TWE=");
    CHECK(base64("M") == "TQ==");
    CHECK(base64("").empty());
    for (const std::size_t size : {0u, 1u, 2u, 3u, 100u, 101u})
        CHECK(fromBase64(base64(noise(size))) == noise(size));
}

TEST_CASE("base64 is read with blanks, and refused with anything else", "[deflate]") {
    CHECK(fromBase64(" TW\r\nE= \t") == "Ma");
    for (const char* bad : {"TW!E", "TWE=TWE=", "T", "TWE", "===="})
        CHECK_FALSE(fromBase64(bad).has_value());
}

TEST_CASE("zlib data are inflated up to a limit, or the start of them", "[deflate]") {
    const std::string bytes = noise(3000000), packed = deflated(bytes);
    CHECK(inflated(packed, bytes.size()) == bytes);
    CHECK(inflatedStart(packed, 1000) == bytes.substr(0, 1000));
    CHECK(inflatedStart(packed, bytes.size() + 5) == bytes);
    CHECK(inflated(deflated(""), 0).empty());
    test::expectError(Kind::BadInput, {"more than 2999999 bytes"},
                      [&] { inflated(packed, bytes.size() - 1); });
}

TEST_CASE("damaged and truncated zlib data are refused", "[deflate]") {
    std::string packed = deflated(noise(5000));
    test::expectError(Kind::BadInput, {"cut off"},
                      [&] { inflated(packed.substr(0, packed.size() / 2), 10000); });
    test::expectError(Kind::BadInput, {"cut off"}, [] { inflated("", 10); });
    test::expectError(Kind::BadInput, {"damaged"}, [] { inflated("no data of zlib", 10); });
    packed[packed.size() / 2] = char(packed[packed.size() / 2] ^ 0x55);
    test::expectError(Kind::BadInput, {"damaged"}, [&] { inflated(packed, 10000); });
}

}  // namespace
}  // namespace igeo
