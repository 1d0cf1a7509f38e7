/// Pictures of existing triangles. Internal to the pictures and pages.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/march/field.h>
#include <igeo/path/trace.h>
#include <igeo/results/detail/camera.h>
#include <igeo/results/detail/drawn_surface.h>
#include <igeo/results/picture_options.h>
#include <igeo/surface/level_set.h>

#include <string>
#include <vector>

namespace igeo {

/// The triangles of a picture.
/// @param levelSet  the surface; null: psi = 0 of the band
DrawnSurface drawnSurface(const LevelSet* levelSet, const Band& band, Progress& progress);

/// The same as renderPng in picture.h.
/// @param reader  of the field
/// @param view    null: as the options say (chooseView); given: of a small picture, packed in haste
std::string renderPng(const DrawnSurface& surface, const Field& field, const ArrivalReader& reader,
                      const std::vector<Path>& paths, const PictureOptions& options,
                      const View* view, Progress& progress);
std::string renderPng(const LevelSet* levelSet, const Field& field, const ArrivalReader& reader,
                      const std::vector<Path>& paths, const PictureOptions& options,
                      Progress& progress);

}  // namespace igeo
