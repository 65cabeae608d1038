#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep.sh GICSWEEP GICRUN: sweeps have the digits of gicrun, run by run; grids and hypercubes have the runs that
# they should; a killed sweep goes on and ends with the same bytes; without a compiler, or shared out among processes, the
# same bytes; clear errors.
gicsweep=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
GICGEN_CACHE=$work/kept
OMP_NUM_THREADS=2
export GICGEN_CACHE OMP_NUM_THREADS

# says TEXT STATUS COMMAND...: it ends with the status and the text in its message
says() {
    text=$1
    status=$2
    shift 2
    "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -q -- "$text" "$work/err"
}

# scene DURATION [SPEED [SPRING]] >FILE
scene() {
    cat <<XXX
gicscene: 1
duration: $1
step: 0.005
output_step: 0.05
initial: {speed: ${2:-5}, coordinates: {spring_f_l: ${3:-0.24}}}
road: {type: bumps, bumps: [{x: 4, length: 2, height: 0.06, tracks: left}]}
outputs: [chassis.z, wheel_f_l.z]
XXX
}

# the same columns of a run of gicrun, to 15 digits: end, least, greatest of both outputs
ranges() {
    awk -F, 'NR > 1 { for (i = 2; i <= 3; ++i) { end[i] = $i; if (NR == 2 || $i + 0 < low[i] + 0) low[i] = $i
                      if (NR == 2 || $i + 0 > high[i] + 0) high[i] = $i } }
             END { print end[2] "," low[2] "," high[2] "," end[3] "," low[3] "," high[3] }' "$1"
}

car=models/hmmwv.veh
scene 1 >"$work/s.scene"

# ---- a grid: runs and digits

"$gicsweep" -q "$car" "$work/s.scene" --vary speed=4:20:3 --vary spring_f_l=0.23:0.24:2 -o "$work/grid.csv" 2>"$work/err"
check "a grid" [ $? -eq 0 ]
check "its header" [ "$(head -1 "$work/grid.csv")" = "run,speed [m/s],spring_f_l [m],status,time [s],\
chassis.z.end [m],chassis.z.min [m],chassis.z.max [m],wheel_f_l.z.end [m],wheel_f_l.z.min [m],wheel_f_l.z.max [m]" ]
check "its values" [ "$(sed 1d "$work/grid.csv" | cut -d, -f1-5 | tr '\n' ' ')" = \
    "0,4,0.23,0,1 1,4,0.24,0,1 2,12,0.23,0,1 3,12,0.24,0,1 4,20,0.23,0,1 5,20,0.24,0,1 " ]
for run in 0 3 4; do
    row=$(sed -n "$((run + 2))p" "$work/grid.csv")
    scene 1 "$(echo "$row" | cut -d, -f2)" "$(echo "$row" | cut -d, -f3)" >"$work/one.scene"
    "$gicrun" -q "$car" "$work/one.scene" -o "$work/one.csv" 2>"$work/err"
    check "run $run has gicrun's digits" [ "$(echo "$row" | cut -d, -f6-)" = "$(ranges "$work/one.csv")" ]
done
"$gicsweep" --cc /nonexistent "$car" "$work/s.scene" --vary speed=4:20:3 --vary spring_f_l=0.23:0.24:2 \
    -o "$work/plain.csv" 2>"$work/err"
check "without a compiler the same bytes" cmp -s "$work/grid.csv" "$work/plain.csv"
check "which it says" grep -q "note: each run by itself instead of lanes: .*/nonexistent" "$work/err"
# a compiler that takes 2 s longer: the time that is said has them
printf '#!/bin/sh\nsleep 2\nexec cc "$@"\n' >"$work/late"
chmod +x "$work/late"
GICGEN_CACHE='' "$gicsweep" --cc "$work/late" "$car" "$work/s.scene" --vary speed=4:20:3 -o "$work/late.csv" 2>"$work/err"
check "the time includes compiling" awk '/ runs in / {
    match($0, /[0-9.]+ s: [0-9.]+ s to read and compile, [0-9.]+ s of runs/); split(substr($0, RSTART), t, " ")
    good = t[1] >= 2 && t[3] >= 2 && t[1] >= t[3] } END { exit !good }' "$work/err"
check "numbers alone" [ "$(sed 1d "$work/grid.csv" | tr -d '0-9.,e+\n-' | wc -c)" -eq 0 ]
check "numpy reads it" /usr/bin/python3 - "$work/grid.csv" <<'XXX'
import sys
import numpy
table = numpy.genfromtxt(sys.argv[1], delimiter=",", names=True)
assert table.shape == (6,) and not numpy.isnan(table["chassiszmax_m"]).any()
assert (table["chassiszmin_m"] < table["chassiszmax_m"]).all() and table["speed_ms"][4] == 20
XXX

# ---- a Latin hypercube

# latin SEED FILE
latin() {
    "$gicsweep" -q "$car" "$work/s.scene" --latin 8 --seed "$1" --vary speed=4:12 --vary spring_f_l=0.23:0.24 -o "$2" \
        2>"$work/err"
}

# every eighth of the range from LOW on, WIDTH wide, once
strata() {
    sed 1d "$work/latin.csv" | cut -d, -f"$1" |
        awk -v low="$2" -v width="$3" '{ n[int(($1 - low) / width * 8)]++ } END { for (i = 0; i < 8; ++i) bad += n[i] != 1
                                                                                 exit bad }'
}
latin 1 "$work/latin.csv"
latin 1 "$work/again.csv"
latin 2 "$work/other.csv"
check "one run in each part of the speeds" strata 2 4 8
check "and of the springs" strata 3 0.23 0.01
check "the same seed, the same runs" cmp -s "$work/latin.csv" "$work/again.csv"
check "another seed, other runs" [ "$(cut -d, -f2 "$work/latin.csv")" != "$(cut -d, -f2 "$work/other.csv")" ]

# ---- killed, and going on

scene 6 >"$work/long.scene"
long() {
    exec "$gicsweep" "$car" "$work/long.scene" --vary speed=4:6:1000 -o "$1" 2>"$work/err"
}
(long "$work/whole.csv")
(long "$work/killed.csv") &
sweep=$!
while kill -0 $sweep 2>/dev/null && [ "$(cat "$work/killed.csv.journal" 2>/dev/null | wc -l)" -lt 100 ]; do sleep 0.02; done
kill -9 $sweep 2>/dev/null
wait $sweep 2>/dev/null
kept=$(($(wc -l <"$work/killed.csv.journal") - 1))
check "killed on the way" [ ! -e "$work/killed.csv" ]
printf '999 0 999,half a li' >>"$work/killed.csv.journal" # as a kill in the middle of a write leaves it
check "only its own sweep goes on" says "is of another sweep" 1 \
    "$gicsweep" "$car" "$work/long.scene" --vary speed=4:6:1001 -o "$work/killed.csv"
# it goes on, is killed again, and goes on again: the half line has not become the beginning of another one
(long "$work/killed.csv") &
sweep=$!
more=$((kept + 50))
while kill -0 $sweep 2>/dev/null && [ "$(cat "$work/killed.csv.journal" 2>/dev/null | wc -l)" -lt $more ]; do sleep 0.02; done
kill -9 $sweep 2>/dev/null
wait $sweep 2>/dev/null
check "killed again" [ ! -e "$work/killed.csv" ]
check "a half line is cut off" eval '! grep -q half "$work/killed.csv.journal"'
kept=$(($(wc -l <"$work/killed.csv.journal") - 1))
(long "$work/killed.csv")
check "no finished run is lost" grep -q "1000 runs in .*, $kept of them from an earlier start" "$work/err"
check "the same bytes in the end" cmp -s "$work/whole.csv" "$work/killed.csv"
check "no journal is left" [ ! -e "$work/killed.csv.journal" ]

# ---- nothing else goes on where a sweep was stopped: another road in the same file, other flags, another program

# stopped COMMAND...: begins a sweep and stops it when it has finished some runs
stopped() {
    "$@" >"$work/out" 2>"$work/err" &
    sweep=$!
    while kill -0 $sweep 2>/dev/null && [ "$(cat "$work/cut.csv.journal" 2>/dev/null | wc -l)" -lt 3 ]; do sleep 0.02; done
    kill -TERM $sweep 2>/dev/null
    wait $sweep
}
sed 's/^road:.*/road: {type: table, file: road.csv}/' "$work/long.scene" >"$work/table.scene"
printf '%s\n' 'x,height' 0,0 4,0.03 8,0 >"$work/road.csv"
onward() { "$@" "$car" "$work/table.scene" --vary speed=4:6:1000 -o "$work/cut.csv"; }
onward stopped "$gicsweep" -q
check "stopped on the way" [ "$(wc -l <"$work/cut.csv.journal")" -gt 2 ]
printf '%s\n' 'x,height' 0,0 4,0.02 8,0 >"$work/road.csv"
check "another road in the same file" says "is of another sweep" 1 onward "$gicsweep" -q
printf '%s\n' 'x,height' 0,0 4,0.03 8,0 >"$work/road.csv"
check "other flags" says "is of another sweep" 1 onward "$gicsweep" -q --cflags -O1
cp "$gicsweep" "$work/other_sweep"
echo >>"$work/other_sweep"
check "another program" says "is of another sweep" 1 onward "$work/other_sweep" -q
check "the same goes on" onward "$gicsweep" -q

# ---- inputs among the outputs, in lanes and alone, as gicrun writes them

cat >"$work/cart.veh" <<'XXX'
gicgen: 1
model: cart
base: ground
bodies:
  cart: {mass: 2, position: [0, 0, 0], com: [0, 0, 0], inertia: [1, 1, 1]}
inputs:
  push: {unit: N}
joints:
  guide: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  s: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-100, 100]}
forces:
  push: {type: force, coordinate: s, value: push}
outputs:
  s: {type: coordinate, coordinate: s}
XXX
cat >"$work/cart.scene" <<'XXX'
gicscene: 1
duration: 1
step: 0.01
output_step: 0.05
inputs: {push: {knots: {times: [0, 0.5, 1], values: [1, -2, 5]}}}
outputs: [s.value, input.push]
XXX
"$gicrun" -q "$work/cart.veh" "$work/cart.scene" -o "$work/one.csv" 2>"$work/err"
for engine in '' '--engine tcc' '--engine tape'; do
    # shellcheck disable=SC2086  # words
    "$gicsweep" -q $engine "$work/cart.veh" "$work/cart.scene" --vary s=0:1:2 -o "$work/inputs.csv" 2>"$work/err"
    check "an input among the outputs $engine: its name" [ "$(head -1 "$work/inputs.csv" | cut -d, -f8-)" = \
        "input.push.end [N],input.push.min [N],input.push.max [N]" ]
    check "and gicrun's numbers" [ "$(sed -n 2p "$work/inputs.csv" | cut -d, -f5-)" = "$(ranges "$work/one.csv")" ]
done

# least and greatest of what stays negative
sed 's/^inputs/initial: {coordinates: {s: -3}}\ninputs/' "$work/cart.scene" >"$work/left.scene"
"$gicrun" -q "$work/cart.veh" "$work/left.scene" -o "$work/one.csv" 2>"$work/err"
for engine in '' '--engine tape'; do
    # shellcheck disable=SC2086  # words
    "$gicsweep" -q $engine "$work/cart.veh" "$work/cart.scene" --vary s=-3:-2:2 -o "$work/left.csv" 2>"$work/err"
    check "negative numbers $engine" [ "$(sed -n 2p "$work/left.csv" | cut -d, -f5-)" = "$(ranges "$work/one.csv")" ]
done
check "all of them" [ "$(sed -n 2p "$work/left.csv" | cut -d, -f7 | cut -c1)" = - ]

# ---- runs that fail are rows

"$gicsweep" "$car" "$work/s.scene" --vary spring_f_l=0.24:2:2 -o "$work/fail.csv" 2>"$work/err"
check "a failed run is no error" [ $? -eq 0 ]
check "but has a status" [ "$(sed -n 3p "$work/fail.csv" | cut -d, -f3)" -lt 0 ]
check "and is told of" grep -q "1 failed, the first is run 1: at t = 0 s: .*subset 'wheel_f_l'" "$work/err"
check "the good one is not disturbed" [ "$(sed -n 2p "$work/fail.csv" | cut -d, -f3)" -eq 0 ]

# ---- complete vehicles in lanes: each has the digits that it has alone in a lane, and within rounding those of the code
# for one vehicle, whatever its neighbours do: fail, end, begin when others are under way, have drivers

cat >"$work/mixed.scene" <<'XXX'
gicscene: 1
duration: 1
step: 0.006
ratio: 6
output_step: 0.06
initial: {gear: 1}
inputs: {accelerator: {knots: {times: [0, 0.5], values: [0, 1]}}, rack: {knots: {times: [0, 0.3, 0.6], values: [0, 0.01, 0]}}}
outputs: [chassis.x, chassis_velocity.y, slip_r_l.fx, slip_f_l.fy]
XXX
sed '/^inputs:/d; s/^duration.*/duration: 3/' "$work/mixed.scene" >"$work/driven.scene"
cat >>"$work/driven.scene" <<'XXX'
driver: {period: 0.018, speed: {target: 8}, steering: {path: {points: [[-10, 0], [5, 0], [20, 2], [40, 2], [80, 2]]}, input: rack, per_angle: -0.17, wheelbase: 3.3, limit: 0.03, preview: 0.5}}
XXX
sed 's/^ratio.*/&\nsteady: 0.001/' "$work/driven.scene" >"$work/steady.scene"

# near A B: the same runs with the same statuses and times, numbers apart by 1e-9 relative to the larger of 1 and each; a
# run that diverges ends at a number of any size: its own are not compared. With `steady` 1e-8: between fast steps slips go
# straight on with what other elementary functions left in their rates, which is 1e-9 N of forces, 1e-13 of the load of a
# wheel; with libm's lanes have all bits of these steps, too (test_batch_vehicles)
near() {
    awk -F, -v most="$([ "$kind" = steady ] && echo 1e-8 || echo 1e-9)" 'NR == FNR { for (i = 1; i <= NF; ++i) a[FNR, i] = $i; n = FNR; next }
             FNR > 1 { for (i = 1; i <= NF; ++i) { d = $i - a[FNR, i]; s = $i < 0 ? -$i : $i
                       if ((i < 5 || $3 == 0) && (d < 0 ? -d : d) > most * (s > 1 ? s : 1)) bad = 1 } }
             END { exit bad || FNR != n || FNR < 2 }' "$1" "$2"
}
for kind in mixed driven steady; do
    case $kind in mixed) range=2:90 ;; *) range=4:8 ;; esac
    # many SWEEPING: 24 runs
    many() { "$gicsweep" models/hmmwv_vehicle.veh "$work/$kind.scene" --vary speed=$range:24 "$@" 2>"$work/err"; }
    OMP_NUM_THREADS=1 many -o "$work/lanes.csv"
    check "$kind: in lanes" grep -q "24 runs in .*; in lanes, [0-9]" "$work/err"
    many --engine cc -o "$work/alone.csv"
    check "$kind: each by itself" grep -q "24 runs in .*; each by itself" "$work/err"
    check "$kind: the numbers are those of the code for one vehicle" near "$work/lanes.csv" "$work/alone.csv"
    for part in 1 2 3 4 5 6 7 8; do OMP_NUM_THREADS=1 many -q --shard $part/8 -o "$work/$kind.parts"; done
    "$gicsweep" -q --merge "$work/$kind.parts" -o "$work/merged.csv"
    check "$kind: the same bytes with other neighbours" cmp -s "$work/lanes.csv" "$work/merged.csv"
    OMP_NUM_THREADS=5 many -o "$work/five.csv"
    check "$kind: the same bytes by five processes" cmp -s "$work/lanes.csv" "$work/five.csv"
done
check "some of the first kind fail" [ "$("$gicsweep" models/hmmwv_vehicle.veh "$work/mixed.scene" --vary speed=2:90:24 \
    -o "$work/lanes.csv" 2>&1 | grep -c ' failed, the first is run')" = 1 ]
# more runs than lanes, of which every second one fails at once: their places are taken by others in between
"$gicsweep" models/hmmwv_vehicle.veh "$work/mixed.scene" --vary speed=4:5:80 --vary state/spring_f_l=0.24:2:2 -o "$work/lanes.csv" 2>"$work/err"
check "refilled: half of them fail" grep -q "80 failed" "$work/err"
for part in 1 2 3 4 5; do
    "$gicsweep" -q models/hmmwv_vehicle.veh "$work/mixed.scene" --vary speed=4:5:80 --vary state/spring_f_l=0.24:2:2 \
        --shard $part/5 -o "$work/refilled.parts"
done
"$gicsweep" -q --merge "$work/refilled.parts" -o "$work/merged.csv"
check "refilled: the same bytes" cmp -s "$work/lanes.csv" "$work/merged.csv"
sed 's/^ratio.*/&\nlocate: true/' "$work/mixed.scene" >"$work/located.scene"
check "contacts within steps: each by itself, and why" says "note: each run by itself instead of lanes: contacts within" 0 \
    "$gicsweep" models/hmmwv_vehicle.veh "$work/located.scene" --vary speed=4:5:2 -o "$work/located.csv"

# ---- processes without lanes

cat >"$work/tires.scene" <<'XXX'
gicscene: 1
duration: 1
step: 0.002
ratio: 2
road: {type: bumps, bumps: [{x: 4, length: 2, height: 0.06, tracks: left}]}
outputs: [chassis.z]
XXX
# tires PROCESSES FILE
tires() {
    exec env OMP_NUM_THREADS="$1" "$gicsweep" --engine cc models/hmmwv_tires.veh "$work/tires.scene" --vary speed=4:6:300 -o "$2" 2>"$work/err"
}
(tires 1 "$work/tires.csv")
check "tires" [ "$(wc -l <"$work/tires.csv")" -eq 301 ]
check "by one process" grep -q "300 runs in .*; each by itself, [0-9]" "$work/err"
check "all of them good" [ "$(sed 1d "$work/tires.csv" | cut -d, -f3 | sort -u)" = 0 ]
(tires 3 "$work/shared.csv")
check "by three" grep -q "300 runs in .*; each by itself, up to 3 processes" "$work/err"
check "the same bytes" cmp -s "$work/tires.csv" "$work/shared.csv"

# ends SIGNAL WHOM: begin such a sweep and send a signal to it, or to the first of its processes; $code: its exit status
ends() {
    rm -f "$work/ended.csv.journal"
    (tires 2 "$work/ended.csv") &
    sweep=$!
    while kill -0 $sweep 2>/dev/null && [ "$(cat "$work/ended.csv.journal" 2>/dev/null | wc -l)" -lt 10 ]; do sleep 0.02; done
    children=$(cat /proc/[0-9]*/stat 2>/dev/null | awk -v sweep=$sweep '{ child = $1; sub(/.*\) /, ""); if ($2 == sweep) print child }')
    if [ "$2" = sweep ]; then kill "-$1" $sweep; else kill "-$1" "${children%%[!0-9]*}"; fi
    wait $sweep 2>/dev/null
    code=$?
    kept=$(($(wc -l <"$work/ended.csv.journal") - 1))
    cp "$work/err" "$work/end"
}
# goes_on WHAT: the next one ends with the same bytes
goes_on() {
    (tires 2 "$work/ended.csv")
    check "$1: no finished run is lost" grep -q "300 runs in .*, $kept of them from an earlier start" "$work/err"
    check "$1: the same bytes in the end" cmp -s "$work/tires.csv" "$work/ended.csv"
}
# gone: none of the processes does anything any more; they end with the sweep
gone() {
    for child in $children; do
        for _ in 1 2 3 4 5 6 7 8 9 10; do
            state=$(sed 's/.*) \(.\).*/\1/' "/proc/$child/stat" 2>/dev/null)
            [ -z "$state" ] || [ "$state" = Z ] && continue 2
            sleep 0.1
        done
        return 1
    done
    [ -n "$children" ]
}
ends KILL sweep
check "killed: its processes too" gone
goes_on "killed"
ends TERM sweep
check "asked to stop: says what is kept" grep -q "interrupted; $kept of 300 runs are kept" "$work/end"
check "asked to stop: its processes too" gone
goes_on "asked to stop"
ends KILL process
check "a process killed: a message and status 1" [ "$code:$(grep -c 'was ended by signal 9' "$work/end")" = 1:1 ]
check "a process killed: the others too" gone
goes_on "a process killed"
ends TERM process
check "a process asked to stop: says what is kept" grep -q "interrupted; $kept of 300 runs are kept" "$work/end"
goes_on "a process asked to stop"
"$gicsweep" models/hmmwv_tires.veh "$work/tires.scene" --vary speed=4:4e9:4 -o "$work/fail.csv" 2>"$work/err"
check "reasons of failures come along" grep -q "3 failed, the first is run 1: at t = 0 s: " "$work/err"

# ---- ranges of coordinates

for what in spring_f_l=0.19:0.24:2 spring_f_l=0.24:0.30:2 state/spring_f_l=0.30:0.24:2; do
    "$gicsweep" "$car" "$work/s.scene" --vary $what -o "$work/far.csv" 2>"$work/err"
    check "outside the range: $what" \
        grep -q "^gicsweep: warning: coordinate 'spring_f_l' leaves its range \[0.2, 0.29\]" "$work/err"
done
"$gicsweep" models/hmmwv_tires.veh "$work/tires.scene" --vary rack=-0.06:0:2 -o "$work/far.csv" 2>"$work/err"
check "driven outside the range" grep -q "^gicsweep: warning: coordinate 'rack' leaves its range" "$work/err"
"$gicsweep" "$car" "$work/s.scene" --vary spring_f_l=0.21:0.28:2 --vary speed=4:5:2 -o "$work/far.csv" 2>"$work/err"
check "inside" eval '! grep -q warning "$work/err"'

# ---- errors

sweep() {
    "$gicsweep" "$car" "$work/s.scene" -o "$work/e.csv" "$@"
}
check "an unknown name" says "nothing that can be varied is called 'wings'" 1 sweep --vary wings=1:2:3
check "no range" says "takes name=low:high" 2 sweep --vary speed=1
check "no count" says "needs a count" 2 sweep --vary speed=1:2
check "a count too many" says "no count of its own" 2 sweep --latin 4 --vary speed=1:2:3
check "a seed too large" says "--seed takes a whole number" 2 sweep --latin 4 --seed 99999999999999999999999 --vary speed=1:2
printf 'mine' >"$work/e.csv.journal"
check "somebody's file" says "^gicsweep: error: .*is of another sweep" 1 sweep --vary speed=1:2:2
check "which is left as it was" [ "$(cat "$work/e.csv.journal")" = mine ]
rm "$work/e.csv.journal"
check "no count of runs" says "1 to 10000000 runs, not '0'" 2 sweep --latin 0 --vary speed=1:2
check "half a run" says "1 to 10000000 runs, not '2.5'" 2 sweep --latin 2.5 --vary speed=1:2
check "twice" says "given twice" 2 sweep --vary speed=1:2:3 --vary speed=1:2:3
check "nothing varied" says "nothing is varied" 2 sweep
check "too many runs" says "ten million" 2 sweep --vary speed=1:2:10000 --vary spring_f_l=0.23:0.24:10000
check "standard output" says "results go into a file" 2 sweep --vary speed=1:2:2 -o -

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
