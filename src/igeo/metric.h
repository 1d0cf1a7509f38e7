/// What a unit of length costs.
#pragma once

#include <igeo/types.h>

#include <vector>

namespace igeo {

/// An isotropic metric: the weight g of |grad d| = g, constant along normals (M&S (10)).
struct Metric {
    std::vector<float> weight;  ///< cost per unit length per band node, > 0; empty: 1 everywhere

    double at(NodeIndex i) const { return weight.empty() ? 1.0 : double(weight[i]); }
};

}  // namespace igeo
