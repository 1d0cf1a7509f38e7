/// The smooth surface through a point cloud.
#pragma once

#include <igeo/base/point_tree.h>
#include <igeo/base/progress.h>
#include <igeo/base/types.h>
#include <igeo/io/point_cloud.h>
#include <igeo/surface/cloud_density.h>
#include <igeo/surface/quadric_fit.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace igeo {

class PointsAround;
class StackedSheets;

/// The surface F = 0 of a cloud. At each point a quadric is fitted to its neighbors by least
/// squares, and F blends the quadrics where they overlap,
///
///     F(y) = sum_j w_j(y) f_j(y) / sum_j w_j(y),   w_j = (1 - |y - p_j|^2 / reach_j^2)^3
///
/// (a partition of unity as in Ohtake, Belyaev, Alexa, Turk and Seidel, Multi-level partition of
/// unity implicits, SIGGRAPH 2003, but around the points themselves; reach_j is three spacings). F
/// is twice differentiable, so foot points lie on one smooth surface, and their normals are those
/// of that surface.
///
/// It ends where the points end: at y there is a surface if y, seen along the normal, lies within
/// the convex hull of the points that reach it. So rims follow the outermost points, and holes of
/// less than about three spacings in radius are closed.
///
/// Sheets: points whose normals are at a cosine below -0.2 are on another sheet, and so are those
/// one above the other (StackedSheets). Fits and blends leave them out. Sheets closer than 1.8
/// spacings, with scatter 2.3, become one in between, or are refused as points that fill a volume;
/// if they face each other and the file has normals, 0.7 spacings are enough.
///
/// Sharp edges: where two sheets at a cosine below 0.2 meet and no normal lies between theirs
/// (separateSheets), each is continued up to the edge and ends there. Other edges are rounded.
///
/// The result depends only on the set of points: not on their order, nor on the number of threads.
class PointSurface {
public:
    using Index = PointTree::Index;

    /// @throws Error  as requireUsable; BadInput for fewer than 16 distinct points, or for points
    ///         along curves or throughout a volume; Cancelled through `progress`
    /// Time O(n log n), parallel except for the signs of normals; about 300 bytes per point.
    explicit PointSurface(PointCloud cloud, Progress& progress = Progress::none());

    const CloudDensity& density() const { return density_; }
    const std::string& file() const { return file_; }
    const PointTree& points() const { return points_; }
    /// The normal of the fit at a point; all on one side of a two-sided surface.
    const Vec3d& normal(std::size_t i) const { return normals_[i]; }
    /// The larger principal curvature of the fit at a point, 1 / world length.
    double curvature(std::size_t i) const { return curvature_[i]; }

    /// A foot point, world units.
    struct Foot {
        bool valid = false;  ///< false: no surface there, or not within the points
        Vec3d point, normal;
        double psi = 0;       ///< signed distance of the projected point
        bool onEdge = false;  ///< on a sharp edge; the normal leads from there to the point
    };
    /// The point of the surface nearest to x, on the sheet of the fit that passes nearest to x.
    /// @param farthest  not valid beyond
    Foot project(const Vec3d& x, double farthest) const;
    /// The same for one of many positions in a ball; reads points up to reachOfProject() beyond the
    /// ball.
    /// @param beyond  positions up to so far beyond a rim, along S, have their foot point on it
    Foot project(const Vec3d& x, double farthest, PointsAround& around, double beyond = 0) const;
    /// @param nearest  the point nearest to the middle of the ball
    double reachOfProject(Index nearest, double farthest) const;
    /// The approximate distance of x from the surface, by only the fit at the point nearest to x.
    double roughDistance(const Vec3d& x, Index nearest) const;
    /// Whether project() may find a foot point for a position in a ball by the fit at a point.
    bool mayProject(const Vec3d& middle, double radius, Index nearest, double farthest) const;

private:
    struct Blend {
        double weight = 0, value = 0;
        Vec3d gradient;
    };
    /// The data of a point that a blend reads, stored together.
    struct Patch {
        Vec3d at, normal;
        double reach2, leastCosine;
        Quadric fit;
    };
    /// A position above a point of a sheet, or of what continues it.
    struct OnSheet {
        bool found = false;
        Vec3d at, normal;
        Index nearest = 0;  ///< the point of the sheet at which the search began
    };
    /// A sheet that ends another one at a sharp edge.
    struct EndOfSheet {
        bool found = false;
        Index point = 0;    ///< of the sheet, the nearest one
        double side = 0;    ///< less than 0: the other one lies below it
        double beyond = 0;  ///< of a position: how far it is beyond the edge; world units
    };
    struct PointFit {
        Quadric quadric;
        double curvature, off, scatter, residual;
        Vec3d normal;
    };
    void measureSpacing();
    /// The normals of a cloud, unit, per point; none where it has none.
    std::vector<Vec3d> givenNormals(const PointCloud& cloud) const;
    /// The `count` points nearest to point i.
    void nearestTo(std::size_t i, std::size_t count, std::vector<PointTree::Found>& found) const;
    /// The same on the sheet of point i.
    void nearestOnSheet(std::size_t i, std::size_t count, const StackedSheets& sheets,
                        std::vector<PointTree::Found>& found) const;
    /// The normals, those of thick planes exchanged for that of the thinnest one around; to tell
    /// sheets apart.
    std::vector<Vec3d> clearNormals() const;
    void fitNormals(const std::vector<Vec3d>& given, std::size_t count);
    /// Turns the normals to one side, or to that of given ones.
    void orient(const std::vector<Vec3d>& given);
    double measureNoise(Progress& progress);
    /// @return SheetFits::misfit
    std::vector<double> fitQuadrics(std::size_t count, Progress& progress);
    PointFit fitAt(std::size_t i, std::size_t count,
                   const std::vector<PointTree::Found>& nearest) const;
    std::vector<char> strays() const;
    void build(const PointCloud& cloud, Progress& progress);
    Index nearestSheet(const std::vector<PointTree::Found>& nearest, const Vec3d& x) const;
    /// Positions farther than this from the fit at the nearest point have no foot point.
    double roughLimit(Index nearest, double farthest) const;
    bool sameSheet(std::size_t j, const Vec3d& n) const {
        return dot(normals_[j], n) > leastCosine(j);
    }
    /// Of the normals of one sheet.
    double leastCosine(std::size_t j) const;
    Blend blend(const Vec3d& y, const Vec3d& n, const std::vector<Index>& neighbors) const;
    /// Whether the fit at a point is of the sheet at y rather than of one above or below.
    bool onLayer(std::size_t j, const Vec3d& y, const Vec3d& n) const;
    OnSheet ontoSheet(const Vec3d& x, Index nearest, double farthest, PointsAround& around,
                      std::vector<Index>& neighbors) const;
    EndOfSheet endOf(const OnSheet& on, const std::vector<Index>& neighbors) const;
    /// Whether the sheet is there, rather than what continues it.
    bool reaches(const OnSheet& on, const EndOfSheet& end,
                 const std::vector<Index>& neighbors) const;
    Foot ontoEdge(const Vec3d& x, double farthest, const OnSheet& on, const EndOfSheet& end,
                  const std::vector<Index>& neighbors) const;
    bool within(const Vec3d& y, const Vec3d& n, const std::vector<Index>& neighbors) const;
    /// The point nearest to y on the rim of the convex hull of the points around, in the tangent
    /// plane.
    Vec3d onRim(const Vec3d& y, const Vec3d& n, const std::vector<Index>& neighbors) const;

    std::string file_;
    PointTree points_;
    std::vector<double> spacing_;
    std::vector<Index> ring_;  ///< per point: its nearest points, nearest first
    std::vector<Vec3d> normals_;
    std::vector<double> thickness_;  ///< per normal: of its plane, the ratio of two variances
    std::vector<Quadric> fits_;
    std::vector<Patch> patches_;
    std::vector<double> curvature_;      ///< per fit
    std::vector<double> off_;            ///< per point: distance to the surface of its neighbors
    std::vector<std::uint8_t> layered_;  ///< per point: whether a sheet is above or below its own
    std::vector<std::uint8_t> atEdge_;   ///< per point: bits of separateSheets(); empty: not yet
    CloudDensity density_;
};

}  // namespace igeo
