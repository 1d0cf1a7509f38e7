/// The standard output that the program was given: results go there, and nothing else.
#pragma once

#include <ostream>

/// Takes standard output for results. What a library prints to it from now on goes to standard
/// error. Call it first in main.
void reserveStdout();

/// The stream of results; where writing fails, its state says so.
std::ostream& results();

/// The program at the other end of a pipe has read enough: nothing to complain of.
struct ReaderGone {};

/// Hands on what was written to it so far.
/// @throws igeo::Error  Io where that failed, or anything before it
/// @throws ReaderGone  where standard output is a pipe that nothing reads any more
void flushResults();

/// While it lives, what libraries print to std::cout is dropped: they log there what they also
/// throw, or what the program says in its own words.
class LibrariesSilenced {
public:
    LibrariesSilenced();
    ~LibrariesSilenced();
    LibrariesSilenced(const LibrariesSilenced&) = delete;
    LibrariesSilenced& operator=(const LibrariesSilenced&) = delete;

private:
    std::streambuf* const printed_;
};
