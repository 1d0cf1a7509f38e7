#!/usr/bin/env bash
# From a clean clone to test results: installs what is missing, builds, runs all tests.
#
# usage: scripts/test.sh [ctest options]
#   scripts/test.sh -L unit       the tests of one label: unit accuracy invariance cli
#                                 python viewer slurm install slow
#   scripts/test.sh -R trefoil    the tests whose name matches

set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-} in
    -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
esac

scripts/setup.sh
# The Python package is no part of what users build by default.
if pkg-config --exists pybind11; then
    cmake --preset release -DIGEO_PYTHON=ON
fi
scripts/build.sh release
ctest --preset release -j2 "$@"
