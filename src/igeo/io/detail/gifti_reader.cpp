#include <igeo/io/detail/gifti_reader.h>

#include <fmt/core.h>
#include <igeo/base/detail/deflate.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/base64.h>
#include <igeo/io/detail/byte_reader.h>
#include <igeo/io/detail/file_bytes.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

namespace igeo {

namespace {

constexpr std::string_view kXmlBlank = " \t\r\n";
constexpr std::size_t kMostValues = std::size_t(1) << 34;

/// A tag of XML: <name attributes>, </name> or <name attributes/>.
struct Tag {
    std::string_view name;
    std::map<std::string_view, std::string_view> attributes;
    bool ends = false;   ///< </name>
    bool empty = false;  ///< <name/>
};

/// The tags of an XML file. Parts that GIFTI does not use, such as entities and nested comments of
/// a document type, are skipped.
class Tags {
public:
    Tags(const std::string& file, std::string_view bytes) : file_(file), bytes_(bytes) {}

    /// The next tag; none at the end.
    std::optional<Tag> next() {
        for (;;) {
            at_ = std::min(bytes_.find('<', at_), bytes_.size());
            if (at_ == bytes_.size()) return std::nullopt;
            const std::string_view rest = bytes_.substr(at_);
            if (rest.starts_with("<!--"))
                skipTo("-->");
            else if (rest.starts_with("<![CDATA["))
                skipTo("]]>");
            else if (rest.starts_with("<!") || rest.starts_with("<?"))
                skipTo(">");
            else
                return tag();
        }
    }
    /// The text between the last tag and the next.
    std::string_view text() {
        const std::size_t end = bytes_.find('<', at_);
        if (end == bytes_.npos) fail("the file ends within data");
        return bytes_.substr(at_, end - at_);
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(Error::Kind::BadInput, fmt::format("{}, byte {}: {}", file_, at_, what),
                    "the file is cut off or broken: write it again");
    }

private:
    void skipTo(std::string_view end) {
        const std::size_t found = bytes_.find(end, at_);
        if (found == bytes_.npos) fail("the file ends within a tag or a comment");
        at_ = found + end.size();
    }
    void skipBlank() { at_ = std::min(bytes_.find_first_not_of(kXmlBlank, at_), bytes_.size()); }
    std::string_view word(std::string_view stops) {
        const std::size_t end = std::min(bytes_.find_first_of(stops, at_), bytes_.size());
        const std::string_view word = bytes_.substr(at_, end - at_);
        at_ = end;
        return word;
    }
    char peek() const {
        if (at_ == bytes_.size()) fail("the file ends within a tag");
        return bytes_[at_];
    }

    Tag tag() {
        Tag tag;
        ++at_;
        tag.ends = peek() == '/';
        if (tag.ends) ++at_;
        tag.name = word(" \t\r\n/>");
        for (skipBlank(); peek() != '>'; skipBlank()) {
            if (peek() == '/') {
                tag.empty = true;
                ++at_;
                continue;
            }
            const std::string_view name = word(" \t\r\n=/><");
            skipBlank();
            if (name.empty() || peek() != '=') fail("an attribute has no value");
            ++at_;
            skipBlank();
            const char quote = peek();
            if (quote != '"' && quote != '\'') fail("the value of an attribute has no quotes");
            ++at_;
            tag.attributes[name] = word(std::string_view(&quote, 1));
            peek();
            ++at_;
        }
        ++at_;
        return tag;
    }

    const std::string& file_;
    std::string_view bytes_;
    std::size_t at_ = 0;
};

/// Reads the arrays of one file.
class GiftiReader {
public:
    GiftiReader(const std::string& file, std::string_view bytes)
        : file_(file), tags_(file, bytes) {}

    std::vector<GiftiArray> read() {
        std::vector<GiftiArray> arrays;
        bool isGifti = false, ended = false;
        while (const auto tag = tags_.next()) {
            if (tag->name == "GIFTI") (tag->ends ? ended : isGifti) = true;
            if (tag->name == "DataArray" && !tag->ends && isGifti) arrays.push_back(array(*tag));
        }
        if (!isGifti) tags_.fail("this is no GIFTI file, which has the element GIFTI");
        if (!ended) tags_.fail("the file ends within GIFTI");
        return arrays;
    }

private:
    GiftiArray array(const Tag& tag) {
        GiftiArray array;
        array.intent = attribute(tag, "Intent");
        const std::size_t dims = whole(tag, "Dimensionality");
        if (dims < 1 || dims > 2)
            tags_.fail(fmt::format("an array has {} dimensions; 1 or 2 are read", dims));
        std::size_t count = 1;
        for (std::size_t d = 0; d < dims; ++d) {
            array.dims.push_back(whole(tag, d == 0 ? "Dim0" : "Dim1"));
            if (array.dims[d] != 0 && count > kMostValues / array.dims[d])
                tags_.fail("an array announces more than 2^34 numbers");
            count *= array.dims[d];
        }
        array.values = values(tag, count, data());
        if (dims == 2 && attribute(tag, "ArrayIndexingOrder") == "ColumnMajorOrder")
            array.values = transposed(array.values, array.dims[0], array.dims[1]);
        return array;
    }

    /// The text of Data, up to the end of its array.
    std::string_view data() {
        std::string_view text;
        for (auto tag = tags_.next();; tag = tags_.next()) {
            if (!tag) tags_.fail("the file ends within an array");
            if (tag->ends && tag->name == "DataArray") return text;
            if (tag->name == "Data" && !tag->ends && !tag->empty) text = tags_.text();
        }
    }

    std::vector<double> values(const Tag& tag, std::size_t count, std::string_view text) {
        const std::string_view encoding = attribute(tag, "Encoding");
        if (encoding == "ExternalFileBinary")
            throw Error(Error::Kind::BadInput,
                        fmt::format("the data of '{}' are in another file, '{}'", file_,
                                    attribute(tag, "ExternalFileName")),
                        "write them into the file itself, as GZipBase64Binary");
        if (encoding == "ASCII") return fromText(count, text);
        if (encoding != "Base64Binary" && encoding != "GZipBase64Binary")
            tags_.fail(
                fmt::format("the encoding '{}' is none of ASCII, Base64Binary and "
                            "GZipBase64Binary",
                            encoding.substr(0, 40)));
        const NumberType type = numberType(tag);
        const std::size_t size = count * sizeOf(type);
        std::optional<std::string> raw = fromBase64(text);
        if (!raw) tags_.fail("the data are not in base64");
        if (encoding == "GZipBase64Binary")
            raw = naming("'" + file_ + "'", [&] { return inflated(*raw, size); });
        if (raw->size() != size)
            tags_.fail(fmt::format("an array of {} bytes has data of {}", size, raw->size()));
        ByteReader reader(file_, *raw, attribute(tag, "Endian") == "BigEndian");
        std::vector<double> values(count);
        for (double& value : values) value = reader.next(type);
        return values;
    }

    std::vector<double> fromText(std::size_t count, std::string_view text) {
        std::vector<double> values;
        for (;;) {
            const std::size_t begin = std::min(text.find_first_not_of(kXmlBlank), text.size());
            const std::size_t end = std::min(text.find_first_of(kXmlBlank, begin), text.size());
            if (begin == end) break;
            std::string_view word = text.substr(begin, end - begin);
            text.remove_prefix(end);
            if (word[0] == '+') word.remove_prefix(1);
            const auto value = parseDouble(word);
            if (!value) tags_.fail(fmt::format("'{}' is no number", word.substr(0, 40)));
            values.push_back(*value);
        }
        if (values.size() != count)
            tags_.fail(fmt::format("an array of {} numbers holds {}", count, values.size()));
        return values;
    }

    static std::vector<double> transposed(const std::vector<double>& columns, std::size_t rows,
                                          std::size_t width) {
        std::vector<double> values(columns.size());
        for (std::size_t r = 0; r < rows; ++r)
            for (std::size_t c = 0; c < width; ++c) values[r * width + c] = columns[c * rows + r];
        return values;
    }

    std::string_view attribute(const Tag& tag, std::string_view name) const {
        const auto at = tag.attributes.find(name);
        if (at == tag.attributes.end()) tags_.fail(fmt::format("an array has no {}", name));
        return at->second;
    }
    std::size_t whole(const Tag& tag, std::string_view name) const {
        const std::string_view text = attribute(tag, name);
        std::uint32_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size())
            tags_.fail(fmt::format("{} is '{}', no number from 0 on", name, text.substr(0, 40)));
        return value;
    }
    NumberType numberType(const Tag& tag) const {
        static constexpr std::pair<std::string_view, NumberType> kTypes[] = {
            {"NIFTI_TYPE_UINT8", NumberType::U8},    {"NIFTI_TYPE_INT8", NumberType::I8},
            {"NIFTI_TYPE_UINT16", NumberType::U16},  {"NIFTI_TYPE_INT16", NumberType::I16},
            {"NIFTI_TYPE_UINT32", NumberType::U32},  {"NIFTI_TYPE_INT32", NumberType::I32},
            {"NIFTI_TYPE_UINT64", NumberType::U64},  {"NIFTI_TYPE_INT64", NumberType::I64},
            {"NIFTI_TYPE_FLOAT32", NumberType::F32}, {"NIFTI_TYPE_FLOAT64", NumberType::F64}};
        const std::string_view name = attribute(tag, "DataType");
        for (const auto& [known, type] : kTypes)
            if (name == known) return type;
        tags_.fail(fmt::format("the type of numbers '{}' is not read", name.substr(0, 40)));
    }

    const std::string& file_;
    Tags tags_;
};

/// The only array of an intent, with rows of three.
const GiftiArray& rowsOfThree(const std::vector<GiftiArray>& arrays, const char* intent,
                              const std::string& file) {
    const GiftiArray* found = nullptr;
    for (const GiftiArray& array : arrays) {
        if (array.intent != intent) continue;
        if (found)
            refuseFile(file, fmt::format("holds several arrays of {}", intent),
                       "write each surface into a file of its own");
        found = &array;
    }
    if (!found)
        refuseFile(file, fmt::format("holds no surface: there is no array of {}", intent),
                   "give the .surf.gii that its values belong to");
    if (found->dims.size() != 2 || found->dims[1] != 3)
        refuseFile(file, fmt::format("has an array of {} that is not of three columns", intent),
                   "the file is broken: write it again");
    return *found;
}

}  // namespace

std::vector<GiftiArray> readGifti(const std::string& file, const std::string& bytes) {
    return GiftiReader(file, bytes).read();
}

PolygonMesh readGiftiMesh(const std::string& file, const std::string& bytes) {
    const std::vector<GiftiArray> arrays = readGifti(file, bytes);
    const GiftiArray& points = rowsOfThree(arrays, "NIFTI_INTENT_POINTSET", file);
    const GiftiArray& faces = rowsOfThree(arrays, "NIFTI_INTENT_TRIANGLE", file);
    PolygonMesh mesh;
    const std::vector<double>& p = points.values;
    for (std::size_t k = 0; k < p.size(); k += 3)
        mesh.vertices.push_back({p[k], p[k + 1], p[k + 2]});
    for (std::size_t k = 0; k < faces.values.size(); k += 3) {
        std::array<std::uint32_t, 3> face{};
        for (std::size_t c = 0; c < 3; ++c) {
            const double corner = faces.values[k + c];
            if (!(corner >= 0 && corner < double(mesh.vertices.size()) &&
                  corner == std::floor(corner)))
                refuseFile(
                    file,
                    fmt::format("names vertex {} of {} in a face", corner, mesh.vertices.size()),
                    "the file is broken: write it again");
            face[c] = std::uint32_t(corner);
        }
        mesh.addFace(face);
    }
    return mesh;
}

}  // namespace igeo
