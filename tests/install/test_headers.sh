#!/usr/bin/env bash
# Compiles each public header by itself; those of base, band, march and path must get by without
# OpenVDB.
#
# usage: test_headers.sh <compiler> <option>...

set -euo pipefail
cd "$(dirname "$0")/../../src"

compiler=("$@")
mapfile -t headers < <(find igeo -name '*.h' -not -path '*/detail/*' | LC_ALL=C sort)
[[ ${#headers[@]} -gt 50 ]] || { echo "only ${#headers[@]} headers are there" >&2; exit 1; }

check() {
    local header=$1
    shift
    local needed
    if ! needed=$(echo "#include <$header>" | "$@" -I. -std=c++20 -fsyntax-only -MD -MF /dev/stdout \
        -x c++ - 2>&1); then
        printf '%s does not compile alone:\n%s\n' "$header" "$needed"
        return 1
    fi
    case $header in
        igeo/base/* | igeo/band/* | igeo/march/* | igeo/path/*)
            if grep -q '/openvdb/' <<<"$needed"; then
                echo "$header includes OpenVDB"
                return 1
            fi
            ;;
    esac
}
export -f check

printf '%s\0' "${headers[@]}" |
    xargs -0 -P "$(nproc)" -I{} bash -c 'check "$@"' check {} "${compiler[@]}"
echo "${#headers[@]} headers compile alone"
