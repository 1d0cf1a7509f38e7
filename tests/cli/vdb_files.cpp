#include "vdb_files.h"

#include <openvdb/io/Stream.h>

#include <cmath>
#include <sstream>

namespace igeo::test {

VdbFile readVdb(const std::string& path) {
    openvdb::io::File file(path);
    file.open(/*delayLoad=*/false);
    VdbFile out;
    out.grids = *file.getGrids();
    out.metadata = *file.getMetadata();
    return out;
}

VdbFile readVdbBytes(const std::string& bytes) {
    std::istringstream in(bytes);
    openvdb::io::Stream stream(in, /*delayLoad=*/false);
    VdbFile out;
    out.grids = *stream.getGrids();
    out.metadata = *stream.getMetadata();
    return out;
}

openvdb::FloatGrid::Ptr readDistance(const std::string& path, const std::string& name) {
    return readVdb(path).get<openvdb::FloatGrid>(name);
}

double largestDifference(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
    double largest = 0;
    const auto other = b.getConstAccessor();
    for (auto value = a.cbeginValueOn(); value; ++value) {
        float there = 0;
        if (!other.probeValue(value.getCoord(), there)) continue;
        largest = std::max(largest, std::abs(double(*value) - there));
    }
    return largest;
}

}  // namespace igeo::test
