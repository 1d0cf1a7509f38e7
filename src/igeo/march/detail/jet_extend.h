/// From the core of a band to the rest of it, for scheme `jet`.
#pragma once

#include <igeo/march/detail/jet_core.h>

namespace igeo {

/// Fills distance, gradient and label of a field on the whole band: core nodes have their own jets,
/// the others take those of the core around their foot points.
/// @param limit  larger distances become +inf
/// @param everywhere  whether the march reached all of the core; if not, leaves without a jet in or
///                    next to them are skipped
/// Time O(n), in parallel.
void extendJets(const JetCore& core, double limit, bool everywhere, Field& field);

}  // namespace igeo
