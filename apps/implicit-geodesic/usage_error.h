/// Errors in options, beyond those that CLI11 finds.
#pragma once

#include <igeo/base/error.h>

#include <string>

[[noreturn]] inline void usageError(const std::string& what, const std::string& remedy) {
    throw igeo::Error(igeo::Error::Kind::InvalidArgument, what, remedy);
}
