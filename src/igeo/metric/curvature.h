/// Curvature of S, and weights made from it: for paths along valleys, along crests, around bends.
#pragma once

#include <igeo/band/band.h>
#include <igeo/base/progress.h>
#include <igeo/io/triangle_mesh.h>
#include <igeo/metric/metric.h>

#include <string>
#include <vector>

namespace igeo {

/// Principal curvatures at the foot point of every band node, so constant along normals. Positive
/// where S bends away from its normal: a sphere of radius R with psi < 0 inside has k1 = k2 = 1/R.
struct Curvature {
    std::vector<float> k1, k2;      ///< k1 >= k2, in 1/voxel
    std::vector<Vec3f> direction1;  ///< unit tangent direction of k1, up to its sign; k2's is
                                    ///< cross(normal, direction1). Arbitrary where k1 = k2

    /// k1 + k2: M of M&S 4.1, the Laplacian of psi on S.
    float mean(NodeIndex i) const { return k1[i] + k2[i]; }
    float gaussian(NodeIndex i) const { return k1[i] * k2[i]; }
};

/// Default scale, voxels. Noise of 0.1 voxels in psi moves k1 + k2 by 0.005 / voxel, 5 % of that of
/// a sphere of 20 voxels radius. Smoothing reduces it by 0.6 % on an ellipsoid of axes 1 : 1.3 :
/// 1.7 there; a scale of 3 divides the effect of noise by three and doubles that of smoothing.
constexpr double kDefaultCurvatureScale = 2;

/// Curvature by weighted least squares over the core's foot points y_j around each one, y_i:
///
///     n_j = c + W (y_j - y_i) + Q(y_j - y_i)   in the tangent plane at y_i, Q quadratic.
///
/// The eigenvalues of W, made symmetric, are the principal curvatures (for psi a distance, W is its
/// Hessian on the tangent plane). c absorbs the noise of n_i and Q a varying curvature, so that
/// neither enters W, however unevenly the y_j lie. On spheres and cylinders normals are linear in
/// the chord's tangential part, so large angles are no problem. The y_j are found from neighbor to
/// neighbor within sqrt(8) scale of y_i, never across a gap, nor where the normal is opposite to
/// that of y_i (Band::kOtherSheet). Nodes outside the core take the blend of the core around their
/// foot points.
/// @param scale standard deviation of the least-squares weights along a tangent, voxels, 1 to 16
/// @return finite everywhere; across a crease about its angle divided by the width of the weights
/// @throws Error  InvalidArgument for a scale out of range; Cancelled through `progress`
/// Time O(n scale^2), in parallel, about 2 microseconds per node on one thread at the default
/// scale; 25 bytes per node while it works, and 20 for the result. Error: of second order in dx,
/// about scale^2 / 2 times the second derivative of the curvature. Noise of standard deviation s in
/// psi moves k1 + k2 by 0.4 to 0.6 s / scale^3.
Curvature curvature(const Band& band, double scale = kDefaultCurvatureScale,
                    Progress& progress = Progress::none());

/// Facets wider than this have no curvature inside and too much along their edges: costs from it
/// are off by 3 to 5 % at this width, and by 10 to 50 % from twice as much on (spheres and
/// cylinders).
constexpr double kWidestFacetPerScale = 5;

/// The share of the area of a mesh that stands for a bent surface with facets too wide for a scale:
/// triangles at edges that bend by 1 to 53 degrees, where both triangles are higher over the edge
/// than kWidestFacetPerScale scales. A flat face beside a finely divided bend is none.
/// @param dx     voxel size
/// @param scale  as of curvature(), voxels
/// Time O(n log n).
double shareOfWideFacets(const TriangleMesh& mesh, double dx, double scale);

/// A sentence where that share is 1 % or more, with a remedy; else empty.
std::string wideFacetWarning(const TriangleMesh& mesh, double dx, double scale);

enum class CurvatureKind {
    Valley,    ///< eps + (M - min M)^p: paths keep to valleys (M&S 4.1, figure 10)
    Crest,     ///< the same with -M
    Mean,      ///< eps + |M|^p, M = k1 + k2: paths keep to minimal surface
    Gaussian,  ///< eps + |K|^p, K = k1 k2: paths keep to what unrolls into a plane
    Principal  ///< eps + max(|k1|, |k2|)^p: paths keep to flat parts
};

/// The unit of length for curvatures in curvatureWeights, voxels.
///
/// M&S give eps = 100 and p = 3 but no unit for M. With 1/voxel, (M - min M)^3 would vary by about
/// 1 where S is well resolved, and every path would be the unweighted one; M&S figure 10 shows the
/// opposite. On a cortex of 1 mm voxels, paths with this unit are in valleys for most of their
/// length, and larger units change little. A unit f times as long has the effect of eps / f^p.
constexpr double kCurvatureUnit = 10;

/// The values of M&S figure 10.
constexpr double kDefaultCurvatureEpsilon = 100, kDefaultCurvaturePower = 3;

/// The share of nodes with the least M that is cut off in Valley and Crest, so that a single spot
/// does not set the weight of all others. The weight of the nodes cut off is eps.
constexpr double kLeastShare = 0.001;

/// Weights for Metric, one per band node: the paper's g, in units of kCurvatureUnit voxels.
/// @param epsilon > 0, the weight where the curvature is the one sought
/// @param power   > 0
/// @throws Error  InvalidArgument for either out of range, or where a weight does not fit a float
/// Time O(n).
std::vector<float> curvatureWeights(const Curvature& curvature, CurvatureKind kind,
                                    double epsilon = kDefaultCurvatureEpsilon,
                                    double power = kDefaultCurvaturePower);

enum class Bending {
    Avoid,  ///< paths that bend with the surface cost more: along a cylinder rather than around it
    Prefer  ///< paths that bend with the surface cost less: around a cylinder rather than along it
};

/// The bound of L k in curvatureTensor: costs differ by a factor of 10 at most.
constexpr double kMostBending = 10;

/// A metric made from the principal curvatures: G = 1 + (L k1)^2 e1 e1^T + (L k2)^2 e2 e2^T to
/// avoid bending, with k1 and k2 exchanged to prefer it; |L k| is cut at kMostBending.
/// @param length L, voxels, >= 0; bends of that radius cost sqrt(2)
/// @return one tensor per band node, for Metric
/// @throws Error  InvalidArgument for a length that is negative or not finite
std::vector<Tensor> curvatureTensor(const Band& band, const Curvature& curvature, Bending bending,
                                    double length);

}  // namespace igeo
