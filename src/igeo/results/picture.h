/// Pictures of a result, without a display.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/path/trace.h>
#include <igeo/results/picture_options.h>
#include <igeo/surface/level_set.h>

#include <string>
#include <vector>

namespace igeo {

/// Renders the surface as the bytes of a PNG file: colored by distance, with isolines, paths and
/// seeds.
///
/// The surface is psi = 0 as OpenVDB's LevelSetRayIntersector finds it, as far as psi is known.
/// Distances are those of sampleDistance(); where there is none, it is gray. Isolines are as wide
/// everywhere on the surface, as |grad d| there is the weight. Paths and isolines lie on the
/// surface, as do seed curves; seeds and the ends of paths are dots that face the camera. The frame
/// holds the whole surface unless an eye is given.
/// @throws Error  InvalidArgument for options out of range, a view from inside a closed surface or
///         along `up`; Cancelled through `progress`
/// The same bytes for any number of threads. Time O(pixels), in parallel, about a microsecond per
/// ray; pixels whose neighbors differ take 9 rays more, the others one. Memory: about 50
/// bytes per pixel.
std::string renderPng(const LevelSet& levelSet, const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options = {}, Progress& progress = Progress::none());

/// The same of a field on the band of a mesh: its triangles, open or closed. Their shading is
/// smooth over edges of less than 30 degrees.
/// @throws Error  as above; InvalidArgument for a band without triangles
std::string renderPng(const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options = {}, Progress& progress = Progress::none());

}  // namespace igeo
