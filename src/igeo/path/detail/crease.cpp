#include <igeo/path/detail/crease.h>

#include <algorithm>
#include <numbers>
#include <utility>

namespace igeo {

namespace {

constexpr double kCreaseStep = 0.5;
constexpr double kLeastTurn = 0.94;  // cosine of 20 degrees, between sheets
constexpr double kDisturbed = 3.2;   // voxels from another sheet

double degrees(const Vec3d& a, const Vec3d& b) {
    return angleBetween(a, b) * 180 / std::numbers::pi;
}

/// Whether a node on the sheet has its foot point near q.
bool isOn(const std::vector<SheetNode>& nodes, const SheetFit& sheet, const Vec3d& q,
          double radius) {
    constexpr double kAlike = 0.98, kOff = 0.1;
    const Vec3d n = sheet.normal(q);
    return std::any_of(nodes.begin(), nodes.end(), [&](const SheetNode& node) {
        return length(node.foot - q) < radius && dot(node.normal, n) > kAlike &&
               std::abs(sheet.height(node.at) - node.psi) < kOff;
    });
}

bool isBend(const Vec3d& a, const Vec3d& b) {
    constexpr double kLeast = 25, kMost = 155;
    const double bend = degrees(a, b);
    return bend >= kLeast && bend <= kMost;
}

/// Sheets beside `sheet` (null: all sheets), from the nodes on the side of S with the kink.
std::vector<SheetFit> othersThan(const SheetFit* sheet, const std::vector<SheetNode>& nodes,
                                 int side) {
    constexpr std::size_t kMost = 4, kFew = 4;
    constexpr double kAround = 3, kAlike = 0.99;
    std::vector<const SheetNode*> rest;
    for (const SheetNode& node : nodes)
        if (node.psi * side >= 0 &&
            !(sheet && (!sheet->reaches(node.foot) ||
                        dot(node.normal, sheet->normal(node.foot)) >= kLeastTurn)))
            rest.push_back(&node);
    std::vector<SheetFit> found;
    for (std::size_t round = 0; round < kMost; ++round) {
        // The node with the most nodes like it around.
        const SheetNode* best = nullptr;
        std::size_t most = kFew - 1;
        for (const SheetNode* a : rest) {
            std::size_t count = 0;
            for (const SheetNode* b : rest)
                count += dot(a->normal, b->normal) > kAlike && length(a->foot - b->foot) < kAround;
            if (count > most) most = count, best = a;
        }
        if (!best) break;
        SheetFit fit(nodes, best->foot, best->normal, side);
        const Vec3d n = best->normal;
        std::erase_if(rest, [&](const SheetNode* node) {
            return dot(node->normal, n) > kLeastTurn ||
                   (fit.valid() && dot(node->normal, fit.normal(node->foot)) > kLeastTurn);
        });
        if (fit.valid()) found.push_back(std::move(fit));
    }
    return found;
}

/// Whether a third sheet is near a line where two meet.
bool isCorner(const std::vector<SheetNode>& nodes, const Vec3d& p, const Vec3d& edge) {
    constexpr double kNear = 1, kAcross = 0.3;
    constexpr std::ptrdiff_t kFew = 4;  // between the sheets of a sharp edge single normals are off
    // Normals of the two sheets, and those around the edge between them, are across it.
    return std::count_if(nodes.begin(), nodes.end(), [&](const SheetNode& node) {
               return length(node.foot - p) < kNear && std::abs(dot(node.normal, edge)) > kAcross;
           }) >= kFew;
}

/// The direction in the plane `to` away from the plane `from`, across the line where they meet.
/// @param side  -1 of a convex edge, 1 of a hollow one
Vec3d awayFrom(const Vec3d& from, const Vec3d& to, int side) {
    const Vec3d away = cross(to, normalized(cross(from, to)));
    return dot(away, from) * side < 0 ? -away : away;
}

/// Turns the direction over the line where two sheets meet, at the same angle to it.
void turnOver(const Vec3d& from, const Vec3d& to, int side, Walker& w) {
    const Vec3d edge = normalized(cross(from, to));
    const double along = dot(w.v, edge);
    w.v = along * edge + std::sqrt(std::max(1 - along * along, 0.0)) * awayFrom(from, to, side);
    w.n = to;
}

/// How far a walk on one sheet is from another one, which it meets within a step.
double arcTo(const Walker& from, double step, const SheetFit& on, const SheetFit& other, int side) {
    constexpr int kHalvings = 40;
    double low = 0, high = step;
    for (int round = 0; round < kHalvings; ++round) {
        const double half = (low + high) / 2;
        Walker at = from;
        at.step(on, half);
        (side * other.height(at.p) > 0 ? low : high) = half;
    }
    return high;
}

}  // namespace

/// The sheet of a walk and those beside it, over edges of one kind.
struct CreaseWalk::Sheets {
    const std::vector<SheetNode>& nodes;
    int side;      ///< -1: convex edges, 1: hollow ones
    SheetFit own;  ///< not valid where none fits
    std::vector<SheetFit> others;

    /// @param kept  the sheet so far
    Sheets(const std::vector<SheetNode>& all, const Walker& w, int s,
           const std::optional<SheetFit>& kept)
        : nodes(all), side(s) {
        constexpr double kSame = 0.9986, kOffKept = 0.1, kOff = 0.5, kAround = 4;  // 3 degrees
        const bool keeps = kept && length(kept->center() - w.p) < kAround;
        if (kept && kept->isPlane())
            own = *kept;
        else {
            own = SheetFit(all, w.p, w.n, s);
            auto fits = [&](double off, double cosine) {
                return own.valid() && std::abs(own.height(w.p)) < off &&
                       dot(own.normal(w.p), w.n) > cosine;
            };
            if (keeps && !fits(kOffKept, kSame)) own = *kept;
            if (!keeps && !fits(kOff, kLeastTurn)) return;
        }
        others = othersThan(&own, all, s);
    }
    /// How far p is before another sheet, positive before it.
    double before(const SheetFit& other, const Vec3d& p) const { return side * other.height(p); }
    /// The distance of a walk from the nearest of the other sheets.
    double toSheet(const Vec3d& p) const {
        double least = kInfinity;
        for (const SheetFit& other : others) {
            const Vec3d a = own.normal(p), b = other.normal(p);
            if (!isBend(a, b) || !other.reaches(p)) continue;
            // Beyond a right angle the foot point is on the other sheet, not on the line.
            const double turn = dot(a, b) > 0 ? length(cross(a, b)) : 1;
            least = std::min(least, std::abs(other.height(p)) / turn);
        }
        return least;
    }
    /// Whether the own sheet ends at the line where it meets another one.
    bool endsAt(const Vec3d& p, const SheetFit& other) const {
        constexpr double kBeyond = 1.3, kFoot = 0.8;
        return !isOn(nodes, own, p - kBeyond * awayFrom(other.normal(p), own.normal(p), side),
                     kFoot);
    }
    /// Whether another sheet begins at this line. Foot points around an edge are on the edge.
    bool begins(const Vec3d& p, const SheetFit& other) const {
        constexpr double kFoot = 0.8;
        const Vec3d away = awayFrom(own.normal(p), other.normal(p), side);
        // A converted level set has few good nodes beside a hollow edge.
        return isOn(nodes, other, p + 1.2 * away, kFoot) ||
               isOn(nodes, other, p + 2.2 * away, kFoot);
    }
};

struct CreaseWalk::Crossing {
    bool isBefore(const Crossing& o) const { return isLost != o.isLost ? o.isLost : at < o.at; }
    double at = 0;
    std::vector<Walker> steps;     ///< to the line; the last one is turned
    std::optional<SheetFit> next;  ///< the sheet behind it
    bool isCorner = false;
    bool isLost = false;  ///< the sheet ends, and no other is known to begin there
};

bool CreaseWalk::isNearCrease(const Walker& w) const {
    constexpr int kDirections = 12, kSteps = 3;
    constexpr double kStep = 1.3, kLeastRate = 0.16;  // of the turn, per voxel
    const Vec3d u = anyNormalTo(w.n), v = cross(w.n, u);
    for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        const Vec3d direction = std::cos(angle) * u + std::sin(angle) * v;
        Vec3d p = w.p, n = w.n, foot = w.p;
        for (int step = 0; step < kSteps; ++step) {
            const Vec3d q = p + kStep * normalized(tangential(direction, n));
            if (!hasIjk(q)) return true;
            const Ijk voxel = roundToIjk(q);
            const NodeIndex i = band_.nodeAt(voxel);
            if (i == kNoNode) return true;
            const Vec3d next(band_.normal[i]), nextFoot = Vec3d(voxel) + Vec3d(band_.footOf(i));
            if (length(next - n) > kLeastRate * std::max(length(nextFoot - foot), kStep))
                return true;
            n = next, foot = nextFoot;
            p = q - dot(q - foot, n) * n;
        }
    }
    return false;
}

bool CreaseWalk::settle(Walker& start, const Vec3d& asked, const Vec3d& direction) {
    constexpr double kOff = 0.7, kFoot = 1.2, kTilt = 0.5;
    constexpr int kRounds = 3;
    if (!isNearCrease(start)) return false;
    const std::vector<SheetNode> nodes = nodesForSheets(band_, start.p);
    double least = kInfinity;
    for (const int side : {-1, 1}) {
        const std::vector<SheetFit> sheets = othersThan(nullptr, nodes, side);
        for (const SheetFit& sheet : sheets) {
            const double off = std::abs(sheet.height(asked));
            const bool isBeside =
                std::any_of(sheets.begin(), sheets.end(), [&](const SheetFit& other) {
                    return isBend(sheet.normal(asked), other.normal(asked)) &&
                           std::abs(other.height(asked)) < kDisturbed;
                });
            if (!isBeside || off > kOff || !isOn(nodes, sheet, asked, kFoot)) continue;
            // Of two sheets that are as near, the one that the direction is along.
            const double tilt = std::abs(dot(normalized(direction), sheet.normal(asked)));
            if (off + kTilt * tilt < least) least = off + kTilt * tilt, own_ = sheet;
        }
    }
    if (!own_) return false;
    start.p = asked;
    for (int round = 0; round < kRounds; ++round)
        start.p -= own_->height(start.p) * own_->normal(start.p);
    start.n = own_->normal(start.p);
    return true;
}

std::vector<Walker> CreaseWalk::onSheet(const Walker& w, const SheetFit& sheet, double arc) const {
    std::vector<Walker> steps;
    Walker next = w;
    for (const double last = std::min(w.at + arc, length_); next.at < last;) {
        if (!next.step(sheet, std::min(kCreaseStep, last - next.at)) ||
            band_.nodeAt(roundToIjk(next.p)) == kNoNode)
            break;
        steps.push_back(next);
    }
    return steps;
}

std::optional<CreaseWalk::Crossing> CreaseWalk::firstCrossing(const Walker& w,
                                                              const Sheets& sheets) const {
    constexpr double kAhead = 2.5, kArmed = 1e-3, kFoot = 2;
    std::vector<bool> armed(sheets.others.size(), false);
    Crossing crossing;
    Walker last = w;
    for (const double end = std::min(w.at + kAhead, length_); last.at < end;) {
        const double step = std::min(kCreaseStep, end - last.at);
        std::vector<std::pair<double, std::size_t>> over;
        Walker next = last;
        if (!next.step(sheets.own, step)) return std::nullopt;
        for (std::size_t k = 0; k < armed.size(); ++k) {
            const SheetFit& other = sheets.others[k];
            if (sheets.before(other, last.p) > kArmed) armed[k] = true;
            if (!armed[k] || sheets.before(other, next.p) > 0) continue;
            armed[k] = false;
            over.emplace_back(arcTo(last, step, sheets.own, other, sheets.side), k);
        }
        std::sort(over.begin(), over.end());
        for (const auto& [arc, k] : over) {
            const SheetFit& other = sheets.others[k];
            Walker at = last;
            at.step(sheets.own, arc);
            if (!isBend(sheets.own.normal(at.p), other.normal(at.p)) ||
                !sheets.endsAt(at.p, other) || !sheets.begins(at.p, other) || !other.reaches(at.p))
                continue;
            crossing.at = at.at;
            return overLine(last, at, sheets, other, std::move(crossing));
        }
        if (!isOn(sheets.nodes, sheets.own, next.p, kFoot)) {
            crossing.at = last.at;
            crossing.isLost = true;
            return crossing;
        }
        crossing.steps.push_back(last = next);
    }
    return std::nullopt;
}

CreaseWalk::Crossing CreaseWalk::overLine(const Walker& last, const Walker& roughly,
                                          const Sheets& sheets, const SheetFit& other,
                                          Crossing crossing) const {
    constexpr double kMore = 0.25;
    const std::vector<SheetNode> nodes = nodesForSheets(band_, roughly.p);
    // Fits of curved sheets are the most accurate at their center.
    SheetFit own = sheets.own;
    crossing.next = other;
    for (SheetFit* sheet : {&own, &*crossing.next}) {
        if (sheet->isPlane()) continue;
        SheetFit closer(nodes, roughly.p, sheet->normal(roughly.p), sheets.side);
        if (closer.valid()) *sheet = std::move(closer);
    }
    Walker at = last;
    const double step = roughly.at - last.at + kMore;
    at.step(own, std::min(arcTo(last, step, own, *crossing.next, sheets.side), length_ - last.at));
    const Vec3d a = own.normal(at.p), b = crossing.next->normal(at.p);
    crossing.isCorner = isCorner(nodes, at.p, normalized(cross(a, b)));
    turnOver(a, b, sheets.side, at);
    crossing.at = at.at;
    crossing.steps.push_back(at);
    return crossing;
}

bool CreaseWalk::advance(std::vector<Walker>& track) {
    constexpr double kAtOnce = 2, kAgain = 0.9, kSameBend = 5;
    const Walker w = track.back();
    if (length(w.p - without_) < kAgain || !isNearCrease(w)) {
        own_.reset();
        return false;
    }
    const std::vector<SheetNode> nodes = nodesForSheets(band_, w.p);
    std::optional<Crossing> first;
    std::optional<SheetFit> own;
    double least = kDisturbed;
    bool isAlone = true;
    for (const int side : {-1, 1}) {
        const Sheets sheets(nodes, w, side, own_);
        if (sheets.others.empty()) continue;
        isAlone = false;
        const double to = sheets.toSheet(w.p);
        std::optional<Crossing> crossing = firstCrossing(w, sheets);
        // Far from other sheets the fit ends, not the sheet.
        if (crossing && crossing->isLost && to >= kDisturbed) crossing.reset();
        if (crossing && (!first || crossing->isBefore(*first))) first = std::move(crossing);
        if (to < least) least = to, own = sheets.own;
    }
    if (isAlone) without_ = w.p;
    if (first && first->isLost && first->at - w.at < kCreaseStep) {
        if (lost_.empty() || w.at - lost_.back() > kSameBend) lost_.push_back(w.at);
        own_.reset();
        return false;
    }
    if (first) {
        track.insert(track.end(), first->steps.begin(), first->steps.end());
        if (first->isLost) return true;
        own_ = first->next;
        seen_.push_back(first->at);
        corners_ += first->isCorner;
        return true;
    }
    if (!own) return false;
    own_ = own;
    const std::vector<Walker> steps = onSheet(w, *own, kAtOnce);
    track.insert(track.end(), steps.begin(), steps.end());
    return !steps.empty();
}

std::size_t CreaseWalk::roundedBends(const std::vector<Walker>& track) const {
    // Steps to each side: a sharp bend turns as much within two voxels as within eight.
    constexpr std::size_t kNarrow = 2, kWide = 8;
    constexpr double kLeast = 10, kSpread = 1.25, kNear = 5;
    std::size_t count = lost_.size();
    for (std::size_t k = kNarrow; k + kNarrow < track.size(); ++k) {
        const double turn = degrees(track[k - kNarrow].n, track[k + kNarrow].n);
        if (turn < kLeast) continue;
        const std::size_t before = std::max(k, kWide) - kWide,
                          after = std::min(k + kWide, track.size() - 1);
        auto isNear = [&](double at) { return std::abs(at - track[k].at) < kNear; };
        if (std::any_of(seen_.begin(), seen_.end(), isNear) ||
            std::any_of(lost_.begin(), lost_.end(), isNear) ||
            degrees(track[before].n, track[after].n) > kSpread * turn)
            continue;
        ++count;
        k += kWide;
    }
    return count;
}

}  // namespace igeo
