// Inputs that a program reading level sets has to refuse or to handle with care.
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

namespace igeo::test {

struct BadInput {
    std::string kind;
    std::string what;  ///< one line for the usage text
    openvdb::GridPtrVec (*make)();
};

/// All kinds, in the order of the usage text.
const std::vector<BadInput>& badInputs();

}  // namespace igeo::test
