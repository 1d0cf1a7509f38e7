/// Points joined by lines or polygons, with data at the points: what geometry files hold.
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
    std::vector<double> values;  ///< components of each point after those of the point before
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

/// As vtkPolyData. Points are in world units.
struct PolyData {
    std::vector<Vec3d> points;
    Cells lines;     ///< polylines; a closed one repeats its first point
    Cells polygons;  ///< counterclockwise seen from outside
    std::vector<PointData> data;
    std::vector<PointData> lineData;  ///< per line instead of per point
    std::vector<PointData> faceData;  ///< per polygon instead of per point
};

}  // namespace igeo
