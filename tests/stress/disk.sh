#!/bin/sh
# SPDX-License-Identifier: MIT
# disk.sh GICGEN GICRUN GICSWEEP GICBENCH: full disks, files that may not grow, read-only folders, ends while writing
#
# What stood at the place of the results stays as it was or is replaced as a whole; there is one message; no temporary
# files are left but those of a program that was killed outright, and the journal of a sweep.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicsweep=$(realpath "$3")
gicbench=$(realpath "$4")
models=$(realpath "$(dirname "$0")/../../models")
work=$(mktemp -d) || exit 1
trap 'chmod -R u+w "$work"; rm -rf "$work"' EXIT
cd "$work" || exit 1
GICGEN_CACHE=
TMPDIR=$work/tmp
export GICGEN_CACHE TMPDIR
mkdir tmp place
sed 's/^duration: .*/duration: 0.1/' "$models/scenes/pendulum.scene" >short.scene
sed 's/^duration: .*/duration: 3000/; s/^output_step: .*//' "$models/scenes/pendulum.scene" >long.scene
model=$models/pendulum.veh

begin() { tried=0 refused=0 good=0 wrong=; }
# judge LABEL STATUS...: the exit status must be one of these, with one message where it is not 0
judge() {
    label=$1
    shift
    reason=
    case " $* " in
    *" $status "*) ;;
    *) reason="exit status $status: $(tail -n 1 err)" ;;
    esac
    [ "$status" -ne 1 ] || [ "$(grep -c 'error: ' err)" -eq 1 ] || reason="$(grep -c 'error: ' err) messages"
    [ -z "$(ls tmp)" ] || reason="leaves $(ls tmp)"
    for file in place/* place/report/*; do
        case $file in
        *.tmp) reason="leaves $file" ;;
        *.svg) [ "$(cat "$file")" = old ] || tail -c 20 "$file" | grep -q '</svg>' || reason="half of $file" ;;
        *.html) [ "$(cat "$file")" = old ] || tail -c 20 "$file" | grep -q '</html>' || reason="half of $file" ;;
        *.csv) [ "$(tail -c 1 "$file" | wc -l)" -eq 1 ] || reason="half of $file" ;;
        esac
        case $file in
        *.tmp | *.journal) ;; # with it a sweep goes on
        place/old.*) [ "$(cat "$file")" = old ] || [ "$status" -eq 0 ] || reason="$file is spoilt" ;;
        'place/*' | 'place/report/*' | place/report) ;;
        place/report/*.csv | place/report/bench.txt) ;; # a report is one with its index
        *) [ "$status" -eq 0 ] || reason="$file in spite of an error" ;;
        esac
    done
    chmod -R u+w place
    rm -rf place tmp
    mkdir place tmp
    tried=$((tried + 1))
    if [ -n "$reason" ]; then
        wrong=${wrong:-$label: $reason}
        echo "$label: $reason" >&2
    elif [ "$status" -eq 0 ]; then
        good=$((good + 1))
    else
        refused=$((refused + 1))
    fi
}
row() { echo "disk | $1 | $tried | $good | $refused | | ${wrong:-ok}"; }
# run COMMAND...
run() {
    timeout 60 "$@" >out 2>err </dev/null
    status=$?
}
old() {
    for ending in c h csv svg html; do
        echo old >place/old.$ending
    done
}

# every way to write, at the place of $1
writes() {
    case $2 in
    1) run "$gicgen" "$model" -o "$1.c" ;;
    2) run "$gicgen" --report "$1.html" "$model" ;;
    3) run "$gicgen" --graph "$1.svg" "$model" ;;
    4) run "$gicrun" -q --engine tape "$model" short.scene -o "$1.csv" ;;
    5) run "$gicrun" -q --engine tape "$model" short.scene --plot "$1.svg" ;;
    6) run "$gicrun" -q --engine tape "$model" short.scene --animate "$1.html" ;;
    7) run "$gicrun" -q --engine tape --equilibrium "$model" -o "$1.csv" ;;
    8) run "$gicsweep" -q --engine tape "$model" short.scene --vary state/angle=0:1:3 -o "$1.csv" ;;
    9) run "$gicbench" --quick --drive --engines tape "$model" short.scene -o "${1%/*}/report" ;;
    esac
}
WAYS="1 2 3 4 5 6 7 8 9"

begin
for way in $WAYS; do
    for size in 0 1 4 40; do # blocks of 512 bytes
        old
        status=$(
            trap '' XFSZ
            ulimit -f "$size"
            writes place/old "$way" 2>/dev/null
            echo "$status"
        )
        # under the limit err itself can't be written to
        [ "$status" = 1 ] && echo 'error: ' >err
        judge "limit of $size, way $way" 1 0
    done
done
row "files that may not grow"

begin
for way in 1 2 4 6; do
    case $way in
    1) run "$gicgen" "$model" -o /dev/full ;;
    2) run sh -c '"$1" --sequence "$2" >/dev/full' sh "$gicgen" "$model" ;;
    4) run "$gicrun" -q --engine tape "$model" short.scene -o /dev/full ;;
    6) run sh -c '"$1" --dump-model "$2" >/dev/full' sh "$gicgen" "$model" ;;
    esac
    judge "/dev/full, way $way" 1 2
done
row "/dev/full"

begin
if [ "$(id -u)" -ne 0 ]; then
    for way in $WAYS; do
        old
        chmod a-w place
        writes place/old "$way"
        judge "read-only folder, way $way" 1
    done
else
    for way in $WAYS; do
        writes nowhere/results "$way"
        judge "no such folder, way $way" 1
        writes /proc/results "$way"
        judge "folder of the system, way $way" 1
    done
fi
row "folders that can't be written"

# killed while it writes: what was there stays
[ "$STRESS" = short ] && times=6 || times=60
for signal in TERM INT KILL; do
    begin
    i=0
    while [ $i -lt "$times" ]; do
        i=$((i + 1))
        old
        # whoever runs this in the background may have had SIGINT ignored, which is inherited
        env --default-signal=INT timeout -s $signal 0.0$((1 + 3 * (i % 3))) "$gicrun" -q --engine tape "$model" long.scene -o place/old.csv >out 2>err
        status=$?
        [ $signal != KILL ] || rm -f place/*.tmp
        # the shell says 124 or 137; gicrun keeps what was computed and ends by the signal or with 1
        case $status in
        124 | 137 | 130 | 143 | 1) status=124 ;;
        esac
        grep -q '^old\|^time' place/old.csv && [ "$(tail -c 1 place/old.csv | wc -l)" -eq 1 ] && echo old >place/old.csv
        judge "SIG$signal" 124 0
    done
    row "ended by SIG$signal"
done
