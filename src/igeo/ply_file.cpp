#include <igeo/ply_file.h>

#include <igeo/error.h>

#include <algorithm>
#include <cstring>
#include <sstream>

namespace igeo {

namespace {

enum class Format { Ascii, Little, Big };
enum class Type { None, Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

struct Property {
    std::string name;
    Type count = Type::None;  ///< of a list: type of its length
    Type type = Type::None;
};
struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

Type typeOf(const std::string& word) {
    static const std::vector<std::pair<const char*, Type>> kTypes{
        {"char", Type::Int8},     {"int8", Type::Int8},     {"uchar", Type::Uint8},
        {"uint8", Type::Uint8},   {"short", Type::Int16},   {"int16", Type::Int16},
        {"ushort", Type::Uint16}, {"uint16", Type::Uint16}, {"int", Type::Int32},
        {"int32", Type::Int32},   {"uint", Type::Uint32},   {"uint32", Type::Uint32},
        {"float", Type::Float},   {"float32", Type::Float}, {"double", Type::Double},
        {"float64", Type::Double}};
    for (const auto& [name, type] : kTypes)
        if (word == name) return type;
    return Type::None;
}

class Reader {
public:
    Reader(std::istream& in, const std::string& file) : in_(in), file_(file) { readHeader(); }

    PlyFaces read() {
        PlyFaces ply;
        for (const Element& e : elements_) {
            const bool points = e.name == "vertex", faces = e.name == "face";
            for (std::size_t k = 0; k < e.count; ++k) {
                Vec3d p;
                for (const Property& property : e.properties) {
                    if (property.count != Type::None) {
                        readList(property, faces && (property.name == "vertex_indices" ||
                                                     property.name == "vertex_index")
                                               ? &ply.faces
                                               : nullptr);
                        continue;
                    }
                    const double value = number(property.type);
                    if (property.name.size() == 1 && property.name[0] >= 'x' &&
                        property.name[0] <= 'z')
                        p[property.name[0] - 'x'] = value;
                }
                if (points) ply.points.push_back(p);
            }
        }
        for (const auto& face : ply.faces)
            for (const std::uint32_t v : face)
                if (v >= ply.points.size())
                    fail("a face names point " + std::to_string(v) + " of " +
                         std::to_string(ply.points.size()));
        return ply;
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(Error::Kind::BadInput, "cannot read '" + file_ + "' as PLY: " + what,
                    "the file is cut off or broken: write it again");
    }

    void readHeader() {
        std::string line;
        auto next = [&] {
            if (!std::getline(in_, line)) fail("the header does not end");
            if (!line.empty() && line.back() == '\r') line.pop_back();
        };
        next();
        if (line != "ply") fail("it does not begin with 'ply'");
        for (next(); line != "end_header"; next()) {
            std::istringstream words(line);
            std::string word, name, type, count;
            words >> word;
            if (word == "format") {
                words >> name;
                if (name == "ascii")
                    format_ = Format::Ascii;
                else if (name == "binary_little_endian")
                    format_ = Format::Little;
                else if (name == "binary_big_endian")
                    format_ = Format::Big;
                else
                    fail("format '" + name + "'");
            } else if (word == "element") {
                Element e;
                if (!(words >> e.name >> e.count)) fail("'" + line + "'");
                elements_.push_back(e);
            } else if (word == "property") {
                Property p;
                words >> type;
                if (type == "list") {
                    words >> count >> type;
                    p.count = typeOf(count);
                    if (p.count == Type::None) fail("'" + line + "'");
                }
                p.type = typeOf(type);
                if (p.type == Type::None || !(words >> p.name) || elements_.empty())
                    fail("'" + line + "'");
                elements_.back().properties.push_back(p);
            }
        }
    }

    void readList(const Property& property, std::vector<std::vector<std::uint32_t>>* faces) {
        const double count = number(property.count);
        constexpr double kMost = 1e6;
        if (!(count >= 0 && count <= kMost)) fail("a list of " + std::to_string(count));
        std::vector<std::uint32_t> corners;
        for (std::size_t k = 0; k < std::size_t(count); ++k) {
            const double v = number(property.type);
            if (!faces) continue;
            if (!(v >= 0 && v < 4294967295.0)) fail("a face names point " + std::to_string(v));
            corners.push_back(std::uint32_t(v));
        }
        if (faces) faces->push_back(std::move(corners));
    }

    template <typename T>
    double binary() {
        std::array<char, sizeof(T)> bytes;
        if (!in_.read(bytes.data(), sizeof(T))) fail("it ends too early");
        const std::uint16_t one = 1;
        char lowFirst;
        std::memcpy(&lowFirst, &one, 1);
        if ((format_ == Format::Little) != (lowFirst == 1))
            std::reverse(bytes.begin(), bytes.end());
        T value;
        std::memcpy(&value, bytes.data(), sizeof(T));
        return double(value);
    }

    double number(Type type) {
        if (format_ == Format::Ascii) {
            // strtod knows nan and inf, which streams do not.
            std::string word;
            if (!(in_ >> word)) fail("it ends too early");
            char* end = nullptr;
            const double value = std::strtod(word.c_str(), &end);
            if (*end) fail("'" + word + "' is no number");
            return value;
        }
        switch (type) {
            case Type::Int8:
                return binary<std::int8_t>();
            case Type::Uint8:
                return binary<std::uint8_t>();
            case Type::Int16:
                return binary<std::int16_t>();
            case Type::Uint16:
                return binary<std::uint16_t>();
            case Type::Int32:
                return binary<std::int32_t>();
            case Type::Uint32:
                return binary<std::uint32_t>();
            case Type::Float:
                return binary<float>();
            case Type::Double:
                return binary<double>();
            case Type::None:
                break;
        }
        fail("a number of no type");
    }

    std::istream& in_;
    const std::string& file_;
    Format format_ = Format::Ascii;
    std::vector<Element> elements_;
};

}  // namespace

PlyFaces readPlyFaces(std::istream& in, const std::string& file) { return Reader(in, file).read(); }

}  // namespace igeo
