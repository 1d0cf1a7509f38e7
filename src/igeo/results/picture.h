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
/// Distances are those of sampleDistance() at every pixel, or between pixels
/// where they are even to a few hundredths of a pixel; where there is none, it is gray.
/// Isolines (chosenLevels) are as wide everywhere on the surface, as |grad d| there is the weight.
/// Paths and isolines lie on the surface, as do seed curves; seeds and the ends of paths are dots
/// that face the camera. Paths, seed curves and dots behind the surface show through it, faint. The
/// frame holds the whole surface unless an eye is given.
/// @param levelSet  the surface is that of surfaceMesh(), as far as psi is known, shaded where
///        folds keep light off. Null: that of the field's band. Of a mesh: its triangles, open or
///        closed; their shading is smooth over edges of less than 40 degrees. Else psi = 0 in the
///        band, which has to be that of the whole surface.
/// @throws Error  InvalidArgument for options out of range, too many isolines, a view from inside a
///         closed surface or along `up`; Cancelled through `progress`
/// The same bytes for any number of threads. Time O(triangles + pixels), in parallel, about half a
/// microsecond per pixel; pixels at an edge take 9 samples more, the others one. Memory: about 60
/// bytes per pixel and 100 per triangle.
std::string renderPng(const LevelSet* levelSet, const Field& field, const std::vector<Path>& paths,
                      const PictureOptions& options = {}, Progress& progress = Progress::none());

}  // namespace igeo
