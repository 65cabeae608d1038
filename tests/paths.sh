# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# paths.sh: finds the programs that a script wants; to be sourced, with $build set. A script's first line of comment
# names them in capitals: `# test_dump.sh GICGEN COMPARE_DUMP: ...` is called with the paths of gicgen and compare_dump.

# paths SCRIPT: of its programs, which are ours or the tests'
# shellcheck disable=SC2154  # $build is set by who sources this
paths() {
    for program in $(sed -n "s/^# $(basename "$1")\([A-Z0-9_ ]*\):.*/\1/p" "$1" | tr '[:upper:]' '[:lower:]'); do
        if [ -x "$build/$program" ]; then echo "$build/$program"; else echo "$build/check/$program"; fi
    done
}
