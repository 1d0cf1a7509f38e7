/// Surfaces and values per vertex from GIFTI files. Internal.
#pragma once

#include <igeo/io/polygon_mesh.h>

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

/// A DataArray of a GIFTI file.
struct GiftiArray {
    std::string intent;             ///< as in the file: NIFTI_INTENT_POINTSET, ...
    std::vector<std::size_t> dims;  ///< one or two
    std::vector<double> values;     ///< the last dimension is the fastest
};

/// Reads all data arrays: as text, base64 or compressed base64, of either byte order, either order
/// of dimensions and any number type of NIfTI. By hand, because GIFTI needs little of XML and the
/// usual libraries print and abort.
/// @param file   its name, for messages
/// @param bytes  all of the file
/// @throws Error  BadInput for another kind of file, one that is cut off or damaged, or whose data
///         are in another file
/// Time O(size). Memory O(size), whatever counts the file announces.
std::vector<GiftiArray> readGifti(const std::string& file, const std::string& bytes);

/// The positions of NIFTI_INTENT_POINTSET, without the transforms that the file may list, and the
/// faces of NIFTI_INTENT_TRIANGLE.
/// @throws Error  BadInput as readGifti, where there is not one of each, and for a corner that is
///         no vertex number
PolygonMesh readGiftiMesh(const std::string& file, const std::string& bytes);

}  // namespace igeo
