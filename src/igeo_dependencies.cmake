# The least versions that will do; docs/dependencies.md has those that the tests were run with.
set(igeo_least_OpenVDB 10.0)
set(igeo_least_TBB 2021.0)
set(igeo_least_PNG 1.6)
set(igeo_least_assimp 5.0)

# Appends to `list_var` those of the packages that were not found, with the version that is asked for
# and the one that is there.
function(igeo_list_missing list_var)
    foreach(package IN LISTS ARGN)
        set(least ${igeo_least_${package}})
        set(there ${${package}_VERSION} ${${package}_CONSIDERED_VERSIONS} ${${package}_VERSION_STRING})
        list(GET there 0 there)
        # Find modules may find a version that is too old and not say so.
        if(${package}_FOUND AND NOT (least AND there AND there VERSION_LESS least))
            continue()
        endif()
        if(least)
            string(APPEND package " ${least} or newer")
        endif()
        if(there)
            string(APPEND package " (${there} is there)")
        endif()
        list(APPEND ${list_var} "${package}")
    endforeach()
    set(${list_var} "${${list_var}}" PARENT_SCOPE)
endfunction()

# Finds what igeo links against, for the build and for the installed igeoConfig.cmake alike.
#
# Sets `missing_var` to the names of what was not found. A function, because FindOpenVDB.cmake sets
# BUILD_SHARED_LIBS and prints as it goes: neither may reach the project that uses igeo.
function(igeo_find_dependencies missing_var)
    set(missing "")
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
    set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # or a parent of this project could not link igeo

    # First and by its own config: OpenVDB's FindTBB.cmake defines TBB::tbb alone, on which a later
    # find_package(TBB CONFIG), such as VTK's, fails. Boost and zlib: FindOpenVDB.cmake requires
    # them, Debian's libopenvdb-dev does not bring them.
    find_package(TBB ${igeo_least_TBB} CONFIG QUIET)
    find_package(Threads QUIET)
    find_package(ZLIB QUIET)
    find_package(PNG ${igeo_least_PNG} QUIET)
    find_package(assimp ${igeo_least_assimp} QUIET)
    find_package(Boost QUIET COMPONENTS iostreams)
    igeo_list_missing(missing TBB Threads ZLIB PNG assimp Boost)

    # OpenVDB has a find module and no config; Debian keeps it outside CMake's module path. For an
    # OpenVDB elsewhere, put its lib/cmake/OpenVDB into CMAKE_MODULE_PATH.
    if(NOT missing)
        list(APPEND CMAKE_MODULE_PATH
            /usr/lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE}/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB)
        find_package(OpenVDB ${igeo_least_OpenVDB} QUIET)
        igeo_list_missing(missing OpenVDB)
    endif()
    set(${missing_var} "${missing}" PARENT_SCOPE)
endfunction()
