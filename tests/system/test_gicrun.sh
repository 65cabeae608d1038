#!/bin/sh
# SPDX-License-Identifier: MIT
# test_gicrun.sh GICRUN: scenes and --eval from end to end: results against closed solutions, messages, and what is
# left behind.
gicrun=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
TMPDIR=$work/tmp
export TMPDIR
mkdir "$TMPDIR"

clean() { [ -z "$(ls -A "$TMPDIR")" ]; }

# Two carts on a wall, side by side. `left` hangs on a spring without damping: x = 0.1 cos(6 t) from rest at 0.1
# (k / m = 72 / 2). `right` is driven.
cat >"$work/carts.veh" <<'END'
gicgen: 1
model: carts
gravity: [0, 0, 0]
base: ground
bodies:
  left: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
  right: {mass: 3, com: [0, 1, 0], inertia: [1, 1, 1]}
joints:
  left: {type: prismatic, bodies: [ground, left], axis: [1, 0, 0]}
  right: {type: prismatic, bodies: [ground, right], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, left], axis: [1, 0, 0], range: [-0.5, 0.5]}
  drive: {type: translation, bodies: [ground, right], axis: [1, 0, 0], range: [-0.5, 0.5], driven: true}
forces:
  spring: {type: spring_damper, coordinate: x, stiffness: 72}
outputs:
  x: {type: coordinate, coordinate: x}
  drive: {type: coordinate, coordinate: drive}
  force: {type: drive_force, coordinate: drive}
END
cat >"$work/swing.scene" <<'END'
gicscene: 1
duration: 2
step: 0.002
integrator: rk4
output_step: 0.02
initial: {coordinates: {x: 0.1}}
inputs:
  drive: {knots: {times: [0.5, 1.5], values: [0, 0.2]}}
END

run "$work/carts.veh" "$work/swing.scene" -o "$work/a.csv"
check 'a scene runs' exits 0
# four a step, and two for each of the two knots of the drive
check 'the summary counts right-hand sides' says 'right-hand sides *4004$'
check 'no temporary file is left' clean
header='time \[s\],x.value \[m\],x.rate \[m/s\],x.acceleration \[m/s^2\],drive.value \[m\],'
check 'time first, units in the header' grep -q "^$header" "$work/a.csv"
check 'a row an output time, times as a person writes them' [ "$(sed 1d "$work/a.csv" | cut -d, -f1)" = \
    "$(awk 'BEGIN {for (i = 0; i <= 100; ++i) printf "%.15g\n", i / 50}')" ]
check 'the free cart swings as its closed solution' awk -F, 'NR > 1 {
    d = $2 - 0.1 * cos(6 * $1); if (d < 0) d = -d; if (!(d < 1e-9)) bad = 1
    d = $4 + 3.6 * cos(6 * $1); if (d < 0) d = -d; if (!(d < 1e-7)) bad = 1
} END {exit bad || NR != 102}' "$work/a.csv"
# halfway through the move the rate is 0.2 * 15/8 over 1 s and the acceleration 0; the force is 3 kg times acceleration
check 'the driven cart follows its knots' awk -F, 'function off(a, b) {return a - b > 1e-12 || b - a > 1e-12}
    NR > 1 && off($8, 3 * $7) {bad = 1} $1 == 1 {seen = 1; if (off($5, 0.1) || off($6, 0.375) || off($7, 0)) bad = 1}
    END {exit bad || !seen || off($5, 0.2)}' "$work/a.csv"

# the same numbers as the outputs that repeat them
sed '$a outputs: [drive.value, input.drive, drive.acceleration, input.drive.acceleration]' "$work/swing.scene" \
    >"$work/inputs.scene"
run "$work/carts.veh" "$work/inputs.scene" -o "$work/inputs.csv"
check 'inputs are columns' awk -F, 'NR == 1 && $3 $5 != "input.drive [m]input.drive.acceleration [m/s^2]" {bad = 1}
    NR > 1 && ($2 != $3 || $4 != $5) {bad = 1} $3 == 0.2 {seen = 1} END {exit bad || !seen || NR != 102}' \
    "$work/inputs.csv"

sed '/^output_step/d' "$work/swing.scene" >"$work/often.scene"
run "$work/carts.veh" "$work/often.scene" -q
check 'results go to standard output by default' [ "$(wc -l <"$work/out")" -eq 1002 ]
check '--quiet is quiet' [ ! -s "$work/err" ]
check 'outputs leave no trace in the computation' [ "$(tail -n 1 "$work/out")" = "$(tail -n 1 "$work/a.csv")" ]

# a picture, or why not
run "$work/carts.veh" "$work/swing.scene" --plot "$work/a.svg"
check 'a picture is drawn' grep -q '</svg>' "$work/a.svg"
check 'curves are named' grep -q 'drive.value' "$work/a.svg"
check 'a picture alone writes no results' [ ! -s "$work/out" ]
sed '$a plot: [{x: drive.value, y: drive.rate}, input.drive, {x: x.value, y: drive.value}]' \
    "$work/swing.scene" >"$work/over.scene"
run "$work/carts.veh" "$work/over.scene" --plot "$work/over.svg"
check 'panels of one output over another have axes' [ 2 -eq \
    "$(grep -oE '>(drive.value \[m\]|drive.rate \[m/s\]|x.value \[m\])<' "$work/over.svg" | sort | uniq -c |
        awk '/drive.value/ {n = $1} END {print n}')" ]
check 'axes say what is measured, and in what' grep -q '>length \[m\]<' "$work/over.svg"
# one scale where both are lengths, and no number upright
sed '$a plot: [{x: x.value, y: drive.value}]' "$work/swing.scene" >"$work/equal.scene"
run "$work/carts.veh" "$work/equal.scene" --plot "$work/equal.svg"
check 'panels over one another have a title' grep -q '>drive.value over x.value<' "$work/equal.svg"
check 'ticks of both axes are equally far apart, and numbers do not meet' \
    /usr/bin/python3 -B "$(dirname "$0")/../tools/gicrun_ticks.py" "$work/equal.svg"
check 'inputs are curves' grep -q 'input.drive' "$work/over.svg"
# another run beside it: the same run lies on it, point by point; one that has not all of it; one that has nothing of it
sed '$a plot: [drive.value, drive.rate, {x: x.value, y: drive.value}]' "$work/swing.scene" >"$work/twice.scene"
run "$work/carts.veh" "$work/twice.scene" -o "$work/once.csv" --plot "$work/once.svg"
run "$work/carts.veh" "$work/twice.scene" --plot "$work/twice.svg" --with "$work/once.csv"
check 'the same run beside a run lies on it' \
    /usr/bin/python3 -B "$(dirname "$0")/../tools/gicrun_overlay.py" "$work/once.svg" "$work/twice.svg" 3
check 'it has its name' grep -q '>drive.value (once.csv)<' "$work/twice.svg"
cut -d, -f1 "$work/once.csv" >"$work/time.csv"
paste -d, "$work/time.csv" "$work/time.csv" | sed '1s/.*/time [s],drive.rate [m\/s]/' >"$work/rate.csv"
run "$work/carts.veh" "$work/twice.scene" --plot "$work/rate.svg" --with "$work/rate.csv"
check 'of a run with less there is less' \
    /usr/bin/python3 -B "$(dirname "$0")/../tools/gicrun_overlay.py" "$work/once.svg" "$work/rate.svg" 0 1
sed '1s/drive.rate .*/other/' "$work/rate.csv" >"$work/nothing.csv"
run "$work/carts.veh" "$work/twice.scene" --plot "$work/none.svg" --with "$work/nothing.csv"
check 'of a run with nothing there is a message' says "none of the columns that are drawn, such as 'drive.value'"
check 'and no picture' [ ! -e "$work/none.svg" ]
sed '1s/m\/s/m/' "$work/rate.csv" >"$work/unit.csv"
run "$work/carts.veh" "$work/twice.scene" --plot "$work/none.svg" --with "$work/unit.csv"
check 'another unit is a mistake' exits 1
run "$work/carts.veh" "$work/twice.scene" -o "$work/rate.csv" --plot "$work/none.svg" --with "$work/rate.csv"
check 'the other run is not overwritten' exits 1
run "$work/carts.veh" "$work/twice.scene" --with "$work/rate.csv"
check 'another run without a picture: usage error' exits 2
mkdir "$work/bin"
for tool in cc gcc as ld; do
    ln -s "$(command -v "$tool")" "$work/bin/$tool"
done
PATH=$work/bin "$gicrun" "$work/carts.veh" "$work/swing.scene" -o "$work/b.csv" --plot "$work/b.svg" 2>"$work/err"
status=$?
check 'no gnuplot: an error' exits 1
check 'no gnuplot: a remedy' says 'remedy: .*gnuplot'
check 'no gnuplot: noticed before the run' [ ! -e "$work/b.csv" ]
# what can't be written is noticed before anything is compiled or run
for option in --plot:svg --animate:html -o:csv; do
    for place in nowhere/x folder; do
        mkdir -p "$work/folder.${option#*:}"
        PATH=$work/bin "$gicrun" "$work/carts.veh" "$work/swing.scene" --engine cc --cc "$work/nothing" -o "$work/b.csv" \
            "${option%:*}" "$work/$place.${option#*:}" 2>"$work/err"
        check "$option at $place is noticed first" says "$place.${option#*:}: error: can't create"
    done
done
check 'a folder of that name: a remedy' says 'remedy: that is a folder'
if [ "$(id -u)" -eq 0 ] && command -v setpriv >/dev/null; then
    chmod 755 "$work"
    setpriv --reuid 65534 --clear-groups "$gicrun" "$work/carts.veh" "$work/swing.scene" -o "$work/c.csv" 2>"$work/err"
    check 'a folder of others: the reason' says "c.csv: error: can't create: Permission denied"
    check 'a folder of others: the remedy' says 'remedy: .*who may'
fi
run "$work/carts.veh" "$work/swing.scene" --engine cc --cc "$work/nothing"
check 'no compiler: an error' exits 1
check 'no compiler: a remedy' says 'remedy: .*--cc'
check 'no compiler: no temporary file' clean
run "$work/carts.veh" "$work/swing.scene" --engine cc --cc "cc -DGIC_FLOAT"
check 'another number type is noticed' says 'error: the compiled model does not fit'
run "$work/carts.veh" "$work/swing.scene" -o "$work/nowhere/a.csv"
check 'results that cannot be written are an error' exits 1

# a crank and its spring's line: at w = 1 they are in line, the length stops being a coordinate, the run must end there
cat >"$work/crank.veh" <<'END'
gicgen: 1
model: crank
base: ground
gravity: [0, 0, 0]
bodies:
  arm: {mass: 1, com: [0.5, 0, 0], inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 0, 1]}
coordinates:
  w: {type: length, bodies: [ground, arm], points: [[0, 0.75, 0], [1, 0, 0]]}
END
cat >"$work/crank.scene" <<'END'
gicscene: 1
duration: 10
step: 0.001
initial: {rates: {w: 0.3}}
END
run "$work/crank.veh" "$work/crank.scene" -o "$work/crank.csv"
check 'a run that can go no further fails' exits 1
check 'the message tells when and which subset' says "error: the run ends at t = .* s: .*: subset 'arm'"
# roundings of a rotation over thousands of steps, the largest of them
root=$(dirname "$0")/../..
for engine in tape gic; do
    run --engine $engine "$root/models/pendulum.veh" "$root/models/scenes/pendulum.scene" -o "$work/never.csv"
    check "$engine: the largest constraint residual" says 'constraint residual  *[1-9][.0-9]*e-1[3-6] at most'
    run --engine $engine "$work/crank.veh" "$work/crank.scene" -o "$work/never.csv"
    check "$engine: and which subset" says "error: the run ends at t = .* s: .*: subset 'arm'"
done
rm -f "$work/never.csv"
# w' = 0.3 at first and w must stay below 1.75: rows are there, and all are numbers
check 'its results are kept' awk -F, 'NR > 1 && !($2 >= 1.25 - 1e-9 && $2 < 1.75) {bad = 1}
    END {exit bad || NR < 100}' "$work/crank.csv"

# a mass that its damper drives: rates of AB3 and RK4 by the formulas of the methods; the step that can't be made begins at
# the last good state, whether that is at an output time or not
cat >"$work/driven.veh" <<'END'
gicgen: 1
model: driven
base: ground
gravity: [0, 0, 0]
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-5, 5]}
forces:
  push: {type: force, coordinate: x, value: "rate(x)"}
outputs:
  x: {type: coordinate, coordinate: x}
END
cat >"$work/methods.py" <<'END'
import sys
import numpy
table, every, method, h = sys.argv[1], sys.argv[2], sys.argv[3], 0.5
slope = lambda y: numpy.array([y[1], y[1]])
def rk4(y):
    a = slope(y); b = slope(y + h / 2 * a); c = slope(y + h / 2 * b)
    return y + h / 6 * (a + 2 * b + 2 * c + slope(y + h * c))
states, slopes = [numpy.array([0.0, 1.0])], []
for i in range(40):
    slopes.append(slope(states[i]))
    ab3 = method == "ab3" and i > 1
    states.append(states[i] + h / 12 * (23 * slopes[i] - 16 * slopes[i - 1] + 5 * slopes[i - 2]) if ab3 else rk4(states[i]))
rows, all = (numpy.genfromtxt(name, delimiter=",", skip_header=1) for name in (table, every))
times = list(rows[:, 0])
assert times == [t for t in (0, 4, 8, 12) if t < all[-1, 0]] + [all[-1, 0]], times
assert (rows[-1] == all[-1]).all() and 4 < times[-1] < 12
for row in rows if method in ("ab3", "rk4") else []:
    y = states[int(2 * row[0])]
    assert numpy.allclose(row[1:4], [y[0], y[1], y[1]], rtol=1e-12), (row, y)
END
for integrator in ab3 rk4; do
    for engine in tape gic; do
        for every in 4 0.5; do
            echo "{gicscene: 1, duration: 20, step: 0.5, output_step: $every, integrator: $integrator, initial: {rates: {x: 1}}}" >"$work/driven.scene"
            run --engine $engine "$work/driven.veh" "$work/driven.scene" -o "$work/every_$every.csv"
            check "$integrator, $engine: it fails" exits 1
            check "$integrator, $engine: at its last row" says "ends at t = $(tail -n 1 "$work/every_$every.csv" | cut -d, -f1) s"
        done
        /usr/bin/python3 "$work/methods.py" "$work/every_4.csv" "$work/every_0.5.csv" $integrator 2>"$work/err"
        verdict $? "$integrator, $engine: the last good state is the last row"
    done
done
run "$work/crank.scene" "$work/crank.veh"
check 'a scene in place of the model' says 'crank.scene:1:11: error: this is a scene, where a model is wanted'
run "$work/crank.veh" "$work/crank.veh"
check 'a model in place of the scene' says 'crank.veh:1:9: error: this is a model, where a scene is wanted'
: >"$work/empty.scene"
run "$work/crank.veh" "$work/empty.scene"
check 'an empty scene' says 'begin a model with .* a scene with .gicscene: 1'
printf 'gicscene: 1\nduration: 1\nstep: 0.01\noutputs: [nothing]\n' >"$work/nothing.scene"
run "$(dirname "$0")/../../models/hmmwv.veh" "$work/nothing.scene" -o "$work/nothing.csv"
check 'an output that is none' says "nothing.scene:4:11: error: the model has no output 'nothing'"
check 'and some of the many that are' says "remedy: there are: chassis, .* more, which gicgen --dump-model lists"
# from rest, a step of 20 s carries the cart out of all bounds
printf 'gicscene: 1\nduration: 40\nstep: 20\nintegrator: rk4\ninitial: {coordinates: {x: 0.1}}\n' >"$work/leap.scene"
run "$work/carts.veh" "$work/leap.scene" -o "$work/leap.csv"
check 'a step far too long, from rest' says "ends at t = 0 s: a state moves too far within a step.*'x' is at 0.1 m before the step"
sed 's/rates: {w: 0.3}/coordinates: {w: 1.8}/' "$work/crank.scene" >"$work/far.scene"
run "$work/crank.veh" "$work/far.scene" -o "$work/far.csv"
check 'an initial state out of reach is an error' says 'error: the run can.t start: '
check 'it writes no results' [ ! -e "$work/far.csv" ]

# asked to stop: results so far are there, the folder is clean, the signal is passed on
sed 's/^duration.*/duration: 1000000/; s/^output_step.*/output_step: 0.2/' "$work/swing.scene" >"$work/long.scene"
"$gicrun" "$work/carts.veh" "$work/long.scene" -q -o "$work/long.csv" 2>"$work/err" &
child=$!
waited=0
while [ "$waited" -lt 100 ] && ! ls "$work"/long.csv* >/dev/null 2>&1; do # until it steps
    sleep 0.1
    waited=$((waited + 1))
done
sleep 0.3
kill -TERM "$child"
wait "$child" 2>/dev/null
status=$?
check 'SIGTERM ends it' exits 143
check 'SIGTERM keeps the results' [ "$(wc -l <"$work/long.csv")" -gt 1 ]
check 'SIGTERM leaves no temporary file' [ "$(echo "$work"/long.csv*)" = "$work/long.csv" ]
printf '#!/bin/sh\nsleep 30\n' >"$work/slow"
chmod +x "$work/slow"
"$gicrun" "$work/carts.veh" "$work/swing.scene" --engine cc --cc "$work/slow" 2>"$work/err" &
child=$!
sleep 0.5
kill -TERM "$child"
wait "$child" 2>/dev/null
status=$?
check 'SIGTERM ends the compiler too' exits 143
check 'and removes its folder' clean

# rows of states; poses of the crank: w^2 = 0.75^2 + 1 - 2 * 0.75 sin(angle)
states() { printf 'w [m],w.rate\n%s\n' "$1"; }
states '1.25,0
1,0.5
1.8,0
1.4,-1' >"$work/s.csv"
run --eval "$work/s.csv" "$work/crank.veh" -o "$work/e.csv"
check '--eval gives a row for each state' [ "$(wc -l <"$work/e.csv")" -eq 5 ]
check '--eval: exit status 0 and a note' exits 0
check '--eval: the note counts' says 'warning: 1 of 4 rows have no result'
check '--eval: a failing row has empty cells and a status' grep -q '^,*-[0-9]*,"' "$work/e.csv"
# the base's acceleration is a.x to alpha.z
for base in a alpha ground; do
    cat >"$work/named.veh" <<END
gicgen: 1
model: named
base: $base
bodies:
  a: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  alpha: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  one: {type: revolute, bodies: [$([ $base = alpha ] && echo alpha, a || echo a, alpha)], point: [0.5, 0, 0], axis: [0, 1, 0]}
$([ $base = ground ] && echo '  two: {type: revolute, bodies: [ground, a], point: [0, 0, 0], axis: [0, 1, 0]}')
coordinates:
  turn: {type: angle, bodies: [$([ $base = alpha ] && echo alpha, a || echo a, alpha)], axis: [0, 1, 0]}
$([ $base = ground ] && echo '  lift: {type: angle, bodies: [ground, a], axis: [0, 1, 0]}')
END
    if [ $base = ground ]; then echo 'turn,turn.rate,lift,lift.rate' && echo 0,0,0,0; else
        echo 'r.x,r.y,r.z,e0,e1,e2,e3,turn,v.x,v.y,v.z,omega.x,omega.y,omega.z,turn.rate' && echo 7,0,0,1,0,0,0,0,0,0,0,0,0,0,0; fi >"$work/named.csv"
    run --eval "$work/named.csv" "$work/named.veh" -o "$work/named.out"
    check "--eval: no two columns of one name, base $base" [ -s "$work/named.out" ] && head -1 "$work/named.out" | tr ',' '\n' | sed 's/ .*//' | sort | uniq -d >"$work/twice"
    check "--eval: their names, base $base" [ ! -s "$work/twice" ]
done
check '--eval: the pose is the closed one' awk -F, 'function abs(x) {return x < 0 ? -x : x}
    NR == 1 {for (i = 1; i <= NF; ++i) {sub(/ \[.*/, "", $i); at[$i] = i}}
    NR == 3 {s = 2 * $at["arm.e0"] * $at["arm.e3"]; exit !(abs(s - (0.5625 + 1 - 1) / 1.5) < 1e-14)}' "$work/e.csv"
states '1.4,-1
1,0.5
1.25,0' | "$gicrun" --eval - "$work/crank.veh" >"$work/f.csv" 2>"$work/err"
check '--eval: the order of rows is irrelevant, bit by bit' [ "$(sed 1d "$work/e.csv" | grep ',0,"ok"$' | sort)" = \
    "$(sed 1d "$work/f.csv" | sort)" ]

# bad LINE:COLUMN TEXT: what was written to $work/bad must be refused there, before anything is compiled
bad() {
    run "$work/carts.veh" "$work/bad" --cc false
    check "bad scene: exit status 1 for $2" exits 1
    check "bad scene: $1 $2" grep -q "^$work/bad:$1: error: .*$2" "$work/err"
    check "bad scene: one error, one remedy for $2" [ "$(grep -c 'error: ' "$work/err")" -eq 1 ]
}
# change SED LINE:COLUMN TEXT: a scene that is good but for one edit
change() {
    sed "$1" "$work/swing.scene" >"$work/bad"
    bad "$2" "$3"
}
change 's/gicscene: 1/gicscene: 2/' 1:11 'version 1'
change '1d' 1:1 "needs the key 'gicscene'"
change 's/^step/stepp/' 3:1 "unknown key 'stepp'"
change 's/^duration: 2/duration: -2/' 2:11 'must be positive'
change 's/^duration: 2/duration: 0.01/' 2:11 'before the first output'
change 's/^step: 0.002/step: 0,002/' 3:7 'must be a number'
change 's/^step: 0.002/step: 0.003/' 5:14 'multiple of step'
change 's/rk4/rk5/' 4:13 "no integrator 'rk5'"
change '$a ratio: 2' 9:8 'rk4 has one rate'
change 's/^integrator: rk4/ratio: 2.5/' 4:8 'whole number'
change 's/^integrator: rk4/ratio: 0/' 4:8 'whole number'
change 's/coordinates: {x: 0.1}/states: {w.spin: 1}/' 6:20 "no fast state 'w.spin'"
change 's/{x: 0.1}/{y: 0.1}/' 6:25 "no coordinate 'y'"
change 's/{x: 0.1}/{drive: 0.1}/' 6:25 'is driven'
change 's/coordinates: {x: 0.1}/speed: 5/' 6:18 'is fixed'
change 's/  drive:/  drives:/' 8:3 "no input 'drives'"
change 's/  drive:/  drive.rate:/' 8:3 'no input of its own'
change 's/values: \[0, 0.2\]/values: [0]/' 8:46 '2 times and 1 values'
change 's/times: \[0.5, 1.5\]/times: [1.5, 0.5]/' 8:32 'must rise'
change '$s/knots/bend/' 8:11 "unknown key 'bend'"
change '$a outputs: [x, speed]' 9:14 "no output 'speed'"
change '$a outputs: []' 9:10 'list of names'
change '$a outputs: [input.drives]' 9:11 "no output 'input.drives'"
change '$a outputs: [{x: x.value, y: x.rate}]' 9:11 'name of an output'
change '$a plot: [{x: x.value}]' 9:8 "needs the key 'y'"
change '$a plot: [{x: x.value, y: x}]' 9:24 "output 'x' has 3 components"
change '$a course: {cone: [[0, 0]]}' 9:10 "unknown key 'cone'"
change '$a course: {cones: [0, 0]}' 9:18 'a list of 2 numbers'
change '$a course: {lanes: {points: [[0, 0], [1, 0]]}}' 9:17 'lanes must be a list'
change '$a course: {lanes: [{points: [[0, 0]], width: 3}]}' 9:27 'at least 2 points'
change '$a course: {lanes: [{points: [[0, 0], [0, 0]], width: 3}]}' 9:18 'are the same'
change '$a course: {lanes: [{points: [[0, 0], [5, 0], [0, 0]], width: 3}]}' 9:18 'turns back at point 2'
change '$a course: {lanes: [{points: [[0, 0], [5, 0]], width: 0}]}' 9:52 'must be positive'
change '$a course: {lanes: [{points: [[0, 0], [5, 0]], width: 3, cones: 1.5}]}' 9:62 'whole number'
change '$a road: {type: bump}' 9:14 "no road of type 'bump'"
change '$a road: {type: sine, amplitude: 1}' 9:7 "needs the key 'wavelength'"
change '$a road: {type: table, x: [0, 0], height: [0, 1]}' 9:28 'must rise'
change '$a road: {type: table, x: [0, 1], left: [0, 1]}' 9:7 "needs the key 'right'"
change '$a road: {type: bumps, bumps: [{x: 0, length: 0, height: 1}]}' 9:44 'must be positive'
change '$a road: {type: bumps, bumps: [{x: 0, length: 1, height: 1, tracks: middle}]}' 9:66 "can't be 'middle'"

# badstates HEADER ROW LINE:COLUMN TEXT
badstates() {
    printf '%s\n%s\n' "$1" "$2" >"$work/bad"
    run --eval "$work/bad" "$work/crank.veh" -o "$work/never.csv"
    check "bad states: $3 $4" grep -q "^$work/bad:$3: error: .*$4" "$work/err"
    check "bad states: no results for $4" [ ! -e "$work/never.csv" ]
}
badstates 'w,w.rat' '1,2' 1:3 "no state, input or tunable parameter 'w.rat'"
badstates 'w [rad] [rad],w.rate' '1,2' 1:1 "column 'w' is in rad. .rad,"
badstates 'w' '1' 1:1 'columns are missing'
badstates 'w,w.rate' '1,2,3' 2:5 'more than'
badstates 'w,w.rate' '1,1.5 mm' 2:3 'must be a number'

run
check 'no arguments: usage error' exits 2
run "$work/carts.veh"
check 'no scene: usage error' exits 2
run "$work/carts.veh" "$work/swing.scene" --plot "$work/a.pdf"
check 'unknown kind of picture: usage error' exits 2
run --engine swift "$work/carts.veh" "$work/swing.scene"
check 'an engine that there is not: usage error' exits 2
check 'those that there are' [ "$(sed -n 's/^  remedy: one of //p' "$work/err" | sed 's/, /\n/g' | sort | xargs)" = \
    'auto cc gcp1 gcp2 gic page tape tcc' ]
run -h
check 'help goes to standard output' grep -q '^usage: gicrun' "$work/out"

# a pipe stays one
mkfifo "$work/pipe"
cat "$work/pipe" >"$work/piped" &
run "$work/carts.veh" "$work/swing.scene" -o "$work/pipe"
wait
check 'results through a pipe' [ -p "$work/pipe" ] && check 'rows through a pipe' grep -q '^time' "$work/piped"
check 'nothing is left behind in the end' clean

# a coordinate that goes beyond its range, and one that goes to its end
cat >"$work/slide.veh" <<'END'
gicgen: 1
model: slide
gravity: [0, 0, 0]
base: ground
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  p: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-1, 1]}
END
for duration in 1 3; do
    printf 'gicscene: 1\nduration: %s\nstep: 0.01\noutput_step: 0.1\nintegrator: rk4\ninitial: {rates: {x: -1}}\n' $duration >"$work/slide.scene"
    run "$work/slide.veh" "$work/slide.scene" -o "$work/slide.csv"
    beyond() { says "range                'x' is beyond \\[-1, 1\\] from t = 1.1 s on: -3 to 0 m in all"; }
    [ $duration -eq 3 ] || beyond() { exits 0 && ! says 'beyond'; }
    check "a range, $duration s" beyond
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
