#!/usr/bin/env bash
# Runs the commands of README.md and docs/*.md that are marked as tests: a block fenced with
# ```bash on the line after <!-- test -->. They run in order, in one shell, in a copy of the
# repository, with the built program in PATH. A bash block that calls implicit-geodesic is either
# such a test or follows <!-- not run: REASON -->. A block fenced with ```text between such a test and
# the next block has lines that the test prints, in this order; "..." stands for any number of others.
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
function closed() { if (inside) broken("the block before has no end"); marked = excused = ended = 0 }
FNR == 1 && NR > 1 { closed() }
inside && /^```/ {
    if (inside == "test") { print "ends"; ended = 1 }
    if (inside == "shown") print "END_OF_BLOCK"
    inside = 0
    next
}
inside == "test" || inside == "shown" { print; next }
inside == "bash" && /implicit-geodesic( |$)/ {
    broken("a call of implicit-geodesic that is neither <!-- test --> nor <!-- not run: REASON -->")
}
inside           { next }
marked           {
    if ($0 !~ /^```bash[ \t]*$/) broken("<!-- test --> is not followed by a ```bash block")
    printf "cd \"%s\"\nbegins %s:%d\n", copy, FILENAME, FNR
    inside = "test"; marked = 0; ++blocks
    next
}
ended && /^```text[ \t]*$/ {
    printf "shows %s:%d <<\"END_OF_BLOCK\"\n", FILENAME, FNR
    inside = "shown"; ended = 0
    next
}
/^```/ {
    ended = 0
    inside = /^```(bash|sh|console)?[ \t]*$/ && !excused ? "bash" : "other"
    excused = 0
    next
}
{ excused = 0 }
/^<!-- test -->[ \t]*$/ { marked = 1 }
/^<!-- not run: .+ -->[ \t]*$/ { excused = 1 }
END {
    if (error) exit 1
    if (inside) broken("the last block has no end")
    if (!blocks) { print "no block is marked <!-- test -->" > "/dev/stderr"; exit 1 }
}' "${pages[@]}" >"$scratch/blocks.sh"

cat - "$scratch/blocks.sh" >"$scratch/commands.sh" <<END
said=$scratch/said told=1
exec 3>&1
trap '((told)) || cat "\$said" >&3' EXIT
begins() { echo "== \$1" >&3; told=0; exec >"\$said" 2>&1; }
ends() { cat "\$said" >&3; told=1; }
shows() {
    awk -v block="\$1" '
        NR == FNR { if (\$0 != "...") lines[++count] = \$0; next }
        found < count && \$0 == lines[found + 1] { ++found }
        END { if (found < count) { print block ": not printed: " lines[found + 1]; exit 1 } }
    ' - "\$said" >&3
}
END

tar --exclude=./build --exclude=./out --exclude=./.git -cf - . | tar -xf - -C "$scratch/copy"
mkdir "$scratch/copy/build"
ln -s "$build" "$scratch/copy/build/release"

# model.obj stands for a mesh of the reader's own: a ball through the point they start from.
vdb_tool -quiet -sphere dim=64 radius=0.374166 -ls2mesh -write "$scratch/copy/model.obj"

PATH=$build/bin:$PATH bash -euo pipefail "$scratch/commands.sh" </dev/null

cd "$scratch/copy"
for document in out/*.json; do
    kind=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["type"])' "$document")
    echo "== $document: docs/$kind.schema.json" >&2
    /usr/bin/python3 tests/cli/validate_json.py "docs/$kind.schema.json" "$document"  # 77: cannot
done
