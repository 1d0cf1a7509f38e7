/// Rendered pictures of a result; no display is needed.
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
/// Distances are those of sampleDistance() at the corners of visible triangles, and linear between
/// them where that is exact to about a quarter of a pixel; elsewhere those at every pixel.
/// Unreached parts are gray. Isolines (chosenLevels) have the same width everywhere on the surface,
/// because |grad d| there is the weight. Paths, isolines and seed curves lie on the surface; seeds
/// and the ends of paths are dots that face the camera. Paths, seed curves and dots behind the
/// surface are visible through it, faintly. The frame holds the whole surface unless an eye is
/// given.
/// @param levelSet  the surface is that of surfaceMesh(), where psi is known, shaded in folds.
///                  Null: the surface of the field's band. Of a mesh: its triangles, open or
///                  closed, shaded smoothly over edges of less than 40 degrees. Otherwise psi = 0
///                  in the band, which must be that of the whole surface.
/// @throws Error  InvalidArgument for options out of range, too many isolines, a view from inside a
///         closed surface or along `up`; Cancelled through `progress`
/// The same bytes for any number of threads. Time O(triangles + pixels), in parallel, about a
/// quarter of a microsecond per pixel; pixels at an edge take 9 more samples. Memory: about 70
/// bytes per pixel and 100 per triangle.
std::string renderPng(const LevelSet* levelSet, const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options = {}, Progress& progress = Progress::none());

}  // namespace igeo
