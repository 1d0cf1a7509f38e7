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
    // Normals that turn look like another sheet, up to three times as far about.
    const bool hasSheets = density.facing > 0.02 + 3 * density.turned;
    if (hasSheets)
        warnings.push_back(
            fmt::format("{}: on {} of the surface another sheet is within three spacings; folds "
                        "may close there and distances be off; take more points",
                        file, percent(density.facing)));
    constexpr double kSeam = 10, kMany = 0.01;
    if (density.seam > kSeam * density.spacing || (density.turned > kMany && !hasSheets))
        warnings.push_back(fmt::format(
            "{}: normals turn to the other side of the surface from point to point, beside {} of "
            "the points and along up to {:.3g}: no front passes there; {}",
            file, percent(density.turned), density.seam,
            density.hasNormals
                ? "turn the normals to one side, or leave them out"
                : "the surface is one-sided or too thin for the points: give it as a "
                  "mesh, or take more points"));
    else if (density.conflicts > kMany)
        warnings.push_back(
            fmt::format("{}: {} of the normals are more than 60 degrees off the surface through "
                        "the points; give better ones, or leave them out",
                        file, percent(density.conflicts)));
    return warnings;
}

}  // namespace igeo
