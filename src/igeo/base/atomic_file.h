/// Output files that are complete or absent.
#pragma once

#include <fstream>
#include <string>

namespace igeo {

/// A file that is written under a temporary name in its final folder and renamed when complete. A
/// failure leaves a previous file of the final name intact. Links are followed; devices and pipes
/// are written directly.
class AtomicFile {
public:
    /// @throws Error  Io when the folder is missing or not writable
    explicit AtomicFile(const std::string& path);
    ~AtomicFile();  ///< removes the temporary file unless committed
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    std::fstream& stream() { return stream_; }

    /// Flushes to disk and renames.
    /// @throws Error  Io, for instance when the disk is full; the final name is then untouched
    void commit();

    /// The Io error for a failed write to `path`, with the system's reason.
    [[noreturn]] static void throwWriteError(const std::string& path, int systemError);

    /// The number of files that the process has committed so far.
    static std::size_t committed() noexcept;

    /// Removes the temporary files of all live AtomicFiles, for a program about to exit: from then
    /// on none is made or committed, and a thread that does so or removes one waits.
    static void discardAll() noexcept;

private:
    /// Only names. Once it has run, the destructor follows a failure of the constructor above.
    AtomicFile(const std::string& path, std::string finalPath);

    std::string path_;       ///< as the caller named it
    std::string finalPath_;  ///< links resolved
    std::string temporary_;  ///< empty when writing directly or committed
    std::fstream stream_;
};

/// The file that writing to `path` creates or replaces: `path` with all links followed.
/// @throws Error  Io for links that run in a circle
std::string fileBehindLinks(const std::string& path);

/// Writes a whole text file atomically.
void writeFile(const std::string& path, const std::string& content);

}  // namespace igeo
