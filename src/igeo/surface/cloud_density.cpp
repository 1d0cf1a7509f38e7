#include <igeo/surface/cloud_density.h>

#include <fmt/core.h>
#include <igeo/base/detail/text.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace igeo {

FitError CloudDensity::fitError() const {
    constexpr double kUnknowns = 6;
    const double count = std::max(double(fitted), kUnknowns + 1);
    FitError e;
    e.spacing = spacing;
    e.radius = spacing * std::sqrt(count / std::numbers::pi);
    e.freedom = 1 - (kUnknowns + 1) / count;
    e.heightNoise = kUnknowns / count * noise * noise * e.radius;
    return e;
}

std::vector<std::string> densityWarnings(const CloudDensity& density, const std::string& file) {
    std::vector<std::string> warnings;
    const double all = double(density.points + density.isolated);
    if (double(density.isolated) > 0.001 * all)
        warnings.push_back(fmt::format(
            "{}: {} points ({}) are far from the others or from the surface; they are left out",
            file, density.isolated, percent(double(density.isolated) / all)));
    if (density.noise > 0.1 * density.spacing)
        warnings.push_back(
            fmt::format("{}: points scatter by {} of their spacing about the surface; each fit "
                        "averages over {}",
                        file, percent(density.noise / density.spacing), density.fitted));
    if (density.spacing99 > 3 * density.spacing)
        warnings.push_back(
            fmt::format("{}: the spacing is uneven: {:g} in the median, {:g} at the 99th "
                        "percentile; thin parts may end or merge",
                        file, density.spacing, density.spacing99));
    if (density.facing > 0.02)
        warnings.push_back(
            fmt::format("{}: on {} of the surface another sheet is within three spacings; folds "
                        "may close there and distances be off; take more points",
                        file, percent(density.facing)));
    if (density.conflicts > 0.01)
        warnings.push_back(file + ": " + percent(density.conflicts) +
                           " of the normals disagree with their neighbors; where the surface is "
                           "one-sided or too thin for the points, no front passes");
    return warnings;
}

}  // namespace igeo
