/// What the library needs of an operating system beyond C++: system_posix.cpp, system_windows.cpp.
/// Errors are numbers of <cerrno>, 0 for success.
#pragma once

#include <cstddef>
#include <string>

namespace igeo {

int processId();

/// The error with which writing to an existing file or folder is refused.
int writeRefusal(const std::string& path);

/// Makes an empty file; EEXIST where the name is taken.
int createFile(const std::string& path);

/// Returns after the file is on disk.
int syncFile(const std::string& path);

/// Asks for pages of 2 MB, for memory that was never used: reads all over a large array miss the
/// address cache less often, and fewer pages are touched first. A system that has none goes on with
/// its own.
void askForLargePages(void* memory, std::size_t bytes);

/// Whether the system would give the process this much memory in one piece. A heap that holds some
/// in store is not asked.
bool wouldGive(std::size_t bytes);

/// Whether a write error means that the disk is full.
bool isOutOfSpace(int error);

}  // namespace igeo
