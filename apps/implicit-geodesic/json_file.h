/// JSON files of batches.
#pragma once

#include <igeo/base/error.h>

#include <nlohmann/json.hpp>
#include <string>

using Json = nlohmann::ordered_json;

/// Reads a whole file; refuses an object with a repeated member, of which a reader would see only
/// one.
/// @throws igeo::Error  Io, BadInput
Json readJson(const std::string& file);

[[noreturn]] inline void inputError(const std::string& what, const std::string& remedy) {
    throw igeo::Error(igeo::Error::Kind::BadInput, what, remedy);
}
