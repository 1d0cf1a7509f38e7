#!/usr/bin/env bash
# Everything CI does. Goes through all steps, one line each, and ends with the list of those that
# failed; the output of a failed step follows its line.
#
# usage: scripts/check.sh [--quick] [--tidy] [--fix]
#   --quick   without the sanitizers
#   --tidy    with clang-tidy (minutes)
#   --fix     only format the sources, in place
#
# The tests include the README's commands. scripts/setup.sh --dev installs the tools.

set -euo pipefail
cd "$(dirname "$0")/.."

quick=false tidy=false fix=false
for option in "$@"; do
    case $option in
        --quick) quick=true ;;
        --tidy) tidy=true ;;
        --fix) fix=true ;;
        -h | --help) sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; exit ;;
        *) echo "check.sh: unknown option $option (see --help)" >&2; exit 2 ;;
    esac
done

mapfile -t sources < <(find src apps tests -name '*.h' -o -name '*.cpp' | sort)
if $fix; then
    exec clang-format -i "${sources[@]}"
fi

log=$(mktemp)
trap 'rm -f "$log"' EXIT
failed=()

# step <name> <command...>: prints the name, then "ok" or "FAILED" and the seconds it took.
step() {
    local name=$1 start=$SECONDS
    shift
    printf '%-28s' "$name"
    if "$@" >"$log" 2>&1; then
        echo "ok ($((SECONDS - start)) s)"
    else
        echo "FAILED ($((SECONDS - start)) s)"
        sed 's/^/    /' "$log"
        failed+=("$name")
    fi
}

run_tidy() {
    local units
    # One file at a time, as clang-tidy takes them.
    cmake --preset release -B build/tidy -DIGEO_UNITY=OFF
    cmake --build build/tidy --target implicit_geodesic_commit
    mapfile -t units < <(printf '%s\n' "${sources[@]}" |
        grep '\.cpp$' | grep -v -e tests/install/ -e tests/support/catch_main.cpp)
    printf '%s\0' "${units[@]}" | xargs -0 -n1 -P"$(nproc)" clang-tidy -p build/tidy --quiet
}

step "format" clang-format --dry-run --Werror "${sources[@]}"
step "include arrows" tests/check_includes.sh
step "words" scripts/check_words.py
step "release, -Werror" cmake --preset release -DIGEO_WERROR=ON
step "release build" scripts/build.sh release
step "all tests" ctest --preset release -j2
if $tidy; then
    step "clang-tidy" run_tidy
fi
if ! $quick; then
    step "sanitizer build" scripts/build.sh asan
    step "tests under sanitizers" ctest --preset asan -j2
fi

if [[ ${#failed[@]} -gt 0 ]]; then
    echo "Failed:"
    printf '    %s\n' "${failed[@]}"
    exit 1
fi
