#include <igeo/ply_points.h>

#include <igeo/error.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>

namespace igeo {

namespace {

using Kind = Error::Kind;

enum class Type { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

std::size_t sizeOf(Type type) {
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[std::size_t(type)];
}

struct Property {
    std::string name;
    Type type;
    bool isList = false;
    Type countType = Type::Uint8;
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

class PlyReader {
public:
    PlyReader(const std::string& file, const std::string& bytes) : file_(file), bytes_(bytes) {}

    PointCloud read() {
        readHeader();
        for (const Element& element : elements_) {
            if (element.name == "vertex") return readVertices(element);
            for (std::size_t row = 0; row < element.count; ++row)
                for (const Property& property : element.properties) skip(property);
        }
        fail("there is no element 'vertex'");
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(Kind::BadInput, file_ + ", byte " + std::to_string(at_) + ": " + what,
                    "export the points again, as text or binary PLY");
    }

    std::string line() {
        const std::size_t end = bytes_.find('\n', at_);
        if (end == std::string::npos) fail("the header does not end");
        std::string text = bytes_.substr(at_, end - at_);
        if (!text.empty() && text.back() == '\r') text.pop_back();
        at_ = end + 1;
        return text;
    }

    Type typeNamed(const std::string& name) const {
        constexpr std::array<std::array<const char*, 2>, 8> kNames{{{"char", "int8"},
                                                                    {"uchar", "uint8"},
                                                                    {"short", "int16"},
                                                                    {"ushort", "uint16"},
                                                                    {"int", "int32"},
                                                                    {"uint", "uint32"},
                                                                    {"float", "float32"},
                                                                    {"double", "float64"}}};
        for (std::size_t t = 0; t < kNames.size(); ++t)
            if (name == kNames[t][0] || name == kNames[t][1]) return Type(t);
        fail("'" + name + "' is no type of number");
    }

    void readHeader() {
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

    double number(Type type) {
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
            case Type::Int8:
                return std::int8_t(bits);
            case Type::Int16:
                return std::int16_t(bits);
            case Type::Int32:
                return std::int32_t(bits);
            case Type::Float: {
                const auto half = std::uint32_t(bits);
                float value;
                std::memcpy(&value, &half, sizeof value);
                return double(value);
            }
            case Type::Double: {
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
        const char* first = bytes_.data() + at_ + (bytes_[at_] == '+');
        double value = 0;
        const auto [stop, error] = std::from_chars(first, bytes_.data() + end, value);
        if (error != std::errc() || stop != bytes_.data() + end)
            fail("'" + bytes_.substr(at_, std::min<std::size_t>(end - at_, 40)) + "' is no number");
        at_ = end;
        return value;
    }

    void skip(const Property& property) {
        if (!property.isList) {
            number(property.type);
            return;
        }
        const double count = number(property.countType);
        if (!(count >= 0)) fail("a list has " + std::to_string(count) + " entries");
        for (double k = 0; k < count; ++k) number(property.type);
    }

    PointCloud readVertices(const Element& element) {
        constexpr std::array<const char*, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
        std::array<int, 6> found;
        found.fill(-1);
        for (std::size_t p = 0; p < element.properties.size(); ++p)
            for (std::size_t k = 0; k < 6; ++k)
                if (element.properties[p].name == kNames[k] && !element.properties[p].isList)
                    found[k] = int(p);
        if (std::min({found[0], found[1], found[2]}) < 0) fail("vertices lack x, y or z");
        const bool normals = std::min({found[3], found[4], found[5]}) >= 0;
        // Every number takes a byte at least: a count that is made up allocates nothing.
        if (element.count > (bytes_.size() - at_) / 3)
            fail(std::to_string(element.count) +
                 " vertices are announced, more than the file holds");

        PointCloud cloud{file_, {}, {}};
        cloud.points.reserve(element.count);
        std::vector<double> row(element.properties.size());
        for (std::size_t i = 0; i < element.count; ++i) {
            for (std::size_t p = 0; p < row.size(); ++p)
                if (element.properties[p].isList)
                    skip(element.properties[p]);
                else
                    row[p] = number(element.properties[p].type);
            auto at = [&](std::size_t k) { return row[std::size_t(found[k])]; };
            cloud.points.push_back({at(0), at(1), at(2)});
            if (normals) cloud.normals.push_back(Vec3f(Vec3d{at(3), at(4), at(5)}));
        }
        return cloud;
    }

    enum class Format { None, Text, Little, Big };

    const std::string& file_;
    const std::string& bytes_;
    std::size_t at_ = 0;
    Format format_ = Format::None;
    std::vector<Element> elements_;
};

}  // namespace

PointCloud pointsFromPly(const std::string& file, const std::string& bytes) {
    return PlyReader(file, bytes).read();
}

}  // namespace igeo
