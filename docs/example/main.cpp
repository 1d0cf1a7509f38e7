// From the north pole of data/sphere.vdb to the south pole, along the surface.
#include <igeo/igeo.h>

#include <iostream>

int main() try {
    const igeo::Surface surface(igeo::readLevelSetGrid({"data/sphere.vdb", ""}));
    const igeo::GeodesicSolver solver(surface);  // Euclidean, scheme jet
    const igeo::Distance distance = solver.distance({{0, 0, 1}});
    const igeo::Polyline path = distance.path({0, 0, -1});
    std::cout << igeo::toString(path.status) << ", distance " << distance.at({0, 0, -1}) << ", "
              << path.length << " long\n";
} catch (const igeo::Error& e) {
    std::cerr << e.what() << "\n" << e.remedy() << "\n";
    return 1;
}
