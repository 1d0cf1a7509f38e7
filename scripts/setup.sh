#!/usr/bin/env bash
# Installs what the build and the tests need, from Debian's own packages.
#
# usage: scripts/setup.sh [--dev] [--viewer] [--slurm]
#   --dev      also what scripts/check.sh needs: clang, clang-format, clang-tidy, lintian, valgrind
#   --viewer   also what the tests labeled viewer need: an X server without a screen, OpenGL; and those of the
#              pages of --view: Chromium
#   --slurm    also what the test labeled slurm needs: Slurm and MUNGE, run without a service
#
# Uses sudo unless root. Does and prints nothing when everything is there.

set -euo pipefail
cd "$(dirname "$0")/.."

packages=(
    g++ cmake ninja-build ccache
    libopenvdb-dev libtbb-dev
    libboost-iostreams-dev  # FindOpenVDB.cmake asks for it, libopenvdb-dev does not
    zlib1g-dev libpng-dev libfreetype-dev libassimp-dev libfmt-dev libxxhash-dev
    nlohmann-json3-dev libcli11-dev catch2
    libjs-three                        # draws the pages of --view; packed into the program
    libopenvdb-tools python3-openvdb   # vdb_tool, vdb_print, vdb_render, pyopenvdb: for the tests
    python3 python3-jsonschema         # the tests check reports against their schema
    groff-base                         # and that the manual page is one
    zsh fish                           # and what the completions offer
    parallel                           # and batches in shards
    pkg-config python3-yaml            # and what is installed or packed
    pybind11-dev python3-dev python3-numpy python3-setuptools python3-wheel python3-pip python3-venv
    python3-pytest mypy python3-matplotlib   # the Python package and its tests
    dpkg-dev file                      # cpack makes the dependencies of a .deb with them
    ca-certificates
)
dev_packages=(clang clang-format clang-tidy libclang-rt-dev lintian valgrind)
viewer_packages=(xvfb xdotool libgl1-mesa-dri chromium chromium-driver python3-selenium)
slurm_packages=(slurmctld slurmd slurm-client munge)

for option in "$@"; do
    case $option in
        --dev) packages+=("${dev_packages[@]}") ;;
        --viewer) packages+=("${viewer_packages[@]}") ;;
        --slurm) packages+=("${slurm_packages[@]}") ;;
        -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
        *) echo "setup.sh: unknown option $option (see --help)" >&2; exit 2 ;;
    esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    # The libraries are CMake's to look for: it names each one it misses.
    missing=()
    for tool in c++ cmake ninja python3; do
        command -v "$tool" >/dev/null || missing+=("$tool")
    done
    [[ ${#missing[@]} -gt 0 ]] || exit 0
    {
        echo "setup.sh: not a Debian system, and these tools are missing: ${missing[*]}"
        echo "Please install what these Debian packages hold: ${packages[*]}"
    } >&2
    exit 1
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${db:Status-Status}\n' "$package" 2>/dev/null || true)
    grep -qx installed <<<"$status" || missing+=("$package")
done
[[ ${#missing[@]} -gt 0 ]] || exit 0

as_root=()
if [[ $EUID -ne 0 ]]; then
    if ! command -v sudo >/dev/null; then
        {
            echo "setup.sh: missing packages, and neither root nor sudo to install them. As root, run:"
            echo "apt-get install --no-install-recommends ${missing[*]}"
        } >&2
        exit 1
    fi
    as_root=(sudo)
fi

echo "Installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install -q -y --no-install-recommends "${missing[@]}"
