// Geodesic distances on the torus, by shooting: no mesh, no grid, nothing from the library.
#pragma once

#include <openvdb/openvdb.h>

#include <vector>

namespace igeo::test {

/// Distances from one point of a torus about the z axis through `center`.
///
/// With angles u about the axis and v about the tube, and d = majorRadius + minorRadius cos v,
/// unit-speed geodesics obey Clairaut's relation d^2 u' = constant and
/// v'' = -d sin v u'^2 / minorRadius; neighbors spread by j, j'' = -K j (Jacobi's equation) with
/// K = cos v / (minorRadius d). A fan of geodesics from the seed, each followed until it surely is
/// no shortest path any more, gives starting values for Newton's method on (direction, length);
/// the shortest geodesic that hits the query is the distance.
///
/// Accuracy: 1e-9 of majorRadius; where the query is conjugate to the seed along its shortest
/// geodesic (the ends of the cut locus), 1e-7. A query takes about 2 ms, on a thin
/// ring (majorRadius above 10 minorRadius) up to 10 ms.
class TorusGeodesics {
public:
    TorusGeodesics(const openvdb::Vec3d& center, double majorRadius, double minorRadius,
                   const openvdb::Vec3d& seed);

    /// @param p  a point of the surface (others count as their angles u, v)
    double distance(const openvdb::Vec3d& p) const;

private:
    struct Angles {
        double u, v;
    };
    /// A point of a geodesic: position, change of v, Jacobi field and its change per length.
    struct State {
        double u, v, dv, j, dj;
    };
    struct Ray {
        double direction;           ///< angle to the direction of growing u
        std::vector<State> states;  ///< one per step, from the seed on
    };

    Angles anglesOf(const openvdb::Vec3d& p) const;
    double axisDistance(double v) const;
    State start(double direction) const;
    double clairaut(double direction) const;
    State derivative(const State& s, double clairaut) const;
    State step(const State& s, double clairaut, double length) const;
    State shoot(double direction, double length) const;
    bool isPastCut(const State& s, double length) const;
    Ray trace(double direction) const;
    void traceBetween(const Ray& first, double lastDirection, int depth);
    double gap(const State& s, const Angles& target) const;
    bool isNearest(std::size_t ray, std::size_t at, const std::vector<double>& gaps) const;
    double refine(double direction, double length, const Angles& target) const;

    openvdb::Vec3d center_;
    double majorRadius_, minorRadius_, step_, maxLength_;
    Angles seed_;
    std::vector<Ray> fan_;               ///< by direction, [0, 2 pi)
    std::vector<std::size_t> firstGap_;  ///< per ray, its first state among all states
};

/// Where the geodesic of the torus that leaves `p` in a direction (its tangential part counts) is
/// after `length`, by the same equations: the exponential map. Error below 1e-9 of the length.
openvdb::Vec3d walkOnTorus(const openvdb::Vec3d& center, double majorRadius, double minorRadius,
                           const openvdb::Vec3d& p, const openvdb::Vec3d& direction, double length);

}  // namespace igeo::test
