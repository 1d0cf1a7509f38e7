// From the north pole of data/sphere.vdb to the south pole, along the surface.
#include <igeo/band_width.h>
#include <igeo/godunov.h>
#include <igeo/level_set_band.h>
#include <igeo/trace.h>

#include <iostream>

int main() try {
    igeo::LevelSet surface = igeo::checkLevelSet(igeo::readLevelSetGrid({"data/sphere.vdb", ""}));
    const igeo::LevelSetStats& st = surface.stats;
    const auto bounds = igeo::bandBounds(st.largestCurvature, st.reach, st.halfWidth);
    const double h = igeo::defaultBandWidth(2, st.largestCurvature, bounds);  // voxels
    igeo::widen(surface, h);  // does nothing if the level set is wide enough
    const igeo::Band band = igeo::bandFromLevelSet(surface, h);

    auto onSurface = [&](const igeo::Vec3d& pWorld) {
        return igeo::nearestSurfacePoint(band, band.transform.indexFromWorld(pWorld));
    };
    const igeo::Field field = igeo::marchGodunov(band, igeo::Metric{}, {onSurface({0, 0, 1})});
    const auto gradient = igeo::surfaceGradient(band, field);
    const igeo::Path path = igeo::tracePath(band, field, gradient, onSurface({0, 0, -1}));
    std::cout << igeo::toString(path.status) << ", " << path.length * band.transform.dx
              << " long\n";
} catch (const igeo::Error& e) {
    std::cerr << e.what() << "\n" << e.remedy() << "\n";
    return 1;
}
