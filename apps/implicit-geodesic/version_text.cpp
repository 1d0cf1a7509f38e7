#include "version_text.h"

#include <igeo/base/version.h>
#include <igeo/results/view_page.h>
#include <openvdb/version.h>
#include <tbb/version.h>

#include <implicit_geodesic_commit.h>  // changes with every commit: for this file alone

std::string versionText() {
    return std::string("implicit-geodesic ") + igeo::kVersion + "\ncommit " + kCommit +
           "\nOpenVDB " + openvdb::getLibraryVersionString() + ", file format " +
           std::to_string(openvdb::OPENVDB_FILE_VERSION) + "\nTBB " + TBB_runtime_version() +
           "\ncompiler " + IGEO_COMPILER +
           (igeo::hasViewer() ? "\nthree.js is packed in, for --view"
                              : "\nno three.js, so no --view");
}
