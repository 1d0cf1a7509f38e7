#!/usr/bin/env bash
# Configures and builds one preset into build/<preset>.
#
# usage: scripts/build.sh [release | dev | asan] [target...]
#
# Without targets everything is built, tests included. The program is
# build/<preset>/bin/implicit-geodesic. IGEO_JOBS=<n> sets the number of compilers run at once (one
# per core otherwise); each takes about 1 GB.

set -euo pipefail
cd "$(dirname "$0")/.."

preset=${1:-release}
case $preset in
    -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
    -*) echo "build.sh: unknown option $preset (see --help)" >&2; exit 2 ;;
esac

cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "${IGEO_JOBS:-$(nproc)}" ${2:+--target "${@:2}"}
