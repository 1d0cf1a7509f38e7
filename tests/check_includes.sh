#!/usr/bin/env bash
# Holds the picture of docs/architecture.md: who may include what. Lists every include that breaks
# it and every cycle between files, and fails if there is one.
set -euo pipefail
cd "$(dirname "$0")/.."

# The folders of src/igeo, and the folders whose headers the files of each may include beside their
# own. A file in detail/ belongs to the folder above it.
folders='
base
io       base
band     base
metric   band io base
surface  band io base
march    metric band base
path     march metric band base
results  path march surface metric band io base
'

# These do without OpenVDB, also through what they include.
no_openvdb='base band march path'

# Headers that cost seconds per file or that not every system has: the prefix, where the rule holds,
# and the files excepted. Tests may use TBB, JSON and POSIX directly.
guarded='
CLI/       src apps tests  apps/implicit-geodesic/options/command_line.cpp
nlohmann/  src apps        src/igeo/io/data_files.cpp src/igeo/io/point_list.cpp apps/implicit-geodesic/json_file.h
zlib.h     src apps        src/igeo/base/detail/deflate.cpp
png.h      src apps        src/igeo/results/detail/canvas.cpp
ft2build.h src apps        src/igeo/results/detail/font.cpp
assimp/    src apps        src/igeo/io/mesh_file.cpp
xxhash     src apps        src/igeo/base/digest.cpp
fmt/format.h  src apps
fmt/printf.h  src apps
tbb/       src apps        src/igeo/base/parallel.h src/igeo/base/parallel.cpp apps/implicit-geodesic/version_text.cpp
fcntl.h    src apps        src/igeo/base/detail/system_posix.cpp src/igeo/base/detail/system_windows.cpp apps/implicit-geodesic/process_posix.cpp
sys/       src apps        src/igeo/base/detail/system_posix.cpp src/igeo/base/detail/system_windows.cpp apps/implicit-geodesic/process_posix.cpp
unistd.h   src apps        src/igeo/base/detail/system_posix.cpp apps/implicit-geodesic/process_posix.cpp apps/implicit-geodesic/heap.cpp
windows.h  src apps        src/igeo/base/detail/system_windows.cpp apps/implicit-geodesic/process_windows.cpp
'

mapfile -t files < <(find src apps tests -name '*.h' -o -name '*.cpp' | LC_ALL=C sort)
status=0

awk -v folders="$folders" -v no_openvdb="$no_openvdb" -v guarded="$guarded" '
function fail(what) { print FILENAME ":" FNR ": " what; failed = 1 }
function folder_of(file) { sub(/\/.*/, "", file); return file }
# The header, or one that it includes, that includes OpenVDB; empty: none.
function openvdb_through(header,   list, n, i, found) {
    if (header in answer) return answer[header]
    answer[header] = ""
    if (header in includes_openvdb) return answer[header] = header
    n = split(includes[header], list, " ")
    for (i = 1; i <= n; ++i)
        if ((found = openvdb_through(list[i])) != "") return answer[header] = found
    return ""
}

BEGIN {
    n = split(folders, line, "\n")
    for (i = 1; i <= n; ++i) {
        m = split(line[i], word, " ")
        for (j = 1; j <= m; ++j) allowed[word[1], word[j]] = 1
        if (m) known[word[1]] = 1
    }
    n = split(no_openvdb, word, " ")
    for (i = 1; i <= n; ++i) free[word[i]] = 1
    n = split(guarded, line, "\n")
    for (i = 1; i <= n; ++i) {
        m = split(line[i], word, " ")
        if (m == 0) continue
        prefixes[++count] = word[1]
        for (j = 2; j <= m; ++j) {
            if (word[j] ~ /\//) excepted[word[1], word[j]] = 1
            else holds[word[1], word[j]] = 1
        }
    }
}

FNR == 1 {
    in_library = FILENAME ~ /^src\/igeo\//
    top = FILENAME; sub(/\/.*/, "", top)
    self = FILENAME; sub(/^src\/igeo\//, "", self)
    folder = folder_of(self)
    # The public classes: files beside the folders may include all, and no file in a folder includes them.
    front = in_library && self !~ /\//
    if (in_library && !front && !(folder in known))
        fail("no folder of the table in tests/check_includes.sh")
}

/^[ \t]*#[ \t]*pragma[ \t]+once/ { has_pragma[FILENAME] = 1 }

/^[ \t]*#[ \t]*include[ \t]*[<"]/ {
    header = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*[<"]/, "", header); sub(/[>"].*/, "", header)
    sub(/^oneapi\/tbb/, "tbb", header)

    for (i = 1; i <= count; ++i) {
        prefix = prefixes[i]
        if (index(header, prefix) == 1 && (prefix, top) in holds &&
            !((prefix, FILENAME) in excepted))
            fail("<" prefix "...> does not belong here")
    }
    if (top == "src" && header ~ /(^|\/)(\.\.|apps|tests|support|implicit-geodesic)\//)
        fail("the library includes neither apps nor tests: " header)
    if (top == "apps" && header ~ /(^|\/)(tests|support)\//)
        fail("the program does not include tests: " header)
    if (!in_library) next

    if (header ~ /^openvdb\//) includes_openvdb[self] = 1
    if (header !~ /^igeo\//) next
    other = header; sub(/^igeo\//, "", other)
    includes[self] = includes[self] " " other
    other_folder = folder_of(other)
    if (!front && folder != other_folder && !((folder, other_folder) in allowed))
        fail("a file of " folder "/ does not include " header)
    if (FILENAME ~ /\.h$/ && FILENAME !~ /\/detail\// && header ~ /\/detail\//)
        fail("a public header does not include an internal one: " header)
}

END {
    for (file in includes)
        if (folder_of(file) in free && (found = openvdb_through(file)) != "") {
            print "src/igeo/" file ": does without OpenVDB, and gets it from " found
            failed = 1
        }
    for (i = 1; i < ARGC; ++i)
        if (ARGV[i] ~ /\.h$/ && !(ARGV[i] in has_pragma)) {
            print ARGV[i] ": no #pragma once"
            failed = 1
        }
    exit failed
}' "${files[@]}" || status=1

# Cycles: a header and the source of its name are one file here.
for folder in src apps/implicit-geodesic; do
    loops=$(cd "$folder" && grep -rHoP --include='*.h' --include='*.cpp' \
        '^\s*#\s*include\s*[<"]\K[^>"]+\.h(?=[>"])' . |
        sed -E 's|^\./||; s|\.(h\|cpp):|.h |' |
        awk '$1 != $2 { print }' |
        while read -r from to; do [[ -e $to ]] && echo "$from $to"; done |
        LC_ALL=C sort -u | tsort 2>&1 >/dev/null) || true
    if [[ -n $loops ]]; then
        echo "$folder: files that include each other:"
        echo "$loops"
        status=1
    fi
done
exit $status
