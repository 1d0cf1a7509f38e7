#!/usr/bin/env bash
# Builds program and library for /usr, without the tests, and packs them: .deb (on Debian) and .tar.gz
# in build/package/packages.
#
# usage: scripts/packaging/make_packages.sh
#
# IGEO_JOBS=<n> sets the number of compilers run at once, as for scripts/build.sh.

set -euo pipefail
cd "$(dirname "$0")/../.."

case ${1:-} in
    -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
esac

cmake --preset release -B build/package -DIGEO_BUILD_TESTS=OFF -DCMAKE_INSTALL_PREFIX=/usr
cmake --build build/package --parallel "${IGEO_JOBS:-$(nproc)}"
rm -rf build/package/packages
cpack --config build/package/CPackConfig.cmake
