#include <igeo/io/detail/ply_reader.h>

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <sstream>

namespace igeo {

namespace {

enum class Format { None, Text, Little, Big };
enum class PlyType { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

std::size_t sizeOf(PlyType type) {
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[std::size_t(type)];
}

struct Property {
    std::string name;
    PlyType type;
    bool isList = false;
    PlyType countType = PlyType::Uint8;
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;

    /// The index of a property; the number of properties if it is missing.
    std::size_t column(const std::string& property, bool isList) const {
        std::size_t p = 0;
        while (p < properties.size() &&
               (properties[p].name != property || properties[p].isList != isList))
            ++p;
        return p;
    }
};

/// The numbers of each property: one, or those of a list.
using Row = std::vector<std::vector<double>>;

class Reader {
public:
    Reader(const std::string& file, const std::string& bytes) : file_(file), bytes_(bytes) {
        readHeader();
    }

    Ply read(bool withFaces) {
        const auto vertex = std::find_if(elements_.begin(), elements_.end(),
                                         [](const Element& e) { return e.name == "vertex"; });
        if (vertex == elements_.end()) fail("there is no element 'vertex'");
        Ply ply;
        for (const Element& e : elements_)
            if (e.name == "vertex")
                readVertices(e, ply);
            else if (e.name == "face" && withFaces)
                readFaces(e, vertex->count, ply);
            else
                forRows(e, [](const Row&) {});
        return ply;
    }

private:
    [[noreturn]] void fail(const std::string& what, const std::string& remedy =
                                                        "the file is cut off or broken: export it "
                                                        "again, as text or binary PLY") const {
        throw Error(Error::Kind::BadInput, fmt::format("{}, byte {}: {}", file_, at_, what),
                    remedy);
    }

    std::string line() {
        const std::size_t end = bytes_.find('\n', at_);
        if (end == std::string::npos) fail("the header does not end");
        std::string words = bytes_.substr(at_, end - at_);
        if (!words.empty() && words.back() == '\r') words.pop_back();
        at_ = end + 1;
        return words;
    }

    PlyType typeNamed(const std::string& name) const {
        constexpr std::array<std::array<const char*, 2>, 8> kNames{{{"char", "int8"},
                                                                    {"uchar", "uint8"},
                                                                    {"short", "int16"},
                                                                    {"ushort", "uint16"},
                                                                    {"int", "int32"},
                                                                    {"uint", "uint32"},
                                                                    {"float", "float32"},
                                                                    {"double", "float64"}}};
        for (std::size_t t = 0; t < kNames.size(); ++t)
            if (name == kNames[t][0] || name == kNames[t][1]) return PlyType(t);
        fail("'" + name + "' is no type of number that is read",
             "export the file with numbers of the types char, uchar, short, ushort, int, uint, "
             "float or double");
    }

    void readHeader() {
        at_ = bytes_.size() - withoutByteOrderMark(bytes_).size();
        if (line() != "ply") fail("this is not a PLY file, which begins with 'ply'");
        for (;;) {
            std::istringstream words(line());
            std::string key, first;
            words >> key;
            if (key == "end_header") break;
            if (key.empty() || key == "comment" || key == "obj_info") continue;
            words >> first;
            if (key == "format") {
                if (first == "ascii")
                    format_ = Format::Text;
                else if (first == "binary_little_endian")
                    format_ = Format::Little;
                else if (first == "binary_big_endian")
                    format_ = Format::Big;
                else
                    fail("the format '" + first + "' is unknown");
            } else if (key == "element") {
                long long count = -1;
                if (!(words >> count) || count < 0)
                    fail("the element '" + first + "' has no count");
                for (const Element& e : elements_)
                    if (e.name == first) fail("the element '" + first + "' is there twice");
                elements_.push_back({first, std::size_t(count), {}});
            } else if (key == "property" && !elements_.empty()) {
                Property property;
                property.isList = first == "list";
                if (property.isList) {
                    words >> first;
                    property.countType = typeNamed(first);
                    words >> first;
                }
                property.type = typeNamed(first);
                if (!(words >> property.name)) fail("a property has no name");
                elements_.back().properties.push_back(property);
            } else {
                fail("'" + key + "' does not belong into a header");
            }
        }
        if (format_ == Format::None) fail("the header names no format");
    }

    /// Each number takes at least a byte, so that a forged count allocates nothing.
    bool hasRoom(double numbers) const { return numbers <= double(bytes_.size() - at_); }

    double number(PlyType type) {
        if (format_ == Format::Text) return textNumber();
        const std::size_t size = sizeOf(type);
        if (bytes_.size() - at_ < size) fail("the file ends before its last element");
        std::uint64_t bits = 0;
        for (std::size_t k = 0; k < size; ++k) {
            const std::size_t byte = format_ == Format::Little ? size - 1 - k : k;
            bits = bits << 8 | std::uint8_t(bytes_[at_ + byte]);
        }
        at_ += size;
        switch (type) {
            case PlyType::Int8:
                return std::int8_t(bits);
            case PlyType::Int16:
                return std::int16_t(bits);
            case PlyType::Int32:
                return std::int32_t(bits);
            case PlyType::Float: {
                const auto half = std::uint32_t(bits);
                float value;
                std::memcpy(&value, &half, sizeof value);
                return double(value);
            }
            case PlyType::Double: {
                double value;
                std::memcpy(&value, &bits, sizeof value);
                return value;
            }
            default:
                return double(bits);
        }
    }

    double textNumber() {
        constexpr const char* kBlank = " \t\r\n";
        at_ = bytes_.find_first_not_of(kBlank, at_);
        if (at_ == std::string::npos)
            at_ = bytes_.size(), fail("the file ends before its last element");
        const std::size_t end = std::min(bytes_.find_first_of(kBlank, at_), bytes_.size());
        const std::size_t first = at_ + (bytes_[at_] == '+');
        const auto value = parseDouble(std::string_view(bytes_).substr(first, end - first));
        if (!value)
            fail("'" + bytes_.substr(at_, std::min<std::size_t>(end - at_, 40)) + "' is no number");
        at_ = end;
        return *value;
    }

    template <typename Visit>
    void forRows(const Element& element, const Visit& visit) {
        const std::vector<Property>& properties = element.properties;
        // Rows without properties are empty.
        if (properties.empty()) return;
        if (!hasRoom(double(element.count) * double(properties.size())))
            fail(fmt::format("{} of '{}' are announced, more than the file holds", element.count,
                             element.name));
        Row row(properties.size());
        for (std::size_t i = 0; i < element.count; ++i) {
            for (std::size_t p = 0; p < row.size(); ++p) {
                double count = 1;
                if (properties[p].isList) {
                    count = number(properties[p].countType);
                    if (!(count >= 0 && count == std::floor(count) && hasRoom(count)))
                        fail(fmt::format("a list has {:.10g} entries", count));
                }
                row[p].resize(std::size_t(count));
                for (double& value : row[p]) value = number(properties[p].type);
            }
            visit(row);
        }
    }

    void readVertices(const Element& element, Ply& ply) {
        constexpr std::array<const char*, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
        std::array<std::size_t, 6> column;
        for (std::size_t k = 0; k < 6; ++k) column[k] = element.column(kNames[k], false);
        const std::size_t none = element.properties.size();
        if (std::count(column.begin(), column.begin() + 3, none) > 0)
            fail("vertices lack x, y or z");
        const bool normals = std::count(column.begin() + 3, column.end(), none) == 0;
        forRows(element, [&](const Row& row) {
            auto at = [&](std::size_t k) { return row[column[k]][0]; };
            ply.points.push_back({at(0), at(1), at(2)});
            if (normals) ply.normals.push_back(Vec3f(Vec3d{at(3), at(4), at(5)}));
        });
    }

    void readFaces(const Element& element, std::size_t points, Ply& ply) {
        const std::size_t column =
            std::min(element.column("vertex_indices", true), element.column("vertex_index", true));
        const double end = std::min(double(points), 0x1p32);  // corners have 32 bits
        forRows(element, [&](const Row& row) {
            if (column == row.size()) return;
            for (const double v : row[column])
                if (!(v >= 0 && v < end && v == std::floor(v)))
                    fail(fmt::format("a face names point {:.10g} of {}", v, points));
            ply.faces.emplace_back(row[column].begin(), row[column].end());
        });
    }

    const std::string& file_;
    const std::string& bytes_;
    std::size_t at_ = 0;
    Format format_ = Format::None;
    std::vector<Element> elements_;
};

}  // namespace

Ply readPlyPoints(const std::string& file, const std::string& bytes) {
    return Reader(file, bytes).read(false);
}

Ply readPlyFaces(const std::string& file, const std::string& bytes) {
    return Reader(file, bytes).read(true);
}

}  // namespace igeo
