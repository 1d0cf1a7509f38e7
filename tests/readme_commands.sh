#!/usr/bin/env bash
# Runs the commands of README.md and docs/*.md that are marked as tests: a block fenced with
# ```bash on the line after <!-- test -->. They run in order, in one shell, in a copy of the
# repository, with the built program in PATH.
#
# usage: tests/readme_commands.sh [build-dir]

set -euo pipefail
cd "$(dirname "$0")/.."

build=$(cd "${1:-build/release}" && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/copy"

pages=(README.md)
for page in docs/*.md; do
    [[ ! -e $page ]] || pages+=("$page")
done

awk -v copy="$scratch/copy" '
function broken(what) { print FILENAME ":" FNR ": " what > "/dev/stderr"; error = 1; exit 1 }
FNR == 1         { if (inside) broken("the block before has no end"); marked = 0 }
inside && /^```/ { inside = 0; next }
inside           { print; next }
marked           {
    if ($0 !~ /^```bash[ \t]*$/) broken("<!-- test --> is not followed by a ```bash block")
    printf "cd \"%s\"\necho \"== %s:%d\" >&2\n", copy, FILENAME, FNR
    inside = 1; marked = 0; ++blocks
    next
}
/^<!-- test -->[ \t]*$/ { marked = 1 }
END {
    if (error) exit 1
    if (inside) broken("the last block has no end")
    if (!blocks) { print "no block is marked <!-- test -->" > "/dev/stderr"; exit 1 }
}' "${pages[@]}" >"$scratch/commands.sh"

tar --exclude=./build --exclude=./out --exclude=./.git -cf - . | tar -xf - -C "$scratch/copy"
mkdir "$scratch/copy/build"
ln -s "$build" "$scratch/copy/build/release"

PATH=$build/bin:$PATH bash -euo pipefail "$scratch/commands.sh" </dev/null
