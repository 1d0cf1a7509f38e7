#include <igeo/surface/cloud_density.h>

#include <cmath>

namespace igeo {

std::vector<std::string> densityWarnings(const CloudDensity& density, const std::string& file) {
    std::vector<std::string> warnings;
    auto percent = [](double share) {
        const double p = std::round(1000 * share) / 10;
        std::string text = std::to_string(p);
        return text.substr(0, text.find('.') + 2) + " %";
    };
    const double all = double(density.points + density.isolated);
    if (double(density.isolated) > 0.001 * all)
        warnings.push_back(file + ": " + std::to_string(density.isolated) + " points (" +
                           percent(double(density.isolated) / all) +
                           ") are far from the others or from the surface; they are left out");
    if (density.noise > 0.1 * density.spacing)
        warnings.push_back(file + ": points scatter by " +
                           percent(density.noise / density.spacing) +
                           " of their spacing about the surface; each fit averages over " +
                           std::to_string(density.fitted));
    if (density.spacing99 > 3 * density.spacing)
        warnings.push_back(file + ": the spacing is uneven: " + std::to_string(density.spacing) +
                           " in the median, " + std::to_string(density.spacing99) +
                           " at the 99th percentile; thin parts may end or merge");
    if (density.conflicts > 0.01)
        warnings.push_back(file + ": " + percent(density.conflicts) +
                           " of the normals disagree with their neighbors; where the surface is "
                           "one-sided or too thin for the points, no front passes");
    return warnings;
}

}  // namespace igeo
