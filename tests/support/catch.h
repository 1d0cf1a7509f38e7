/// Catch2, of which 2.13 and 3 are served: the one place that names it. Tests of the pure numerics
/// include this alone and compile in no time; tests that use OpenVDB include support/openvdb.h too.
#pragma once

#include <cstdio>
#include <string>

namespace igeo::test {
/// Of a check that cannot be done here: ctest shows the test as skipped if all others pass.
inline void markSkipped(const char* reason) {
    std::printf("SKIPPED: %s\n", reason);
    std::fflush(stdout);
}
}  // namespace igeo::test

#if __has_include(<catch2/catch_test_macros.hpp>)

#include <catch2/catch_approx.hpp>
#include <catch2/catch_test_macros.hpp>
#include <catch2/generators/catch_generators.hpp>
#include <catch2/matchers/catch_matchers.hpp>
#include <catch2/matchers/catch_matchers_string.hpp>

using Catch::Approx;

namespace igeo::test {
inline auto contains(const std::string& part) { return Catch::Matchers::ContainsSubstring(part); }
inline auto startsWith(const std::string& part) { return Catch::Matchers::StartsWith(part); }
inline auto matches(const std::string& regex) { return Catch::Matchers::Matches(regex); }
}  // namespace igeo::test

#else

#include <catch2/catch.hpp>

namespace igeo::test {
inline auto contains(const std::string& part) { return Catch::Contains(part); }
inline auto startsWith(const std::string& part) { return Catch::StartsWith(part); }
inline auto matches(const std::string& regex) { return Catch::Matches(regex); }
}  // namespace igeo::test

#endif
