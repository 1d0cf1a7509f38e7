#!/usr/bin/env bash
# Packs a build tree with cpack, looks into the packages and has lintian judge those of Debian.
#
# usage: test_packages.sh <build-dir> <config>
set -euo pipefail
build=$(cd "$1" && pwd) config=$2
for tool in dpkg-shlibdeps lintian; do
    command -v $tool >/dev/null || { echo "no $tool here"; exit 77; }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
umask 077  # the packages must not inherit it

cpack --config "$build/CPackConfig.cmake" -C "$config" -B "$scratch" >"$scratch/cpack.log" 2>&1 || {
    cat "$scratch/cpack.log"
    exit 1
}
cd "$scratch"

failed=0
complain() { echo "$1"; failed=1; }
# holds <listing> <pattern>...: whether each is in it.
holds() {
    local listing=$1
    for pattern in "${@:2}"; do
        grep -qE -- "$pattern" "$listing" || complain "$listing: no $pattern"
    done
}
for package in implicit-geodesic libigeo-dev; do
    dpkg-deb --contents ${package}_*.deb >$package.contents
    tar -tzf $package-*.tar.gz >$package.archive
    dpkg-deb --field ${package}_*.deb Depends >$package.depends
done
holds implicit-geodesic.contents 'root/root .*/bin/implicit-geodesic$' /man1/implicit-geodesic.1.gz \
    /bash-completion/completions/implicit-geodesic /schemas/report.schema.json /data/sphere.vdb /copyright
holds implicit-geodesic.archive '^implicit-geodesic-[^/]*/bin/implicit-geodesic$' /LICENSE /data/torus_seeds.csv
holds implicit-geodesic.depends libopenvdb libtbb libassimp libpng libfmt
holds libigeo-dev.contents /libigeo.a /igeoConfig.cmake /pkgconfig/igeo.pc /include/igeo/base/version.h /copyright
holds libigeo-dev.archive '^implicit-geodesic-[^/]*/include/igeo/base/version.h$' /LICENSE
holds libigeo-dev.depends libopenvdb-dev libtbb-dev libboost-iostreams-dev zlib1g-dev libpng-dev libassimp-dev libfmt-dev
! grep -qE '/include/|\.a$' implicit-geodesic.contents || complain "implicit-geodesic has files of the library"
! grep -qE '/bin/' libigeo-dev.contents || complain "libigeo-dev has files of the program"

# Where igeo.pc lies is right only in a build tree for /usr, such as that of make_packages.sh.
lintian --allow-root --fail-on error,warning --tag-display-limit 0 \
    --suppress-tags pkg-config-unavailable-for-cross-compilation ./*.deb || failed=1
exit $failed
