/// Points named on the command line or listed in files.
#pragma once

#include <igeo/types.h>

#include <string>
#include <vector>

namespace igeo {

/// A seed or target as asked for, before the surface is known.
struct AskedPoint {
    Vec3d position;    ///< world or index space, as the caller says
    double start = 0;  ///< distance at which a seed starts, world units times weight
};

/// The comma-separated finite numbers of a text (blanks allowed); empty if it holds anything else.
std::vector<double> parseNumbers(const std::string& text);

/// "x,y,z" (blanks allowed).
/// @throws Error  InvalidArgument for anything but three finite numbers
AskedPoint parsePoint(const std::string& text);

/// Points from a .json file, [[x, y, z], ...] or [{"position": [x, y, z], "start": s}, ...], or
/// from a text file of lines x,y,z[,start]; empty lines, lines with # and one header line are
/// skipped.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPoint> readPoints(const std::string& file);

}  // namespace igeo
