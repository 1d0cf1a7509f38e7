# Not run: only its syntax was checked, by CMake; vcpkg never built it.
# PLACEHOLDER: the project has no public home yet; URLS and SHA512 stand for those of a release.
vcpkg_download_distfile(archive
    URLS "https://example.org/PLACEHOLDER/implicit-geodesic-${VERSION}.tar.gz"
    FILENAME "implicit-geodesic-${VERSION}.tar.gz"
    SHA512 0
)
vcpkg_extract_source_archive(SOURCE_PATH ARCHIVE "${archive}")

vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS FEATURES tools IGEO_BUILD_APPS)
string(COMPARE EQUAL "${VCPKG_LIBRARY_LINKAGE}" dynamic shared)
vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS ${FEATURE_OPTIONS} -DIGEO_BUILD_TESTS=OFF -DIGEO_SHARED=${shared}
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME igeo CONFIG_PATH lib/cmake/igeo)
vcpkg_fixup_pkgconfig()
if("tools" IN_LIST FEATURES)
    vcpkg_copy_tools(TOOL_NAMES implicit-geodesic AUTO_CLEAN)
endif()

file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
