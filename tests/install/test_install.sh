#!/usr/bin/env bash
# Installs a build tree under a temporary prefix, then builds and runs a project that uses it.
#
# usage: test_install.sh <build-dir> <config> <c++-compiler>
set -euo pipefail

build=$1 config=$2 compiler=$3
consumer=$(cd "$(dirname "$0")" && pwd)/consumer
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

cmake --install "$build" --config "$config" --prefix "$scratch/prefix" >"$scratch/install.log"

headers=$scratch/prefix/include/igeo
[[ -f $headers/version.h ]] || { echo "version.h is not installed"; exit 1; }
[[ ! -f $headers/leaf_block.h ]] || { echo "leaf_block.h is private but installed"; exit 1; }

cmake -S "$consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$scratch/prefix" \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$config"
cmake --build "$scratch/build"
version=$("$scratch/build/consumer")
echo "consumer built against igeo $version"

program=$scratch/prefix/bin/implicit-geodesic
if [[ -e $program ]]; then
    "$program" --version | grep -F "$version"
    share=$scratch/prefix/share
    grep -q '^\.TH IMPLICIT-GEODESIC 1' "$share/man/man1/implicit-geodesic.1"
    bash -n "$share/bash-completion/completions/implicit-geodesic"
    grep -q '^#compdef implicit-geodesic' "$share/zsh/site-functions/_implicit-geodesic"
    grep -q '^complete -c implicit-geodesic' "$share/fish/vendor_completions.d/implicit-geodesic.fish"
fi
