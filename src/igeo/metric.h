/// What a unit of length costs.
#pragma once

#include <igeo/types.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace igeo {

/// An isotropic metric: the weight g of |grad d| = g, constant along normals (M&S (10)).
struct Metric {
    std::vector<float> weight;  ///< cost per unit length per band node, > 0; empty: 1 everywhere

    double at(NodeIndex i) const { return weight.empty() ? 1.0 : double(weight[i]); }

    /// The least and the largest weight; 1 where there are none.
    double least() const {
        return weight.empty() ? 1.0 : double(*std::min_element(weight.begin(), weight.end()));
    }
    double largest() const {
        return weight.empty() ? 1.0 : double(*std::max_element(weight.begin(), weight.end()));
    }

    /// @throws Error  InvalidArgument unless there is one positive, finite weight for each of n
    /// nodes
    void check(std::size_t n) const;
};

}  // namespace igeo
