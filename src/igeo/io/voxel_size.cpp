#include <igeo/io/voxel_size.h>

#include <fmt/core.h>
#include <igeo/base/error.h>
#include <igeo/base/types.h>

namespace igeo {

namespace {

[[noreturn]] void refuse(Error::Kind kind, const std::string& what, bool small,
                         const char* otherwise) {
    throw Error(kind,
                fmt::format("{}; a grid has voxels of {:.2g} to {:.2g} units", what,
                            kLeastVoxelSize, kLargestVoxelSize),
                small ? fmt::format("give the coordinates in a smaller unit, as millimeters "
                                    "instead of meters{}",
                                    otherwise)
                      : "give the coordinates in a larger unit, as meters instead of millimeters");
}

}  // namespace

void requireVoxelSize(double dx, const std::string& where, Error::Kind kind) {
    if (dx >= kLeastVoxelSize && dx <= kLargestVoxelSize) return;
    refuse(kind, fmt::format("{} has voxels of {:.3g} units of its coordinates", where, dx),
           dx < kLeastVoxelSize, ", or take larger voxels");
}

void requireExtent(double side, const std::string& where) {
    constexpr double kFewest = 8, kMost = kFarthestIndex;
    if (side == 0 || (side >= kFewest * kLeastVoxelSize && side <= kMost * kLargestVoxelSize))
        return;
    refuse(Error::Kind::BadInput,
           fmt::format("{} is {:.3g} units of its coordinates across", where, side),
           side < kFewest * kLeastVoxelSize, "");
}

void requireFine(double dx, double side, const std::string& where) {
    constexpr double kFewest = 8;
    if (side == 0 || dx * kFewest <= side * (1 + 1e-9)) return;
    throw Error(Error::Kind::InvalidArgument,
                fmt::format("voxels of {:.4g} are larger than an eighth of the surface, which is "
                            "{:.4g} across ({})",
                            dx, side, where),
                fmt::format("take voxels of up to {:.2g}; 1/256 of its longest side is usual",
                            side / kFewest));
}

}  // namespace igeo
