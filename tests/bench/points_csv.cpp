#include "points_csv.h"

#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>

namespace igeo::test {

void writePoints(const std::string& file, const PointsCsv& csv) {
    std::FILE* out = std::fopen(file.c_str(), "w");
    if (!out) throw std::runtime_error("cannot write " + file);
    for (std::size_t k = 0; k < csv.points.size(); ++k)
        std::fprintf(out, "%.12g,%.12g,%.12g,%.12g\n", csv.points[k].x, csv.points[k].y,
                     csv.points[k].z, csv.distance[k]);
    if (std::fclose(out) != 0) throw std::runtime_error("cannot write " + file);
}

PointsCsv readPoints(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw std::runtime_error("cannot read " + file);
    PointsCsv csv;
    for (std::string line; std::getline(in, line);) {
        Vec3d p;
        double d = 0;
        if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &p.x, &p.y, &p.z, &d) != 4)
            throw std::runtime_error(file + ": '" + line + "' is not x,y,z,distance");
        csv.add(p, d);
    }
    return csv;
}

}  // namespace igeo::test
