# Writes a source with the bytes of the files of results/detail/view_files.h, those of three.js
# last: cmake -D files=<list> -D output=<source> -P embed_view_files.cmake
set(names page style drawing script license three controls)
set(arrays "")
set(views "")
foreach(name IN LISTS names)
    list(POP_FRONT files file)
    if(NOT file)
        list(APPEND views "{}")
        continue()
    endif()
    file(READ ${file} bytes HEX)
    string(LENGTH "${bytes}" digits)
    math(EXPR size "${digits} / 2")
    string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    string(APPEND arrays "const unsigned char k_${name}[] = {\n${bytes}};\n")
    list(APPEND views "{reinterpret_cast<const char*>(k_${name}), ${size}}")
endforeach()
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
