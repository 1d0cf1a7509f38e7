#include <igeo/march/detail/jet_rim.h>

#include <igeo/band/detail/open_sector.h>
#include <igeo/march/detail/jet_core.h>

#include <algorithm>
#include <cmath>

namespace igeo {

bool JetRims::isOpen(const JetCore& core, NodeIndex i) const {
    return known(i, kOpen, [&] {
        OpenSector sector;
        const TangentFrame frame(core.nodes[i].normal);
        forLinks(core, i, [&](NodeIndex, const Ijk&, const Vec3f& chord, float) {
            sector.add(frame.flat(chord));
        });
        return sector.find();
    });
}

bool JetRims::isBesideOpen(const JetCore& core, NodeIndex i) const {
    return known(i, kBesideOpen, [&] {
        bool open = isOpen(core, i);
        if (!open)
            forLinks(core, i, [&](NodeIndex j, const Ijk&, const Vec3f&, float) {
                open = open || isOpen(core, j);
            });
        return open;
    });
}

bool JetRims::isCreasedBeside(const JetCore& core, NodeIndex i) const {
    const auto isCreased = [&](NodeIndex k) {
        bool crease = false;
        forLinks(core, k, [&](NodeIndex, const Ijk&, const Vec3f&, float cosine) {
            crease |= cosine < JetLink::kSmooth;
        });
        return crease;
    };
    return known(i, kBesideCrease, [&] {
        bool crease = false;
        forLinks(core, i, [&](NodeIndex j, const Ijk&, const Vec3f&, float) {
            crease = crease || isCreased(j);
        });
        return crease;
    });
}

bool leadsOverRim(const Band& band, const Vec3d& from, const Vec3d& to) {
    constexpr double kFar = 3, kStep = 0.5, kOff = 0.1;  // voxels
    const auto beyondRim = [&](const Vec3d& p) {
        if (!band.triangles) return std::isnan(psiAt(band, p)) ? kInfinity : 0.0;
        const SurfaceTriangles::Place at = band.triangles->nearest(p, kFar);
        if (at.triangle == SurfaceTriangles::kNone) return kInfinity;
        return length(tangential(p - at.point, band.triangles->normal(at.triangle)));
    };
    const double most = std::max(beyondRim(from), beyondRim(to)) + kOff;
    const Vec3d chord = to - from;
    const int parts = std::max(2, int(std::ceil(length(chord) / kStep)));
    for (int k = 1; k < parts; ++k)
        if (beyondRim(from + (double(k) / parts) * chord) > most) return true;
    return false;
}

}  // namespace igeo
