/// Points given on the command line or in files.
#pragma once

#include <igeo/base/polyline.h>
#include <igeo/base/seed.h>

#include <string>
#include <vector>

namespace igeo {

/// The comma-separated finite numbers of a text (blanks allowed); empty for any other text.
std::vector<double> parseNumbers(const std::string& text);

/// A point as given: by position, or as a vertex of the surface.
struct AskedPoint : Seed {
    std::string vertex;  ///< as in Surface::vertex; empty: `position` is used

    using Seed::Seed;
    explicit AskedPoint(const std::string& name, double startAt = 0)
        : Seed({}, startAt), vertex(name) {}
};

/// "x,y,z" (blanks allowed), "vertex:123", or "+x", "-x", "+y", "-y", "+z", "-z" or "center".
/// @throws Error  InvalidArgument for anything else
AskedPoint parsePoint(const std::string& text);

/// Points that form one seed.
struct AskedGroup {
    std::string name;  ///< empty: none
    std::vector<AskedPoint> points;
};

/// The content of a file of seeds.
struct AskedSeeds {
    std::vector<AskedPoint> points;
    std::vector<AskedGroup> groups;
    std::size_t vertices = 0;  ///< of the surface that the file was made for; 0: unknown
};

/// Seeds from a file of points (readPoints); or groups of points from a .json file, {"groups":
/// {"name": [...], ...}} or {"groups": [[...], ...]}, with lists as in readPoints; or the regions
/// of a .annot file of FreeSurfer (readAnnotation), one group each.
/// @throws Error  Io, or BadInput with the line or the group and entry
AskedSeeds readSeeds(const std::string& file);

/// Points from a file:
///
/// - `.json`: [[x, y, z], ...], [{"position": [x, y, z], "start": s}, ...], or vertex numbers, [12,
///   {"vertex": 40, "start": s}, ...];
/// - text: lines x,y,z[,start], or a vertex number per line; empty lines, lines with # and one
///   header line are skipped. A header that names x, y and z in another order is refused;
/// - `.label` of FreeSurfer: its vertices.
///
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPoint> readPoints(const std::string& file);

/// Polylines from a .json file: [[x, y, z], ...] is one open polyline; [{"position": [[x, y, z],
/// ...], "closed": c, "start": s}, ...] are several; the isolines and geodesics that this program
/// writes are read too, all lists of a document (paths, walks, pairs, via) but for paths without
/// vertices. From any other file its points, as one open polyline. Closed ones may repeat their
/// first point at the end; in forms without "closed" this closes them.
/// @param warnings  gets a sentence on paths that are left out, if it is given
/// @throws Error  Io, or BadInput with the entry
std::vector<Curve> readCurves(const std::string& file,
                              std::vector<std::string>* warnings = nullptr);

/// Points that a curve passes through, in order.
struct AskedCurve {
    std::vector<AskedPoint> points;
    bool closed = false;  ///< the last point is joined to the first
};

/// "x,y,z x,y,z vertex:12": points as in parsePoint, separated by blanks or semicolons; repeating
/// the first at the end closes the curve. Empty unless the first word is a point.
/// @throws Error  InvalidArgument for a later word that is no point
AskedCurve parseCurve(const std::string& text);

/// Curves through points, from files as in readCurves, or one curve from a file as in readPoints,
/// which may name vertices.
/// @throws Error  Io, or BadInput with the line or entry, also for a document with several lists
std::vector<AskedCurve> readAskedCurves(const std::string& file,
                                        std::vector<std::string>* warnings = nullptr);

/// A source and a target.
struct AskedPair {
    AskedPoint source, target;
};

/// Pairs from a .json file, [[x, y, z, x, y, z], ...], or from a text file of such lines; two
/// numbers are two vertices. Empty lines, lines with # and one header line are skipped.
/// @throws Error  Io, or BadInput with the line or entry
std::vector<AskedPair> readPairs(const std::string& file);

}  // namespace igeo
