/// Catch2 2.13: the one place that names it. Tests of the pure numerics include this alone and
/// compile in no time; tests that use OpenVDB include support/openvdb.h as well.
#pragma once

#include <catch2/catch.hpp>
