#!/usr/bin/env bash
# Whether a program was built and linked as CMakeLists.txt asks for: its code may lie anywhere, its tables
# of addresses are read-only from the start, functions with arrays watch their stack, and calls of the C
# library that know the size of their target check it.
#
# usage: test_hardening.sh <program>
set -euo pipefail
command -v readelf >/dev/null || exit 77
program=$1

check() {  # <what> <readelf option> <pattern>
    # Into a variable: grep -q would end readelf early, which pipefail takes for a failure.
    local message
    message=$(readelf --wide "$2" "$program")
    if ! grep -qE "$3" <<<"$message"; then
        echo "$program: not so: $1"
        failed=1
    fi
}
failed=0
check "position independent" --file-header 'Type: +DYN'
check "RELRO" --program-headers 'GNU_RELRO'
check "bound at the start" --dynamic 'BIND_NOW|FLAGS.*NOW'
check "stack protector" --dyn-syms '__stack_chk_fail'
check "fortified" --dyn-syms '_chk@'
exit $failed
