/// Points named on the command line or listed in files.
#pragma once

#include <igeo/base/polyline.h>
#include <igeo/base/seed.h>

#include <string>
#include <vector>

namespace igeo {

/// The comma-separated finite numbers of a text (blanks allowed); empty if it holds anything else.
std::vector<double> parseNumbers(const std::string& text);

/// "x,y,z" (blanks allowed).
/// @throws Error  InvalidArgument for anything but three finite numbers
Seed parsePoint(const std::string& text);

/// Points from a .json file, [[x, y, z], ...] or [{"position": [x, y, z], "start": s}, ...], or
/// from a text file of lines x,y,z[,start]; empty lines, lines with # and one header line are
/// skipped.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<Seed> readPoints(const std::string& file);

/// Polylines from a .json file: [[x, y, z], ...] is one, open; [{"position": [[x, y, z], ...],
/// "closed": c, "start": s}, ...] are several; and the isolines or geodesics that this program
/// writes. From any other file its points, as one open polyline. Closed ones may repeat their first
/// point at the end; in the other forms, that closes them.
/// @throws Error  Io, or BadInput with the entry
std::vector<Curve> readCurves(const std::string& file);

/// Two points to go between.
struct AskedPair {
    Vec3d source, target;
};

/// Pairs from a .json file, [[x, y, z, x, y, z], ...], or from a text file of such lines; empty
/// lines, lines with # and one header line are skipped.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPair> readPairs(const std::string& file);

}  // namespace igeo
