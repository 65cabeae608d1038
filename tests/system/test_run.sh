#!/bin/sh
# SPDX-License-Identifier: MIT
# test_run.sh: how tests are run (in_parallel.py), on tests that only pretend: all at once on as many processors as it is
# told, longest first, each with folders of its own; what counts as a failure; what an interrupt leaves: nothing. And the
# lists of tests name tests that there are.
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
mkdir -p "$work/tests/system" "$work/build/check" "$work/tmp"
cp "$root/tests/in_parallel.py" "$root/tests/paths.sh" "$work/tests/"
runner=$work/tests/in_parallel.py
TMPDIR=$work/tmp
export TMPDIR
# pretend NAME LINE...: a test
pretend() {
    name=$1
    shift
    printf '# %s.sh: a pretence\n' "$name" >"$work/tests/system/$name.sh"
    printf '%s\n' "$@" >>"$work/tests/system/$name.sh"
}
# tests JOBS NAME...: into out and err
tests() {
    jobs=$1
    shift
    python3 "$runner" --jobs "$jobs" "$work/build" "$@" >"$work/out" 2>"$work/err"
    status=$?
}
last() { [ "$(tail -n 1 "$work/out")" = "$1" ]; }
clean() { [ -z "$(ls -A "$work/tmp")" ]; }

pretend test_good 'echo "3 passed, 0 failed"'
tests 2 test_good
check 'a test that passes' exits 0
check 'is counted' last '3 passed, 0 failed'
check 'its time is kept' grep -q '^test_good [0-9.]*$' "$work/build/test_seconds"
pretend test_bad 'echo "what is wrong"' 'echo "3 passed, 2 failed"' 'exit 1'
pretend test_fallen 'echo "5 passed, 0 failed"' 'exit 7'
pretend test_mute 'true'
# shellcheck disable=SC2016  # $$ of the test
pretend test_killed 'kill -SEGV $$'
tests 2 test_good test_bad test_fallen test_mute test_killed
check 'a test that fails' exits 1
check 'failures are counted: those told, an exit status, silence, a signal' last '11 passed, 5 failed'
check 'the whole log of a failed test is shown' prints '^what is wrong$'
check 'the failed ones are named' prints '^failed:.* test_bad'
check 'a signal is named' prints 'test_killed .*SIGSEGV'
check 'no file is left' clean
printf '#!/bin/sh\necho "[       OK ] one"; echo "[       OK ] two"; echo "[  FAILED  ] three"; exit 1\n' >"$work/build/check/test_program"
chmod +x "$work/build/check/test_program"
tests 1 test_program
check 'programs are counted by what cmocka prints' last '2 passed, 1 failed'
tests 1 test_nowhere
check 'an unknown test' exits 2
check 'is named' says 'no test test_nowhere'

# two wait for each other, which ends well only where both run at once
meet='touch "$M/$0.here"; i=0; while [ "$(ls "$M" | grep -c here)" -lt 2 ]; do sleep 0.1; i=$((i + 1)); [ $i -lt 600 ] || exit 1; done'
meet=$(echo "$meet" | sed "s|\$M|$work/meet|g; s|\$0|\$(basename \"\$0\")|")
mkdir "$work/meet"
pretend test_one "$meet" 'echo "1 passed, 0 failed"'
pretend test_two "$meet" 'echo "1 passed, 0 failed"'
tests 2 test_one test_two
check 'two tests run at once' last '2 passed, 0 failed'
# folders of one's own, which are there and empty; a process that is left behind goes
for name in a b; do
    pretend test_own_$name "echo \$TMPDIR \$GICGEN_CACHE >>$work/folders" '[ -z "$(ls -A "$TMPDIR" "$GICGEN_CACHE" | grep -v :)" ] || exit 1' \
        "sleep 1000 & echo \$! >>$work/left" 'echo "1 passed, 0 failed"'
done
tests 1 test_own_a test_own_b
check 'folders are empty' last '2 passed, 0 failed'
check 'a folder for each, and one cache for all' [ "$(tr ' ' '\n' <"$work/folders" | sort -u | wc -l)" -eq 3 ]
# gone PID...: ended, or a zombie that nobody has asked for yet
gone() {
    for pid; do
        [ ! -e "/proc/$pid/stat" ] || grep -q ') Z ' "/proc/$pid/stat" || return 1
    done
}
# shellcheck disable=SC2046  # numbers
check 'processes that a test leaves behind are ended' gone $(cat "$work/left")
# the longest first
printf 'test_short 1\ntest_middle 20\ntest_long 300\n' >"$work/build/test_seconds"
for name in short middle long; do pretend test_$name 'echo "1 passed, 0 failed"'; done
tests 1 test_middle test_short test_long
check 'the longest first' [ "$(sed -n 's/^\[.*\] test_\([a-z]*\) .*/\1/p' "$work/out" | tr '\n' ' ')" = 'long middle short ' ]
check 'progress is told' prints '^\[  1/3\] test_long .*left)$'

# Ctrl-C
pretend test_endless "echo \$\$ >$work/pid" 'sleep 1000 &' "echo \$! >>$work/pid" 'timeout 1000 sleep 1000'
rm -f "$work/pid"
for signal in INT TERM; do
    setsid python3 "$runner" --jobs 1 "$work/build" test_endless >"$work/out" 2>"$work/err" &
    child=$!
    until [ -s "$work/pid" ] && [ "$(wc -l <"$work/pid")" -eq 2 ]; do sleep 0.1; done
    # a shell without job control lets its children ignore SIGINT, but not what sets a handler
    kill -$signal $child
    wait $child
    status=$?
    check "SIG$signal ends it" [ $status -gt 128 ]
    # shellcheck disable=SC2046  # numbers
    check "SIG$signal ends tests and what they started" gone $(cat "$work/pid")
    check "SIG$signal leaves no file" clean
    rm -f "$work/pid"
done

# ---- the lists

for name in $(sed -n 's/^\(test_[a-z0-9_]*\) .*/\1/p' "$root/tests/quick.txt"); do
    check "$name of quick.txt is there" [ -f "$root/tests/system/$name.sh" ]
done
check 'every line of quick.txt says what for' sh -c "! grep -qE '^test_[a-z0-9_]* *\$' '$root/tests/quick.txt'"
# test_NAME_fast and test_NAME_float are variants
for name in $(sed -n 's/^\(test_[a-z0-9_]*\) .*/\1/p' "$root/tests/seconds.txt"); do
    plain=${name%_fast}
    check "$name of seconds.txt is there" [ -f "$root/tests/system/$name.sh" -o -f "$root/tests/unit/${plain%_float}.c" ]
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
