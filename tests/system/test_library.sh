#!/bin/sh
# SPDX-License-Identifier: MIT
# test_library.sh GICGEN GICRUN LIBRARY: what the library says and computes is what the programs say and compute: messages
# of all broken models byte for byte, results of scenes bit for bit, modes, linear models and equilibria, and it writes
# nothing itself. tests/unit/test_library.c has its calls.
gicgen=$1
gicrun=$2
library=$3
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
tests=$(cd "$(dirname "$0")/.." && pwd)
models=$tests/../models

# ---- messages ----------------------------------------------------------------------------------------------

"$library" open "$tests"/data/mistakes/*.veh "$work/missing.veh" "$tests" >"$work/out" 2>"$work/by_library"
check 'broken models are refused' [ $? -eq 1 ]
for file in "$tests"/data/mistakes/*.veh "$work/missing.veh" "$tests"; do
    echo "== $file"
    "$gicgen" "$file" -o "$work/x.c" 2>&1
done >"$work/by_program"
check 'there are many' [ "$(grep -c '^==' "$work/by_program")" -gt 300 ]
check 'messages are those of gicgen' diff "$work/by_program" "$work/by_library"
check 'nothing is written to the terminal' [ ! -s "$work/out" ]

# the same KIND MODEL SCENE: a run that fails, by both
same_failure() {
    "$library" run "$@" >"$work/said" 2>"$work/err"
    "$gicrun" -q "$@" >"$work/out" 2>"$work/by_program"
    [ -s "$work/err" ] && diff "$work/by_program" "$work/err"
}
printf 'gicscene: 1\nduration: 1\nstep: 0.01\ninputs: {rak: 0}\n' >"$work/name.scene"
printf 'gicscene: 1\nduration: 5\nstep: 0.2\n' >"$work/long.scene"
check 'a scene with an unknown name' same_failure "$models/hmmwv_vehicle.veh" "$work/name.scene"
check 'a scene for another model' same_failure "$models/pendulum.veh" "$models/scenes/lane_change.scene"
check 'a run that becomes unstable' same_failure "$models/quarter_car.veh" "$work/long.scene"

# ---- results -----------------------------------------------------------------------------------------------

same_run() {
    "$library" run "$models/$1.veh" "$models/scenes/$2.scene" >"$work/by_library" 2>"$work/err" &&
        "$gicrun" -q --engine "${LIBRARY_ENGINE:-auto}" "$models/$1.veh" "$models/scenes/$2.scene" -o "$work/by_program" 2>"$work/said" &&
        diff "$work/said" "$work/err" &&
        python3 "$tests/tools/library_runs.py" "$work/by_library" "$work/by_program" 2>"$work/err"
}
# free, with tires and powertrain, a rig, sleep, events, variable steps, a driver, roads
for run in pendulum/pendulum quarter_car/quarter_car hmmwv/paper_run hmmwv/suspension_rig hmmwv_tires/tires_jump \
    hmmwv_vehicle/step_steer hmmwv_vehicle/parked hmmwv_vehicle/lane_change andrews/andrews; do
    check "$run has gicrun's bits" same_run "${run%/*}" "${run#*/}"
done
LIBRARY_ENGINE=tape
export LIBRARY_ENGINE
check 'by the engine tape' same_run quarter_car quarter_car
LIBRARY_ENGINE=cc
check 'by the engine cc' same_run quarter_car quarter_car
unset LIBRARY_ENGINE

# numbers NAME: of an array that the library printed, one a line, without names of rows
numbers() { awk -v name="$1" '/^[A-Za-z0-9]+ [0-9]+ [0-9]+$/ { on = $1 == name; next } on' "$work/by_library" | sed 's/^.*\]: //' | tr ',' '\n'; }
same_modes() {
    "$library" modes "$models/$1.veh" >"$work/by_library" 2>"$work/err" &&
        "$gicrun" -q --modes "$models/$1.veh" -o - >"$work/by_program" 2>"$work/said" && diff "$work/said" "$work/err" &&
        python3 - "$work/by_library" "$work/by_program" <<'PY'
import sys
ours, theirs = ([line.rstrip("\n").split(",") for line in open(path)] for path in sys.argv[1:])
assert len(ours) - 2 == len(theirs) - 1 > 0
for a, b in zip(ours[2:], theirs[1:], strict=True):
    assert [x and float(x) for x in a] == [x and float(x) for x in b], (a, b)
PY
}
check 'modes are those of gicrun' same_modes quarter_car
check 'of a vehicle too' same_modes hmmwv
same_state() {
    "$library" equilibrium "$models/$1.veh" >"$work/by_library" 2>"$work/err" &&
        "$gicrun" -q --equilibrium "$models/$1.veh" -o - >"$work/by_program" 2>"$work/said" && diff "$work/said" "$work/err" &&

        python3 - "$work/by_library" "$work/by_program" <<'PY'
import sys
lines = open(sys.argv[1]).read().splitlines()
names, values = lines[1].split(","), lines[2].split(",")
other, numbers = (line.split(",") for line in open(sys.argv[2]).read().splitlines()[:2])
assert names == other[:len(names)] and [float(x) for x in values] == [float(x) for x in numbers[:len(values)]]
PY
}
check 'the equilibrium is that of gicrun' same_state hmmwv
same_matrix() {
    "$library" linearize "$models/quarter_car.veh" >"$work/by_library" 2>"$work/err" &&
        "$gicrun" -q --linearize "$models/quarter_car.veh" -o "$work/by_program.npz" 2>"$work/said" &&
        numbers "$1" | grep -v '\[' >"$work/numbers" &&
        /usr/bin/python3 - "$work/numbers" "$work/by_program.npz" "$1" <<'PY'
import sys
import numpy
with open(sys.argv[1]) as file:
    ours = numpy.array([float(x) for x in file.read().split()])
theirs = numpy.load(sys.argv[2])[sys.argv[3]].ravel()
assert len(ours) and numpy.array_equal(ours, theirs), (ours, theirs)
PY
}
check 'A is that of gicrun --linearize' same_matrix A
check 'C too' same_matrix C

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
