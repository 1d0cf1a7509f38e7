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

/// Points that are one seed.
struct AskedGroup {
    std::string name;  ///< empty: none
    std::vector<AskedPoint> points;
};

/// What a file of seeds holds.
struct AskedSeeds {
    std::vector<AskedPoint> points;
    std::vector<AskedGroup> groups;
    std::size_t vertices = 0;  ///< of the surface that it is for; 0: the file does not say
};

/// Seeds from a file of points (readPoints), or groups of points from a .json file,
/// {"groups": {"name": [...], ...}} or {"groups": [[...], ...]}, whose lists are as those of
/// readPoints; or the regions of a .annot file of FreeSurfer (readAnnotation), each a group.
/// @throws Error  Io, or BadInput with the line or the group and entry
AskedSeeds readSeeds(const std::string& file);

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

/// Points to go through, in order.
struct AskedCurve {
    std::vector<AskedPoint> points;
    bool closed = false;  ///< the last point joins the first
};

/// "x,y,z x,y,z vertex:12": points as parsePoint with blanks or semicolons between; the first
/// again at the end closes the curve. Empty unless the first word is a point.
/// @throws Error  InvalidArgument for another word that is none
AskedCurve parseCurve(const std::string& text);

/// Points to go through: files as readCurves, or as readPoints, which may name vertices: one curve.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedCurve> readAskedCurves(const std::string& file);

/// Two points to go between.
struct AskedPair {
    AskedPoint source, target;
};

/// Pairs from a .json file, [[x, y, z, x, y, z], ...], or from a text file of such lines; two
/// numbers are two vertices. Empty lines, lines with # and one header line are skipped.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPair> readPairs(const std::string& file);

}  // namespace igeo
