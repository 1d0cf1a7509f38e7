#include <igeo/io/vertex_data_file.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/io/annotation_file.h>
#include <igeo/io/detail/byte_reader.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/gifti_reader.h>
#include <igeo/io/detail/number_lines.h>
#include <igeo/io/detail/number_rows.h>

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <utility>

namespace igeo {

namespace {

using Kind = Error::Kind;
constexpr std::string_view kMorphometry = "\xff\xff\xff";

bool isMorphometry(const std::string& file) {
    std::array<char, kMorphometry.size()> begin{};
    std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
    return std::string_view(begin.data(), begin.size()) == kMorphometry;
}

std::vector<double> fromGifti(const std::string& file, const std::string& bytes) {
    std::vector<double> values;
    std::size_t arrays = 0;
    for (GiftiArray& array : readGifti(file, bytes)) {
        if (array.intent == "NIFTI_INTENT_POINTSET" || array.intent == "NIFTI_INTENT_TRIANGLE")
            continue;
        if (array.intent == "NIFTI_INTENT_NODE_INDEX")
            refuseFile(file, "lists values of some vertices only",
                       "write a value for every vertex");
        if (array.dims.size() == 2 && array.dims[1] != 1)
            refuseFile(file, fmt::format("has {} values per vertex", array.dims[1]),
                       "write one value per vertex");
        values = std::move(array.values);
        ++arrays;
    }
    if (arrays != 1)
        refuseFile(file, fmt::format("holds {} arrays of values, not one", arrays),
                   "write the one you need into a file of its own");
    return values;
}

/// The vertex with this number.
std::size_t vertexOf(double number, std::size_t count, const std::string& file, std::size_t line) {
    if (number >= 0 && number < double(count) && number == std::floor(number))
        return std::size_t(number);
    throw Error(Kind::BadInput,
                fmt::format("{}, line {}: {} is no vertex of the mesh, which has 0 to {}", file,
                            line, number, count == 0 ? 0 : count - 1),
                "give values that belong to this mesh, vertices counted from 0 on");
}

/// @param before  the first line that names the vertex
[[noreturn]] void failTwice(const std::string& file, std::size_t number, std::string_view line,
                            std::size_t vertex, std::size_t before) {
    const std::size_t comma = line.find(',');
    const bool mayBeDecimal = comma != line.npos && isTightComma(line, comma);
    throw Error(Kind::BadInput,
                fmt::format("{}, line {}: '{}' gives vertex {} a value, as line {} does", file,
                            number, line.substr(0, 60), vertex, before),
                mayBeDecimal ? "write each vertex once; if the comma is a decimal comma, write a "
                               "decimal point: 1.5 for 1,5"
                             : "write each vertex once");
}

std::vector<double> fromText(const std::string& file, const std::string& bytes, std::size_t count) {
    std::vector<double> values;
    std::vector<std::size_t> lineOf;  // of each vertex; 0 where none names it
    std::size_t columns = 0, most = 2;
    bool mayBeHeader = true;
    forLines(bytes, [&](std::string_view line, std::size_t number) {
        const std::vector<double> v = numbersIn(file, number, line);
        const bool isHeader = mayBeHeader && v.empty();
        mayBeHeader = false;
        // More columns are allowed only if the first is named `vertex`: x,y,z are not vertex and
        // value.
        if (isHeader) {
            if (namesInHeader(line)[0].starts_with("vertex")) most = v.max_size();
            return;
        }
        if (v.empty() || v.size() > most || (columns != 0 && v.size() != columns))
            throw Error(Kind::BadInput,
                        fmt::format("{}, line {}: '{}' is neither a value nor a vertex and a value",
                                    file, number, line.substr(0, 60)),
                        "write one value per line, or lines vertex,value");
        columns = v.size();
        if (columns == 1) return values.push_back(v[0]);
        values.resize(count);
        lineOf.resize(count);
        const std::size_t vertex = vertexOf(v[0], count, file, number);
        if (lineOf[vertex] != 0) failTwice(file, number, line, vertex, lineOf[vertex]);
        values[vertex] = v[1];
        lineOf[vertex] = number;
    });
    return values;
}

/// The text after `before` up to `stop`, in the header of a .npy file.
std::string_view between(std::string_view text, std::string_view before, char stop) {
    const std::size_t at = text.find(before);
    if (at == text.npos) return {};
    text.remove_prefix(at + before.size());
    return text.substr(0, text.find(stop));
}

std::vector<double> fromNpy(const std::string& file, const std::string& bytes) {
    static constexpr std::pair<std::string_view, NumberType> kTypes[] = {
        {"b1", NumberType::U8},  {"u1", NumberType::U8},  {"i1", NumberType::I8},
        {"u2", NumberType::U16}, {"i2", NumberType::I16}, {"u4", NumberType::U32},
        {"i4", NumberType::I32}, {"u8", NumberType::U64}, {"i8", NumberType::I64},
        {"f4", NumberType::F32}, {"f8", NumberType::F64}};
    ByteReader reader(file, bytes, /*bigEndian=*/false);
    if (!bytes.starts_with("\x93NUMPY")) reader.fail("this is no .npy file");
    reader.skip(6);
    const int version = reader.next<std::uint8_t>();
    reader.skip(1);
    const std::size_t size =
        version == 1 ? reader.next<std::uint16_t>() : reader.next<std::uint32_t>();
    const std::string_view header(bytes.data() + (bytes.size() - reader.left()),
                                  std::min(size, reader.left()));
    reader.skip(size);
    const std::string_view type = between(header, "'descr': '", '\'');
    std::string_view shape = between(header, "'shape': (", ')');
    std::size_t count = 0;
    const auto [stop, error] = std::from_chars(shape.data(), shape.data() + shape.size(), count);
    shape.remove_prefix(std::size_t(stop - shape.data()));
    if (error != std::errc() || (shape != "" && shape != "," && shape != ", 1"))
        reader.fail("the shape is not that of one value per vertex, (n,)");
    for (const auto& [name, known] : kTypes) {
        if (type.size() != 3 || type.substr(1) != name) continue;
        reader.require(count, sizeOf(known), "values");
        ByteReader data(file, std::string_view(bytes).substr(bytes.size() - reader.left()),
                        type[0] == '>');
        std::vector<double> values(count);
        for (double& value : values) value = data.next(known);
        return values;
    }
    reader.fail(fmt::format("values of type '{}' are not read", type.substr(0, 40)));
}

std::vector<double> fromMorphometry(const std::string& file, const std::string& bytes) {
    ByteReader reader(file, bytes, /*bigEndian=*/true);
    reader.skip(kMorphometry.size());
    const auto vertices = reader.next<std::uint32_t>();
    reader.next<std::uint32_t>();  // faces
    if (const auto each = reader.next<std::uint32_t>(); each != 1)
        reader.fail(fmt::format("{} values per vertex; 1 is read", each));
    reader.require(vertices, sizeof(float), "values");
    std::vector<double> values(vertices);
    for (double& value : values) value = double(reader.next<float>());
    return values;
}

std::vector<double> fromLabel(const std::string& file, std::size_t count) {
    std::vector<double> values(count);
    for (const std::size_t v : readLabelFile(file)) values[vertexOf(double(v), count, file, 0)] = 1;
    return values;
}

std::vector<double> valuesFrom(const std::string& file, std::size_t count) {
    const std::string ending = endingBeforeGz(file);
    if (ending == ".label") return fromLabel(file, count);
    const std::string bytes = inflatedFileBytes(file);
    if (ending == ".gii") return fromGifti(file, bytes);
    if (ending == ".csv" || ending == ".txt") return fromText(file, bytes, count);
    if (ending == ".npy") return fromNpy(file, bytes);
    if (bytes.starts_with(kMorphometry)) return fromMorphometry(file, bytes);
    if (isAnnotationFile(file))
        refuseFile(file, "holds regions and no values",
                   "give it as seeds, or name a region as an obstacle or mask: FILE.annot:REGION");
    refuseFile(file, "holds no values per vertex by its name",
               "give a .gii, .csv, .txt, .npy, .label or morphometry file of FreeSurfer");
}

}  // namespace

bool isVertexDataFile(const std::string& file) {
    const std::string ending = endingBeforeGz(file);
    for (const char* known : {".gii", ".csv", ".txt", ".npy", ".label"})
        if (ending == known) return true;
    return isMorphometry(file);
}

std::vector<double> readVertexData(const std::string& file, std::size_t count) {
    std::vector<double> values = valuesFrom(file, count);
    if (values.size() != count)
        refuseFile(
            file,
            fmt::format("holds {} values, and the mesh has {} vertices", values.size(), count),
            "give values that belong to this mesh");
    return values;
}

std::vector<std::size_t> readLabelFile(const std::string& file) {
    std::vector<std::size_t> vertices;
    double announced = -1;
    forLines(fileBytes(file), [&](std::string_view line, std::size_t number) {
        const std::vector<double> v = numbersIn(file, number, line);
        const bool isCount = announced < 0 && v.size() == 1;
        if ((!isCount && (announced < 0 || v.size() != 5)) || !(v[0] >= 0 && v[0] < 0x1p32))
            throw Error(Kind::BadInput,
                        fmt::format("{}, line {}: '{}' is not {}", file, number, line.substr(0, 60),
                                    announced < 0 ? "a count of vertices" : "vertex x y z value"),
                        "write it again as a label of FreeSurfer");
        if (isCount)
            announced = v[0];
        else
            vertices.push_back(std::size_t(v[0]));
    });
    if (double(vertices.size()) != announced)
        refuseFile(file,
                   fmt::format("announces {} vertices and lists {}", announced, vertices.size()),
                   "the file is cut off or broken: write it again");
    return vertices;
}

}  // namespace igeo
