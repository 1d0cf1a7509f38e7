/// The fallback of scheme `jet`, by Fermat's principle: the minimum, over the neighbors and the
/// segments between them, of the value there plus the length of the straight line from there to the
/// node. It is the update of the jet marching method of S. F. Potter and M. K. Cameron, Jet
/// marching methods for solving the eikonal equation, SIAM J. Sci. Comput. 43 (2021).
#pragma once

#include <igeo/march/detail/jet_neighbors.h>

namespace igeo {

/// The fallback: the minimum of u_j + |a_j| over the neighbors, and over the segments between them.
/// Never below the values it starts from; at least first order, second where the front is smooth.
/// @return u = +infinity without neighbors
Jet fermatUpdate(const JetNeighbors& all);

}  // namespace igeo
