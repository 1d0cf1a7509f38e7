/// The surface as asked for, whatever it is made of: read once, and bands made of it.
#pragma once

#include <igeo/band.h>
#include <igeo/level_set.h>
#include <igeo/level_set_band.h>
#include <igeo/progress.h>
#include <igeo/report.h>
#include <igeo/surface_mesh.h>
#include <igeo/survey.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "options.h"

class SurfaceInput {
public:
    /// For the kind of surface that the options name; nothing is read yet.
    static std::unique_ptr<SurfaceInput> of(const Options& options);
    virtual ~SurfaceInput() = default;

    /// Reads the file.
    virtual void read() = 0;
    /// Checks that it is a surface, says in the report what was found, and chooses h, as asked for
    /// or for the scheme.
    virtual void prepare(igeo::Progress& progress, igeo::RunReport& report) = 0;

    /// Instead of both: what the file is like to walk on. A volume that is refused says so in its
    /// survey.
    virtual igeo::FileSurvey survey(igeo::Progress& progress) = 0;

    /// The band in a region; empty: of the whole surface. Some kinds make the whole all the same.
    virtual igeo::Band band(const std::vector<igeo::Ball>& region,
                            igeo::Progress& progress) const = 0;
    /// How many nodes the band of the whole surface has, about.
    virtual double estimatedNodes() const = 0;
    /// Refuses a band of the whole surface that needs more memory than there is.
    void requireMemory() const;
    /// The point of the surface nearest to one in index space.
    virtual igeo::SurfacePoint nearest(const igeo::Band& band, const igeo::Vec3d& p) const;
    /// The surface as triangles that carry the distance.
    virtual igeo::SurfaceMesh mesh(const igeo::Band& band, const igeo::Field& field,
                                   igeo::Progress& progress);

    /// As a level set, for what is made of one; of a mesh and points made when first asked for.
    const igeo::LevelSet& levelSet(igeo::Progress& progress);

    const igeo::Similarity& transform() const { return transform_; }
    const std::string& name() const { return name_; }  ///< of its grid, unique in its file
    /// What results are named after, and how they lie in the world.
    virtual std::string gridName() const { return name_; }
    virtual openvdb::math::Transform::ConstPtr gridTransform() const {
        return igeo::gridTransform(transform_);
    }
    double h() const { return h_; }                ///< half the band's thickness, voxels
    double diagonal() const { return diagonal_; }  ///< across the surface, voxels
    /// How far points may be from it unless asked for, world units.
    double snap() const { return snap_; }
    /// What a user should know, one sentence each.
    std::vector<std::string> warnings() const;
    /// In a few words, for -v.
    const std::string& summary() const { return summary_; }

protected:
    explicit SurfaceInput(const Options& options) : options_(options) {}
    virtual igeo::LevelSet makeLevelSet(igeo::Progress& progress) = 0;
    /// h within M&S (14), as asked for or the best.
    void chooseBandWidth(const igeo::LevelSetStats& stats, igeo::RunReport& report);
    void chooseBandWidth(const igeo::BandBounds& bounds, double best, igeo::RunReport& report);
    /// The voxel size asked for, else as many voxels as `resolution` along the longest side.
    double voxelSize(double longest, int resolution) const;

    const Options& options_;
    igeo::Similarity transform_;
    std::string name_, summary_;
    double h_ = 0, diagonal_ = 0, snap_ = 0;
    std::vector<std::string> warnings_;
    std::optional<igeo::LevelSet> levelSet_;
};
