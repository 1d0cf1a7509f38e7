#include "output/provenance.h"

#include <cstdlib>
#include <sstream>

#include "version_text.h"

namespace {

Json versionsJson() {
    Json j = Json::object();
    std::istringstream versions(versionText());  // "OpenVDB 10.0.1, file format 224"
    for (std::string line; std::getline(versions, line);)
        j[line.substr(0, line.find(' '))] = line.substr(line.find(' ') + 1);
    return j;
}

}  // namespace

Json originJson(const Provenance& p) {
    Json j = {{"command", p.command}, {"versions", versionsJson()}, {"inputs", Json::array()}};
    // digestOfFile returns "missing" where there is no regular file, such as for standard input.
    for (const auto& [file, digest] : p.inputs)
        j["inputs"].push_back(
            {{"file", file}, {"digest", digest == "missing" ? Json(nullptr) : Json(digest)}});
    return j;
}

Json costJson(const Provenance& p) {
    const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
    if (epoch && *epoch) return {{"seconds", nullptr}, {"peakMemoryBytes", nullptr}};
    Json seconds = Json::object();
    for (const auto& [stage, time] : p.seconds) seconds[stage] = time;
    return {{"seconds", seconds}, {"peakMemoryBytes", p.peakMemory}};
}
