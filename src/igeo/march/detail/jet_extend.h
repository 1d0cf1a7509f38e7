/// From the core of a band to the rest of it, for scheme `jet`.
#pragma once

#include <igeo/march/detail/jet_state.h>
#include <igeo/march/field.h>

namespace igeo {

/// Fills distance, gradient and label of a field on the whole band: core nodes have their own jets,
/// the others take those of the core around their foot points.
/// @param everywhere  whether the march reached all of the core; if not, leaves without a jet in or
///                    next to them are skipped
/// Time O(n), in parallel.
void extendJets(const CoreJets& jets, bool everywhere, Field& field);

/// The same for one node.
NodeJet extendJet(const CoreJets& jets, NodeIndex i);

}  // namespace igeo
