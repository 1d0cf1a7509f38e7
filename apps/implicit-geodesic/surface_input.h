/// The surface as asked for: read once, and bands made of it.
#pragma once

#include <igeo/band.h>
#include <igeo/level_set.h>
#include <igeo/level_set_band.h>
#include <igeo/progress.h>
#include <igeo/report.h>

#include <vector>

#include "console.h"
#include "options.h"

class SurfaceInput {
public:
    /// Reads what the options name.
    void read(const Options& options);
    /// Checks that it is a surface, and says in the report what was found.
    void check(const Console& console, igeo::Progress& progress, igeo::RunReport& report);

    /// Chooses h within M&S (14), as asked for or for the scheme; widens the level set if needed.
    void chooseBandWidth(const Options& options, igeo::RunReport& report);

    /// The band in a region; empty: of the whole surface.
    igeo::Band band(const std::vector<igeo::Ball>& region, igeo::Progress& progress) const {
        return igeo::bandFromLevelSet(levelSet_, h_, region, progress);
    }

    double h() const { return h_; }
    const igeo::LevelSet& levelSet() const { return levelSet_; }
    const igeo::Similarity& transform() const { return levelSet_.transform; }
    /// Across the surface, voxels.
    double diagonal() const;

private:
    igeo::LoadedGrid loaded_;  ///< until it is checked
    igeo::LevelSet levelSet_;
    double h_ = 0;  ///< half the band's thickness, voxels
};
