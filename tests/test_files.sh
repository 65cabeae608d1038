#!/bin/sh
# SPDX-License-Identifier: MIT
# test_files.sh GICGEN GICRUN GICSWEEP: what programs write: no link is followed, no input is overwritten, and whatever
# signal ends a program, neither temporary files nor compilers stay behind.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicsweep=$(realpath "$3")
root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=tests/checking.sh
. "$(dirname "$0")/checking.sh"
GICGEN_CACHE=
TMPDIR=$work/tmp
export GICGEN_CACHE TMPDIR
mkdir "$work/tmp" "$work/place"
cd "$work/place" || exit 1
cp "$root/models/pendulum.veh" "$root/models/scenes/pendulum.scene" .

# ---- links under names that could be guessed: of the process, which exec keeps

# followed FILE COMMAND...: is a link that stands where FILE's temporary file might be followed?
followed() {
    file=$1
    shift
    echo mine >"$work/victim"
    sh -c 'file=$1; shift; ln -s "$0" "$file.$$.tmp"; exec "$@"' "$work/victim" "$file" "$@" >"$work/out" 2>"$work/err"
    status=$?
    rm -f ./*.tmp
    [ "$(cat "$work/victim")" != mine ]
}
check "results: no link is followed" eval '! followed out.csv "$gicrun" -q pendulum.veh pendulum.scene -o out.csv'
check "results are written all the same" eval '[ $status -eq 0 ] && [ -s out.csv ]'
check "a picture: no link is followed" eval '! followed out.svg "$gicrun" -q pendulum.veh pendulum.scene --plot out.svg'
check "a picture is drawn all the same" eval '[ $status -eq 0 ] && grep -q "</svg>" out.svg'
check "code: no link is followed" eval '! followed pendulum.c "$gicgen" pendulum.veh -o pendulum.c'
check "code is written all the same" eval '[ $status -eq 0 ] && [ -s pendulum.c ]'
check "files are for whom the mask lets" [ "$(umask 022 && "$gicgen" pendulum.veh -o pendulum.c && stat -c %a pendulum.c)" = 644 ]
ln -s "$work/victim" sweep.csv.journal
check "a journal: no link is followed" eval \
    '! "$gicsweep" -q pendulum.veh pendulum.scene --vary angle=0:1:2 -o sweep.csv 2>"$work/err" && [ "$(cat "$work/victim")" = mine ]'
rm -f sweep.csv.journal

# ---- signals

sed 's/^duration:.*/duration: 1000000/; s/^output_step:.*/output_step: 10/' pendulum.scene >long.scene
rm -f ./*.csv ./*.svg ./*.c ./*.h

# ended SIGNAL: begin a run whose compiler takes a while, send a signal, look at what is left
printf '#!/bin/sh\necho $$ >"%s/compiler"\nexec sleep 60\n' "$work" >slow
chmod +x slow
ended() {
    rm -f "$work/compiler"
    "$gicrun" -q --cc "$PWD/slow" pendulum.veh long.scene -o long.csv >/dev/null 2>"$work/err" &
    run=$!
    for _ in $(seq 200); do
        [ -s "$work/compiler" ] && break
        sleep 0.05
    done
    kill "-$1" $run
    wait $run
    compiler=$(cat "$work/compiler")
    gone=no
    for _ in $(seq 40); do
        state=$(sed 's/.*) \(.\).*/\1/' "/proc/$compiler/stat" 2>/dev/null)
        [ -z "$state" ] || [ "$state" = Z ] && gone=yes && break
        sleep 0.05
    done
    kill -9 "$compiler" 2>/dev/null
    left=$(find . "$TMPDIR" -name '*.tmp' -o -path "$TMPDIR/*")
    echo "left: $left; compiler gone: $gone" >"$work/said"
    [ "$gone" = yes ] && [ -z "$left" ]
}
for signal in TERM ALRM USR1 USR2 PIPE XCPU XFSZ VTALRM; do
    check "$signal: nothing is left behind" ended $signal
    rm -rf ./*.tmp "${TMPDIR:?}"/*
done

# a file larger than the limit: the write fails, and says so
(
    ulimit -f 4
    exec "$gicrun" -q --engine tape pendulum.veh pendulum.scene -o large.csv
) >"$work/out" 2>"$work/err"
status=$?
check "a file larger than the limit is an error" eval '[ $status -eq 1 ] && grep -q "^gicrun: error: can.t write large.csv" "$work/err"'
check "it leaves nothing" [ -z "$(ls ./*.tmp large.csv 2>/dev/null)" ]
(
    ulimit -f 4
    exec "$gicgen" pendulum.veh -o large.c
) >"$work/out" 2>"$work/err"
status=$?
check "code larger than the limit is an error" eval '[ $status -eq 1 ] && grep -q "can.t write" "$work/err"'
check "it leaves nothing either" [ -z "$(ls ./*.tmp large.c 2>/dev/null)" ]
# nobody reads: the program ends as any other, without a word
"$gicrun" -q --engine tape pendulum.veh pendulum.scene 2>"$work/err" | head -n 1 >"$work/out"
check "a reader that goes away" eval '[ ! -s "$work/err" ] && grep -q "^time" "$work/out"'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
