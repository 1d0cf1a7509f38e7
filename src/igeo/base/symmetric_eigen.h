/// Eigenvalues and eigenvectors of symmetric matrices of two and three rows.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace igeo {

/// The two eigenvalues of a symmetric matrix, middle +- radius.
struct SymmetricEigen2 {
    double middle, radius;  ///< radius >= 0
    double x, y;            ///< an eigenvector of middle + radius, not normalized; 0 if radius is 0

    double largest() const { return middle + radius; }
    double least() const { return middle - radius; }
    double largestMagnitude() const { return std::abs(middle) + radius; }
};

/// Of (xx xy; xy yy): middle = (xx + yy) / 2, radius^2 = ((xx - yy) / 2)^2 + xy^2.
inline SymmetricEigen2 symmetricEigen(double xx, double xy, double yy) {
    const double half = (xx - yy) / 2, middle = (xx + yy) / 2, radius = std::hypot(half, xy);
    // The longer of the two forms of the eigenvector is the more accurate.
    if (half > 0) return {middle, radius, half + radius, xy};
    return {middle, radius, xy, radius - half};
}

/// The larger eigenvalue of a matrix of two rows with determinant 1 and trace 2 (1 + excess). This
/// form loses no digits near 1.
template <typename T>
T largestEigenvalueOfUnitDeterminant(T excess) {
    return 1 + excess + std::sqrt(excess * (excess + 2));
}

/// A symmetric matrix of three rows.
struct SymmetricMatrix3 {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

struct SymmetricEigen3 {
    std::array<double, 3> value;  ///< in rising order
    std::array<Vec3d, 3> vector;  ///< unit, orthogonal; vector[k] belongs to value[k]
};

/// Eigenvalues in rising order, to rounding of the largest, by Jacobi's rotations (G. H. Golub and
/// C. F. Van Loan, Matrix Computations, 8.5).
std::array<double, 3> symmetricEigenvalues(const SymmetricMatrix3& m);

/// The same with eigenvectors.
SymmetricEigen3 symmetricEigen(const SymmetricMatrix3& m);

}  // namespace igeo
