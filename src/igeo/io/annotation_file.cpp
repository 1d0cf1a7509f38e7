#include <igeo/io/annotation_file.h>

#include <fmt/core.h>
#include <igeo/io/detail/byte_reader.h>
#include <igeo/io/detail/file_bytes.h>

#include <algorithm>
#include <map>

namespace igeo {

namespace {

constexpr std::int32_t kHasTable = 1, kVersion = 2;
constexpr std::size_t kLeastEntry = 5 * sizeof(std::int32_t);  // bytes of a region in the table

std::size_t countFrom(ByteReader& reader, std::size_t size, const char* what) {
    const auto count = reader.next<std::int32_t>();
    if (count < 0) reader.fail(fmt::format("{} {}", count, what));
    reader.require(std::size_t(count), size, what);
    return std::size_t(count);
}

/// A text with its length in front and a zero at its end.
std::string textFrom(ByteReader& reader) {
    std::string text(countFrom(reader, 1, "letters"), '\0');
    for (char& c : text) c = char(reader.next<std::uint8_t>());
    return text.substr(0, text.find('\0'));
}

/// The region for each color, which is the value of a vertex.
using Colors = std::map<std::uint32_t, std::size_t>;

/// @param number  of the region
void readEntry(ByteReader& reader, std::size_t number, Annotation& annotation, Colors& colors) {
    std::string& name = annotation.regions[number].name;
    name = textFrom(reader);
    if (std::any_of(name.begin(), name.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }))
        reader.fail(fmt::format("the name of region {} holds a control character", number));
    std::uint32_t color = 0;
    for (const unsigned shift : {0u, 8u, 16u, 24u})
        color |= (reader.next<std::uint32_t>() & 0xff) << shift;
    colors.emplace(color, number);
}

Colors readTable(ByteReader& reader, Annotation& annotation) {
    Colors colors;
    const auto first = reader.next<std::int32_t>();
    if (first > 0) {  // the older format: `first` is the number of regions
        reader.require(std::size_t(first), kLeastEntry, "regions");
        annotation.regions.resize(std::size_t(first));
        textFrom(reader);  // the file that the table is from
        for (std::size_t k = 0; k < annotation.regions.size(); ++k)
            readEntry(reader, k, annotation, colors);
        return colors;
    }
    if (first != -kVersion)
        reader.fail(fmt::format("a table of regions of version {}", -std::int64_t(first)));
    constexpr std::size_t kMostRegions = 1 << 20;
    const auto most = reader.next<std::int32_t>();
    if (most < 0 || std::size_t(most) > kMostRegions)
        reader.fail(fmt::format("a table of {} regions", most));
    annotation.regions.resize(std::size_t(most));
    textFrom(reader);
    const std::size_t count = countFrom(reader, sizeof(std::int32_t) + kLeastEntry, "regions");
    for (std::size_t k = 0; k < count; ++k) {
        const auto number = reader.next<std::int32_t>();
        if (number < 0 || number >= most)
            reader.fail(fmt::format("region {} in a table of {}", number, most));
        readEntry(reader, std::size_t(number), annotation, colors);
    }
    return colors;
}

}  // namespace

bool isAnnotationFile(const std::string& file) { return endingBeforeGz(file) == ".annot"; }

Annotation readAnnotation(const std::string& file) {
    return annotationFrom(file, inflatedFileBytes(file));
}

Annotation annotationFrom(const std::string& file, const std::string& bytes) {
    ByteReader reader(file, bytes, /*bigEndian=*/true);
    std::vector<std::uint32_t> colorOf(countFrom(reader, 2 * sizeof(std::int32_t), "vertices"));
    for (std::size_t k = 0; k < colorOf.size(); ++k) {
        const auto vertex = reader.next<std::uint32_t>();
        if (vertex >= colorOf.size())
            reader.fail(fmt::format("a value of vertex {} of {}", vertex, colorOf.size()));
        colorOf[vertex] = reader.next<std::uint32_t>();
    }
    if (reader.left() == 0 || reader.next<std::int32_t>() != kHasTable)
        reader.fail("there is no table of regions");
    Annotation annotation;
    annotation.vertices = colorOf.size();
    const Colors colors = readTable(reader, annotation);
    for (std::size_t v = 0; v < colorOf.size(); ++v)
        if (const auto known = colors.find(colorOf[v]); colorOf[v] != 0 && known != colors.end())
            annotation.regions[known->second].vertices.push_back(v);
    std::erase_if(annotation.regions, [](const VertexRegion& r) { return r.vertices.empty(); });
    if (annotation.regions.empty()) reader.fail("no vertex is in a region of the table");
    return annotation;
}

}  // namespace igeo
