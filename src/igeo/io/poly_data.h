/// Points joined by lines or polygons, with data at the points: the content of geometry files.
#pragma once

#include <igeo/base/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

/// Data at the points of a PolyData.
struct PointData {
    enum class Type { Float32, Float64, Int32 };
    std::string name;            ///< "distance"
    std::vector<double> values;  ///< all components of a point, then those of the next point
    int components = 1;
    Type type = Type::Float32;  ///< in the file
};

/// Lists of point numbers: cell i is members[ends[i - 1] .. ends[i]), with ends[-1] = 0.
struct Cells {
    std::vector<std::uint32_t> members;
    std::vector<std::size_t> ends;

    void add(const std::vector<std::uint32_t>& cell) {
        members.insert(members.end(), cell.begin(), cell.end());
        ends.push_back(members.size());
    }
    std::size_t size() const { return ends.size(); }
};

/// The content of a vtkPolyData. Points are in world units.
struct PolyData {
    std::vector<Vec3d> points;
    Cells lines;     ///< polylines; closed ones repeat their first point
    Cells polygons;  ///< counterclockwise seen from outside
    std::vector<PointData> data;
    std::vector<PointData> lineData;  ///< per line instead of per point
    std::vector<PointData> faceData;  ///< per polygon instead of per point
};

}  // namespace igeo
