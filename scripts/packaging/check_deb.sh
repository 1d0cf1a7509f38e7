#!/usr/bin/env bash
# Installs the .deb files that make_packages.sh made into a bare Debian without a compiler, and runs there
# the first command of README.md that is a test, on the example data that the package brings.
#
# usage: scripts/packaging/check_deb.sh RELEASE [--library]
#   RELEASE     bookworm or trixie: the one on which the packages were made
#   --library   then also installs libigeo-dev and a compiler, and builds docs/example
#
# Needs root, debootstrap and a network; ends with 77 without the first two.

set -euo pipefail
cd "$(dirname "$0")/../.."

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
case ${1:-} in
    -h | --help) usage; exit ;;
    bookworm | trixie) release=$1 ;;
    *) usage >&2; exit 2 ;;
esac
if [[ $EUID -ne 0 ]] || ! command -v debootstrap >/dev/null; then
    echo "check_deb.sh: needs root and debootstrap; nothing was checked" >&2
    exit 77
fi
packages=build/package/packages
compgen -G "$packages/*.deb" >/dev/null || {
    echo "check_deb.sh: no package in $packages; scripts/packaging/make_packages.sh makes them" >&2
    exit 1
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
root=$scratch/root
# quietly <command...>: shows what it prints only if it fails.
quietly() { "$@" >"$scratch/log" 2>&1 || { cat "$scratch/log"; exit 1; }; }
inside() { chroot "$root" env LC_ALL=C DEBIAN_FRONTEND=noninteractive PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
add() { quietly inside apt-get install -y --no-install-recommends "$@"; }

quietly debootstrap --variant=minbase "$release" "$root"
cp -r $packages/*.deb docs/example "$root"

deb() { (cd "$root" && echo ./"$1"_*.deb); }
add "$(deb implicit-geodesic)"
if inside sh -c 'command -v c++ || command -v gcc || command -v cc'; then
    echo "check_deb.sh: the bare system has a compiler"
    exit 1
fi

# The first block of README.md that is a test, and below it the messages that it prints.
mkdir "$root/try"
inside ln -s /usr/share/implicit-geodesic/data /try/data
block() { sed '1,/^<!-- test -->/d' README.md | sed "0,/^\`\`\`$1/d; /^\`\`\`\$/,\$d"; }
block bash >"$root/try/command.sh"
block text >"$scratch/expected"
inside sh -c 'cd /try && sh -e command.sh' 2>"$scratch/messages"
diff "$scratch/expected" "$scratch/messages"
echo "$release: the program is installed and prints what README.md says"

if [[ ${2:-} == --library ]]; then
    add "$(deb libigeo-dev)" g++ cmake make
    quietly inside sh -ec 'cmake -S /example -B /try/build; cmake --build /try/build; cd /try; build/example'
    tail -1 "$scratch/log"
    echo "$release: docs/example is built with libigeo-dev"
fi
