/// The distribution of a level set's values. Internal.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace igeo {

/// Numbers of voxels by |psi|, in shells one voxel thick.
class Shells {
public:
    void add(double voxels) { ++count_[std::size_t(int(std::min(voxels, double(kMost))))]; }
    void add(std::size_t shell, std::uint64_t voxels) { count_[shell] += voxels; }
    void add(const Shells& other) {
        for (std::size_t k = 0; k <= kMost; ++k) count_[k] += other.count_[k];
    }
    std::uint64_t count(std::size_t shell) const { return count_[shell]; }
    /// The |psi| from which on voxels are strays: two voxels beyond the last shell with at least a
    /// hundredth of the voxels of the one below. Infinite if half of all voxels would be strays.
    double strayFrom() const;

private:
    static constexpr std::size_t kMost = 1000;  // the last shell holds all beyond
    std::vector<std::uint64_t> count_ = std::vector<std::uint64_t>(kMost + 1);
};

inline double Shells::strayFrom() const {
    constexpr std::uint64_t kThin = 100;
    std::size_t last = 0;
    while (last < kMost && count_[last + 1] && kThin * count_[last + 1] >= count_[last]) ++last;
    std::uint64_t within = 0, all = 0;
    for (std::size_t k = 0; k <= kMost; ++k) {
        all += count_[k];
        if (k < last + 2) within += count_[k];
    }
    return last + 2 < kMost && 2 * within > all ? double(last + 2) : kInfinity;
}

}  // namespace igeo
