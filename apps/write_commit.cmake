# Writes the header `file` with the commit of the folder `source`; the file is written only if the commit changed.
#
# usage: cmake -D source=DIR -D file=FILE -P write_commit.cmake
set(commit "")
# Only a repository of its own: a copy unpacked inside another one has no commit.
if(EXISTS ${source}/.git)
    execute_process(COMMAND git -C ${source} describe --always --dirty
        OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT commit)
    set(commit unknown)
endif()
file(CONFIGURE OUTPUT ${file} CONTENT "constexpr const char* kCommit = \"${commit}\";\n")
