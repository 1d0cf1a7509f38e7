/// The surface as asked for, whatever it is made of: read once, and bands made of it.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/results/report.h>
#include <igeo/results/surface_mesh.h>
#include <igeo/results/survey.h>
#include <igeo/surface/level_set.h>
#include <igeo/surface/level_set_band.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "options/surface_options.h"

/// Once read, it is looked at only, and by any number of jobs side by side; what not every job
/// needs is made when first asked for.
class SurfaceInput {
public:
    using BandPtr = std::shared_ptr<const igeo::Band>;

    /// For the kind of surface that the options name; nothing is read yet.
    static std::unique_ptr<SurfaceInput> of(const SurfaceOptions& options);
    virtual ~SurfaceInput() = default;

    /// Reads the file.
    virtual void read() = 0;
    /// Checks that it is a surface, and chooses h, as asked for or for the scheme.
    void prepare(igeo::Progress& progress);

    /// Instead of both: what the file is like to walk on. A volume that is refused says so in its
    /// survey.
    /// @param memoryLimit as for requireMemory
    virtual igeo::FileSurvey survey(double memoryLimit, igeo::Progress& progress) = 0;

    /// What a report on any job says of the surface.
    const igeo::RunReport& report() const { return report_; }

    /// The band in a region; empty: of the whole surface, which is made once. Some kinds make the
    /// whole all the same.
    BandPtr band(const std::vector<igeo::Ball>& region, igeo::Progress& progress) const;
    /// What else a user should know, now that there is a band of the whole surface; empty: nothing.
    virtual std::string unreliableShare(const igeo::Band&) const { return {}; }
    /// How many nodes the band of the whole surface has, about.
    virtual double estimatedNodes() const = 0;
    /// How much memory a job on the whole surface takes, about, GiB.
    double estimatedMemory() const;
    /// Refuses a band of the whole surface that needs more memory than there is.
    /// @param limit GiB; 0: what the machine has
    void requireMemory(double limit) const;
    /// The point of the surface nearest to one in index space.
    virtual igeo::SurfacePoint nearest(const igeo::Band& band, const igeo::Vec3d& p) const;
    /// The surface as triangles that carry the distance.
    /// @param report as for levelSet
    virtual igeo::SurfaceMesh mesh(const igeo::Band& band, const igeo::Field& field,
                                   igeo::RunReport& report, igeo::Progress& progress) const;

    /// As a level set, for what is made of one; of a mesh and points made when first asked for.
    /// @param report of the job that asks: warnings about the level set go there
    const igeo::LevelSet& levelSet(igeo::RunReport& report, igeo::Progress& progress) const;

    const igeo::Similarity& transform() const { return transform_; }
    const std::string& name() const { return report_.grid; }  ///< of its grid, unique in its file
    /// What results are named after, and how they lie in the world.
    virtual std::string gridName() const { return name(); }
    virtual openvdb::math::Transform::ConstPtr gridTransform() const {
        return igeo::gridTransform(transform_);
    }
    double h() const { return h_; }                ///< half the band's thickness, voxels
    double diagonal() const { return diagonal_; }  ///< across the surface, voxels
    /// How far points may be from it unless asked for, world units.
    double snap() const { return snap_; }
    /// In a few words, for -v.
    const std::string& summary() const { return summary_; }

protected:
    explicit SurfaceInput(const SurfaceOptions& options) : options_(options) {}
    virtual void examine(igeo::Progress& progress) = 0;
    virtual igeo::Band makeBand(const std::vector<igeo::Ball>& region,
                                igeo::Progress& progress) const = 0;
    virtual bool makesParts() const { return false; }  ///< of the band
    virtual igeo::LevelSet makeLevelSet(igeo::Progress& progress) const = 0;
    /// h within M&S (14), as asked for or the best.
    void chooseBandWidth(const igeo::LevelSetStats& stats);
    void chooseBandWidth(const igeo::BandBounds& bounds, double best);
    /// The voxel size asked for, else as many voxels as `resolution` along the longest side.
    double voxelSize(double longest, int resolution) const;
    void warn(const std::string& sentence) { report_.warnings.push_back(sentence); }

    const SurfaceOptions options_;
    igeo::RunReport report_;
    igeo::Similarity transform_;
    std::string summary_;
    double h_ = 0, diagonal_ = 0, snap_ = 0;
    /// Made before jobs begin, or by the first that asks, whom the others wait for.
    mutable std::optional<igeo::LevelSet> levelSet_;

private:
    mutable std::mutex mutex_;  ///< of what is made when asked for
    mutable BandPtr wholeBand_;
};
