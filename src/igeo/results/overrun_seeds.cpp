#include <igeo/results/overrun_seeds.h>

#include <fmt/core.h>

namespace igeo {

std::vector<std::string> overrunWarnings(const Field& field,
                                         const std::vector<std::string>& names) {
    constexpr double kLate = 0.01;  // voxels
    const Band& band = *field.band;
    struct Source {
        std::size_t segments = 0, lost = 0;
        double start = 0, arrival = 0;  ///< of the first one lost
    };
    std::vector<Source> sources(field.sourceCount());
    for (std::size_t k = 0; k < field.seeds.size(); ++k) {
        const SurfacePoint& s = field.seeds[k];
        Source& source = sources[field.source[k]];
        ++source.segments;
        if (!(s.start > field.leastStart)) continue;
        const double d = arrivalAt(field, s.pIndex, Vec3d(band.normal[s.node])).distance;
        if (d < s.start - kLate && source.lost++ == 0) source.start = s.start, source.arrival = d;
    }
    std::vector<std::string> warnings;
    for (std::size_t k = 0; k < sources.size(); ++k) {
        const Source& s = sources[k];
        if (s.lost == 0) continue;
        const std::string part =
            s.segments > 1 ? fmt::format("{} of {} segments of ", s.lost, s.segments) : "";
        const std::string name =
            k < names.size() && !names[k].empty() ? names[k] : "seed " + std::to_string(k);
        warnings.push_back(
            fmt::format("{}{}: the front of another seed comes at {:.6g}, before the start at "
                        "{:.6g}, so it has no effect there",
                        part, name, s.arrival * band.transform.dx, s.start * band.transform.dx));
    }
    return warnings;
}

}  // namespace igeo
