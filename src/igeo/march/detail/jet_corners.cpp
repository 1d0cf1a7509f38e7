#include <igeo/march/detail/jet_blend.h>
#include <igeo/march/detail/jet_corners.h>

#include <algorithm>

namespace igeo {

void JetCorners::pad() {
    const std::uint32_t most = *std::max_element(count.begin(), count.end());
    for (std::size_t lane = 0; lane < count.size(); ++lane)
        for (std::size_t k = count[lane]; k < most; ++k) {
            Corner& c = corner[k];
            c.weight[lane] = c.x[lane] = c.y[lane] = c.z[lane] = 0;
            c.gx[lane] = c.gy[lane] = c.gz[lane] = c.u[lane] = c.mean[lane] = 0;
        }
}

namespace {

using jet::Four;

/// Four of the nodes, from `first` on.
class FourNodes {
public:
    FourNodes(const JetCorners& corners, std::size_t first) : corners_(corners), first_(first) {
        for (std::size_t k = first; k < first + 4; ++k)
            most_ = std::max(most_, std::size_t(corners.count[k]));
    }

    void carry(CarriedJets& jets) const {
        Four gx{}, gy{}, gz{};
        meanDirection(gx, gy, gz);
        Four value{}, total{}, least = Four{} + 1;
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            const Four w = in(c.weight), x = in(c.gx), y = in(c.gy), z = in(c.gz);
            const Four cosine = gx * x + gy * y + gz * z;
            least = (w > 0) & (cosine < least) ? cosine : least;
            // Directions in space, not in one plane, change the step by (k c)^2 / 12 at curvature
            // k.
            const Four along = (gx + x) * in(c.x) + (gy + y) * in(c.y) + (gz + z) * in(c.z);
            value += w * (in(c.u) + in(c.mean) * along / (1 + cosine));
            total += w;
        }
        out(jets.u) = value / total;
        out(jets.gx) = gx, out(jets.gy) = gy, out(jets.gz) = gz;
        for (std::size_t k = 0; k < 4; ++k) {
            jets.oneFront[first_ + k] = least[k] >= jet::kSameFront;
            jets.close[first_ + k] = least[k] >= jet::kClose;
        }
    }

private:
    Four in(const Lanes& l) const { return *reinterpret_cast<const Four*>(l.of + first_); }
    Four& out(Lanes& l) const { return *reinterpret_cast<Four*>(l.of + first_); }

    /// Unit, in the tangent plane of each node; 0 where the corners cancel each other.
    void meanDirection(Four& gx, Four& gy, Four& gz) const {
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            const Four w = in(c.weight);
            gx += w * in(c.gx), gy += w * in(c.gy), gz += w * in(c.gz);
        }
        const Four nx = in(corners_.nx), ny = in(corners_.ny), nz = in(corners_.nz),
                   off = gx * nx + gy * ny + gz * nz;
        gx -= off * nx, gy -= off * ny, gz -= off * nz;
        const Four len = jet::roots(gx * gx + gy * gy + gz * gz), zero{},
                   inverse = len > 0 ? 1 / len : zero;
        gx *= inverse, gy *= inverse, gz *= inverse;
    }

    const JetCorners& corners_;
    std::size_t first_, most_ = 0;
};

}  // namespace

void carryFromCorners(const JetCorners& corners, CarriedJets& jets) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4)
        FourNodes(corners, first).carry(jets);
}

}  // namespace igeo
