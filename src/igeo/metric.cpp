#include <igeo/metric.h>

#include <igeo/error.h>

#include <string>

namespace igeo {

void Metric::check(std::size_t n) const {
    using Kind = Error::Kind;
    if (weight.empty()) return;
    if (weight.size() != n)
        throw Error(Kind::InvalidArgument, std::to_string(weight.size()) +
                                               " weights for a band of " + std::to_string(n) +
                                               " nodes");
    for (const float w : weight)
        if (!(w > 0 && w < float(kInfinity)))
            throw Error(Kind::InvalidArgument,
                        "weight " + std::to_string(w) + " is not positive and finite");
}

}  // namespace igeo
