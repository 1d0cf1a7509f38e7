# The dependencies of igeo: the least version that works (docs/dependencies.md has the tested
# versions), and the name of the Debian package.
set(igeo_least_OpenVDB 10.0)
set(igeo_least_TBB 2021.0)
set(igeo_least_PNG 1.6)
set(igeo_least_Freetype 2.10)
set(igeo_least_assimp 5.0)
set(igeo_least_fmt 9.0)
set(igeo_least_xxHash 0.8.0)
set(igeo_least_nlohmann_json 3.7)
set(igeo_least_CLI11 2.1)
set(igeo_least_Catch2 2.13)
set(igeo_debian_OpenVDB libopenvdb-dev)
set(igeo_debian_TBB libtbb-dev)
set(igeo_debian_ZLIB zlib1g-dev)
set(igeo_debian_PNG libpng-dev)
set(igeo_debian_Freetype libfreetype-dev)
set(igeo_debian_assimp libassimp-dev)
set(igeo_debian_fmt libfmt-dev)
set(igeo_debian_xxHash libxxhash-dev)
set(igeo_debian_Boost libboost-iostreams-dev)
set(igeo_debian_nlohmann_json nlohmann-json3-dev)
set(igeo_debian_CLI11 libcli11-dev)
set(igeo_debian_Catch2 catch2)

# Appends to `list_var` the packages that are missing or too old.
function(igeo_list_missing list_var)
    foreach(package IN LISTS ARGN)
        set(there ${${package}_VERSION} ${${package}_CONSIDERED_VERSIONS} ${${package}_VERSION_STRING})
        list(GET there 0 there)
        set(least ${igeo_least_${package}})
        if(NOT ${package}_FOUND OR (least AND there AND there VERSION_LESS least))
            list(APPEND ${list_var} ${package})
            set(igeo_there_${package} "${there}" PARENT_SCOPE)
        endif()
    endforeach()
    set(${list_var} "${${list_var}}" PARENT_SCOPE)
endfunction()

# Sets `out_var` to one message about all packages of igeo_list_missing: the version found, the
# version needed, and how to install them.
function(igeo_describe_missing out_var)
    set(text "")
    set(debian "")
    foreach(package IN LISTS ARGN)
        string(APPEND text "\n  ${package}")
        if(igeo_least_${package})
            string(APPEND text " ${igeo_least_${package}} or newer")
        endif()
        if(igeo_there_${package})
            string(APPEND text " (${igeo_there_${package}} is there)")
        endif()
        list(APPEND debian ${igeo_debian_${package}})
    endforeach()
    list(JOIN debian " " debian)
    set(${out_var} "${text}
Debian, Ubuntu: apt-get install ${debian}
Elsewhere: install them under these names, and give their prefix: -DCMAKE_PREFIX_PATH=PREFIX"
        PARENT_SCOPE)
endfunction()

# OpenVDB has a find module and no config. Sets `out_var` to the folder of the module: under one of
# the prefixes that find_package searches, in the folders of Debian, Fedora, conda, Homebrew (lib,
# lib64, lib/<architecture>) and vcpkg (share/openvdb).
function(igeo_find_openvdb_module out_var)
    set(prefixes ${OpenVDB_ROOT} $ENV{OpenVDB_ROOT} ${OPENVDB_ROOT} $ENV{OPENVDB_ROOT}
        ${CMAKE_PREFIX_PATH})
    string(REPLACE ":" ";" in_environment "$ENV{CMAKE_PREFIX_PATH}:$ENV{CONDA_PREFIX}:$ENV{HOMEBREW_PREFIX}")
    list(APPEND prefixes ${in_environment} ${CMAKE_SYSTEM_PREFIX_PATH} /opt/homebrew)
    foreach(prefix IN LISTS prefixes)
        foreach(folder lib lib64 lib/${CMAKE_LIBRARY_ARCHITECTURE} lib/${CMAKE_CXX_LIBRARY_ARCHITECTURE})
            if(EXISTS ${prefix}/${folder}/cmake/OpenVDB/FindOpenVDB.cmake)
                set(${out_var} ${prefix}/${folder}/cmake/OpenVDB PARENT_SCOPE)
                return()
            endif()
        endforeach()
        if(EXISTS ${prefix}/share/openvdb/FindOpenVDB.cmake)
            set(${out_var} ${prefix}/share/openvdb PARENT_SCOPE)
            return()
        endif()
    endforeach()
    set(${out_var} "" PARENT_SCOPE)
endfunction()

# Sets xxHash_FOUND, xxHash_VERSION and the target igeo_xxhash of its header, as Debian's package has no
# config. The header is compiled in: users of the library need no copy.
macro(igeo_find_xxhash)
    find_path(igeo_xxhash_include xxhash.h)
    mark_as_advanced(igeo_xxhash_include)
    if(igeo_xxhash_include)
        set(xxHash_FOUND TRUE)
        file(STRINGS ${igeo_xxhash_include}/xxhash.h xxHash_VERSION
            REGEX "# *define +XXH_VERSION_(MAJOR|MINOR|RELEASE) +[0-9]+")
        list(TRANSFORM xxHash_VERSION REPLACE ".*[A-Z] +([0-9]+).*" "\\1")
        list(JOIN xxHash_VERSION . xxHash_VERSION)
        add_library(igeo_xxhash INTERFACE)
        target_include_directories(igeo_xxhash SYSTEM INTERFACE ${igeo_xxhash_include})
    endif()
endmacro()

# Sets igeo_three to three.js and its OrbitControls, which draw the pages of results, or to nothing.
# They are compiled in: users of the library need no copies.
macro(igeo_find_three)
    set(places ${CMAKE_PREFIX_PATH} ${CMAKE_SYSTEM_PREFIX_PATH})
    find_file(IGEO_THREE_JS three.min.js PATHS ${places}
        PATH_SUFFIXES share/javascript/three share/nodejs/three/build NO_DEFAULT_PATH
        DOC "three.js, for --view")
    find_file(IGEO_THREE_CONTROLS OrbitControls.js PATHS ${places}
        PATH_SUFFIXES share/javascript/three/examples/js/controls NO_DEFAULT_PATH
        DOC "OrbitControls of three.js, for --view")
    mark_as_advanced(IGEO_THREE_JS IGEO_THREE_CONTROLS)
    set(igeo_three ${IGEO_THREE_JS} ${IGEO_THREE_CONTROLS})
    if(NOT IGEO_THREE_JS OR NOT IGEO_THREE_CONTROLS)
        set(igeo_three "")
        message(STATUS "No three.js (Debian: libjs-three): --view is left out")
    endif()
endmacro()

cmake_policy(PUSH)
if(POLICY CMP0167)
    cmake_policy(SET CMP0167 NEW)  # Boost by its own config
endif()

# Finds the libraries that igeo links, for the build and for the installed igeoConfig.cmake.
#
# Sets `missing_var` to the names of missing libraries. It is a function, because FindOpenVDB.cmake
# sets BUILD_SHARED_LIBS and prints, which must not reach the project that uses igeo. No version is
# requested, because configs refuse newer major versions that work; igeo_list_missing compares them.
function(igeo_find_dependencies missing_var)
    set(missing "")
    set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
    set(CMAKE_POLICY_DEFAULT_CMP0167 NEW)  # in FindOpenVDB.cmake, which sets policies of its own
    set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # or a parent of this project could not link igeo

    # First and by its own config: OpenVDB's FindTBB.cmake defines only TBB::tbb, with which a later
    # find_package(TBB CONFIG), such as VTK's, fails.
    find_package(TBB CONFIG QUIET)
    find_package(Threads QUIET)
    find_package(ZLIB QUIET)
    find_package(PNG QUIET)
    find_package(Freetype MODULE QUIET)
    find_package(assimp CONFIG QUIET)
    find_package(fmt CONFIG QUIET)
    igeo_list_missing(missing TBB Threads ZLIB PNG Freetype assimp fmt)

    igeo_find_openvdb_module(module)
    find_path(igeo_openvdb_include openvdb/version.h
        HINTS ${module}/../../../include ${module}/../../../../include ${module}/../../include)
    mark_as_advanced(igeo_openvdb_include)
    # OpenVDB 10 requires Boost, and Debian's libopenvdb-dev does not depend on it; later versions
    # find it themselves if they were built with it.
    if(igeo_openvdb_include)
        file(STRINGS ${igeo_openvdb_include}/openvdb/version.h major
            REGEX "OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER [0-9]+$")
        string(REGEX MATCH "[0-9]+$" major "${major}")
        if(major VERSION_LESS 11)
            find_package(Boost QUIET COMPONENTS iostreams)
            igeo_list_missing(missing Boost)
        endif()
    endif()
    # FindOpenVDB.cmake stops the configuration if one of these is missing.
    if(module AND NOT missing)
        list(APPEND CMAKE_MODULE_PATH ${module})
        find_package(OpenVDB QUIET)
        if(OPENVDB_USE_STATIC_LIBS)  # FindOpenVDB.cmake leaves out what libopenvdb.a calls
            foreach(target IN ITEMS Blosc::blosc ZLIB::ZLIB)
                if(TARGET OpenVDB::openvdb AND TARGET ${target})
                    set_property(TARGET OpenVDB::openvdb APPEND
                        PROPERTY INTERFACE_LINK_LIBRARIES ${target})
                endif()
            endforeach()
        endif()
    endif()
    if(NOT module OR NOT missing)
        igeo_list_missing(missing OpenVDB)
    endif()
    foreach(package IN LISTS missing)
        set(igeo_there_${package} "${igeo_there_${package}}" PARENT_SCOPE)
    endforeach()
    set(${missing_var} "${missing}" PARENT_SCOPE)
endfunction()
cmake_policy(POP)
