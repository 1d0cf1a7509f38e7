/// A bound on how deep JSON may be nested: copying and printing it take stack for each level.
#pragma once

#include <igeo/base/error.h>

#include <string>

namespace igeo {

/// @param depth  as a callback of nlohmann::json's parser is given it
/// @throws Error  BadInput
inline void requireShallow(int depth, const std::string& file) {
    constexpr int kDeepest = 100;
    if (depth > kDeepest)
        throw Error(
            Error::Kind::BadInput,
            file + ": lists and objects are nested more than " + std::to_string(kDeepest) + " deep",
            "write the file again; nothing that is read from it is so deep");
}

}  // namespace igeo
