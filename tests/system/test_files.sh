#!/bin/sh
# SPDX-License-Identifier: MIT
# test_files.sh GICGEN GICRUN GICSWEEP: what programs write: no link is followed, no input is overwritten, and whatever
# signal ends a program, neither temporary files nor compilers stay behind.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicsweep=$(realpath "$3")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
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

# ---- outputs over inputs

mkdir parts
sed -n '/^gicgen/p; /^bodies/,$p' pendulum.veh >parts/rod.veh
sed '/^bodies/,$d' pendulum.veh >whole.veh
echo 'include: parts/rod.veh' >>whole.veh
printf '%s\n' 'angle,angle.rate' '1,0' >states.csv
printf '%s\n' 'x,height' '0,0' '1,0' >road.csv
sed '/^road/d' pendulum.scene >rough.scene
echo 'road: {type: table, file: road.csv}' >>rough.scene
ln whole.veh linked.csv
# kept FILE COMMAND...: refused, and FILE is as it was
kept() {
    file=$1
    shift
    cp "$file" "$work/before"
    "$@" >"$work/out" 2>"$work/err"
    [ $? -eq 1 ] && cmp -s "$file" "$work/before" && grep -q "error: this input would be overwritten by the output" "$work/err"
}
check "results over the scene" kept rough.scene "$gicrun" -q whole.veh rough.scene -o rough.scene
check "results over the model" kept whole.veh "$gicrun" -q whole.veh rough.scene -o whole.veh
check "results over the model by another name" kept whole.veh "$gicrun" -q whole.veh rough.scene -o linked.csv
check "results over an included file" kept parts/rod.veh "$gicrun" -q whole.veh rough.scene -o ./parts/../parts/rod.veh
check "results over the road" kept road.csv "$gicrun" -q whole.veh rough.scene -o road.csv
check "evaluations over the states" kept states.csv "$gicrun" -q --eval states.csv whole.veh -o states.csv
cp whole.veh whole.c
check "code over the model" kept whole.c "$gicgen" whole.c -o whole.c
cp whole.veh whole.h
check "a header over the model" kept whole.h "$gicgen" whole.h -o whole.c
check "a sweep over the road" kept road.csv "$gicsweep" -q whole.veh rough.scene --vary angle=0:1:2 -o road.csv

# ---- two outputs of one name

# alone OPTION FILE NAME: -o FILE and OPTION NAME, another name of FILE, are refused, and nothing is written
alone() {
    "$gicrun" -q --engine tape pendulum.veh pendulum.scene -o "$2" "$1" "$3" >"$work/out" 2>"$work/err"
    [ $? -eq 2 ] && [ ! -s "$2" ] && grep -q "error: $1 needs another file than the results, which go to '$2'" "$work/err"
}
check "a picture in the place of the results" alone --plot both.svg both.svg
check "a page in the place of the results" alone --animate both.html ./parts/../both.html
: >there.html && ln there.html same.html
check "a page in the place of results that are there" alone --animate there.html same.html
check "a picture beside the results" eval \
    '"$gicrun" -q --engine tape pendulum.veh pendulum.scene -o parts/both.svg --plot both.svg 2>"$work/err" && [ -s both.svg ]'

# ---- files that are something else: their place is told, not what stands there

printf '%s\n' 'root:secret:0:0:root:/root:/bin/sh' 'daemon:secret:1:1:' '[secret]' >passwd
# told COMMAND...: refused without a word of what stands there
told() {
    "$@" >"$work/out" 2>"$work/err"
    [ $? -eq 1 ] && grep -q 'passwd' "$work/err" && ! grep -q 'secret\|daemon' "$work/err"
}
sed '/^include/d' whole.veh >foreign.veh
echo 'include: passwd' >>foreign.veh
check "an included file that is no model" told "$gicgen" --sequence foreign.veh
sed 's/road.csv/passwd/' rough.scene >foreign.scene
check "a road that is no table" told "$gicrun" -q whole.veh foreign.scene
sed '/^road/d' rough.scene >foreign.scene
echo 'road: {type: grid, file: passwd}' >>foreign.scene
check "nor a height field" told "$gicrun" -q whole.veh foreign.scene
printf '%s\n' 'gicgen: 1' 'model: cart' 'base: box' 'bodies:' '  box: {mass: 10, com: [0, 0, 1], inertia: [10, 10, 10]}' \
    'tires:' '  all: {file: passwd}' >tire.veh
check "a tire that is no tire" told "$gicgen" --sequence tire.veh
for device in /dev/zero /dev/tty /dev/full; do
    sed "s|road.csv|$device|" rough.scene >foreign.scene
    check "$device as a road" eval '! timeout 20 "$gicrun" -q whole.veh foreign.scene >"$work/out" 2>"$work/err" && says "it is a device"'
    { sed '/^include/d' whole.veh && echo "include: $device"; } >foreign.veh
    check "$device included" eval '! timeout 20 "$gicgen" --sequence foreign.veh >"$work/out" 2>"$work/err" && says "it is a device"'
done

# ---- tables

# table HEADER TEXT: states with that header are refused with that text
table() {
    # shellcheck disable=SC2059  # with \n in it
    printf "$1\\n1,0\\n" >states.csv
    "$gicrun" -q --eval states.csv whole.veh >"$work/out" 2>"$work/err"
    [ $? -eq 1 ] && says "$2"
}
check "degrees are no radians" table 'angle [deg],angle.rate' "column 'angle' is in deg, and its numbers would be taken for rad"
check "nor are degrees a second" table 'angle [rad],angle.rate [deg/s]' "column 'angle.rate' is in deg/s"
check "a NUL byte in the header" table 'angle\000x,angle.rate' 'a NUL byte'
printf '%s\n' 'angle [rad],"angle.rate [rad/s]"' '1,0' >states.csv
check "its own units" "$gicrun" -q --eval states.csv whole.veh -o out.csv

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
