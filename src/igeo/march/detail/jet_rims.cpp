#include <igeo/march/detail/jet_rims.h>

#include <igeo/band/detail/open_sector.h>
#include <igeo/march/detail/jet_core.h>

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

}  // namespace igeo
