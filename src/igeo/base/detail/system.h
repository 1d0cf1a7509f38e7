/// What the library needs of a system and C++ does not have: system_posix.cpp, system_windows.cpp.
/// Errors are numbers of <cerrno>, 0 if all is well.
#pragma once

#include <string>

namespace igeo {

int processId();

/// Why a file or folder that exists may not be written.
int writeRefusal(const std::string& path);

/// Makes an empty file; EEXIST where the name is taken.
int createFile(const std::string& path);

/// Returns once the file is on disk.
int syncFile(const std::string& path);

/// Whether an error of writing is want of space.
bool isOutOfSpace(int error);

}  // namespace igeo
