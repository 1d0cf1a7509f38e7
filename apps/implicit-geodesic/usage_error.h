/// How options are refused that CLI11 cannot judge.
#pragma once

#include <igeo/base/error.h>

#include <string>

[[noreturn]] inline void usageError(const std::string& what, const std::string& remedy) {
    throw igeo::Error(igeo::Error::Kind::InvalidArgument, what, remedy);
}
