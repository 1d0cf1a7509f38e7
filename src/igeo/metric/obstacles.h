/// Spheres, boxes, level sets, masks and parts of a mesh that no path may enter.
#pragma once

#include <igeo/band/surface_triangles.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/io/vdb_read.h>
#include <igeo/metric/index_map.h>
#include <igeo/metric/metric.h>
#include <openvdb/openvdb.h>

#include <memory>
#include <vector>

namespace igeo {

/// A union of closed bodies, given in the world and kept in the index space of a band.
///
/// Spheres and boxes are exact. Level sets block where their trilinear interpolant is negative,
/// sampled every quarter of their voxels or less.
///
/// Masks block in the cubes of their voxels, each grown by a tenth of a voxel, so that voxels which
/// share only an edge or a corner leave no slit. A mask may be as thin as a curve drawn on S:
/// voxels with |psi| <= 1/2 of which each shares at least a corner with the next. For this the test
/// uses not the segment from a to b but the strip that the segment sweeps along the normal: 0.6
/// voxels of the mask to both sides, and as far as S may bulge between a and b. The broken line
/// through the voxels' centers runs within their cubes (midpoints between neighbors are on shared
/// faces, edges or corners) and at most 1/2 from S, so every strip that crosses it is blocked: a
/// curve that closes around a point of S encloses it. Voxels that do not touch leave a gap: a wall
/// across the core of a band (Band::numberCore) needs all voxels that it passes.
class ObstacleSet : public Obstacles {
public:
    /// @param transform  world from index, of the band
    explicit ObstacleSet(const Similarity& transform);
    ObstacleSet(ObstacleSet&&) = default;  // no copies: two would mark one tree
    ObstacleSet& operator=(ObstacleSet&&) = default;

    /// @throws Error  InvalidArgument unless the center is finite and the radius positive and
    /// finite
    void addSphere(const Vec3d& centerWorld, double radiusWorld);

    /// A box with sides along the world's axes; a flat one is a wall without thickness.
    /// @throws Error  InvalidArgument unless the corners are finite and low <= high
    void addBox(const Vec3d& lowWorld, const Vec3d& highWorld);

    /// A level set (by class) blocks where it is negative, inactive voxels and tiles included. Any
    /// other grid blocks with active voxels: all of a mask, those that are true of a bool grid,
    /// those above 1/2 of a float grid. The grid may have any linear transform; its values are
    /// shared or copied.
    /// @throws Error  BadInput where nothing is blocked, for values that are NaN, or a transform
    ///         that is not linear
    /// Time O(voxels).
    void addGrid(const ObstacleGrid& grid);

    /// A part of the mesh that forms the surface: the given vertices, the edges between two and the
    /// triangles between three of them, and all within a fifth of a voxel of these along the
    /// surface. So a closed line of neighboring vertices is a wall.
    /// @param blocked  per vertex of the mesh's source, or per point of the mesh
    /// @throws Error  BadInput where nothing is blocked, InvalidArgument for another number of
    ///         values
    /// Time O(n log n).
    void addVertices(const TriangleMesh& mesh, const std::vector<bool>& blocked);

    /// A part of the mesh as a region of seeds: its points are those of triangles between three of
    /// the vertices. Edges without such a triangle and vertices without such an edge are lines
    /// alone.
    /// @throws Error  as addVertices
    /// Time O(n log n).
    void addVertexRegion(const TriangleMesh& mesh, const std::vector<bool>& inside);

    /// Triangles of the band's mesh, and all within a fifth of a voxel of them along the surface.
    /// @param blocked  per triangle; at least one
    /// Time O(n log n).
    void addTriangles(const SurfaceTriangles& mesh, const std::vector<bool>& blocked);

    bool empty() const {
        return spheres_.empty() && boxes_.empty() && levelSets_.empty() && masks_.empty() &&
               patches_.empty() && lines_.empty();
    }

    /// O(spheres and boxes), and 0.3 to 0.5 microseconds measured per grid where one is near; more
    /// for grids much finer than the band.
    bool block(const Vec3d& a, const Vec3d& b, const Vec3d& normal) const override;
    bool mayBeNear(const Vec3d& p, double radius) const override;
    /// Those of addVertexRegion.
    void forLines(const std::function<void(const Line&)>& visit) const override;
    /// Of masks, and negative ones of level sets; not of tiles, which are no thin parts.
    void forVoxels(const std::function<void(const Vec3d&)>& visit) const override;

    /// Connected parts of grids; voxels that share a corner are connected.
    struct Parts {
        struct Part {
            Vec3d position{};  ///< the mean of its voxels, world
            std::size_t voxels = 0;
        };
        std::size_t all = 0;    ///< the number of parts, with those that meet S
        std::vector<Part> off;  ///< those that do not, the largest first
    };
    /// The parts of masks and level sets, and those in which no point of S lies: a region of seeds
    /// has no seed there. A level set that is negative everywhere far away has no parts.
    /// Time O(voxels + nodes), eight bytes per voxel.
    Parts parts(const Band& band, Progress& progress = Progress::none()) const;

private:
    /// A tree without its virtual functions, which a compiler takes seven seconds for.
    using VoxelSet = openvdb::MaskTree::RootNodeType;

    struct Sphere {
        Vec3d center;
        double radius;
    };
    struct Box {
        Vec3d center, halfSize;  ///< in the world's axes, in voxels
    };
    struct LevelSetBody {
        openvdb::FloatGrid::ConstPtr grid;
        IndexMap map;
    };
    struct MaskBody {
        std::shared_ptr<const VoxelSet> blocked;
        IndexMap map;
    };
    void addLevelSet(const openvdb::FloatGrid::ConstPtr& grid, const IndexMap& map);
    template <typename Grid, typename IsBlocked>
    void addMask(const Grid& grid, const IndexMap& map, const IsBlocked& isBlocked);
    void markNear(const IndexMap& toBand, const openvdb::CoordBBox& voxels, double grown);
    void markNear(const Vec3d& low, const Vec3d& high);
    bool gridMayBeNear(const Vec3d& p, double radius) const;

    Similarity transform_;
    std::vector<Sphere> spheres_;
    std::vector<Box> boxes_;
    std::vector<LevelSetBody> levelSets_;
    std::vector<MaskBody> masks_;
    /// Parts of a mesh, index space of the band.
    struct Patch {
        std::shared_ptr<const SurfaceTriangles> parts;
        std::vector<Vec3d> normal;  ///< per part that of its triangle, oriented as in the band
        bool isRegion = false;      ///< holds points of its triangles alone
    };
    void addParts(const TriangleMesh& mesh, const std::vector<bool>& blocked, bool isRegion);
    /// @param parts  alone, without neighbors
    void addPatch(std::vector<Vec3d> points, std::vector<SurfaceTriangles::Triangle> parts,
                  std::vector<Vec3d> normals, bool isRegion);
    static bool patchBlocks(const Patch& patch, const Vec3d& a, const Vec3d& b,
                            const Vec3d& normal);
    std::vector<Patch> patches_;
    std::vector<Line> lines_;
    std::shared_ptr<VoxelSet> near_;  ///< cells of 8^3 voxels of the band that grids reach into
    bool everywhere_ = false;         ///< a level set blocks everything far away
};

/// What blocks by either of two; null stands for none.
std::shared_ptr<const Obstacles> either(std::shared_ptr<const Obstacles> a,
                                        std::shared_ptr<const Obstacles> b);

}  // namespace igeo
