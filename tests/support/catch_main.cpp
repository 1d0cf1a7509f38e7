// Catch2's main function and nothing else: see tests/CMakeLists.txt for why it is alone.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
