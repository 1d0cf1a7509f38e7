#!/usr/bin/env bash
# Makes the level sets in data/ (data/README.md describes them). Same program, same bytes.
#   bash scripts/make_data.sh
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [ -n "${MAKE_SHAPE:-}" ]; then
    makeShape=$MAKE_SHAPE
else
    makeShape=build/release/bin/make_shape
    [ -f build/release/CMakeCache.txt ] || bash scripts/build.sh release
    cmake --build build/release --target make_shape >/dev/null
fi

# make FILE SHAPE [options]: every shape sits at the world's origin; the voxels are shifted so that
# all indices are positive, which saves 63 kB of empty tree nodes per file.
make() {
    local file=$1 shape=$2
    shift 2
    "$makeShape" "$shape" -o "data/$file" --half "$@"
}

make sphere.vdb sphere --translate -1.6,-1.6,-1.6
make sphere_rotated.vdb sphere --rotate 1,1,1,40 --translate -1.6,-1.6,-1.6
make torus.vdb torus --translate -1.6,-1.6,-0.8
make trefoil.vdb trefoil --voxel-size 0.02 --translate -1.28,-1.28,-0.64
make rounded_box.vdb rounded-box --translate -1.2,-1.2,-0.8
make box.vdb box --translate -1.21,-1.21,-0.81
make cylinder.vdb cylinder --translate -0.8,-0.8,-1.21
make two_spheres.vdb two-spheres --translate -1.6,-0.8,-0.8
make thin_sheet.vdb thin-sheet --translate -1.2,-0.8,-0.41
make plane_patch.vdb plane-patch --param normal=1,1,2 --translate -1.6,-1.6,-1.6

echo "data/: $(du -cb data/*.vdb | tail -1 | cut -f1) bytes in $(ls data/*.vdb | wc -l) files" >&2
