/// VTK's XML format of polygons and lines, for ParaView, VTK, PyVista and F3D.
#pragma once

#include <igeo/io/poly_data.h>

#include <string>

namespace igeo {

/// The bytes of a .vtp file: arrays appended raw, compressed with zlib in blocks of 1 MiB; points
/// are double if single precision would change one. Readers color by the first of `data`. Blocks
/// are compressed in parallel; the same bytes for any number of threads.
/// @throws Error  InvalidArgument for data whose length does not fit, or a name that XML cannot
///         hold
std::string vtp(const PolyData& shape);

}  // namespace igeo
