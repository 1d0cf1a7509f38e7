#include <igeo/io/data_files.h>
#include <igeo/io/volume_file.h>
#include <support/binary.h>
#include <support/catch.h>
#include <support/expect_error.h>
#include <support/temp_dir.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>

namespace igeo {
namespace {

using Kind = Error::Kind;
using test::bytesOf;
using test::expectError;
using test::gzipped;
using test::TempDir;

/// 2 x 3 x 4 numbers from 0 on.
std::vector<float> counted() {
    std::vector<float> values(24);
    std::iota(values.begin(), values.end(), 0.0f);
    return values;
}

/// A header of NIfTI, 0 where nothing is put.
class Header {
public:
    Header(int version, bool bigEndian = false)
        : bytes_(version == 1 ? 352 : 544, '\0'), version_(version), big_(bigEndian) {
        put<std::int32_t>(0, version == 1 ? 348 : 540);
        const std::string magic = version == 1 ? "n+1" : "n+2";
        bytes_.replace(version == 1 ? 344 : 4, 3, magic);
        for (const int d : {3, 2, 3, 4, 1, 1, 1, 1}) dims_.push_back(d);
        datatype(16);
        number(108, 168, version == 1 ? 352 : 544, /*isOffset=*/true);
    }
    template <typename T>
    void put(std::size_t at, T value) {
        bytes_.replace(at, sizeof(T), bytesOf(std::vector<T>{value}, big_));
    }
    void number(std::size_t in1, std::size_t in2, double value, bool isOffset = false) {
        if (version_ == 1)
            put(in1, float(value));
        else if (isOffset)
            put(in2, std::int64_t(value));
        else
            put(in2, value);
    }
    void code(std::size_t in1, std::size_t in2, int value) {
        if (version_ == 1)
            put(in1, std::uint16_t(value));
        else
            put(in2, std::int32_t(value));
    }
    void datatype(int type) { put(version_ == 1 ? 70u : 12u, std::uint16_t(type)); }
    void dim(std::size_t d, int n) { dims_[d] = n; }
    void pixdim(std::size_t d, double v) { number(76 + 4 * d, 104 + 8 * d, v); }
    void sform(const std::vector<double>& rows) {
        code(254, 348, 1);
        for (std::size_t k = 0; k < 12; ++k) number(280 + 4 * k, 400 + 8 * k, rows[k]);
    }
    void qform(const std::vector<double>& bcd, const std::vector<double>& shift) {
        code(252, 344, 1);
        for (std::size_t k = 0; k < 3; ++k) {
            number(256 + 4 * k, 352 + 8 * k, bcd[k]);
            number(268 + 4 * k, 376 + 8 * k, shift[k]);
        }
    }
    void magic(const std::string& word) { bytes_.replace(version_ == 1 ? 344 : 4, 3, word); }
    std::string bytes() {
        for (std::size_t d = 0; d < 8; ++d)
            if (version_ == 1)
                put(40 + 2 * d, std::uint16_t(dims_[d]));
            else
                put(16 + 8 * d, std::int64_t(dims_[d]));
        return bytes_;
    }

private:
    std::string bytes_;
    int version_;
    bool big_;
    std::vector<int> dims_;
};

const std::vector<double> kSheared{-2, 0.5, 0, 10, 0, 3, 0.25, 20, 0, 0, 4, 30};

TEST_CASE("NIfTI-1 and 2 of either byte order, raw and compressed", "[volume]") {
    const TempDir dir;
    for (const int version : {1, 2})
        for (const bool big : {false, true})
            for (const bool packed : {false, true}) {
                INFO(version << big << packed);
                Header header(version, big);
                header.sform(kSheared);
                std::string bytes = header.bytes() + bytesOf(counted(), big);
                if (packed) bytes = gzipped(bytes);
                const VoxelVolume v = readVolume(dir.write(packed ? "a.nii.gz" : "a.nii", bytes));
                CHECK(v.size == std::array<std::size_t, 3>{2, 3, 4});
                CHECK(v.values == counted());
                CHECK(v.axis[0] == Vec3d{-2, 0, 0});
                CHECK(v.axis[1] == Vec3d{0.5, 3, 0});
                CHECK(v.axis[2] == Vec3d{0, 0.25, 4});
                CHECK(v.origin == Vec3d{10, 20, 30});
                CHECK(v.mirrors());
                CHECK(v.finestSpacing() == 2);
                CHECK(v.kind == "NIfTI-" + std::to_string(version) + ", float32");
                CHECK(v.warnings.empty());
            }
}

TEST_CASE("the qform of NIfTI is a rotation, and its first spacing mirrors", "[volume]") {
    const TempDir dir;
    for (const int version : {1, 2})
        for (const double handed : {1.0, -1.0}) {
            Header header(version);
            // A third of a turn about 1,1,1 takes x to y, y to z, z to x.
            header.qform({0.5, 0.5, 0.5}, {1, 2, 3});
            for (std::size_t d = 0; d < 4; ++d) header.pixdim(d, d == 0 ? handed : double(d) + 1);
            const VoxelVolume v =
                readVolume(dir.write("a.nii", header.bytes() + bytesOf(counted())));
            CHECK(v.origin == Vec3d{1, 2, 3});
            CHECK(length(v.axis[0] - Vec3d{0, 2, 0}) < 1e-12);
            CHECK(length(v.axis[1] - Vec3d{0, 0, 3}) < 1e-12);
            CHECK(length(v.axis[2] - Vec3d{4 * handed, 0, 0}) < 1e-12);
        }
}

TEST_CASE("scale and intercept of NIfTI are applied, and every type is read", "[volume]") {
    const TempDir dir;
    const std::vector<float> values = counted();
    const auto check = [&](int type, auto one) {
        INFO(type);
        using T = decltype(one);
        Header header(1);
        header.sform(kSheared);
        header.datatype(type);
        header.number(112, 176, 0.5);
        header.number(116, 184, -3);
        const VoxelVolume v = readVolume(dir.write(
            "a.nii", header.bytes() + bytesOf(std::vector<T>(values.begin(), values.end()))));
        for (std::size_t k = 0; k < 24; ++k) CHECK(v.values[k] == 0.5f * values[k] - 3);
    };
    check(2, std::uint8_t());
    check(256, std::int8_t());
    check(4, std::int16_t());
    check(512, std::uint16_t());
    check(8, std::int32_t());
    check(768, std::uint32_t());
    check(1024, std::int64_t());
    check(1280, std::uint64_t());
    check(16, float());
    check(64, double());
}

TEST_CASE("a pair of files, named by either", "[volume]") {
    const TempDir dir;
    Header header(1);
    header.sform(kSheared);
    header.magic("ni1");
    header.number(108, 168, 0);
    dir.write("a.hdr", header.bytes().substr(0, 348));
    dir.write("a.img", bytesOf(counted()));
    for (const char* name : {"a.hdr", "a.img"}) CHECK(readVolume(dir / name).values == counted());
    dir.write("b.hdr.gz", gzipped(header.bytes().substr(0, 348)));
    dir.write("b.img.gz", gzipped(bytesOf(counted())));
    CHECK(readVolume(dir / "b.hdr.gz").values == counted());
    CHECK(readVolume(dir / "b.img.gz").values == counted());
    std::filesystem::remove(dir / "a.img");
    expectError(Kind::Io, {"a.img"}, [&] { readVolume(dir / "a.hdr"); });
}

TEST_CASE("NIfTI that is no volume of numbers is refused", "[volume]") {
    const TempDir dir;
    const auto refused = [&](const std::vector<std::string>& says, const auto& change,
                             std::vector<float> values = counted(), std::size_t cut = 0) {
        Header header(1);
        header.sform(kSheared);
        change(header);
        std::string bytes = header.bytes() + bytesOf(values);
        bytes.resize(bytes.size() - cut);
        for (const bool packed : {false, true}) {
            const std::string file =
                dir.write(packed ? "a.nii.gz" : "a.nii", packed ? gzipped(bytes) : bytes);
            INFO(says[0]);
            expectError(Kind::BadInput, says, [&] { readVolume(file); });
        }
    };
    const auto same = [](Header&) {};
    refused({"a.nii", "ends after"}, same, counted(), 5);
    refused({"a.nii", "holds 2 volumes"}, [](Header& h) { h.dim(0, 4), h.dim(4, 2); });
    refused({"a.nii", "image, not a volume"}, [](Header& h) { h.dim(3, 1); });
    refused({"a.nii", "type 128"}, [](Header& h) { h.datatype(128); });
    refused({"a.nii", "ANALYZE"}, [](Header& h) { h.magic(std::string(3, '\0')); });
    refused({"a.nii", "dimension of 0"}, [](Header& h) { h.dim(2, 0); });
    refused({"a.nii", "byte 100"}, [](Header& h) { h.number(108, 168, 100); });
    refused({"a.nii", "lie in one plane"}, [](Header& h) {
        h.sform({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0});
    });
    std::vector<float> values = counted();
    values[9] = std::numeric_limits<float>::quiet_NaN();
    refused({"voxel 1,1,1", "a.nii", "nan"}, same, values);
    const std::string none = dir.write("b.nii", "hello"),
                      damaged = dir.write("b.nii.gz", "\x1f\x8bhello, no gzip");
    expectError(Kind::BadInput, {"b.nii", "no NIfTI"}, [&] { readVolume(none); });
    expectError(Kind::BadInput, {"b.nii.gz", "damaged"}, [&] { readVolume(damaged); });
    const std::string vdb = dir.write("b.vdb", "hello");
    expectError(Kind::BadInput, {"b.vdb", ".nii"}, [&] { readVolume(vdb); });
}

TEST_CASE("NIfTI without an orientation says so", "[volume]") {
    const TempDir dir;
    Header header(1);
    for (std::size_t d = 0; d < 4; ++d) header.pixdim(d, double(d));
    const VoxelVolume v = readVolume(dir.write("a.nii", header.bytes() + bytesOf(counted())));
    CHECK(v.axis[2] == Vec3d{0, 0, 3});
    REQUIRE(v.warnings.size() == 1);
    CHECK(v.warnings[0].find("neither sform nor qform") != std::string::npos);
}

const std::string kNrrd =
    "NRRD0004\n# made by hand\ntype: float\ndimension: 3\nsizes: 2 3 4\n"
    "space: left-posterior-superior\nspace directions: (-2,0,0) (0.5,3,0) (0,0.25,4)\n"
    "space origin: (10,20,30)\nkinds: domain domain domain\nendian: little\nkey:=value: 7\n";

namespace {

/// A file of FreeSurfer of 2 x 3 x 4 voxels; without an orientation unless `place` is given:
/// spacings, directions of the axes, center.
std::string mgh(int type, const std::string& voxels, const std::vector<double>& place = {},
                const std::vector<std::int32_t>& sizes = {2, 3, 4, 1}) {
    std::vector<std::int32_t> head{1};
    head.insert(head.end(), sizes.begin(), sizes.end());
    head.insert(head.end(), {type, 0});
    std::string bytes = bytesOf(head, true) +
                        bytesOf(std::vector<std::uint16_t>{std::uint16_t(!place.empty())}, true) +
                        bytesOf(std::vector<float>(place.begin(), place.end()), true);
    bytes.resize(284, '\0');
    return bytes + voxels;
}

const std::vector<double> kTurned{2, 3, 4, -1, 0, 0, 0, 0, -1, 0, 1, 0, 10, 20, 30};

}  // namespace

TEST_CASE("MGH of every type, raw and compressed", "[volume]") {
    const TempDir dir;
    const auto check = [&](int type, const std::string& kind, const std::string& voxels) {
        for (const bool packed : {false, true}) {
            INFO(kind << packed);
            const std::string bytes = mgh(type, voxels, kTurned);
            const std::string file =
                dir.write(packed ? "a.mgz" : "a.mgh", packed ? gzipped(bytes) : bytes);
            CHECK(isVolumeFile(file));
            const VoxelVolume v = readVolume(file);
            CHECK(v.kind == "MGH, " + kind);
            CHECK(v.size == std::array<std::size_t, 3>{2, 3, 4});
            CHECK(v.values == counted());
            CHECK(v.axis == std::array<Vec3d, 3>{{{-2, 0, 0}, {0, 0, -3}, {0, 4, 0}}});
            // The middle voxel, 1,1.5,2, is at the center.
            CHECK(v.origin == Vec3d{12, 12, 34.5});
            CHECK(v.warnings.empty());
        }
    };
    const std::vector<float> f = counted();
    const auto as = [&](auto zero) {
        return bytesOf(std::vector<decltype(zero)>(f.begin(), f.end()), true);
    };
    std::string chars;
    for (const float x : f) chars += char(x);
    check(0, "uint8", chars);
    check(1, "int32", as(std::int32_t{}));
    check(3, "float32", as(0.0f));
    check(4, "int16", as(std::uint16_t{}));
    check(10, "uint16", as(std::uint16_t{}));

    const VoxelVolume bare = readVolume(dir.write("b.mgh", mgh(0, chars)));
    CHECK(bare.axis == std::array<Vec3d, 3>{{{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}});
    CHECK(bare.origin == Vec3d{1, -2, 1.5});
    REQUIRE(bare.warnings.size() == 1);
    CHECK(bare.warnings[0].find("no orientation") != std::string::npos);
}

TEST_CASE("MGH that is no volume of numbers is refused", "[volume]") {
    const TempDir dir;
    const auto refused = [&](const std::string& name, const std::string& bytes,
                             const std::vector<std::string>& says) {
        INFO(name);
        const std::string file = dir.write(name, bytes);
        expectError(Kind::BadInput, says, [&] { readVolume(file); });
    };
    const std::string good = mgh(3, bytesOf(counted(), true), kTurned);
    for (const std::size_t size : {0u, 3u, 100u, 283u})
        refused("cut.mgh", good.substr(0, size), {"cut.mgh", "header is cut off"});
    refused("cut.mgh", good.substr(0, good.size() - 1), {"cut.mgh", "cut off"});
    const std::string packed = gzipped(good);
    for (const std::size_t size : {12u, 40u, unsigned(packed.size()) - 12})
        refused("cut.mgz", packed.substr(0, size), {"cut.mgz", "cut off"});
    std::string damaged = packed;
    damaged[20] = char(damaged[20] ^ 0x55);
    refused("damaged.mgz", damaged, {"damaged.mgz"});
    refused("version.mgh", bytesOf(std::vector<std::int32_t>{2}, true) + good.substr(4),
            {"version.mgh", "version 1"});
    refused("type.mgh", mgh(2, "", kTurned), {"type.mgh", "type 2"});
    refused("times.mgh", mgh(3, "", kTurned, {2, 3, 4, 7}), {"times.mgh", "7 volumes"});
    refused("empty.mgh", mgh(3, "", kTurned, {2, -3, 4, 1}), {"empty.mgh", "-3 voxels"});
    refused("huge.mgh", mgh(3, "", kTurned, {1 << 30, 1 << 30, 1 << 30, 1}), {"huge.mgh"});
    refused("long.mgh", mgh(3, "", kTurned, {1000, 1000, 1000, 1}), {"long.mgh", "cut off"});
    std::vector<double> flat = kTurned, wild = kTurned;
    flat[2] = 0;
    wild[13] = std::numeric_limits<double>::quiet_NaN();
    refused("flat.mgh", mgh(3, bytesOf(counted(), true), flat), {"flat.mgh", "one plane"});
    refused("wild.mgh", mgh(3, bytesOf(counted(), true), wild), {"wild.mgh", "not finite"});
    std::vector<float> nan = counted();
    nan[7] = std::numeric_limits<float>::quiet_NaN();
    refused("nan.mgh", mgh(3, bytesOf(nan, true), kTurned), {"nan.mgh", "voxel 1,0,1", "nan"});
}

TEST_CASE("NRRD raw, gzip and text, in one file or two", "[volume]") {
    const TempDir dir;
    const std::string raw = bytesOf(counted());
    std::string text;
    for (const float v : counted()) text += std::to_string(int(v)) + (v == 7 ? "\n" : " ");
    dir.write("a.raw", "two lines\nto skip\n" + raw);
    dir.write("b.raw", "some bytes" + raw);
    for (const auto& [name, bytes] :
         {std::pair("a.nrrd", kNrrd + "encoding: raw\n\n" + raw),
          {"b.nrrd", kNrrd + "encoding: gzip\n\n" + gzipped(raw)},
          {"c.nrrd", kNrrd + "encoding: ascii\n\n" + text},
          {"d.nhdr", kNrrd + "encoding: raw\nline skip: 2\ndata file: a.raw\n"},
          {"e.nhdr", kNrrd + "encoding: raw\nbyte skip: -1\ndatafile: b.raw\n"}}) {
        INFO(name);
        const VoxelVolume v = readVolume(dir.write(name, bytes));
        CHECK(v.size == std::array<std::size_t, 3>{2, 3, 4});
        CHECK(v.values == counted());
        CHECK(v.axis[1] == Vec3d{0.5, 3, 0});
        CHECK(v.origin == Vec3d{10, 20, 30});
        CHECK(v.kind == "NRRD, float32");
    }
}

TEST_CASE("NRRD without space directions takes spacings and the ranges of axes", "[volume]") {
    const TempDir dir;
    const auto read = [&](const std::string& fields) {
        INFO(fields);
        return readVolume(dir.write(
            "a.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 3 4\nendian: little\n" +
                          fields + "encoding: raw\n\n" + bytesOf(counted())));
    };
    const auto axes = [](double x, double y, double z) {
        return std::array<Vec3d, 3>{{{x, 0, 0}, {0, y, 0}, {0, 0, z}}};
    };
    const auto says = [](const VoxelVolume& v, const std::string& text) {
        return std::any_of(v.warnings.begin(), v.warnings.end(), [&](const std::string& warning) {
            return warning.find(text) != std::string::npos;
        });
    };
    const VoxelVolume spaced = read("spacings: 2 3 4\n");
    CHECK(spaced.axis == axes(2, 3, 4));
    CHECK(spaced.origin == Vec3d{});
    CHECK(spaced.warnings.size() == 1);

    const std::string range = "axis mins: 10 20 30\naxis maxs: 14 26 18\n";
    for (const std::string cells :
         {"", "centers: cell cell cell\n", "centerings: ??? cell none\n"}) {
        const VoxelVolume v = read(range + cells);
        CHECK(v.axis == axes(2, 2, -3));
        CHECK(v.origin == Vec3d{11, 21, 28.5});
        CHECK(v.warnings.size() == 1);
    }
    const VoxelVolume nodes = read(range + "centers: node cell Node\n");
    CHECK(nodes.axis == axes(4, 2, -4));
    CHECK(nodes.origin == Vec3d{10, 21, 30});
    CHECK(nodes.warnings.size() == 1);
    CHECK(read("axismins: 0 0 0\naxismaxs: 4 6 8\n").axis == axes(2, 2, 2));
    // Numbers that the header leaves open, and the origin of its own.
    const VoxelVolume part = read(range + "spacings: nan 2 NaN\nspace origin: (1,2,3)\n");
    CHECK(part.axis == axes(2, 2, -3));
    CHECK(part.origin == Vec3d{1, 2, 3});
    CHECK(part.warnings.size() == 1);
    const VoxelVolume least = read("axis mins: 10 nan 30\nspacings: 1 2 3\n");
    CHECK(least.axis == axes(1, 2, 3));
    CHECK(least.origin == Vec3d{10.5, 0, 31.5});

    const VoxelVolume open = read("spacings: 2 nan nan\n");
    CHECK(open.axis == axes(2, 1, 1));
    CHECK(says(open, "no spacing: 1 is taken along axis 1, 2"));
    CHECK(says(read(""), "no spacing: 1 is taken along axis 0, 1, 2"));
    const VoxelVolume torn = read(range + "spacings: 2 7 -3\n");
    CHECK(torn.axis == axes(2, 7, -3));
    CHECK(torn.warnings.size() == 2);
    CHECK(says(torn, "spacing 7 along axis 1, and axis mins and maxs make it 2"));

    for (const auto& [fields, phrase] : {std::pair("spacings: 1 2\n", "2 spacings; 3"),
                                         {"axis mins: 1\n", "1 axis mins; 3"},
                                         {"axis maxs: 1 2 3 4\n", "4 axis maxs; 3"},
                                         {"axis mins: 1 1 1\naxis maxs: 1 2 2\n", "no length"}})
        expectError(Kind::BadInput, {"a.nrrd", phrase}, [&, &text = fields] { read(text); });
    CHECK(readVolume(dir.write("b.nrrd",
                               "\xEF\xBB\xBF" + kNrrd + "encoding: raw\n\n" + bytesOf(counted())))
              .values == counted());
}

TEST_CASE("the data files that headers and scenes name", "[volume]") {
    const TempDir dir;
    const auto files = [](std::vector<std::string> names) { return names; };
    dir.write("a.nhdr", "NRRD0005\ntype: float\ndata file: my a.raw\n\n");
    CHECK(dataFilesOf(dir / "a.nhdr") == files({dir / "my a.raw"}));
    CHECK(dataFilesOf(dir.write("b.nrrd", "NRRD0005\ntype: float\n\n")).empty());
    CHECK(dataFilesOf(dir.write("c.nhdr", "no header")).empty());
    CHECK(dataFilesOf(dir / "none.nhdr").empty());
    CHECK(dataFilesOf(dir / "a.hdr") == files({dir / "a.img"}));
    dir.write("b.img.gz", "");
    CHECK(dataFilesOf(dir / "b.hdr") == files({dir / "b.img.gz"}));
    CHECK(dataFilesOf(dir / "b.img.gz") == files({dir / "b.hdr.gz"}));
    CHECK(dataFilesOf(dir / "b.nii").empty());
    const std::string scene =
        R"({"buffers": [{"uri": "a%20b.bin"}, {"uri": "data:;base64,AA"}, {}, {"uri": "c.bin"}]})";
    CHECK(dataFilesOf(dir.write("a.gltf", scene)) == files({dir / "a b.bin", dir / "c.bin"}));
    CHECK(dataFilesOf(dir.write("b.gltf", "no scene")).empty());
    CHECK(dataFilesOf(dir.write("a.obj", "")).empty());
}

TEST_CASE("NRRD that is no volume of numbers is refused", "[volume]") {
    const TempDir dir;
    const std::string raw = bytesOf(counted());
    const auto refused = [&](const std::vector<std::string>& says, const std::string& from,
                             const std::string& to, const std::string& data) {
        INFO(says[0]);
        std::string bytes = kNrrd + "encoding: raw\n\n" + data;
        bytes.replace(bytes.find(from), from.size(), to);
        const std::string file = dir.write("a.nrrd", bytes);
        expectError(Kind::BadInput, says, [&] { readVolume(file); });
    };
    refused({"a.nrrd", "no NRRD"}, "NRRD0004", "PNG", raw);
    refused({"a.nrrd", "dimension '4'"}, "dimension: 3", "dimension: 4", raw);
    refused({"a.nrrd", "'none'"}, "(-2,0,0)", "none", raw);
    refused({"a.nrrd", "type 'block'"}, "type: float", "type: block", raw);
    refused({"a.nrrd", "'bzip2'"}, "encoding: raw", "encoding: bzip2", raw);
    refused({"a.nrrd", "byte order"}, "endian: little", "content: x", raw);
    refused({"a.nrrd", "ends after 90 of 96"}, "raw", "raw", raw.substr(0, 90));
    refused({"a.nrrd", "no gzip data"}, "encoding: raw", "encoding: gzip", raw);
    refused({"a.nrrd", "cut off"}, "encoding: raw", "encoding: gzip", gzipped(raw).substr(0, 30));
    refused({"a.nrrd", "2^34"}, "sizes: 2 3 4", "sizes: 2000000 3000000 4", raw);
    refused({"a.nrrd", "several files"}, "kinds: domain domain domain", "data file: LIST", raw);
    const std::string lonely = dir.write("b.nhdr", kNrrd + "encoding: raw\ndata file: none.raw\n");
    expectError(Kind::Io, {"none.raw"}, [&] { readVolume(lonely); });
}

}  // namespace
}  // namespace igeo
