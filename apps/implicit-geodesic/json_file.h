/// JSON files that a batch reads.
#pragma once

#include <igeo/base/error.h>

#include <nlohmann/json.hpp>
#include <string>

using Json = nlohmann::ordered_json;

/// A whole file; an object that has a member twice is refused, of which a reader sees one only.
/// @throws igeo::Error  Io, BadInput
Json readJson(const std::string& file);

[[noreturn]] inline void inputError(const std::string& what, const std::string& remedy) {
    throw igeo::Error(igeo::Error::Kind::BadInput, what, remedy);
}
