#include <igeo/results/detail/seed_frames.h>

namespace igeo {

namespace {

SeedAxes axesAt(const Field& field, const SurfacePoint& seed, const Vec3d& reference) {
    const Band& band = *field.band;
    const Vec3d sheetNormal(band.normal[seed.node]);
    const Vec3d n = SurfaceCell(band, *field.metric, seed.pIndex, sheetNormal).normal;
    Vec3d u = tangential(reference, n);
    if (!(length(u) > 1e-6 * length(reference))) {
        int least = 0;
        for (int a = 1; a < 3; ++a)
            if (std::abs(n[a]) < std::abs(n[least])) least = a;
        Vec3d axis;
        axis[least] = 1;
        u = tangential(axis, n);
    }
    u = normalized(u);
    return {u, cross(n, u)};
}

/// The axis of a frame at the other end of a chord, transported along it.
Vec2f carriedAxis(const Chart& here, const Vec3f& chord, const Vec3f& normal,
                  const SeedFrame& there) {
    const float cosine = dot(here.frame.normal(), normal);
    const JetNeighbor n = flattened(here.frame, chord, normal, cosine, there.axis, 0);
    const Vec2f slope = here.frame.flat(here.logGradient + there.logGradient);
    return turned(n.g, cross(n.a, slope) / 2);
}

}  // namespace

SeedFrames::SeedFrames(const Field& field, const Vec3d& reference)
    : band_(*field.band),
      field_(field),
      metric_(*field.metric),
      core_(*field.jets->core),
      distance_(field.distance),
      gradient_(field.gradient),
      label_(field.label),
      frames_(field.jets->core->nodes.size()) {
    for (const SurfacePoint& seed : field.seeds) atSeeds_.push_back(axesAt(field, seed, reference));
    nodes_.reserve(core_.nodes.size());
    for (const JetNode& node : core_.nodes) nodes_.push_back(core_.inBand(node));
    if (!metric_.obstacles) return;
    ownDistance_ = field.distance, ownGradient_ = field.gradient, ownLabel_ = field.label;
    for (NodeIndex k = 0; k < nodes_.size(); ++k) {
        const NodeIndex i = nodes_[k];
        if (!field.jets->accepted(k) || !isMoved(core_, k)) continue;
        ownDistance_[i] = field.jets->valueOf(k);
        ownGradient_[i] = core_.nodes[k].weight * field.jets->gradientOf(k);
        if (!ownLabel_.empty()) ownLabel_[i] = field.jets->labelOf(k);
    }
    distance_ = ownDistance_, gradient_ = ownGradient_, label_ = ownLabel_;
}

Chart SeedFrames::chart(NodeIndex core) const {
    const NodeIndex i = nodes_[core];
    return chart(i, core_.footOf(core_.nodes[core]), gradient(i), distance(i));
}

Chart SeedFrames::chartAtFoot(NodeIndex i) const {
    const std::uint32_t source = field_.label.empty() ? 0 : field_.label[i];
    return chart(i, band_.footPoint(i), field_.gradient[i],
                 field_.distance[i] - field_.seeds[source].start);
}

Chart SeedFrames::chart(NodeIndex i, const Vec3d& foot, const Vec3f& gradient,
                        double distance) const {
    const TangentFrame frame(band_.normal[i], band_.faceted);
    return {foot, frame, frame.flat(normalized(gradient)), distance, weight(i), logGradient(i)};
}

Vec3f SeedFrames::logGradient(NodeIndex i) const {
    if (!metric_.weighted()) return {};
    const TangentFrame frame(band_.normal[i], band_.faceted);
    float xx = 1e-6f, xy = 0, yy = 1e-6f;
    Vec2f right;
    band_.forNeighbors(&BandLeaf::band, i, [&](NodeIndex j, int, int, int) {
        if (dot(band_.normal[i], band_.normal[j]) < 0.5f) return;
        const Vec2f a = frame.flat(Vec3f(band_.footPoint(j) - band_.footPoint(i)));
        const auto rise = float(std::log(metric_.at(j) / metric_.at(i)));
        xx += a.x * a.x, xy += a.x * a.y, yy += a.y * a.y;
        right = right + rise * a;
    });
    const float det = xx * yy - xy * xy;
    return frame.lift((1 / det) * Vec2f{yy * right.x - xy * right.y, xx * right.y - xy * right.x});
}

bool SeedFrames::fromSeed(NodeIndex i, const Chart& here, SeedFrame& out) const {
    constexpr double kLonger = 1.05, kSlack = 0.05;  // the latter voxels
    const std::uint32_t k = label(i);
    const SurfacePoint& seed = field_.seeds[k];
    const Vec3f chord(here.foot - seed.pIndex);
    const Vec3f normal(cross(atSeeds_[k].u, atSeeds_[k].v));
    const float cosine = dot(normal, here.frame.normal());
    if (length(chord) > float(field_.startRadius) || cosine < 0) return false;
    // The front may have come another way: from a sheet close to the seed's, around a corner, or
    // over a jump of the weight.
    const double straight = double(length(here.frame.unfold(chord, normal, cosine)));
    if (here.distance >
        (kLonger * straight + kSlack) * meanFromSeed(band_, metric_, seed, here.foot, here.weight))
        return false;
    SeedFrame there;
    there.axis = Vec3f(atSeeds_[k].u);
    there.logGradient = here.logGradient;
    out.axis = here.frame.lift(carriedAxis(here, chord, normal, there));
    return true;
}

bool SeedFrames::fromNeighbors(const Chart& here, const FrontNeighbors& all, SeedFrame& out) const {
    constexpr float kPull = 0.005f;
    // Angles are relative to the axis of one of them.
    Vec2f from;
    LineFit fit;
    float turn = 0;
    for (const FrontNeighbor& n : all) {
        const float along = dot(here.direction, n.vector);
        const SeedFrame& there = frames_[n.core];
        if (!(along > 0) || n.bends || !there.known()) continue;
        const Vec2f axis = carriedAxis(here, n.chord, band_.normal[nodes_[n.core]], there);
        if (fit.s0 == 0) from = axis;
        const float w = along * along / dot(n.vector, n.vector) * n.weight;
        fit.add(w, -cross(here.direction, n.vector) / 2,
                angleFrom(from, axis) + there.turn * n.aside / 2);
        turn += w * there.turn;
    }
    if (!(fit.s0 > 0)) return false;
    float angle;
    fit.solve(kPull, turn / fit.s0, angle, out.turn);
    out.axis = here.frame.lift(normalized(turned(from, angle)));
    return true;
}

void SeedFrames::set(NodeIndex core, const Chart& here, const SeedFrame& frame) {
    frames_[core] = frame;
    frames_[core].logGradient = here.logGradient;
}

Vec2f SeedFrames::measure(NodeIndex i, const SeedFrame& frame) const {
    const Vec3f g = normalized(gradient(i)), n = band_.normal[i];
    return normalized(Vec2f{dot(frame.axis, g), dot(n, cross(frame.axis, g))});
}

}  // namespace igeo
