#!/usr/bin/env bash
# Holds the arrows of docs/architecture.md: who may include what. Lists every include that breaks
# them and fails if there is one.
set -euo pipefail
cd "$(dirname "$0")/.."

# The rooms of src/igeo from the ground up, one per line. A file (.h and .cpp alike) includes igeo
# headers of its own room and of those above it in this list.
rooms='
types error parallel progress steps version box disjoint_sets format numbers system system_posix system_windows
eikonal heap selling atomic_file colour_map canvas ply point_tree quadric_fit cloud_density digest
tangent_frame jet_update orient_normals medial_radii
band metric curvature triangle_mesh mesh_voxels ply_file mesh_file
openvdb_grids vdb_archive vdb_io vdb_write level_set rebuild leaf_block band_width index_map point_cloud vdb_points
level_set_band surface_point point_surface point_band seeds grid_sampling obstacles mesh_band
field
godunov jet jet_core jet_extend jet_stencil
trace
straighten
accuracy sampling matrix pairs log_map shoot sides
surface_mesh refined_mesh
isolines survey
cells engrave
field_grids extend report point_file picture legend view surface_rays
'

# Files that do without OpenVDB, and so without the igeo headers that need it.
no_openvdb='
types error parallel progress steps version box disjoint_sets format numbers system system_posix system_windows digest eikonal heap jet_update selling ply tangent_frame band metric
curvature field band_width surface_point seeds godunov jet jet_core jet_extend jet_stencil trace
straighten accuracy sampling matrix log_map shoot sides point_file colour_map canvas point_tree
quadric_fit cloud_density orient_normals medial_radii
triangle_mesh mesh_voxels ply_file mesh_file mesh_band
'

# Headers that cost seconds per file or that not every system has: the prefix, where the rule holds,
# and the files excepted. Tests may use TBB, JSON and POSIX directly.
guarded='
CLI/       src apps tests  apps/implicit-geodesic/options.cpp
nlohmann/  src apps        src/igeo/report.cpp src/igeo/point_file.cpp apps/implicit-geodesic/json_file.h
png.h      src apps        src/igeo/canvas.cpp
assimp/    src apps        src/igeo/mesh_file.cpp
tbb/       src apps        src/igeo/parallel.h src/igeo/parallel.cpp apps/implicit-geodesic/version_text.cpp
fcntl.h    src apps        src/igeo/system_posix.cpp src/igeo/system_windows.cpp apps/implicit-geodesic/process_posix.cpp
sys/       src apps        src/igeo/system_posix.cpp src/igeo/system_windows.cpp apps/implicit-geodesic/process_posix.cpp
unistd.h   src apps        src/igeo/system_posix.cpp apps/implicit-geodesic/process_posix.cpp
windows.h  src apps        apps/implicit-geodesic/process_windows.cpp
'

mapfile -t files < <(find src apps tests -name '*.h' -o -name '*.cpp' | LC_ALL=C sort)

awk -v rooms="$rooms" -v no_openvdb="$no_openvdb" -v guarded="$guarded" '
function fail(what) { print FILENAME ":" FNR ": " what; failed = 1 }

BEGIN {
    n = split(rooms, line, "\n")
    for (i = 1; i <= n; ++i) {
        m = split(line[i], word, " ")
        for (j = 1; j <= m; ++j) room[word[j]] = i
    }
    n = split(no_openvdb, word, " ")
    for (i = 1; i <= n; ++i) free_of_openvdb[word[i]] = 1
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
    stem = FILENAME; sub(/.*\//, "", stem); sub(/\.[a-z]+$/, "", stem)
    if (in_library && !(stem in room))
        fail("src/igeo/" stem " has no room in the table of tests/check_includes.sh")
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
    if (!in_library || !(stem in room)) next

    if (header ~ /^openvdb\// && stem in free_of_openvdb)
        fail(stem " does without OpenVDB")
    if (header ~ /^igeo\// || header !~ /\// && header ~ /\.h$/ && /"/) {
        other = header; sub(/^igeo\//, "", other); sub(/\.h$/, "", other)
        if (!(other in room))
            fail("igeo/" other ".h has no room in the table of tests/check_includes.sh")
        else if (room[other] > room[stem])
            fail(stem " (room " room[stem] - 1 ") includes " other " (room " room[other] - 1 ")")
        else if (stem in free_of_openvdb && !(other in free_of_openvdb))
            fail(stem " does without OpenVDB, igeo/" other ".h does not")
    }
}

END {
    for (i = 1; i < ARGC; ++i)
        if (ARGV[i] ~ /\.h$/ && !(ARGV[i] in has_pragma)) {
            print ARGV[i] ": no #pragma once"
            failed = 1
        }
    exit failed
}' "${files[@]}"
