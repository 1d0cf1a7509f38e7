/// Seeds as asked for: points, curves and regions, laid onto any band.
#pragma once

#include <igeo/io/point_list.h>
#include <igeo/march/field.h>
#include <igeo/march/seeds.h>
#include <igeo/metric/obstacles.h>

#include <memory>
#include <string>
#include <vector>

#include "options/seed_options.h"

/// Points of an option and of a file, in that order.
std::vector<igeo::AskedPoint> askedPoints(const std::vector<igeo::AskedPoint>& given,
                                          const std::string& file);

class SeedInput {
public:
    /// Reads and checks all that the options name.
    /// @param transform of the surface
    void read(const SeedOptions& options, const igeo::Similarity& transform);

    const std::vector<igeo::AskedPoint>& points() const { return points_; }
    /// Whether no march starts from anything.
    bool empty() const { return points_.empty() && !extended() && samples_ == 0; }
    /// Whether there are curves or regions, so that a part of the band will not do.
    bool extended() const { return !curves_.empty() || !regions_.empty(); }

    /// Seeds of curves and regions on a band.
    /// @param snap how far curves may be from S, voxels
    std::vector<igeo::SurfacePoint> extendedSeeds(const igeo::Band& band, double snap) const;
    /// What the march's distance is yet to become: 0 inside regions, or signed.
    void finish(const igeo::Band& band, igeo::Field& field) const;

    /// Per source, what it is: empty for a point.
    std::vector<std::string> names() const;
    /// Of the files read.
    const std::vector<std::string>& warnings() const { return warnings_; }

private:
    struct NamedCurve {
        std::string name;
        igeo::Curve curve;  ///< index space
    };
    struct Region {
        std::string name;
        std::shared_ptr<igeo::ObstacleSet> body;
    };
    std::vector<std::uint8_t> inside(const igeo::Band& band) const;

    std::vector<igeo::AskedPoint> points_;
    std::vector<NamedCurve> curves_;
    std::vector<Region> regions_;
    std::vector<std::string> warnings_;
    int samples_ = 0;
    bool signed_ = false;
};
