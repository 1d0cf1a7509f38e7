#include <igeo/band/severed_links.h>

#include <algorithm>

namespace igeo {

std::uint32_t SeveredLinks::stepsFrom(NodeIndex i) const {
    const auto at = std::lower_bound(ofNode_.begin(), ofNode_.end(), std::pair(i, 0u));
    return at != ofNode_.end() && at->first == i ? at->second : 0;
}

void SeveredLinks::add(const std::vector<std::pair<NodeIndex, std::uint32_t>>& steps) {
    ofNode_.insert(ofNode_.end(), steps.begin(), steps.end());
    std::sort(ofNode_.begin(), ofNode_.end());
    std::size_t count = 0;
    for (const auto& [node, bits] : ofNode_)
        if (count > 0 && ofNode_[count - 1].first == node)
            ofNode_[count - 1].second |= bits;
        else
            ofNode_[count++] = {node, bits};
    ofNode_.resize(count);
    ofNode_.shrink_to_fit();
}

}  // namespace igeo
