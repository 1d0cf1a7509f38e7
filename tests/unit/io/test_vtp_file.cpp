#include "support/catch.h"

#include <igeo/base/detail/deflate.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/base64.h>
#include <igeo/io/vtp_file.h>

using namespace igeo;

TEST_CASE("base64 gives the bytes back, and refuses what it is not", "[unit][base64]") {
    CHECK(base64("") == "");
    CHECK(base64("f") == "Zg==");  // the vectors of RFC 4648
    CHECK(base64("fooba") == "Zm9vYmE=");
    CHECK(base64("foobar") == "Zm9vYmFy");
    CHECK(fromBase64(" Zm9v\n YmE= ") == "fooba");
    for (const char* bad : {"Zg=", "Z===", "====", "Zg==Zg==", "Z*==", "Zm9v YmE"})
        CHECK_FALSE(fromBase64(bad));
}

TEST_CASE("Compressed bytes come back, also of two gzip members", "[unit][deflate]") {
    std::string text(3000000, 'a');
    for (std::size_t i = 0; i < text.size(); i += 7) text[i] = char(i % 251);
    const std::string small = deflated(text);
    CHECK(small.size() < text.size() / 2);
    CHECK(inflated(small, text.size()) == text);
    CHECK(crc32Of("123456789") == 0xcbf43926);
    CHECK_THROWS_AS(inflated(small, text.size() - 1), Error);
    CHECK_THROWS_AS(inflated(small.substr(0, small.size() / 2), text.size()), Error);
    std::string damaged = small;
    damaged[damaged.size() / 2] = char(damaged[damaged.size() / 2] ^ 0x55);
    CHECK_THROWS_AS(inflated(damaged, text.size()), Error);
    const std::string hello(
        "\x1f\x8b\x08\x00\x00\x00\x00\x00\x02\x03\xcb\x48\xcd\xc9\xc9\x07\x00"
        "\x86\xa6\x10\x36\x05\x00\x00\x00",
        25);  // printf hello | gzip -n9
    CHECK(inflated(hello + hello, 10) == "hellohello");
}

TEST_CASE("A .vtp file refuses data that does not fit", "[unit][vtp]") {
    PolyData shape;
    shape.points = {{0, 0, 0}, {1, 0, 0}};
    shape.lines.add({0, 1});
    shape.data.push_back({"distance", {0, 1}});
    CHECK(vtp(shape).find("NumberOfLines=\"1\"") != std::string::npos);
    shape.data[0].values.pop_back();
    CHECK_THROWS_AS(vtp(shape), Error);
    shape.data[0] = {"<b>", {0, 1}};
    CHECK_THROWS_AS(vtp(shape), Error);
}
