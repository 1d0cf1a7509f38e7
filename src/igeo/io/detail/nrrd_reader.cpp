#include <igeo/io/detail/nrrd_reader.h>

#include <fmt/core.h>
#include <igeo/base/detail/numbers.h>
#include <igeo/base/detail/text.h>
#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/voxel_values.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace igeo {

namespace {

using Type = NumberType;
constexpr std::string_view kHeaderBlank = " \t\r";

std::string trimmed(std::string_view text) {
    const std::size_t begin = std::min(text.find_first_not_of(kHeaderBlank), text.size());
    const std::size_t end = text.find_last_not_of(kHeaderBlank) + 1;
    return std::string(text.substr(begin, std::max(begin, end) - begin));
}

class NrrdHeader {
public:
    NrrdHeader(const std::string& file, std::string_view bytes) : file_(file) {
        std::size_t at = bytes.size() - withoutByteOrderMark(bytes).size();
        if (!bytes.substr(at).starts_with("NRRD000"))
            refuse("is no NRRD file, which begins with NRRD000", "write it again");
        for (bool first = true; at < bytes.size(); first = false) {
            const std::size_t end = std::min(bytes.find('\n', at), bytes.size());
            const std::string line = trimmed(bytes.substr(at, end - at));
            at = std::min(end + 1, bytes.size());
            if (line.empty()) break;
            const auto colon = line.find(':');
            if (first || line[0] == '#' || colon == line.npos) continue;
            if (line.compare(colon, 2, ":=") == 0) continue;  // a comment in the file
            fields_[lowerCase(trimmed(line.substr(0, colon)))] = trimmed(line.substr(colon + 1));
        }
        dataBegin = at;
    }

    [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const {
        throw Error(Error::Kind::BadInput, "'" + file_ + "' " + what, remedy);
    }
    /// The field with one of two names; empty if there is none.
    std::string field(const char* name, const char* otherwise = "") const {
        for (const char* n : {name, otherwise})
            if (const auto at = fields_.find(n); at != fields_.end()) return at->second;
        return "";
    }
    /// The numbers of a field, separated by blanks, commas and parentheses.
    std::vector<double> numbers(const char* name, const char* otherwise = "") const {
        std::vector<double> values;
        std::string text = field(name, otherwise);
        constexpr std::string_view kBetween = " \t\r,()";
        for (std::size_t at = 0; (at = text.find_first_not_of(kBetween, at)) != text.npos;) {
            const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
            const std::string word = text.substr(at, end - at);
            const auto value = parseDouble(word);
            if (!value)
                refuse(fmt::format("has '{}' among the numbers of its field '{}'",
                                   word.substr(0, 40), name),
                       "one number per voxel and three axes in space are read: write the channel "
                       "or frame you need into a file of its own");
            values.push_back(*value);
            at = end;
        }
        return values;
    }

    std::size_t dataBegin = 0;

private:
    const std::string& file_;
    std::map<std::string, std::string> fields_;
};

std::optional<Type> typeNamed(const std::string& name) {
    static constexpr std::pair<std::string_view, Type> kTypes[] = {
        {"signed char", Type::I8},
        {"int8", Type::I8},
        {"int8_t", Type::I8},
        {"uchar", Type::U8},
        {"unsigned char", Type::U8},
        {"uint8", Type::U8},
        {"uint8_t", Type::U8},
        {"short", Type::I16},
        {"short int", Type::I16},
        {"signed short", Type::I16},
        {"signed short int", Type::I16},
        {"int16", Type::I16},
        {"int16_t", Type::I16},
        {"ushort", Type::U16},
        {"unsigned short", Type::U16},
        {"unsigned short int", Type::U16},
        {"uint16", Type::U16},
        {"uint16_t", Type::U16},
        {"int", Type::I32},
        {"signed int", Type::I32},
        {"int32", Type::I32},
        {"int32_t", Type::I32},
        {"uint", Type::U32},
        {"unsigned int", Type::U32},
        {"uint32", Type::U32},
        {"uint32_t", Type::U32},
        {"longlong", Type::I64},
        {"long long", Type::I64},
        {"long long int", Type::I64},
        {"signed long long", Type::I64},
        {"signed long long int", Type::I64},
        {"int64", Type::I64},
        {"int64_t", Type::I64},
        {"ulonglong", Type::U64},
        {"unsigned long long", Type::U64},
        {"unsigned long long int", Type::U64},
        {"uint64", Type::U64},
        {"uint64_t", Type::U64},
        {"float", Type::F32},
        {"double", Type::F64}};
    for (const auto& [known, type] : kTypes)
        if (name == known) return type;
    return std::nullopt;
}

void readSize(const NrrdHeader& header, VoxelVolume& volume) {
    const std::vector<double> sizes = header.numbers("sizes");
    if (header.field("dimension") != "3" || sizes.size() != 3)
        header.refuse(fmt::format("has dimension '{}' and {} sizes; 3 are read",
                                  header.field("dimension").substr(0, 40), sizes.size()),
                      "write the frame or channel you need into a file of its own");
    for (std::size_t a = 0; a < 3; ++a) {
        if (!(sizes[a] >= 1 && sizes[a] < 0x1p31 && sizes[a] == std::floor(sizes[a])))
            header.refuse(fmt::format("has {} voxels along an axis", sizes[a]),
                          "the header is broken: write the file again");
        volume.size[a] = std::size_t(sizes[a]);
    }
}

/// A number per axis; NaN for those that the header does not state.
std::vector<double> perAxis(const NrrdHeader& header, const char* name,
                            const char* otherwise = "") {
    std::vector<double> values = header.numbers(name, otherwise);
    if (values.empty()) values.assign(3, std::nan(""));
    if (values.size() != 3)
        header.refuse(fmt::format("has {} {}; 3 are read", values.size(), name),
                      "the header is broken: write the file again");
    return values;
}

/// Axes along x, y and z, by the spacings or the range of each axis.
void readSpacings(const NrrdHeader& header, VoxelVolume& volume) {
    volume.warnings.push_back(
        "the header has no space directions: the axes of the voxels are taken for x, y and z");
    const std::vector<double> spacings = perAxis(header, "spacings"),
                              mins = perAxis(header, "axis mins", "axismins"),
                              maxs = perAxis(header, "axis maxs", "axismaxs");
    std::istringstream centers(lowerCase(header.field("centers", "centerings")));
    std::string none;
    for (std::size_t a = 0; a < 3; ++a) {
        std::string center;
        centers >> center;
        // A range begins at the first sample of `node`, and half a voxel before that of `cell`,
        // which Teem takes where the header states neither.
        const bool atNodes = center == "node";
        const double inRange = (maxs[a] - mins[a]) / (double(volume.size[a]) - (atNodes ? 1 : 0));
        double spacing = std::isnan(spacings[a]) ? inRange : spacings[a];
        if (std::isnan(spacing)) {
            spacing = 1;
            none += fmt::format("{}{}", none.empty() ? "" : ", ", a);
        }
        if (std::abs(spacing - inRange) > 1e-3 * std::abs(inRange))
            volume.warnings.push_back(
                fmt::format("the header has spacing {:g} along axis {}, and axis mins and maxs "
                            "make it {:g}: {:g} is taken",
                            spacing, a, inRange, spacing));
        volume.axis[a][int(a)] = spacing;
        if (!std::isnan(mins[a])) volume.origin[int(a)] = mins[a] + (atNodes ? 0 : spacing / 2);
    }
    if (!none.empty())
        volume.warnings.push_back("the header has no spacing: 1 is taken along axis " + none);
}

void readPlace(const NrrdHeader& header, VoxelVolume& volume) {
    const std::vector<double> directions = header.numbers("space directions"),
                              origin = header.numbers("space origin");
    if (directions.empty()) {
        readSpacings(header, volume);
    } else if (directions.size() != 9) {
        header.refuse(
            fmt::format("has {} numbers of space directions; 9 are read", directions.size()),
            "write a volume of three dimensions in space");
    }
    for (std::size_t k = 0; k < directions.size(); ++k)
        volume.axis[k / 3][int(k % 3)] = directions[k];
    if (!origin.empty() && origin.size() != 3)
        header.refuse(fmt::format("has an origin of {} numbers; 3 are read", origin.size()),
                      "the header is broken: write the file again");
    if (!origin.empty()) volume.origin = {origin[0], origin[1], origin[2]};
}

/// The data file that a header names; empty: there is none.
std::string dataFileOf(const NrrdHeader& header, const std::string& file) {
    const std::string name = header.field("data file", "datafile");
    return name.empty() ? "" : (std::filesystem::path(file).parent_path() / name).string();
}

/// The number in a field; 0 if there is none.
double numberOr0(const NrrdHeader& header, const char* name) {
    const std::vector<double> numbers = header.numbers(name);
    return numbers.empty() ? 0 : numbers[0];
}

/// The data after the lines that the header says to skip.
std::string_view behindLines(const NrrdHeader& header, std::string_view data) {
    const double lines = numberOr0(header, "line skip");
    for (double k = 0; k < lines; ++k) {
        const auto end = data.find('\n');
        if (end == data.npos) header.refuse("has fewer lines than it skips", "write it again");
        data.remove_prefix(end + 1);
    }
    return data;
}

std::vector<float> valuesFromText(const NrrdHeader& header, std::string_view text,
                                  std::size_t count) {
    constexpr std::string_view kBetween = " \t\r\n,";
    std::vector<float> values;
    for (std::size_t at = 0; (at = text.find_first_not_of(kBetween, at)) != text.npos;) {
        const std::size_t end = std::min(text.find_first_of(kBetween, at), text.size());
        const auto value = parseDouble(text.substr(at, end - at));
        if (!value)
            header.refuse(fmt::format("has '{}' among its values", text.substr(at, 40)),
                          "the file is broken: write it again");
        values.push_back(float(*value));
        at = end;
    }
    if (values.size() != count)
        header.refuse(fmt::format("holds {} of {} values", values.size(), count),
                      "the file is cut off or broken: write it again");
    return values;
}

std::vector<float> valuesOf(const NrrdHeader& header, const std::string& file,
                            std::string_view data, Type type, std::size_t count) {
    const std::string encoding = lowerCase(header.field("encoding"));
    if (encoding == "ascii" || encoding == "text" || encoding == "txt")
        return valuesFromText(header, data, count);
    const bool packed = encoding == "gzip" || encoding == "gz";
    if (!packed && encoding != "raw")
        header.refuse(
            "is encoded as '" + encoding.substr(0, 40) + "'; raw, gzip and ascii are read",
            "write it again as one of them");
    if (packed && !isGzip(data))
        header.refuse("has no gzip data, as its header says",
                      "the file is damaged: write it again");
    const std::string endian = lowerCase(header.field("endian"));
    if (sizeOf(type) > 1 && endian != "little" && endian != "big")
        header.refuse("does not say its byte order: there is no 'endian: little' or 'big'",
                      "add it to the header");
    const double skip = numberOr0(header, "byte skip");
    const std::size_t size = count * sizeOf(type);
    // A negative skip: the data are the last bytes.
    if (skip < 0 && !packed) data.remove_prefix(data.size() - std::min(size, data.size()));
    const std::size_t from = skip > 0 ? std::size_t(std::min(skip, 0x1p40)) : 0;
    const std::string raw =
        packed ? dataOf(file, data, from, from + size) : rawDataOf(file, data, from, from + size);
    return voxelsOf(file, raw, type, endian == "big");
}

}  // namespace

VoxelVolume readNrrd(const std::string& file, const std::string& bytes) {
    const NrrdHeader header(file, bytes);
    VoxelVolume volume;
    volume.file = file;
    readSize(header, volume);
    readPlace(header, volume);
    const std::size_t count = voxelCount(file, volume.size);
    const auto type = typeNamed(lowerCase(header.field("type")));
    if (!type)
        header.refuse(
            "has voxels of type '" + header.field("type").substr(0, 40) + "', which is no number",
            "convert it to one number per voxel, as float");
    volume.kind = fmt::format("NRRD, {}", nameOf(*type));

    std::string beside;
    std::string_view data = std::string_view(bytes).substr(header.dataBegin);
    if (const std::string name = header.field("data file", "datafile"); !name.empty()) {
        if (name.starts_with("LIST") || name.find('%') != name.npos)
            header.refuse("has its data in several files", "write them into one file");
        beside = fileBytes(dataFileOf(header, file));
        data = beside;
    }
    volume.values = valuesOf(header, file, behindLines(header, data), *type, count);
    return volume;
}

std::string nrrdDataFile(const std::string& file, std::string_view begin) {
    return dataFileOf(NrrdHeader(file, begin), file);
}

}  // namespace igeo
