# Finds what igeo links against, for the build and for the installed igeoConfig.cmake alike.
#
# Sets `missing_var` to the names of what was not found. A function, because FindOpenVDB.cmake sets
# BUILD_SHARED_LIBS and prints as it goes: neither may reach the project that uses igeo.
function(igeo_find_dependencies missing_var)
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
    set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # or a parent of this project could not link igeo

    # First and by its own config: OpenVDB's FindTBB.cmake defines TBB::tbb alone, on which a later
    # find_package(TBB CONFIG), such as VTK's, fails. Boost and zlib: FindOpenVDB.cmake requires
    # them, Debian's libopenvdb-dev does not bring them.
    find_package(TBB CONFIG QUIET)
    find_package(Threads QUIET)
    find_package(ZLIB QUIET)
    find_package(PNG QUIET)
    find_package(assimp 5.0 QUIET)
    find_package(Boost QUIET COMPONENTS iostreams)
    foreach(package IN ITEMS TBB Threads ZLIB PNG assimp Boost)
        if(NOT ${package}_FOUND)
            list(APPEND missing ${package})
        endif()
    endforeach()

    # OpenVDB has a find module and no config; Debian keeps it outside CMake's module path. For an
    # OpenVDB elsewhere, put its lib/cmake/OpenVDB into CMAKE_MODULE_PATH.
    if(NOT missing)
        list(APPEND CMAKE_MODULE_PATH
            /usr/lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE}/cmake/OpenVDB /usr/local/lib/cmake/OpenVDB)
        find_package(OpenVDB QUIET)
        if(NOT OpenVDB_FOUND)
            list(APPEND missing OpenVDB)
        endif()
    endif()
    set(${missing_var} "${missing}" PARENT_SCOPE)
endfunction()
