/// Quantiles of counts. Internal.
#pragma once

#include <igeo/base/types.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace igeo {

/// Counts over [0, 1) on a monotone scale: its quantiles do not depend on the order of additions.
class Histogram {
public:
    static constexpr std::size_t kBins = 4096;
    static std::size_t binOf(double x) {
        return std::size_t(std::clamp(x, 0.0, 0.999999) * double(kBins));
    }
    void add(double x) { addToBin(binOf(x)); }
    void addToBin(std::size_t bin) { ++counts_[bin]; }
    void add(const Histogram& other) {
        for (std::size_t k = 0; k < kBins; ++k) counts_[k] += other.counts_[k];
    }
    std::uint64_t total() const {
        return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t(0));
    }
    /// Least x (the middle of its bin) with more than `count` entries at or below it; 1 if none.
    double valueAfter(std::uint64_t count) const {
        std::uint64_t sum = 0;
        for (std::size_t k = 0; k < kBins; ++k)
            if ((sum += counts_[k]) > count) return (double(k) + 0.5) / double(kBins);
        return 1;
    }
    /// Entries in bins below that of `x`.
    std::uint64_t countBelow(double x) const {
        return std::accumulate(counts_.begin(), counts_.begin() + std::ptrdiff_t(binOf(x)),
                               std::uint64_t(0));
    }
    /// Share of the entries in [lo, hi]; 1 if there are none.
    double share(double lo, double hi) const {
        std::uint64_t sum = 0;
        for (auto k = std::size_t(lo * double(kBins)); k < std::size_t(hi * double(kBins)); ++k)
            sum += counts_[k];
        const std::uint64_t all = total();
        return all ? double(sum) / double(all) : 1;
    }
    double quantile(double q) const { return valueAfter(std::uint64_t(q * double(total()))); }

private:
    std::vector<std::uint64_t> counts_ = std::vector<std::uint64_t>(kBins);
};

// Curvatures from 1e-6 to 10 per voxel on a logarithmic scale, bins 0.4 % wide.
inline double scaleOfCurvature(double k) { return (std::log10(k) + 6) / 7; }
inline double curvatureOfScale(double s) { return std::pow(10.0, 7 * s - 6); }
constexpr double kLeastCurvature = 1e-6, kMostCurvature = 10;

/// Bins of curvatures without logarithms: a table by exponent and leading bits of the mantissa
/// gives the bin or the one before it.
class CurvatureBins {
public:
    CurvatureBins() {
        for (std::size_t bin = 0; bin <= Histogram::kBins; ++bin)
            from_.push_back(curvatureOfScale(double(bin) / double(Histogram::kBins)));
        from_.back() = kInfinity;  // the last bin holds all beyond
        for (std::uint64_t cell = kFirst; cell <= cellOf(kMostCurvature); ++cell) {
            const double least = std::bit_cast<double>(cell << kDropped);
            first_.push_back(std::uint16_t(
                Histogram::binOf(scaleOfCurvature(std::max(least, kLeastCurvature)))));
        }
    }
    std::size_t operator()(double k) const {
        k = std::clamp(k, kLeastCurvature, kMostCurvature);
        const std::size_t bin = first_[cellOf(k) - kFirst];
        return bin + (k >= from_[bin + 1]);
    }

private:
    static constexpr unsigned kDropped = 44;  ///< bits of the mantissa, of 52
    static constexpr std::uint64_t cellOf(double k) {
        return std::bit_cast<std::uint64_t>(k) >> kDropped;
    }
    static constexpr std::uint64_t kFirst =
        std::bit_cast<std::uint64_t>(kLeastCurvature) >> kDropped;
    std::vector<double> from_;          ///< per bin: its least curvature
    std::vector<std::uint16_t> first_;  ///< per cell: the bin of its least curvature
};

}  // namespace igeo
