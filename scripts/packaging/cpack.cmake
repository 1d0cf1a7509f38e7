# What cpack makes: TGZ and on Debian DEB, each of the components program and library.
file(STRINGS CITATION.cff contact REGEX "^  - name: |^    email: ")
list(TRANSFORM contact REPLACE "^ +-? *[a-z]+: ([^#]*[^# ]).*$" "\\1")
list(GET contact 0 CPACK_PACKAGE_VENDOR)
list(GET contact 1 mail)
set(CPACK_PACKAGE_CONTACT "${CPACK_PACKAGE_VENDOR} <${mail}>")
set(CPACK_PACKAGE_NAME implicit-geodesic)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "geodesic distances on level sets, meshes and points")
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)

set(CPACK_GENERATOR TGZ)
find_program(DPKG_SHLIBDEPS dpkg-shlibdeps)
if(DPKG_SHLIBDEPS)
    list(APPEND CPACK_GENERATOR DEB)
endif()
set(CPACK_COMPONENTS_ALL library)
if(IGEO_BUILD_APPS)
    list(APPEND CPACK_COMPONENTS_ALL program)
endif()
set(CPACK_COMPONENTS_GROUPING IGNORE)  # a package per component

set(CPACK_ARCHIVE_COMPONENT_INSTALL ON)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/archive.cmake)  # read for each generator
file(CONFIGURE OUTPUT archive.cmake CONTENT [[
if(CPACK_GENERATOR STREQUAL TGZ)
    set(CPACK_COMPONENT_INCLUDE_TOPLEVEL_DIRECTORY ON)
endif()
]])
set(platform ${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_PACKAGE_FILE_NAME implicit-geodesic-${platform})  # also the folder that both unpack into
set(CPACK_ARCHIVE_PROGRAM_FILE_NAME ${CPACK_PACKAGE_FILE_NAME})
set(CPACK_ARCHIVE_LIBRARY_FILE_NAME libigeo-dev-${platform})

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 0.1)  # below the first that Debian would make
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian.cmake)
set(CPACK_VERBATIM_VARIABLES ON)

set(about "Distances are computed in a thin band of OpenVDB voxels around the surface,
without triangulating it, at second order on smooth surfaces. Surfaces are
level sets, triangle meshes or point clouds.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME implicit-geodesic)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS libopenvdb-tools)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "${about}")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libigeo-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS  # what igeo_find_dependencies and igeo.pc ask for
    "libopenvdb-dev (>= ${igeo_least_OpenVDB})" "libtbb-dev (>= ${igeo_least_TBB})"
    libboost-iostreams-dev zlib1g-dev "libpng-dev (>= ${igeo_least_PNG})"
    "libfreetype-dev (>= ${igeo_least_Freetype})"
    "libassimp-dev (>= ${igeo_least_assimp})" "libfmt-dev (>= ${igeo_least_fmt})")
list(JOIN CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", " CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "${about}

This package has the C++ headers, the static library, and its files for CMake
and pkg-config.")

include(CPack)
