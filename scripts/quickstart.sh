#!/usr/bin/env bash
# From a fresh clone to geodesics on the Stanford bunny:
#   bash scripts/quickstart.sh               the bunny, from npm or from Debian's package of CGAL
#   bash scripts/quickstart.sh model.obj     a closed mesh of your own (obj, ply, stl)
# Set SEED and TARGET (x,y,z) to choose the points, BUNNY=npm or BUNNY=debian to choose the source.
# Everything made goes to out/; run again, it only does what is missing.
set -euo pipefail
callerDir=$PWD
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { echo "quickstart: $*" >&2; }

# The bunny of the npm package `bunny`: 1839 vertices, closed, 36 kB to download.
bunnyFromNpm() {
    command -v npm >/dev/null || return 1
    mkdir -p out/npm
    npm_config_cache=$PWD/out/npm/cache npm_config_update_notifier=false \
        npm pack --silent bunny@1.0.1 --pack-destination out/npm >/dev/null 2>&1 || return 1
    tar -xzf out/npm/bunny-1.0.1.tgz -C out/npm || return 1
    python3 scripts/mesh_tool.py to-obj out/npm/package/index.js out/bunny.obj
}

# The bunny among the sample meshes of CGAL: 37706 vertices, closed, 24 MB to download.
bunnyFromDebian() {
    local archive=usr/share/doc/libcgal-dev/data.tar.gz mesh=data/meshes/bunny00.off
    mkdir -p out/cgal
    (cd out/cgal && apt-get -qq -o APT::Sandbox::User=root download libcgal-demo >/dev/null 2>&1) ||
        return 1
    dpkg-deb -x out/cgal/libcgal-demo_*.deb out/cgal || return 1
    tar -xzf "out/cgal/$archive" -C out/cgal "$mesh" || return 1
    python3 scripts/mesh_tool.py to-obj "out/cgal/$mesh" out/bunny.obj
}

getBunny() {
    [ -s out/bunny.obj ] && [ ! -e out/bunny.source ] && return
    rm -f out/bunny.source
    case ${BUNNY:-any} in
        npm) bunnyFromNpm ;;
        debian) bunnyFromDebian ;;
        any) bunnyFromNpm || bunnyFromDebian ;;
        *) say "error: BUNNY=$BUNNY should be npm or debian"; exit 2 ;;
    esac
}

# levelSet NAME: out/NAME.obj -> out/NAME.vdb, 256 voxels along the longest side
levelSet() {
    [ "out/$1.vdb" -nt "out/$1.obj" ] && return
    vdb_tool -quiet -read "out/$1.obj" -mesh2ls dim=256 width=3 name=psi -write "out/$1.part.vdb"
    mv "out/$1.part.vdb" "out/$1.vdb"
}

# extreme X,Y,Z: the mesh's vertex farthest in that direction
extreme() { python3 scripts/mesh_tool.py farthest "out/$name.obj" "$1"; }

if [ $# -gt 1 ]; then
    say "usage: bash scripts/quickstart.sh [model.obj|.ply|.stl]"
    exit 2
fi
mesh=${1:-}
if [ -n "$mesh" ]; then
    case $mesh in /*) ;; *) mesh=$callerDir/$mesh ;; esac
    [ -r "$mesh" ] || { say "error: cannot read $mesh"; exit 3; }
fi

bash scripts/setup.sh
bash scripts/build.sh release implicit-geodesic
[ -f data/trefoil.vdb ] || bash scripts/make_data.sh
mkdir -p out

if [ -n "$mesh" ]; then
    name=$(basename "${mesh%.*}")
    # Another model may have the same name.
    if [ ! "out/$name.obj" -nt "$mesh" ] || [ "$(cat "out/$name.source" 2>/dev/null)" != "$mesh" ]; then
        say "reading $mesh"
        # The source is named last: what was cut short is read again.
        rm -f "out/$name.source"
        vdb_tool -quiet -read "$mesh" -write "out/$name.part.obj"
        mv "out/$name.part.obj" "out/$name.obj"
        printf '%s\n' "$mesh" >"out/$name.source"
    fi
elif getBunny; then
    name=bunny
else
    say "no bunny: neither the npm registry nor the Debian archive answered; taking data/trefoil.vdb"
    name=trefoil
fi

if [ "$name" = trefoil ] && [ -z "$mesh" ]; then
    # Where the knot is farthest from its axis: 0.3 * 3 + 0.12 from the origin.
    surface=data/trefoil.vdb
    seed=0,-1.02,0
    targets=(0.883346,0.51,0 -0.883346,0.51,0)
    camera=0,-2,3
else
    levelSet "$name"
    surface=out/$name.vdb
    # On the bunny, which looks along -x with y upwards: tip of an ear; tail and toes.
    seed=$(extreme 0,1,0)
    targets=("$(extreme 1,-0.6,0.8)" "$(extreme -1,-2,1)")
    camera=$(python3 scripts/mesh_tool.py camera "out/$name.obj" -0.13,0.22,1)
fi
picture=()
[ "$name" != bunny ] || picture=(--camera="$camera" --image-size 1280x900)
seed=${SEED:-$seed}
[ -z "${TARGET:-}" ] || targets=("$TARGET")

targetOptions=()
for target in "${targets[@]}"; do targetOptions+=(--target "$target"); done
program=build/release/bin/implicit-geodesic
page=()
"$program" --version | grep -q "^no three.js" || page=(--view "out/$name.html")
command=("$program" --sdf "$surface" --seed "$seed" "${targetOptions[@]}"
    -o "out/${name}_geodesic.vdb" --grids surface,color,engraved --paths "out/${name}_paths.json"
    --report "out/${name}_report.json" --image "out/$name.png" "${picture[@]}" "${page[@]}")
say "${command[*]}"
"${command[@]}"

pageLine=""
[ ${#page[@]} -eq 0 ] || pageLine="
  out/${name}.html           a page to turn, zoom and read: open it in a browser"
cat >&2 <<END

The distance from $seed on $surface, and the shortest paths to it:
  out/${name}.png            a picture$pageLine
  out/${name}_geodesic.vdb   grids psi, psi_geodesic, its colors, and psi with isolines and paths cut into it
  out/${name}_paths.json     the paths, vertex by vertex
  out/${name}_report.json    what was computed, and with which parameters
To look at them:
  vdb_view out/${name}_geodesic.vdb     key 2: surfaces; right arrow: the next grid; mouse: turn, zoom
  vdb_print -l out/${name}_geodesic.vdb
  vdb_render out/${name}_geodesic.vdb out/${name}_render.png -name psi -color psi_geodesic_color \\
      -translate $camera -focal 60 -res 960x720
END
