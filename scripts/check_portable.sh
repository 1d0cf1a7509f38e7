#!/usr/bin/env bash
# Compiles the library and the program for systems other than this one: with clang and libc++, and
# with MinGW for Windows. Nothing is linked or run. One line each; the output of those that failed
# follows their line. Ends with 77 where no such compiler is there.
#
# usage: scripts/check_portable.sh [file...]
#   file   a source of src/igeo or apps/implicit-geodesic; all of them if none is given
#
# On Debian: clang libc++-dev (of Debian 13 or later), g++-mingw-w64-x86-64-posix
# libz-mingw-w64-dev. Of the other libraries, headers of this system do. CLANG names another clang++.

set -euo pipefail
cd "$(dirname "$0")/.."

case ${1:-} in
    -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
    -*) echo "check_portable.sh: unknown option $1 (see --help)" >&2; exit 2 ;;
esac

root=$PWD scratch=$(mktemp -d) failed=false ran=false
trap 'rm -rf "$scratch"' EXIT
sources=("$@")
[[ $# -gt 0 ]] || mapfile -t sources < <(find src apps/implicit-geodesic -name '*.cpp' | sort)

mkdir -p "$scratch/igeo/base" "$scratch/headers"
sed 's/@PROJECT_VERSION@/0/' src/igeo/base/version.h.in >"$scratch/igeo/base/version.h"
# As the build makes it.
echo 'constexpr const char* kCommit = "none";' >"$scratch/implicit_geodesic_commit.h"
# Those of the C library must not be found beside them.
for header in openvdb tbb oneapi boost Imath assimp nlohmann CLI fmt xxhash.h png.h pngconf.h pnglibconf.h; do
    ln -s "/usr/include/$header" "$scratch/headers/"
done

# compile <name> <system left out> <compiler and flags...>
compile() {
    local name=$1 other=$2 start=$SECONDS
    shift 2
    ran=true
    printf '%-28s' "$name"
    if (cd "$scratch" && printf "$root/%s\n" "${sources[@]}" | grep -v "_$other.cpp" |
        xargs -P"$(nproc)" -n1 "$@" -std=c++20 -c -Wall -Wextra -Wpedantic -Wshadow -Werror \
            -DIGEO_COMPILER='"none"' -I"$root/src" -iquote "$root/apps/implicit-geodesic" \
            -I"$scratch" -isystem /usr/include/freetype2) >"$scratch/log" 2>&1; then
        echo "ok ($((SECONDS - start)) s)"
    else
        echo "FAILED ($((SECONDS - start)) s)"
        sed 's/^/    /' "$scratch/log"
        failed=true
    fi
}

skip() { printf '%-28sskipped: %s\n' "$1" "$2"; }

clang=(${CLANG:-clang++} -stdlib=libc++)
if "${clang[@]}" -std=c++20 -fsyntax-only -x c++ - 2>/dev/null <<<'
    #include <atomic>
    int i; std::atomic_ref<int> r(i);'; then
    compile "clang, libc++" windows "${clang[@]}"
else
    skip "clang, libc++" "no clang++ with libc++ 19 or later"
fi

mingw=x86_64-w64-mingw32-g++-posix
if command -v $mingw >/dev/null; then
    compile "MinGW" posix $mingw -isystem "$scratch/headers" -Wa,-mbig-obj
else
    skip "MinGW" "no $mingw"
fi

if $failed; then exit 1; fi
$ran || exit 77
