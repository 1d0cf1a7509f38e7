/// Devices to write to, without putting the machine's own at risk.
#pragma once

#include <support/temp_dir.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace igeo::test {

constexpr unsigned kNullMinor = 3, kFullMinor = 7;

/// A device like /dev/null or /dev/full. Run by root, code that replaces its output instead of
/// writing to it would replace the machine's: root gets a node in `folder`. Others cannot make one
/// nor do harm, and get the one in /dev.
/// @return empty where neither can be had
inline std::string testDevice(const TempDir& folder, const std::string& name, unsigned minor) {
    if (::geteuid() != 0) return std::filesystem::exists("/dev/" + name) ? "/dev/" + name : "";
    const std::string path = folder / name;
    // The folder's file system may be mounted without devices.
    const bool made = ::mknod(path.c_str(), S_IFCHR | 0666, makedev(1, minor)) == 0;
    if (made && std::ofstream(path)) return path;
    std::filesystem::remove(path);
    return {};
}

}  // namespace igeo::test
