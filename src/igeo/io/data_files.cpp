#include <igeo/io/data_files.h>

#include <igeo/base/error.h>
#include <igeo/io/detail/file_bytes.h>
#include <igeo/io/detail/json_depth.h>
#include <igeo/io/detail/nifti_reader.h>
#include <igeo/io/detail/nrrd_reader.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace igeo {

namespace {

/// The first bytes of a file, more than any header has.
std::string beginOf(const std::string& file) {
    std::string begin(std::size_t(1) << 16, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(begin.data(), std::streamsize(begin.size()));
    begin.resize(std::size_t(in.gcount()));
    return begin;
}

/// A part of a URI with %20 and the like replaced by their bytes.
std::string withoutEscapes(const std::string& uri) {
    std::string text;
    for (std::size_t k = 0; k < uri.size(); ++k) {
        const auto isDigit = [&](std::size_t i) {
            return i < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i]));
        };
        if (uri[k] != '%' || !isDigit(k + 1) || !isDigit(k + 2)) {
            text += uri[k];
            continue;
        }
        text += char(std::stoi(uri.substr(k + 1, 2), nullptr, 16));
        k += 2;
    }
    return text;
}

std::vector<std::string> buffersOf(const std::string& file) {
    using json = nlohmann::json;
    const json scene = json::parse(fileBytes(file), JsonGuard<json>(file), false);
    std::vector<std::string> files;
    if (!scene.is_object() || !scene.contains("buffers") || !scene["buffers"].is_array())
        return files;
    for (const json& buffer : scene["buffers"]) {
        if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
        const std::string uri = buffer["uri"].get<std::string>();
        if (uri.starts_with("data:")) continue;
        files.push_back((std::filesystem::path(file).parent_path() / withoutEscapes(uri)).string());
    }
    return files;
}

}  // namespace

std::vector<std::string> dataFilesOf(const std::string& file) {
    const std::string ending = endingBeforeGz(file);
    std::vector<std::string> files;
    try {
        if (ending == ".gltf")
            files = buffersOf(file);
        else if (ending == ".nhdr" || ending == ".nrrd")
            files = {nrrdDataFile(file, beginOf(file))};
        else if (ending == ".hdr" || ending == ".img")
            files = {otherOfPair(file)};
    } catch (const Error&) {
        return {};
    }
    if (files == std::vector<std::string>{""}) files.clear();
    return files;
}

}  // namespace igeo
