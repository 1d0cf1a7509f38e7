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

TEST_CASE("Digest: the published values of MurmurHash3, x64, 128 bits, seed 0") {
    CHECK(digestOf("") == "00000000000000000000000000000000");
    CHECK(digestOf("The quick brown fox jumps over the lazy dog") ==
          "e34bbc7bbc071b6c7a433ca9c49a9347");
    CHECK(digestOf("The quick brown fox jumps over the lazy cog") ==
          "658ca970ff85269a43fee3eaa68e5c3e");
}

TEST_CASE("Digest: bytes in pieces are the same bytes") {
    std::string bytes;
    for (int k = 0; k < 100; ++k) bytes += char(17 * k);
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
    for (const char* name : {"a", "b"}) std::ofstream(folder / name) << bytes;
    CHECK(igeo::digestOfFile(folder / "a") == digestOf(bytes));
    CHECK(igeo::digestOfFile(folder / "b") == digestOf(bytes));
}
