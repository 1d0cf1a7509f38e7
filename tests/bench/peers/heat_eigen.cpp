#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <stdexcept>

#include "bench/extracted_mesh.h"
#include "peer.h"

namespace igeo::test {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Solver = Eigen::SimplicialLDLT<Matrix>;  // ordered by AMD; reads the lower triangle

constexpr double kFactor = 10;  // of the time, which CGAL has as the mean edge squared

/// The gradients of the three hat functions of a triangle, each times twice its area.
struct Triangle {
    std::array<Vec3d, 3> gradient;
    double doubleArea;

    Triangle(const TriangleMesh& mesh, const TriangleMesh::Triangle& corners) {
        std::array<Vec3d, 3> edge;  // opposite each corner
        for (std::size_t k = 0; k < 3; ++k)
            edge[k] = mesh.points[corners[(k + 2) % 3]] - mesh.points[corners[(k + 1) % 3]];
        const Vec3d normal = cross(edge[0], edge[1]);
        doubleArea = length(normal);
        for (std::size_t k = 0; k < 3; ++k)
            gradient[k] = doubleArea > 0 ? cross(normal * (1 / doubleArea), edge[k]) : Vec3d{};
    }
};

class HeatOnEigen : public Peer {
public:
    explicit HeatOnEigen(const TriangleMesh& mesh) : mesh_(mesh) {
        const auto n = Eigen::Index(mesh.points.size());
        Eigen::VectorXd mass = Eigen::VectorXd::Zero(n);
        std::vector<Eigen::Triplet<double>> entries;
        entries.reserve(6 * mesh.triangles.size());
        for (const auto& corners : mesh.triangles) {
            const Triangle t(mesh, corners);
            for (std::size_t a = 0; a < 3; ++a) {
                mass[corners[a]] += t.doubleArea / 6;
                for (std::size_t b = 0; b < 3; ++b)
                    if (corners[a] >= corners[b] && t.doubleArea > 0)
                        entries.emplace_back(
                            int(corners[a]), int(corners[b]),
                            dot(t.gradient[a], t.gradient[b]) / (2 * t.doubleArea));
            }
        }
        Matrix laplacian(n, n);  // of cotangents, positive semidefinite
        laplacian.setFromTriplets(entries.begin(), entries.end());
        const double h = meanEdge(mesh);
        Matrix flow = kFactor * h * h * laplacian;
        const double regular = 1e-8 / mass.sum();  // constants are no solution any more
        for (Eigen::Index i = 0; i < n; ++i) {
            flow.coeffRef(i, i) += mass[i];
            laplacian.coeffRef(i, i) += regular * mass[i];
        }
        flow_.compute(flow);
        poisson_.compute(laplacian);
        if (flow_.info() != Eigen::Success || poisson_.info() != Eigen::Success)
            throw std::runtime_error("heat method: the factorization failed");
    }

    std::vector<double> distances(std::size_t seed) override {
        const Eigen::VectorXd heat = flow_.solve(unit(seed));
        const Eigen::VectorXd potential = poisson_.solve(divergence(heat));
        std::vector<double> result(mesh_.points.size());
        for (std::size_t v = 0; v < result.size(); ++v)
            result[v] = potential[Eigen::Index(v)] - potential[Eigen::Index(seed)];
        return result;
    }

private:
    Eigen::VectorXd unit(std::size_t seed) const {
        return Eigen::VectorXd::Unit(Eigen::Index(mesh_.points.size()), Eigen::Index(seed));
    }
    /// Of the unit field against the gradient of the heat, integrated with each hat function.
    Eigen::VectorXd divergence(const Eigen::VectorXd& heat) const {
        Eigen::VectorXd sums = Eigen::VectorXd::Zero(heat.size());
        for (const auto& corners : mesh_.triangles) {
            const Triangle t(mesh_, corners);
            // Squares of the heat far away would underflow.
            const double scale = std::max({std::abs(heat[corners[0]]), std::abs(heat[corners[1]]),
                                           std::abs(heat[corners[2]])});
            if (!(scale > 0)) continue;
            Vec3d slope{};
            for (std::size_t k = 0; k < 3; ++k) slope += t.gradient[k] * (heat[corners[k]] / scale);
            const double size = length(slope);
            if (!(size > 0)) continue;
            for (std::size_t k = 0; k < 3; ++k)
                sums[corners[k]] -= dot(t.gradient[k], slope) / (2 * size);
        }
        return sums;
    }

    const TriangleMesh& mesh_;
    Solver flow_, poisson_;
};

}  // namespace

std::unique_ptr<Peer> heatMethodTuned(const TriangleMesh& mesh) {
    return std::make_unique<HeatOnEigen>(mesh);
}

}  // namespace igeo::test
