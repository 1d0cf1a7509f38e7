#!/usr/bin/env bash
# From a clean clone to test results: installs what is missing, builds, runs all tests.
#
# usage: scripts/test.sh [ctest options]
#   scripts/test.sh -L unit       the tests of one label: unit accuracy invariance cli
#                                 viewer slurm install slow
#   scripts/test.sh -R trefoil    the tests whose name matches

set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-} in
    -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
esac

scripts/setup.sh
scripts/build.sh release
ctest --preset release -j2 "$@"
