# Run by cpack on the staged files: what Debian wants of a package beyond what is installed.
if(NOT CPACK_GENERATOR STREQUAL DEB)
    return()
endif()

# run(<command>...): ends with the command's message where it fails.
function(run)
    execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)  # of SOURCE_DATE_EPOCH, if that is set
file(GLOB stages ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*)
foreach(stage IN LISTS stages)
    cmake_path(GET stage FILENAME component)
    string(TOUPPER ${component} component)
    set(package ${CPACK_DEBIAN_${component}_PACKAGE_NAME})
    set(share ${stage}${CPACK_PACKAGING_INSTALL_PREFIX}/share)
    set(doc ${share}/doc/${package})

    file(READ ${CMAKE_CURRENT_LIST_DIR}/../../src/igeo/results/font/LICENSE font_license)
    string(REGEX REPLACE "\n+$" "" font_license "${font_license}")
    string(REGEX REPLACE "\n\n" "\n.\n" font_license "${font_license}")
    string(REGEX REPLACE "\n" "\n " font_license " ${font_license}")
    # Debian has the license itself; the file that is installed elsewhere would be one too many.
    file(REMOVE ${doc}/LICENSE ${doc}/LICENSE.font)
    file(WRITE ${doc}/copyright
"Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/
Upstream-Name: implicit-geodesic
Upstream-Contact: ${CPACK_PACKAGE_CONTACT}
Comment: The program has CLI11 (BSD-3-clause), nlohmann-json (Expat), xxHash (BSD-2-clause) and
 three.js (Expat) compiled in, the library all of these but CLI11. Pages of --view have three.js in them, with
 its license.

Files: src/igeo/results/font/*
Copyright: 2003 Bitstream, Inc.; changes of DejaVu are in the public domain
License: bitstream-vera
${font_license}
Files: *
Copyright: 2026 ${CPACK_PACKAGE_VENDOR}
License: Apache-2.0
 On Debian systems, the text of the license is in /usr/share/common-licenses/Apache-2.0.
")
    file(RENAME ${doc}/CHANGELOG.md ${doc}/changelog)
    file(WRITE ${doc}/changelog.Debian
"implicit-geodesic (${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}) unstable; urgency=medium

  * Made by cpack from the sources. What has changed in them is in changelog.gz.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
    file(GLOB pages ${share}/man/man1/*.1)
    run(gzip -9n ${doc}/changelog ${doc}/changelog.Debian ${pages})
    file(GLOB_RECURSE binaries ${stage}${CPACK_PACKAGING_INSTALL_PREFIX}/bin/* ${stage}/*.a)
    run(strip --strip-debug --remove-section=.comment --remove-section=.note ${binaries})
    run(chmod -R u=rwX,go=rX ${stage})  # whatever the umask
endforeach()
