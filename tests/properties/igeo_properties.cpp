/// Asks every property of every case, and tells how far off the worst was.
///
/// usage: igeo_properties [--cases N] [--first K]
#include "property.h"

#include <openvdb/openvdb.h>
#include <support/arguments.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

namespace igeo::test {
namespace {

/// What was seen of a property on one kind of surface.
struct Seen {
    std::vector<double> misfits;
    unsigned worstCase = 0;
    std::size_t failures = 0;

    void add(double misfit, unsigned number, double allowed) {
        if (misfits.empty() || misfit > *std::max_element(misfits.begin(), misfits.end()))
            worstCase = number;
        misfits.push_back(misfit);
        failures += !(misfit <= allowed);
    }
    void print(const char* name, const char* kind, double allowed) {
        if (misfits.empty()) return;
        std::sort(misfits.begin(), misfits.end());
        std::printf("%-52s %-6s %10.4g %10.4g %10.4g %8u %10.4g %8zu\n", name, kind,
                    misfits[misfits.size() / 2], misfits[misfits.size() * 99 / 100], misfits.back(),
                    worstCase, allowed, failures);
    }
};

std::size_t run(unsigned first, unsigned cases) {
    std::vector<Property> properties = kOfOneBand;
    properties.insert(properties.end(), kOfChanges.begin(), kOfChanges.end());
    std::vector<Seen> smooth(properties.size()), sharp(properties.size());
    std::size_t failures = 0;
    for (unsigned number = first; number < first + cases; ++number) try {
            const RandomCase c(number);
            for (std::size_t k = 0; k < properties.size(); ++k) {
                const Property& p = properties[k];
                const double allowed = c.sharp ? p.sharp : p.smooth, misfit = p.misfit(c);
                (c.sharp ? sharp : smooth)[k].add(misfit, number, allowed);
                if (misfit <= allowed) continue;
                ++failures;
                std::printf("FAILED case %u: %s: %.6g, allowed %g\n", number, p.name, misfit,
                            allowed);
            }
        } catch (const std::exception& e) {
            ++failures;
            std::printf("FAILED case %u: %s\n", number, e.what());
        }
    std::printf("\n%-52s %-6s %10s %10s %10s %8s %10s %8s\n", "property", "kind", "median",
                "99 of 100", "worst", "at case", "allowed", "failures");
    for (std::size_t k = 0; k < properties.size(); ++k) {
        smooth[k].print(properties[k].name, "smooth", properties[k].smooth);
        sharp[k].print(properties[k].name, "sharp", properties[k].sharp);
    }
    std::printf("%u cases, %zu failures\n", cases, failures);
    return failures;
}

}  // namespace
}  // namespace igeo::test

int main(int argc, char** argv) {
    unsigned first = 0, cases = 0;
    try {
        const igeo::test::Arguments args(argc, argv, 1);
        args.require({"first", "cases"});
        first = unsigned(args.number("first", 1)), cases = unsigned(args.number("cases", 30));
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\nusage: igeo_properties [--cases N] [--first K]\n", e.what());
        return 2;
    }
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // what was seen before a crash is to be seen
    openvdb::initialize();
    return igeo::test::run(first, cases) ? 1 : 0;
}
