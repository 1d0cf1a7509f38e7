#include <igeo/base/symmetric_eigen.h>

namespace igeo {

namespace {

/// Zeroes the off-diagonal entries of `a` one by one, in six sweeps; from about the third on each
/// sweep squares what remains.
/// @param rotate  rotate(p, q, c, s) is called for every rotation in the plane of axes p and q
template <typename Rotate>
void diagonalize(double (&a)[3][3], const Rotate& rotate) {
    for (int k = 0; k < 18; ++k) {
        const int p = k % 3 == 2, q = k % 3 == 0 ? 1 : 2, r = 3 - p - q;
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        a[p][p] -= t * a[p][q], a[q][q] += t * a[p][q];
        a[p][q] = a[q][p] = 0;
        const double rp = a[r][p], rq = a[r][q];
        a[r][p] = a[p][r] = c * rp - s * rq;
        a[r][q] = a[q][r] = s * rp + c * rq;
        rotate(p, q, c, s);
    }
}

}  // namespace

std::array<double, 3> symmetricEigenvalues(const SymmetricMatrix3& m) {
    double a[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
    diagonalize(a, [](int, int, double, double) {});
    std::array<double, 3> e{a[0][0], a[1][1], a[2][2]};
    std::sort(e.begin(), e.end());
    return e;
}

SymmetricEigen3 symmetricEigen(const SymmetricMatrix3& m) {
    double a[3][3] = {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
    std::array<Vec3d, 3> v{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    diagonalize(a, [&](int p, int q, double c, double s) {
        Vec3d &vp = v[std::size_t(p)], &vq = v[std::size_t(q)];
        const Vec3d old = vp;
        vp = c * old - s * vq;
        vq = s * old + c * vq;
    });
    std::array<int, 3> by{0, 1, 2};
    std::sort(by.begin(), by.end(), [&](int i, int j) { return a[i][i] < a[j][j]; });
    SymmetricEigen3 e;
    for (std::size_t k = 0; k < 3; ++k) {
        e.value[k] = a[by[k]][by[k]];
        e.vector[k] = v[std::size_t(by[k])];
    }
    return e;
}

}  // namespace igeo
