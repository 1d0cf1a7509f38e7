#include <igeo/io/detail/text_mesh_reader.h>

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/detail/single.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <utility>

namespace igeo {

namespace {

constexpr std::string_view kLineBlank = " \t\r\f\v";

/// The lines of a file, and the words of the current line.
class Lines {
public:
    /// @param hasComments  whether # begins one
    Lines(const std::string& file, std::string_view bytes, bool hasComments = true)
        : file_(file), bytes_(withoutByteOrderMark(bytes)), hasComments_(hasComments) {}

    /// Moves to the next line with a word; false at the end.
    bool next() {
        while (!bytes_.empty()) {
            line_ = cutLine(bytes_);
            if (hasComments_) line_ = line_.substr(0, line_.find('#'));
            ++number_;
            if (line_.find_first_not_of(kLineBlank) != line_.npos) return true;
        }
        return false;
    }
    /// The next word of the line; empty at its end.
    std::string_view word() {
        const std::size_t begin = std::min(line_.find_first_not_of(kLineBlank), line_.size());
        const std::size_t end = std::min(line_.find_first_of(kLineBlank, begin), line_.size());
        const std::string_view word = line_.substr(begin, end - begin);
        line_.remove_prefix(end);
        // OBJ files may break lines.
        if (word == "\\" && line_.find_first_not_of(kLineBlank) == line_.npos && next())
            return this->word();
        return word;
    }
    double number(const char* what) {
        std::string_view text = word();
        if (text.empty()) fail(fmt::format("{} is missing", what));
        if (text[0] == '+') text.remove_prefix(1);
        const auto value = parseDouble(text);
        if (!value) fail(fmt::format("'{}' is no number", text.substr(0, 40)));
        return *value;
    }
    Vec3d position() {
        const double x = number("x"), y = number("y"), z = number("z");
        return {x, y, z};
    }
    [[noreturn]] void fail(
        const std::string& what,
        const std::string& remedy = "the file is cut off or broken: export it again") const {
        throw Error(Error::Kind::BadInput, fmt::format("{}, line {}: {}", file_, number_, what),
                    remedy);
    }

private:
    const std::string& file_;
    std::string_view bytes_, line_;  ///< those left, and the rest of the current line
    bool hasComments_;
    std::size_t number_ = 0;
};

long long wholeNumber(std::string_view text, const Lines& lines) {
    long long value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        lines.fail(fmt::format("'{}' is no whole number", text.substr(0, 40)));
    return value;
}

constexpr long long kMostVertices = 1LL << 31;

/// @param vertices  their number
std::uint32_t cornerOf(long long number, long long vertices, const Lines& lines,
                       std::string_view named) {
    if (number < 0 || number >= vertices)
        lines.fail(fmt::format("a face names vertex {} of {}", named, vertices));
    return std::uint32_t(number);
}

}  // namespace

PolygonMesh readObjMesh(const std::string& file, const std::string& bytes) {
    PolygonMesh mesh;
    Lines lines(file, bytes);
    std::vector<std::uint32_t> face;
    std::uint32_t largest = 0;
    while (lines.next()) {
        const std::string_view key = lines.word();
        if (key == "v") {
            mesh.vertices.push_back(lines.position());
        } else if (key == "f" || key == "fo") {
            face.clear();
            for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
                // vertex/texture/normal
                const std::string_view vertex = word.substr(0, word.find('/'));
                const long long number = wholeNumber(vertex, lines);
                if (number == 0)
                    lines.fail("a face names vertex 0, and OBJ files count vertices from 1 on",
                               "add 1 to all vertices of faces, or export the file again");
                const auto count = (long long)mesh.vertices.size();
                // A face may precede its vertices.
                face.push_back(cornerOf(number < 0 ? count + number : number - 1,
                                        number < 0 ? count : kMostVertices, lines, vertex));
                largest = std::max(largest, face.back());
            }
            mesh.addFace(face);
        }
    }
    if (!mesh.corners.empty() && largest >= mesh.vertices.size())
        lines.fail(fmt::format("a face names vertex {} of {}", largest + 1, mesh.vertices.size()));
    return mesh;
}

PolygonMesh readOffMesh(const std::string& file, const std::string& bytes) {
    PolygonMesh mesh;
    Lines lines(file, bytes);
    if (!lines.next()) lines.fail("the file holds no line");
    const std::string_view kind = lines.word();
    if (!kind.ends_with("OFF")) lines.fail("this is not an OFF file, which begins with OFF");
    if (kind.find_first_of("4n") != kind.npos)
        lines.fail(fmt::format("'{}' is not in three dimensions", kind));
    std::string_view word = lines.word();
    if (word == "BINARY") lines.fail("binary OFF files are not read; export it as text");
    if (word.empty()) {
        if (!lines.next()) lines.fail("the counts are missing");
        word = lines.word();
    }
    const long long vertices = wholeNumber(word, lines), faces = wholeNumber(lines.word(), lines);
    if (vertices < 0 || faces < 0) lines.fail("a count is negative");
    for (long long v = 0; v < vertices; ++v) {
        if (!lines.next())
            lines.fail(fmt::format("the file ends after {} of {} vertices", v, vertices));
        mesh.vertices.push_back(lines.position());
    }
    std::vector<std::uint32_t> face;
    for (long long f = 0; f < faces; ++f) {
        if (!lines.next()) lines.fail(fmt::format("the file ends after {} of {} faces", f, faces));
        const long long corners = wholeNumber(lines.word(), lines);
        face.clear();
        for (long long k = 0; k < corners; ++k) {
            const std::string_view corner = lines.word();
            face.push_back(cornerOf(wholeNumber(corner, lines), vertices, lines, corner));
        }
        mesh.addFace(face);
    }
    return mesh;
}

std::vector<Vec3d> readTextStlCorners(const std::string& file, const std::string& bytes) {
    std::vector<Vec3d> corners;
    Lines lines(file, bytes, /*hasComments=*/false);        // but lines: 1.#QNAN is a normal
    bool isStl = false, isSolid = false, isNormal = false;  // what the next word is in
    while (lines.next())
        for (std::string word(lines.word()); !word.empty(); word = lines.word()) {
            if (word[0] == '#') break;
            word = lowerCase(std::move(word));
            if (word == "solid" || word == "endsolid") {
                isStl = true;
                isSolid = word == "solid";
                break;  // its name follows
            }
            if (!isSolid) lines.fail("this is not an STL file, which begins with solid");
            if (word == "facet") {
                isNormal = true;
            } else if (word == "outer") {
                isNormal = false;
            } else if (word == "vertex") {
                corners.push_back(inSingle(lines.position()));
            } else if (word == "endfacet" && corners.size() % 3 != 0) {
                lines.fail("a facet has other than three vertices");
            } else if (!isNormal && word != "loop" && word != "endloop" && word != "endfacet") {
                lines.fail(fmt::format("'{}' does not belong into a facet", word.substr(0, 40)));
            }
        }
    if (!isStl || isSolid) lines.fail("the file ends before endsolid");
    return corners;
}

}  // namespace igeo
