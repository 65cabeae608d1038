#!/bin/sh
# SPDX-License-Identifier: MIT
# test_stress.sh: the frame of `make stress` notices every kind of finding; and the short version of all attacks.
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
frame=$(dirname "$0")/../stress/run.sh

# attack NAME TEXT...: an attack in the folder of attacks
attack() {
    printf '# %s.sh: a pretence\n' "$1" >"$work/attacks/$1.sh"
    name=$1
    shift
    printf '%s\n' "$@" >>"$work/attacks/$name.sh"
}
# pretend NAME TEXT: what it prints, with its verdict, and whether the frame takes that for a finding
pretend() {
    ATTACKS=$work/attacks BUILD=$work STRESS=short LIMIT=2 sh "$frame" "$@" >"$work/out" 2>&1
    status=$?
}
finds() { [ $status -eq 1 ] && grep -q "$1" "$work/out" && grep -q "$1" "$work/stress/table.md"; }
mkdir "$work/attacks"
attack sound 'echo "sound | car | 3 | 2 | 1 | 1e-13 m | ok"' 'echo "sound | van | 3 | 3 | 0 | nancy | ok: with a remark"'
pretend sound
check "nothing to find" [ $status -eq 0 ]
check "rows are counted" grep -q '^2 rows, 0 findings' "$work/out"
attack wrong 'echo "wrong | car | 3 | 3 | 0 | 1 m | off by a metre"' 'exit 1'
pretend sound wrong
check "a verdict" finds 'off by a metre'
check "one finding" grep -q '^3 rows, 1 findings' "$work/out"
attack lost 'echo "lost | car | 3 | 1 | 1 | 0 | ok"'
pretend lost
check "a result is lost" finds 'lost: tried 3, accounted for 2'
attack nan 'echo "nan | car | 3 | 3 | 0 | -nan m | ok"'
pretend nan
check "not a number" finds 'not a number: -nan m'
attack columns 'echo "columns | car | 3 | 3 | 0 | ok"'
pretend columns
check "a column is missing" finds 'a row of 6 columns'
attack counts 'echo "counts | car | all | 3 | 0 | 0 | ok"'
pretend counts
check "counts are numbers" finds 'counts that are none'
attack silent true
pretend silent
check "no rows" finds 'no rows'
# shellcheck disable=SC2016  # $$ of the attack
attack crash 'echo "crash | car | 1 | 1 | 0 | 0 | ok"' 'echo "about to fall" >&2' 'kill -SEGV $$'
pretend crash
check "a crash" finds 'exit status 139: .*about to fall'
attack hang 'echo "hang | car | 1 | 1 | 0 | 0 | ok"' 'sleep 60'
pretend hang
check "a hang" finds 'takes longer than 2 s'

make -C "$(dirname "$0")/../.." --no-print-directory -s -j2 WERROR=-Werror BUILD="$(realpath "${BUILD:-build}")" fuzz \
    >"$work/out" 2>&1
check "make fuzz" [ $? -eq 0 ]
STRESS=short sh "$frame" >"$work/out" 2>&1
check "attacks find nothing" [ $? -eq 0 ]
grep '^\[\|^ ' "$work/out"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
