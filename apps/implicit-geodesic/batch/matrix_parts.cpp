#include "batch/matrix_parts.h"

#include <igeo/results/distance_matrix.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "file_ending.h"
#include "json_file.h"
#include "option_words.h"

namespace {

struct MatrixPart {
    std::string file;
    Json document;
    std::size_t first = 0, count = 0;
    std::vector<igeo::MatrixPlace> seeds = {}, targets = {};
};

/// The rows or columns of a part, with what a table shows of them.
std::vector<igeo::MatrixPlace> placesOf(const Json& list) {
    std::vector<igeo::MatrixPlace> places;
    for (const Json& entry : list) {
        igeo::MatrixPlace place;
        if (entry.contains("group")) {
            entry.at("group").get_to(place.name);
            entry.at("points").get_to(place.points);
        } else {
            const Json& p = entry.at("position");
            place.point.offSurface = p.is_null();
            if (p.is_null()) {
                const Json& off = entry.at("snapDistance");
                place.point.distance = off.is_null() ? igeo::kInfinity : off.get<double>();
                places.push_back(place);
                continue;
            }
            place.point.position = {p.at(0).get<double>(), p.at(1).get<double>(),
                                    p.at(2).get<double>()};
        }
        places.push_back(place);
    }
    return places;
}

MatrixPart readPart(const std::string& file) {
    MatrixPart part{file, readJson(file)};
    try {
        if (part.document.at("type") != "matrix") inputError(file + " is no matrix", "name a part");
        if (!part.document.contains("rows"))
            inputError(file + " is a whole matrix, no part of one",
                       "parts are written by --matrix FILE.json --matrix-rows K/N");
        if (Json& warnings = part.document["warnings"]; warnings.is_null())
            warnings = Json::array();
        for (const char* list : {"seeds", "targets", "distance", "warnings"})
            if (!part.document.at(list).is_array())
                inputError(file + ": '" + list + "' is no list", "write it again");
        part.document["rows"].at("first").get_to(part.first);
        part.document["rows"].at("count").get_to(part.count);
        if (part.document["distance"].size() != part.count)
            inputError(file + " lacks rows", "write it again");
        for (const Json& row : part.document["distance"])
            for (const Json& d : row)
                if (!d.is_number() && !d.is_null())
                    inputError(file + " holds distances that are no numbers", "write it again");
        part.document.at("asymmetry");
        const Json& seconds = part.document["seconds"];
        if (!seconds.is_null() && !seconds.is_object())
            inputError(file + ": 'seconds' is no object", "write it again");
        for (const auto& [stage, time] : seconds.items()) static_cast<void>(time.get<double>());
        part.seeds = placesOf(part.document["seeds"]);
        part.targets = placesOf(part.document["targets"]);
    } catch (const Json::exception&) {
        inputError(file + " is no part of a matrix", "write it again");
    }
    return part;
}

/// Adds the times of a part to those of the whole, and takes the larger memory; null where a part
/// has none.
void addCost(Json& whole, const Json& part) {
    Json& seconds = whole["seconds"];
    if (part["seconds"].is_null()) seconds = nullptr;
    if (!seconds.is_null())
        for (const auto& [stage, time] : part["seconds"].items())
            seconds[stage] = seconds.value(stage, 0.0) + time.get<double>();
    Json& memory = whole["peakMemoryBytes"];
    if (memory.is_null() || part["peakMemoryBytes"].is_null())
        memory = nullptr;
    else
        memory = std::max(memory, part["peakMemoryBytes"]);
}

void addWarning(Json& whole, const Json& warning) {
    Json& all = whole["warnings"];
    if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
}

/// All parts must agree in everything except the rows: surface, points, program.
void requireSameMatrix(const MatrixPart& a, const MatrixPart& b) {
    static const std::set<std::string> kOwn{"rows",     "distance", "warnings",       "command",
                                            "versions", "seconds",  "peakMemoryBytes"};
    for (const auto& [member, value] : a.document.items())
        if (kOwn.count(member) == 0 &&
            (!b.document.contains(member) || b.document[member] != value))
            inputError(a.file + " and " + b.file + " differ in '" + member +
                           "': they are parts of different matrices",
                       "make all parts with the same options, but for --matrix-rows and files");
}

void requireAllRows(const std::vector<MatrixPart>& parts) {
    std::size_t next = 0;
    const std::size_t rows = parts.front().document.at("seeds").size();
    auto range = [](std::size_t begin, std::size_t end) {
        return "rows " + std::to_string(begin) + " to " + std::to_string(end - 1);
    };
    auto missing = [&](std::size_t end) {
        inputError(range(next, end) + " of " + std::to_string(rows) + " (from 0) are in no part",
                   "name all parts, K/N for every K from 1 to N");
    };
    for (const MatrixPart& part : parts) {
        if (part.count == 0) continue;
        if (part.first > next) missing(part.first);
        if (part.first < next)
            inputError(part.file + " begins with row " + std::to_string(part.first) +
                           ", which another part holds as well",
                       "name each part once, and parts K/N of one N only");
        next += part.count;
    }
    if (next < rows) missing(rows);
}

/// The command line that merges the parts.
std::vector<std::string> commandOf(const std::vector<std::string>& files,
                                   const std::string& output) {
    std::vector<std::string> words{"batch", "merge", "--matrix"};
    words.insert(words.end(), files.begin(), files.end());
    words.insert(words.end(), {"-o", output});
    return words;
}

}  // namespace

std::string joinedMatrix(const std::vector<std::string>& files, const std::string& output,
                         const Console& console) {
    const std::string ending = endingOf(output);
    std::vector<MatrixPart> parts;
    for (const std::string& file : files) {
        parts.push_back(readPart(file));
        requireSameMatrix(parts.front(), parts.back());
    }
    std::sort(parts.begin(), parts.end(), [](const MatrixPart& a, const MatrixPart& b) {
        return std::pair(a.first, a.count) < std::pair(b.first, b.count);
    });
    igeo::DistanceMatrix matrix;
    requireAllRows(parts);
    Json& whole = parts.front().document;
    matrix.seeds = parts.front().seeds;
    matrix.targets = parts.front().targets;
    for (const MatrixPart& part : parts)
        for (const Json& row : part.document["distance"]) {
            if (row.size() != matrix.targets.size())
                inputError(part.file + " lacks columns", "write it again");
            for (const Json& d : row) {
                const bool skipped =
                    matrix.targets[matrix.distance.size() % row.size()].point.offSurface;
                const double none = skipped ? std::nan("") : igeo::kInfinity;
                matrix.distance.push_back(d.is_null() ? none : d.get<double>());
            }
        }
    matrix.withReasons =
        whole.contains("parameters") && whole["parameters"].value("skipOffSurface", false);
    if (whole["asymmetry"].is_null()) igeo::makeSymmetric(matrix);
    const std::string oneWay = inOptionWords(igeo::oneWayWarning(matrix));
    if (!oneWay.empty()) console.warning(oneWay);
    if (ending == ".npy") return igeo::matrixNpy(matrix);
    if (ending != ".json") return igeo::matrixCsv(matrix);

    whole.erase("rows");
    whole["command"] = commandOf(files, output);
    for (std::size_t k = 1; k < parts.size(); ++k) {
        addCost(whole, parts[k].document);
        for (const Json& warning : parts[k].document["warnings"]) addWarning(whole, warning);
    }
    if (!oneWay.empty()) addWarning(whole, oneWay);
    whole["distance"] = Json::array();
    for (std::size_t s = 0; s < matrix.seeds.size(); ++s) {
        Json row = Json::array();
        for (std::size_t t = 0; t < matrix.targets.size(); ++t) {
            const double d = matrix.at(s, t);
            row.push_back(d < igeo::kInfinity ? Json(d) : Json(nullptr));
        }
        whole["distance"].push_back(std::move(row));
    }
    whole["asymmetry"] = matrix.asymmetry;
    return whole.dump() + "\n";
}
