/// Parts of JSON common to documents of runs and surveys.
#pragma once

#include <igeo/base/types.h>
#include <igeo/base/version.h>
#include <igeo/surface/mesh_facts.h>
#include <igeo/surface/unresolved.h>

#include <cmath>
#include <optional>
#include <string>

#include "json_file.h"

/// JSON must be UTF-8, which file and grid names may not be.
inline std::string dump(const Json& j, int indent) {
    return j.dump(indent, ' ', false, Json::error_handler_t::replace) + "\n";
}

inline Json meshJson(const igeo::MeshFacts& m) {
    return {{"points", m.points},
            {"triangles", m.triangles},
            {"dropped", m.dropped},
            {"repeated", m.repeated},
            {"junctions", m.junctions},
            {"components", m.components},
            {"boundaryEdges", m.boundaryEdges},
            {"holes", m.holes},
            {"nonManifoldEdges", m.nonManifoldEdges},
            {"nonOrientable", m.nonOrientable},
            {"crossingPairs", m.crossingPairs},
            {"closed", m.closed}};
}

inline Json triple(const igeo::Vec3d& v) { return {v.x, v.y, v.z}; }

/// JSON has no infinity: unknown values are null.
inline Json finiteOrNull(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

inline Json shareOrNull(const std::optional<double>& share) {
    return share ? Json(*share) : Json(nullptr);
}

inline Json unresolvedJson(const igeo::Unresolved& u) {
    return {{"thinShare", shareOrNull(u.thin)},
            {"closedShare", shareOrNull(u.closed)},
            {"gapShare", shareOrNull(u.gap)},
            {"cutOffShare", shareOrNull(u.cutOff)},
            {"eulerDifference", u.eulerDifference ? Json(*u.eulerDifference) : Json(nullptr)}};
}

inline Json header(const char* type, int schema = 2) {
    return {{"schema", schema},
            {"type", type},
            {"creator", std::string("implicit-geodesic ") + igeo::kVersion},
            {"units", "lengths and distances in world units of the surface's transform"},
            {"space", "world"}};
}
