#include <igeo/base/detail/registers.h>
#include <igeo/march/detail/jet_ray_lanes.h>

#include <algorithm>

namespace igeo {

namespace {

/// The rays from `first` on that fit into a register.
template <int Width>
class RayRegisters {
    using V = typename Registers<Width>::Vector;
    using Integers = typename Registers<Width>::Integers;
    using Vectors = VectorLanes<Width>;

public:
    IGEO_INLINE RayRegisters(const JetCorners& corners, std::size_t first, RayLanes& rays)
        : corners_(corners), first_(first), rays_(rays) {
        for (std::size_t k = first; k < first + Width; ++k)
            most_ = std::max(most_, std::size_t(corners.count[k]));
    }

    IGEO_INLINE void step(bool faceted) {
        constexpr float kHigh = 0.5f;
        // Arc over chord, of a circle; over an edge somewhere in the step, in the mean.
        const float perBend2 = faceted ? 1.0f / 12 : 1.0f / 24;
        const Vectors from{in(rays_.x), in(rays_.y), in(rays_.z)},
            n{in(rays_.nx), in(rays_.ny), in(rays_.nz)},
            v{in(rays_.vx), in(rays_.vy), in(rays_.vz)};
        normal_ = meanNormal();
        const V height = heightOverS();
        toS_ = normal_ * -height;
        const Vectors to = Vectors{in(rays_.aheadX), in(rays_.aheadY), in(rays_.aheadZ)} + toS_,
                      chord = to - from, bend = normal_ - n;
        // A circle: its arc, and its direction at the end, the mirror image of that at the start.
        const V len = roots(dot(chord, chord)), kc = dot(bend, chord) / len;
        const Vectors along = chord * (1 / len);
        v_ = unit(tangential(along * (2 * dot(v, along)) - v));
        out(rays_.length) = in(rays_.length) + len * (1 + kc * kc * perBend2);
        out(rays_.turn) = dot(bend, v_);
        put(to, rays_.x, rays_.y, rays_.z);
        put(v_, rays_.vx, rays_.vy, rays_.vz);
        put(normal_, rays_.nx, rays_.ny, rays_.nz);
        valid_ = integers(rays_.valid.data()) & (integers(corners_.count.data()) > 0) &
                 (integers(corners_.smooth.data()) != 0) &
                 (integers(corners_.hindered.data()) == 0) & (absolute(height) <= kHigh);
        storeLanes(valid_, rays_.valid.data() + first_);
    }

    /// Looks to the side of the end of a ray, where the corners there lie on the other one.
    IGEO_INLINE void lookBeside(BesideRays& beside) {
        begin();
        const Vectors side = cross(normal_, v_);
        V total{}, l{}, ll{};
        for (std::size_t k = 0; k < most_; ++k) {
            const V w = in(corners_.corner[k].weight), across = -dot(side, chord(k));
            total += w, l += w * across, ll += w * across * across;
        }
        l /= total;
        const V way = l > 0 ? V{} - beside.kStep : V{} + beside.kStep;
        const Integers wanted = valid_ & (ll / total - l * l < beside.kSpread);
        storeLanes(wanted, beside.wanted.data() + first_);
        const Vectors to = Vectors{in(rays_.x), in(rays_.y), in(rays_.z)} + side * way;
        look(to.x, rays_.start.x, beside.cell.x, beside.points.x, beside.x);
        look(to.y, rays_.start.y, beside.cell.y, beside.points.y, beside.y);
        look(to.z, rays_.start.z, beside.cell.z, beside.points.z, beside.z);
        out(beside.points.nx) = normal_.x, out(beside.points.ny) = normal_.y,
        out(beside.points.nz) = normal_.z;
    }

    /// The front at the end, from the corners that belong to it. Its direction there, not at their
    /// middle, which may lie to the side: as it changes from side to side.
    IGEO_INLINE void read(const BesideRays& beside) {
        constexpr float kStiff = 0.01f;
        begin();
        const Vectors mean = unit(tangential(membersOfFront())), side = cross(normal_, mean);
        V total{}, l{}, t{}, ll{}, lt{};
        for (std::size_t k = 0; k < most_; ++k) {
            const V w = member_[k], across = -dot(side, chord(k)), turned = dot(side, own(k));
            total += w, l += w * across, t += w * turned;
            ll += w * across * across, lt += w * across * turned;
        }
        V all = total, allL = l, allT = t;
        l /= total, t /= total;
        // The corners beside the end show the change only.
        const Integers counts = integers(beside.wanted.data()) &
                                (integers(beside.corners.smooth.data()) != 0) &
                                (integers(beside.corners.hindered.data()) == 0);
        const Vectors toEnd = Vectors{in(rays_.x), in(rays_.y), in(rays_.z)} -
                              Vectors{in(beside.x), in(beside.y), in(beside.z)};
        for (std::size_t k = 0; k < mostBeside(beside); ++k) {
            const JetCorners::Corner& c = beside.corners.corner[k];
            const Vectors g{in(c.gx), in(c.gy), in(c.gz)},
                chord = Vectors{in(c.x), in(c.y), in(c.z)} + toEnd;
            const V w = (counts & (dot(g, lead_) >= kMember)) ? in(c.weight) : V{},
                    across = -dot(side, chord), turned = dot(side, g);
            all += w, allL += w * across, allT += w * turned;
            ll += w * across * across, lt += w * across * turned;
        }
        const V curvature = (lt - allL * allT / all) / (ll - allL * allL / all + kStiff * all);
        const Vectors g = unit(mean + side * (t - curvature * l));
        V value{};
        for (std::size_t k = 0; k < most_; ++k)
            value += member_[k] *
                     (in(corners_.corner[k].u) + dot(g + own(k), chord(k)) / (1 + dot(g, own(k))));
        out(rays_.u) = value / total;
        out(rays_.curvature) = curvature;
        out(rays_.off) = dot(cross(g, v_), normal_);
        storeLanes(valid_, rays_.valid.data() + first_);
    }

private:
    static constexpr float kMember = 0.97f;  ///< of one front at the end, cosine

    /// At the end of a ray.
    IGEO_INLINE void begin() {
        normal_ = {in(rays_.nx), in(rays_.ny), in(rays_.nz)};
        v_ = {in(rays_.vx), in(rays_.vy), in(rays_.vz)};
        toS_ = Vectors{in(rays_.x), in(rays_.y), in(rays_.z)} -
               Vectors{in(rays_.aheadX), in(rays_.aheadY), in(rays_.aheadZ)};
        valid_ = integers(rays_.valid.data());
    }
    IGEO_INLINE std::size_t mostBeside(const BesideRays& beside) const {
        std::size_t most = 0;
        for (std::size_t k = first_; k < first_ + Width; ++k)
            most = std::max(most, std::size_t(beside.corners.count[k]));
        return most;
    }
    /// The cell of a coordinate, and the place in it.
    template <typename Starts, typename Cells>
    IGEO_INLINE void look(const V& to, const Starts& start, Cells& low, Lanes& place, Lanes& at) {
        const Integers whole = __builtin_convertvector(to, Integers),
                       floor = whole + (__builtin_convertvector(whole, V) > to);
        storeLanes(loadAs<Integers>(start.data() + first_) + floor, low.data() + first_);
        out(place) = to - __builtin_convertvector(floor, V);
        out(at) = to;
    }

    /// Finds the corners of the front that travels most nearly against the ray.
    /// @return the weighted sum of their directions
    IGEO_INLINE Vectors membersOfFront() {
        constexpr float kAgainst = 0.7f;
        V most{};
        lead_ = Vectors{};
        for (std::size_t k = 0; k < most_; ++k) {
            const Vectors g = own(k);
            const V against = -dot(g, v_);
            const Integers better = (in(corners_.corner[k].weight) > 0) & (against > most);
            most = better ? against : most;
            lead_ = {better ? g.x : lead_.x, better ? g.y : lead_.y, better ? g.z : lead_.z};
        }
        valid_ &= most > kAgainst;
        Vectors sum{};
        for (std::size_t k = 0; k < most_; ++k) {
            const Vectors g = own(k);
            const V w = in(corners_.corner[k].weight);
            member_[k] = dot(g, lead_) >= kMember ? w : V{};
            sum = sum + g * member_[k];
        }
        return sum;
    }

    IGEO_INLINE Vectors meanNormal() const {
        Vectors sum{};
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            sum = sum + Vectors{in(c.mx), in(c.my), in(c.mz)} * in(c.weight);
        }
        return unit(sum);
    }
    /// Of the point ahead: the mean of chord . (m + n) / 2, exact on spheres.
    IGEO_INLINE V heightOverS() const {
        V sum{}, total{};
        for (std::size_t k = 0; k < most_; ++k) {
            const JetCorners::Corner& c = corners_.corner[k];
            const V w = in(c.weight);
            sum += w * dot(Vectors{in(c.x), in(c.y), in(c.z)},
                           Vectors{in(c.mx), in(c.my), in(c.mz)} + normal_);
            total += w;
        }
        return sum / (2 * total);
    }
    /// From the foot point of a corner to the end of the step.
    IGEO_INLINE Vectors chord(std::size_t k) const {
        const JetCorners::Corner& c = corners_.corner[k];
        return Vectors{in(c.x), in(c.y), in(c.z)} + toS_;
    }
    IGEO_INLINE Vectors own(std::size_t k) const {
        const JetCorners::Corner& c = corners_.corner[k];
        return {in(c.gx), in(c.gy), in(c.gz)};
    }

    IGEO_INLINE Vectors tangential(const Vectors& w) const { return w - normal_ * dot(w, normal_); }
    IGEO_INLINE static V roots(V v) {
        takeRoots<Width>(v);
        return v;
    }
    IGEO_INLINE static Vectors unit(const Vectors& w) { return w * (1 / roots(dot(w, w))); }
    IGEO_INLINE const V& in(const Lanes& l) const {
        return *reinterpret_cast<const V*>(l.of + first_);
    }
    IGEO_INLINE V& out(Lanes& l) const { return *reinterpret_cast<V*>(l.of + first_); }
    IGEO_INLINE void put(const Vectors& w, Lanes& x, Lanes& y, Lanes& z) const {
        out(x) = w.x, out(y) = w.y, out(z) = w.z;
    }
    template <typename T>
    IGEO_INLINE Integers integers(const T* from) const {
        return loadAs<Integers>(from + first_);
    }

    const JetCorners& corners_;
    const std::size_t first_;
    RayLanes& rays_;
    std::size_t most_ = 0;  ///< corners of a point
    Vectors normal_, v_, toS_, lead_;
    Integers valid_;
    V member_[JetCorners::kMax];  ///< weights of the corners of the front, or 0
};

template <typename Do>
void byFour(const JetCorners& corners, RayLanes& rays, const Do& work) {
    for (std::size_t first = 0; first < Lanes::kNodes; first += 4) {
        RayRegisters<4> registers(corners, first, rays);
        work(registers);
    }
}
#ifdef IGEO_AVX2
IGEO_AVX2 void stepByEight(const JetCorners& corners, bool faceted, RayLanes& rays) {
    RayRegisters<8>(corners, 0, rays).step(faceted);
}
IGEO_AVX2 void lookByEight(const JetCorners& corners, RayLanes& rays, BesideRays& beside) {
    RayRegisters<8>(corners, 0, rays).lookBeside(beside);
}
IGEO_AVX2 void readByEight(const JetCorners& corners, const BesideRays& beside, RayLanes& rays) {
    RayRegisters<8>(corners, 0, rays).read(beside);
}
#endif

}  // namespace

void lookAhead(float step, RayLanes& rays, CellPoints& points) {
    using Four = Registers<4>::Vector;
    using Integers = Registers<4>::Integers;
    for (std::size_t lane = 0; lane < Lanes::kNodes; lane += 4) {
        const auto in = [&](const Lanes& l) { return loadLanes<4>(l.of + lane); };
        const Four sink = step * in(rays.turn) / 2;
        const auto look = [&](const Lanes& from, const Lanes& v, const Lanes& n, Lanes& ahead,
                              const auto& start, auto& low, Lanes& place) {
            const Four way = step * in(v), down = sink * in(n), to = in(from) + way - down;
            const Integers whole = __builtin_convertvector(to, Integers),
                           floor = whole + (__builtin_convertvector(whole, Four) > to);
            storeLanes(to, ahead.of + lane);
            storeLanes(loadAs<Integers>(start.data() + lane) + floor, low.data() + lane);
            storeLanes(to - __builtin_convertvector(floor, Four), place.of + lane);
        };
        const CellPlaces& start = rays.start;
        look(rays.x, rays.vx, rays.nx, rays.aheadX, start.x, rays.cell.x, points.x);
        look(rays.y, rays.vy, rays.ny, rays.aheadY, start.y, rays.cell.y, points.y);
        look(rays.z, rays.vz, rays.nz, rays.aheadZ, start.z, rays.cell.z, points.z);
    }
    rays.cell.leaf = rays.start.leaf;
    points.nx = rays.nx, points.ny = rays.ny, points.nz = rays.nz;
}
void makeStep(const JetCorners& corners, bool faceted, RayLanes& rays) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return stepByEight(corners, faceted, rays);
#endif
    byFour(corners, rays, [&](auto& r) { r.step(faceted); });
}
void lookBeside(const JetCorners& corners, RayLanes& rays, BesideRays& beside) {
    beside.cell.leaf = rays.start.leaf;
#ifdef IGEO_AVX2
    if (eightAtATime()) return lookByEight(corners, rays, beside);
#endif
    byFour(corners, rays, [&](auto& r) { r.lookBeside(beside); });
}
void readFronts(const JetCorners& corners, const BesideRays& beside, RayLanes& rays) {
#ifdef IGEO_AVX2
    if (eightAtATime()) return readByEight(corners, beside, rays);
#endif
    byFour(corners, rays, [&](auto& r) { r.read(beside); });
}

}  // namespace igeo
