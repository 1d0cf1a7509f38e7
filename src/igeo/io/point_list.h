/// Points named on the command line or listed in files.
#pragma once

#include <igeo/base/polyline.h>
#include <igeo/base/seed.h>

#include <string>
#include <vector>

namespace igeo {

/// The comma-separated finite numbers of a text (blanks allowed); empty if it holds anything else.
std::vector<double> parseNumbers(const std::string& text);

/// A point as it is asked for: by position, or as a vertex of the surface.
struct AskedPoint : Seed {
    std::string vertex;  ///< as Surface::vertex; empty: `position` counts

    using Seed::Seed;
    explicit AskedPoint(const std::string& name, double startAt = 0)
        : Seed({}, startAt), vertex(name) {}
};

/// "x,y,z" (blanks allowed), "vertex:123", or "+x", "-x", "+y", "-y", "+z", "-z" or "center".
/// @throws Error  InvalidArgument for anything else
AskedPoint parsePoint(const std::string& text);

/// Points from a .json file, [[x, y, z], ...], [{"position": [x, y, z], "start": s}, ...] or
/// numbers of vertices, [12, {"vertex": 40, "start": s}, ...]; or from a text file of lines
/// x,y,z[,start] or of a vertex each; empty lines, lines with # and one header line are skipped;
/// or the vertices of a .label file of FreeSurfer.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPoint> readPoints(const std::string& file);

/// Polylines from a .json file: [[x, y, z], ...] is one, open; [{"position": [[x, y, z], ...],
/// "closed": c, "start": s}, ...] are several; and the isolines or geodesics that this program
/// writes. From any other file its points, as one open polyline. Closed ones may repeat their first
/// point at the end; in the other forms, that closes them.
/// @throws Error  Io, or BadInput with the entry
std::vector<Curve> readCurves(const std::string& file);

/// Two points to go between.
struct AskedPair {
    AskedPoint source, target;
};

/// Pairs from a .json file, [[x, y, z, x, y, z], ...], or from a text file of such lines; two
/// numbers are two vertices. Empty lines, lines with # and one header line are skipped.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPair> readPairs(const std::string& file);

}  // namespace igeo
