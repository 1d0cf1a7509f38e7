# Writes a source with the bytes of the files of results/detail/view_files.h, those of three.js
# last: cmake -D files=<list> -D output=<source> -P embed_view_files.cmake
set(names page style drawing script license)
set(arrays "")
set(views "")

macro(add_array name bytes)
    string(LENGTH "${bytes}" digits)
    math(EXPR size "${digits} / 2")
    string(REGEX REPLACE "(................................)" "\\1\n" rows "${bytes}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," rows "${rows}")
    string(APPEND arrays "const unsigned char k_${name}[] = {\n${rows}};\n")
    list(APPEND views "{reinterpret_cast<const char*>(k_${name}), ${size}}")
endmacro()

foreach(name IN LISTS names)
    list(POP_FRONT files file)
    file(READ ${file} bytes HEX)
    add_array(${name} ${bytes})
endforeach()
if(files)  # three.js and its controls: packed here, once for all pages
    file(WRITE ${output}.js "")
    foreach(file IN LISTS files)
        file(READ ${file} text)
        file(APPEND ${output}.js "${text}\n")
    endforeach()
    file(ARCHIVE_CREATE OUTPUT ${output}.js.gz PATHS ${output}.js FORMAT raw COMPRESSION GZip
        COMPRESSION_LEVEL 9)
    file(READ ${output}.js.gz bytes HEX)
    # Without the build time, which gzip stores in bytes 4 to 7.
    string(SUBSTRING ${bytes} 0 8 head)
    string(SUBSTRING ${bytes} 16 -1 tail)
    add_array(library ${head}00000000${tail})
else()
    list(APPEND views "{}")
endif()
list(JOIN views ",\n        " views)
file(WRITE ${output} "// Made by embed_view_files.cmake.
#include <igeo/results/detail/view_files.h>

namespace igeo {

namespace {
${arrays}}  // namespace

const ViewFiles& viewFiles() {
    static const ViewFiles files{
        ${views}};
    return files;
}

}  // namespace igeo
")
