#!/usr/bin/env bash
# Installs a build tree under a temporary prefix, moves that, then builds and runs a project that uses it,
# by CMake and by pkg-config.
#
# usage: test_install.sh <build-dir> <config> <c++-compiler>
set -euo pipefail

build=$1 config=$2 compiler=$3 skipped=0
source=$(cd "$(dirname "$0")/../.." && pwd)
consumer=$source/tests/install/consumer
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --config "$config" --prefix "$scratch/first" >"$scratch/install.log"
mkdir "$scratch/moved"
mv "$scratch/first" "$scratch/moved/prefix"
prefix=$scratch/moved/prefix
! grep -rIl "$scratch/first" "$prefix" || { echo "these files name the first prefix"; exit 1; }

headers=$prefix/include/igeo
[[ -f $headers/base/version.h ]] || { echo "version.h is not installed"; exit 1; }
[[ -z $(find "$headers" -name leaf_block.h) ]] || { echo "leaf_block.h is private but installed"; exit 1; }

cmake -S "$consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$config"
cmake --build "$scratch/build"
version=$("$scratch/build/consumer")
echo "consumer built against igeo $version"

pc=$(dirname "$(find "$prefix" -name igeo.pc)")
if command -v pkg-config >/dev/null; then
    [[ $(PKG_CONFIG_PATH=$pc pkg-config --modversion igeo) == "$version" ]]
    read -ra flags < <(PKG_CONFIG_PATH=$pc pkg-config --cflags --libs igeo)
    "$compiler" -std=c++20 "$source/docs/example/main.cpp" "${flags[@]}" -o "$scratch/example"
    (cd "$source" && LD_LIBRARY_PATH=$(dirname "$pc") "$scratch/example")
else
    echo "no pkg-config here: igeo.pc was not tried"
    skipped=77
fi

program=$prefix/bin/implicit-geodesic
if [[ -e $program ]]; then
    "$program" --version | grep -F "$version"
    share=$prefix/share
    grep -q '^\.TH IMPLICIT-GEODESIC 1' "$share/man/man1/implicit-geodesic.1"
    bash -n "$share/bash-completion/completions/implicit-geodesic"
    grep -q '^#compdef implicit-geodesic' "$share/zsh/site-functions/_implicit-geodesic"
    grep -q '^complete -c implicit-geodesic' "$share/fish/vendor_completions.d/implicit-geodesic.fish"
    cd "$scratch"
    "$program" --sdf "$share/implicit-geodesic/data/sphere.vdb" --seed 0,0,1 -q -o out.vdb
    cmp "$share/implicit-geodesic/schemas/report.schema.json" "$source/docs/report.schema.json"
fi
exit $skipped
