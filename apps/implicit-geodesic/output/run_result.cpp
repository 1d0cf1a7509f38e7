#include "output/run_result.h"

#include "output/path_curves.h"

const igeo::SurfaceMesh& RunResult::mesh() {
    if (!madeMesh) madeMesh = distance.indexMesh(progress);
    return *madeMesh;
}

const std::vector<igeo::Isoline>& RunResult::isolines() {
    if (madeIsolines) return *madeIsolines;
    const igeo::Field& field = distance.field();
    const std::vector<double> levels =
        igeo::onBothSides(field, igeo::chosenLevels(field, options.levels, options.spacing));
    madeIsolines = igeo::isolines(field, mesh(), levels, progress);
    return *madeIsolines;
}

const igeo::LevelSet& RunResult::levelSet() {
    const igeo::LevelSet& levelSet = distance.levelSet(progress);
    report.warn(levelSet.warnings);
    return levelSet;
}

std::vector<igeo::Path> RunResult::drawnLines() const {
    std::vector<igeo::Path> all;
    for (const igeo::NamedCurve& curve : pathCurves(report)) {
        all.emplace_back();
        for (const igeo::Vec3d& p : curve.points)
            all.back().vertices.push_back({band().transform.indexFromWorld(p)});
    }
    return all;
}
