// From the north pole of data/sphere.vdb to the south pole, along the surface.
#include <igeo/march/jet.h>
#include <igeo/path/trace.h>
#include <igeo/surface/band_bounds.h>
#include <igeo/surface/level_set_band.h>

#include <iostream>

int main() try {
    igeo::LevelSet surface = igeo::checkLevelSet(igeo::readLevelSetGrid({"data/sphere.vdb", ""}));
    const igeo::LevelSetStats& st = surface.stats;
    const double h = igeo::bandBounds(st.largestCurvature, st.reach, st.halfWidth).lower;  // voxels
    igeo::widen(surface, h);  // does nothing if the level set is wide enough
    const igeo::Band band = igeo::bandFromLevelSet(surface, h);

    auto onSurface = [&](const igeo::Vec3d& pWorld) {
        return igeo::nearestSurfacePoint(band, band.transform.indexFromWorld(pWorld));
    };
    const igeo::Field field = igeo::marchJet(band, {}, {onSurface({0, 0, 1})});
    const igeo::SurfacePoint target = onSurface({0, 0, -1});
    const igeo::Path path = igeo::tracePath(band, field, field.gradient, target);
    const double dx = band.transform.dx;
    std::cout << igeo::toString(path.status) << ", distance " << path.distance * dx << ", "
              << path.length * dx << " long\n";
} catch (const igeo::Error& e) {
    std::cerr << e.what() << "\n" << e.remedy() << "\n";
    return 1;
}
