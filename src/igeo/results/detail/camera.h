/// The camera of a picture. Internal to the pictures.
#pragma once

#include <igeo/march/field.h>
#include <igeo/path/trace.h>
#include <igeo/results/detail/drawn_surface.h>
#include <igeo/results/picture_options.h>

#include <vector>

namespace igeo {

/// A perspective camera in world space. Axes are unit vectors.
struct View {
    Vec3d eye, right, up, back;
    double depth = 1;  ///< from the eye to the middle of the surface, world units

    /// Half the width of the frame per depth: a lens of 75 mm on Houdini's film of 41.2136 mm.
    static constexpr double kFocalLength = 75, kAperture = 41.2136;
    static constexpr double kHalfWidth = kAperture / kFocalLength / 2;
};

/// The given view; or the first of 26 directions, three-quarter views first, that shows the seeds,
/// the paths and the reached surface almost as well as the best of them, with all of the surface in
/// the frame.
/// @param aspect  height / width of the frame
/// @throws Error  InvalidArgument for a view that shows nothing
View chooseView(const DrawnSurface& surface, const Field& field, const std::vector<Path>& paths,
                const PictureOptions& options, double aspect);

}  // namespace igeo
