#include <igeo/march/detail/jet_neighborhood.h>

#include <igeo/march/detail/jet_update.h>

#include <algorithm>

namespace igeo {

namespace {

/// The neighbors of one source.
JetNeighbors ofSource(const Neighborhood& around, std::uint32_t source) {
    const JetNeighbors& all = around.all;
    JetNeighbors part;
    part.smooth = all.smooth;
    part.rim = all.rim;
    part.pull = all.pull;
    part.far2 = all.far2;
    for (int k = 0; k < all.count(); ++k)
        if (around.label[std::size_t(k)] == source)
            part.add({all.a(k), all.g(k), all.base() + double(all.u(k))});
    return part;
}

}  // namespace

Jet updatePerSource(const Neighborhood& around, std::uint32_t& source) {
    const int count = around.all.count();
    if (count == 0) return {};
    source = around.label[0];
    if (around.oneLabel) return jetUpdate(around.all);
    std::array<std::uint32_t, JetNeighbors::kMax> sources = around.label;
    const auto end = sources.begin() + count;
    std::sort(sources.begin(), end);
    Jet best;
    for (auto at = sources.begin(); at != end; at = std::upper_bound(at, end, *at)) {
        const Jet jet = jetUpdate(ofSource(around, *at));
        if (jet.u < best.u) best = jet, source = *at;
    }
    return best;
}

}  // namespace igeo
