#include <igeo/march/detail/godunov_update.h>
#include <support/catch.h>

#include <random>
#include <vector>

namespace igeo::test {
namespace {

using Terms = std::array<UpwindTerm, 3>;

double solve(std::vector<UpwindTerm> given, double cost) {
    Terms terms{};
    std::copy(given.begin(), given.end(), terms.begin());
    return godunovSolve(terms, int(given.size()), cost);
}

/// The equation in the comment of godunovSolve, by bisection. Its left side never falls with T, so
/// the root is unique.
double solveByBisection(const std::vector<UpwindTerm>& terms, double cost) {
    auto excess = [&](double t) {
        double sum = -cost * cost;
        for (const UpwindTerm& u : terms) {
            const double slope = std::max(u.coefficient * (t - u.base), 0.0);
            sum += slope * slope;
        }
        return sum;
    };
    double low = terms[0].base;
    for (const UpwindTerm& u : terms) low = std::min(low, u.base);
    double high = low + cost;
    while (high - low > 1e-15 * (1 + std::abs(high))) {
        const double middle = (low + high) / 2;
        if (middle == low || middle == high) break;
        (excess(middle) < 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

/// Random terms of one solve, of mixed order, as they come up in a march.
std::vector<UpwindTerm> randomTerms(std::mt19937& random, int n, double cost) {
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<UpwindTerm> terms;
    for (int j = 0; j < n; ++j) {
        const double m = 10 + 2 * cost * unit(random);
        // Accepted values differ by no more than the cost from voxel to voxel.
        if (unit(random) < 0.5)
            terms.push_back(firstOrderTerm(m));
        else
            terms.push_back(secondOrderTerm(m, m - cost * unit(random)));
    }
    return terms;
}

}  // namespace

TEST_CASE("eikonal: one term adds the cost") {
    CHECK(solve({firstOrderTerm(2)}, 0.5) == 2.5);
    // (3 T - 4 m + mm) / 2 = cost at m = 4, mm = 1: T = (2 cost + 16 - 1) / 3.
    CHECK(solve({secondOrderTerm(4, 1)}, 3) == 7);
}

TEST_CASE("eikonal: two terms meet the quadratic") {
    const double a = 1.25, b = 1.5, cost = 0.75;
    const double expected = (a + b + std::sqrt(2 * cost * cost - (a - b) * (a - b))) / 2;
    // A handful of operations on numbers near 1: a few units of 2e-16.
    CHECK(std::abs(solve({firstOrderTerm(a), firstOrderTerm(b)}, cost) - expected) < 2e-15);
    // The further one is not upwind of the result and drops out.
    CHECK(solve({firstOrderTerm(a), firstOrderTerm(a + cost)}, cost) == a + cost);
    CHECK(solve({firstOrderTerm(a), firstOrderTerm(a + 2 * cost)}, cost) == a + cost);
}

TEST_CASE("eikonal: equal terms share the slope") {
    CHECK(solve({firstOrderTerm(0), firstOrderTerm(0)}, 1) ==
          Approx(std::sqrt(0.5)).epsilon(1e-15));
    CHECK(solve({firstOrderTerm(0), firstOrderTerm(0), firstOrderTerm(0)}, 1) ==
          Approx(std::sqrt(1.0 / 3)).epsilon(1e-15));
    const UpwindTerm u = secondOrderTerm(0, 0);
    CHECK(solve({u, u, u}, 1) == Approx(std::sqrt(1.0 / 3) / 1.5).epsilon(1e-15));
}

TEST_CASE("eikonal: a plane front is met exactly at any order and number of terms") {
    // d = n.x has the values -n_j and -2 n_j one and two voxels upwind of 0; the root is 0. There
    // the square root is the sum of slopes, at least 1, so rounding stays within a few units.
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit(0.01, 1);
    for (int trial = 0; trial < 1000; ++trial) {
        std::array<double, 3> n{unit(random), unit(random), unit(random)};
        const int dims = 1 + trial % 3;
        double norm = 0;
        for (int j = 0; j < dims; ++j) norm += n[std::size_t(j)] * n[std::size_t(j)];
        std::vector<UpwindTerm> terms;
        for (int j = 0; j < dims; ++j) {
            const double nj = n[std::size_t(j)] / std::sqrt(norm);
            terms.push_back(trial % 2 ? secondOrderTerm(-nj, -2 * nj) : firstOrderTerm(-nj));
        }
        CHECK(std::abs(solve(terms, 1)) < 1e-14);
    }
}

TEST_CASE("eikonal: agrees with bisection of the equation") {
    std::mt19937 random(2);
    for (int trial = 0; trial < 20000; ++trial) {
        const double cost = trial % 4 == 0 ? 1 : std::pow(10.0, trial % 7 - 3);
        const auto terms = randomTerms(random, 1 + trial % 3, cost);
        const double expected = solveByBisection(terms, cost);
        INFO("trial " << trial << ", cost " << cost);
        // A slope that just begins to count enters with its square: an error e of the equation
        // (2e-15 cost^2) moves the root by e over the sum of slopes, which is at least cost. The
        // values themselves are rounded to 2e-15 where they are near 10.
        REQUIRE(std::abs(solve(terms, cost) - expected) < 1e-14 * (10 + 2 * cost));
    }
}

TEST_CASE("eikonal: what is not upwind of the result changes no bit") {
    std::mt19937 random(3);
    for (int trial = 0; trial < 5000; ++trial) {
        const auto terms = randomTerms(random, 3, 1);
        const double t = solve(terms, 1);
        std::vector<UpwindTerm> used;
        for (const UpwindTerm& u : terms)
            if (u.base < t) used.push_back(u);
        REQUIRE(!used.empty());
        REQUIRE(solve(used, 1) == t);
    }
}

TEST_CASE("eikonal: the order of the axes does not matter") {
    std::mt19937 random(4);
    for (int trial = 0; trial < 5000; ++trial) {
        auto terms = randomTerms(random, 3, 1);
        // Equal neighbors of two axes, one of them at order 2: on a plane of symmetry.
        if (trial % 3 == 0) {
            terms[0] = firstOrderTerm(10);
            terms[1] = secondOrderTerm(10, 10 - 0.25 * (trial % 5));
        }
        const double t = solve(terms, 1);
        // The sums run in sorted order; where bases tie the coefficients may swap: a few roundings
        // of numbers near 12.
        const double rounding = trial % 3 == 0 ? 8e-15 : 0;
        for (const auto& p :
             {std::array<std::size_t, 3>{0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}})
            REQUIRE(std::abs(solve({terms[p[0]], terms[p[1]], terms[p[2]]}, 1) - t) <= rounding);
    }
}

TEST_CASE("eikonal: a common offset changes nothing, however large") {
    // Values in multiples of 2^-10 and offsets below 2^42 are exact at order 1, so only the final
    // sums round: half a unit in the last place of each.
    std::mt19937 random(5);
    std::uniform_int_distribution<int> step(0, 1000);
    for (const double offset : {1.0, 1024.0, 1e6, 1e9, 1e12}) {
        for (int trial = 0; trial < 500; ++trial) {
            std::vector<UpwindTerm> near, far;
            for (int j = 0; j < 3; ++j) {
                const double m = step(random) / 1024.0;
                near.push_back(firstOrderTerm(m));
                far.push_back(firstOrderTerm(offset + m));
            }
            const double rounding = (offset + 3) * 1.2e-16 + 2e-16;
            REQUIRE(std::abs((solve(far, 1) - offset) - solve(near, 1)) <= rounding);
        }
    }
    // Far from the seed the plane front is still met to the last digits.
    const double n = 1 / std::sqrt(3.0), offset = 1e9;
    const UpwindTerm u = secondOrderTerm(offset - n, offset - 2 * n);
    CHECK(std::abs(solve({u, u, u}, 1) - offset) <= 4e-7);
}

TEST_CASE("eikonal: scaling cost and values by a power of two scales the result bitwise") {
    std::mt19937 random(6);
    for (int trial = 0; trial < 1000; ++trial) {
        const auto terms = randomTerms(random, 3, 1);
        auto scaled = terms;
        for (UpwindTerm& u : scaled) u.base *= 4;
        REQUIRE(solve(scaled, 4) == 4 * solve(terms, 1));
    }
}

}  // namespace igeo::test
