/// Distances as a picture, and as an interactive page for a browser.
#pragma once

#include <igeo/distance.h>
#include <igeo/results/picture_options.h>
#include <igeo/results/survey.h>
#include <igeo/results/view_page.h>

#include <string>
#include <vector>

namespace igeo {

/// The surface with its distances and paths as the bytes of a PNG file: renderPng of
/// results/picture.h, with the level set of a volume and the triangles of a mesh.
/// @param lines  paths, world units
std::string renderPng(const Distance& distance, const std::vector<NamedCurve>& lines,
                      const PictureOptions& options = {}, Progress& progress = Progress::none());

/// The size limit of pages.
struct ViewLimits {
    std::size_t triangles = 300000;  ///< most triangles; a page with so many has about 4 MB
};

/// The picture of a page for browsers without 3D: 320 x 240 pixels.
PictureOptions viewPicture();

/// The content of a page for a result: the surface with its distances, obstacles, seeds and
/// targets.
///
/// Of a mesh the vertices are its own, with more between them where edges are longer than some
/// voxels; of other surfaces those of Distance::mesh. Beyond the limit the mesh is simplified
/// (thinOut), and a note says so.
/// @param lines    paths, world units
/// @param picture  color map, spacing of isolines and camera of both picture and page
/// @throws Error  as renderPng
/// Time about that of Distance::mesh and renderPng together.
ViewScene viewScene(const Distance& distance, const std::vector<NamedCurve>& lines = {},
                    const PictureOptions& picture = viewPicture(), const ViewLimits& limits = {},
                    Progress& progress = Progress::none());

/// The same for a survey: where results are unreliable, and the factor by which a bound is exceeded
/// there (SurfaceSurvey::unreliability).
/// @param survey  with a surface
ViewScene viewScene(const FileSurvey& survey, const ViewLimits& limits = {},
                    Progress& progress = Progress::none());

/// Writes the scene of a distance as a page.
/// @throws Error  as viewScene and viewPage, and Io
void writeView(const std::string& file, const Distance& distance,
               const std::vector<NamedCurve>& lines = {},
               const PictureOptions& picture = viewPicture(),
               Progress& progress = Progress::none());

}  // namespace igeo
