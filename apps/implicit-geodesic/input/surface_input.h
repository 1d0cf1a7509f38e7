/// The surface of a job, from its file.
#pragma once

#include <igeo/base/progress.h>
#include <igeo/surface.h>

#include "options/surface_options.h"

/// Reads and checks a surface: stages `read` and `check`.
/// @throws igeo::Error  as the readers of volumes, meshes and points, and as Surface
igeo::Surface readSurface(const SurfaceOptions& options, igeo::Progress& progress);
