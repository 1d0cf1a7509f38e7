#include <igeo/base/digest.h>
#include <support/catch.h>
#include <support/temp_dir.h>

#include <fstream>
#include <set>

using igeo::Digest;

namespace {

std::string digestOf(const std::string& bytes) {
    Digest digest;
    digest.add(bytes);
    return digest.hex();
}

}  // namespace

TEST_CASE("Digest: the 128 bits of XXH3, as xxhsum -H2 0.8.1 prints them") {
    CHECK(digestOf("") == "99aa06d3014798d86001c324468d497f");
    CHECK(digestOf("The quick brown fox jumps over the lazy dog") ==
          "ddd650205ca3e7fa24a1cc2e3a8a7651");
    CHECK(digestOf("The quick brown fox jumps over the lazy cog") ==
          "ebbf680882ee26a0c6d1c36eaa33e913");
}

TEST_CASE("Digest: bytes in pieces are the same bytes") {
    std::string bytes;
    for (int k = 0; k < 700; ++k) bytes += char(17 * k);
    for (std::size_t piece = 1; piece < 40; ++piece) {
        Digest digest;
        for (std::size_t k = 0; k < bytes.size(); k += piece) digest.add(bytes.substr(k, piece));
        INFO("pieces of " << piece);
        CHECK(digest.hex() == digestOf(bytes));
    }
}

TEST_CASE("Digest: any bit changes it, any length, and where words end") {
    std::set<std::string> seen;
    std::string bytes(33, '\0');
    for (std::size_t n = 0; n <= bytes.size(); ++n) seen.insert(digestOf(bytes.substr(0, n)));
    CHECK(seen.size() == bytes.size() + 1);
    for (std::size_t k = 0; k < 8 * bytes.size(); ++k) {
        std::string other = bytes;
        other[k / 8] = char(1 << k % 8);
        seen.insert(digestOf(other));
    }
    CHECK(seen.size() == 9 * bytes.size() + 1);

    Digest one, two;
    one.addWord("ab"), one.addWord("c");
    two.addWord("a"), two.addWord("bc");
    CHECK(one.hex() != two.hex());
}

TEST_CASE("digestOfFile: the content, wherever it is") {
    const igeo::test::TempDir folder;
    CHECK(igeo::digestOfFile(folder / "none") == "missing");
    CHECK(igeo::digestOfFile(folder.path().string()) == "missing");
    const std::string bytes(3 * (1 << 20) + 5, 'x');  // more than one buffer
    CHECK(digestOf(bytes) == "98a8ff0b4e112e62112b3fdfe4eedd1e");
    for (const char* name : {"a", "b"}) std::ofstream(folder / name) << bytes;
    CHECK(igeo::digestOfFile(folder / "a") == digestOf(bytes));
    CHECK(igeo::digestOfFile(folder / "b") == digestOf(bytes));
}
