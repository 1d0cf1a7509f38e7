/// The widest gap between the directions in which the links of a node lead. Internal.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace igeo {

/// Directions in a tangent plane, and the widest sector between two of them.
class OpenSector {
public:
    void clear() { angles_.clear(); }
    /// Adds a direction, unless it is about 0.
    void add(const Vec2f& direction) {
        if (dot(direction, direction) > 1e-4f) angles_.push_back(angleOf(direction));
    }
    /// Finds the sector, of those that have been added.
    /// @return whether it is open
    bool find() {
        constexpr double kOpen = 1.9;  // radians; neighbors in a lattice leave a right angle
        std::sort(angles_.begin(), angles_.end());
        from_ = 0, to_ = kTurn;
        double widest = angles_.empty() ? kTurn : 0;
        for (std::size_t k = 0; k < angles_.size(); ++k) {
            const double next = k + 1 < angles_.size() ? angles_[k + 1] : angles_[0] + kTurn;
            if (next - angles_[k] > widest)
                widest = next - angles_[k], from_ = angles_[k], to_ = next;
        }
        return widest > kOpen;
    }
    /// Whether a direction is in the sector, farther than `beside` radians from its sides.
    bool holds(const Vec2f& direction, double beside) const {
        double angle = angleOf(direction);
        while (angle < from_) angle += kTurn;
        return angle > from_ + beside && angle < to_ - beside;
    }

private:
    static constexpr double kTurn = 2 * std::numbers::pi;
    static double angleOf(const Vec2f& v) { return std::atan2(double(v.y), double(v.x)); }

    std::vector<double> angles_;
    double from_ = 0, to_ = kTurn;
};

}  // namespace igeo
