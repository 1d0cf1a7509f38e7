/// Regions of a surface, such as a parcellation of the cortex, from files.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace igeo {

struct VertexRegion {
    std::string name;                   ///< may be empty
    std::vector<std::size_t> vertices;  ///< ascending, one or more
};

struct Annotation {
    std::size_t vertices = 0;  ///< number of vertices of the surface
    std::vector<VertexRegion> regions;
};

/// Whether a file holds regions by the ending of its name, in any case: .annot.
bool isAnnotationFile(const std::string& file);

/// Regions from FreeSurfer's .annot file, in the order of its table; those without vertices are
/// left out. A vertex whose value is 0 or in no row of the table is in no region.
/// @throws Error  Io; BadInput, with the byte, for another kind of file, a damaged one, one without
///         a table, and names that hold control characters
/// Time and memory O(size), whatever counts the file announces.
Annotation readAnnotation(const std::string& file);

/// The same from bytes.
/// @param file  its name, for messages
Annotation annotationFrom(const std::string& file, const std::string& bytes);

}  // namespace igeo
