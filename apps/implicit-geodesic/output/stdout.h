/// The program's standard output, reserved for results.
#pragma once

#include <ostream>

/// Reserves standard output for results. From now on, what libraries print to it goes to standard
/// error. Call it first in main.
void reserveStdout();

/// The stream of results; its state reports failed writes.
std::ostream& results();

/// Thrown when the reader of a pipe has stopped reading, which is no error.
struct ReaderGone {};

/// Flushes the stream of results.
/// @throws igeo::Error  Io where writing failed, now or before
/// @throws ReaderGone  where standard output is a pipe without a reader
void flushResults();

/// While it lives, output of libraries to std::cout is dropped: they print there what they also
/// throw, or what the program reports itself.
class LibrariesSilenced {
public:
    LibrariesSilenced();
    ~LibrariesSilenced();
    LibrariesSilenced(const LibrariesSilenced&) = delete;
    LibrariesSilenced& operator=(const LibrariesSilenced&) = delete;

private:
    std::streambuf* const printed_;
};
