#!/bin/sh
# SPDX-License-Identifier: MIT
# test_coincidences.sh GICGEN GICRUN REFERENCE AGREE: what is so for the numbers in a file and not for others. Parameters that turn a
# mechanism over, make masses unequal or move points by a table at set-up; numbers that differ by roundings; points next to
# those about which bodies are solved; sines of many turns. Judged by --engine gic on a file that has the same numbers without parameters, by the quad-precision reference, and by
# the C library's sine.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
reference=$(realpath "$3")
agree=$(realpath "$4")
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# near A B LIMIT: rows of two tables differ by at most LIMIT (1 + |x|), but for the residual, in all columns of A that are numbers
near() {
    paste -d '\n' "$1" "$2" | awk -F, -v limit="$3" '
        NR == 1 { last = NF; for (i = 1; i <= NF; ++i) if ($i == "constraint") last = i - 1; next }
        NR % 2 { for (i = 1; i <= last; ++i) a[i] = $i; next }
        NR > 2 { for (i = 1; i <= last; ++i) {
            d = a[i] - $i
            x = a[i] < 0 ? -a[i] : a[i]
            if (d < 0) d = -d
            if ($i == "" || a[i] == "" || d > limit * (1 + x)) { print "row " NR / 2 - 1 ", column " i ": " a[i] " and " $i; bad = 1 } } }
        END { exit bad || NR < 4 }'
}

# ---- parameters: either refused, by a status, or as in a file with that number --------------------------------------------------

# refused FILE WHY: each row ends in a status whose message says why
refused() { awk -F '"' -v why="$2" 'NR > 1 && $2 !~ why { bad = 1 } END { exit bad || NR < 2 }' "$1"; }

# sweep NAME NAMES STATE WHY VALUE...: the model on standard input, whose parameter p gets each VALUE, at the STATE of these
# NAMES; WHY: a regular expression for messages that are right too
sweep() {
    what=$1 names=$2 state=$3 why=$4
    shift 4
    cat >tuned.veh
    for p in "$@"; do
        sed "s/^  p: .*/  p: $p/" tuned.veh >baked.veh
        printf '%s\n%s\n' "$names" "$state" >states
        printf '%s,p\n%s,%s\n' "$names" "$state" "$p" >states.p
        rm -f baked.csv
        "$gicrun" --quiet --engine gic --eval states baked.veh -o baked.csv 2>err
        verdict $? "$what, p = $p in the file"
        for options in "tape --recovery auto" "tape --recovery closed" "tape --recovery newton" tcc "tape --solve augmented" gic; do
            rm -f tuned.csv
            # shellcheck disable=SC2086  # a list of words
            "$gicrun" --quiet --engine $options --eval states.p tuned.veh -o tuned.csv 2>err
            { [ -n "$why" ] && refused tuned.csv "$why"; } || near baked.csv tuned.csv 1e-9 >out
            verdict $? "$what, p = $p at set-up, $options"
        done
        # code for the scene alone
        printf 'gicscene: 1\nduration: 0.02\nstep: 0.001\nintegrator: rk4\n' >baked.scene
        { cat baked.scene && echo "parameters: {p: $p}"; } >tuned.scene
        rm -f tuned.csv
        "$gicrun" --quiet --engine gic baked.veh baked.scene -o baked.csv 2>err
        if "$gicrun" --quiet tuned.veh tuned.scene -o tuned.csv 2>said; then
            near baked.csv tuned.csv 1e-9 >out
        else
            [ -n "$why" ] && grep -qE "$why" said
        fi
        verdict $? "$what, p = $p in a scene"
    done
}

# an arm that hangs on a strut from above or from below
sweep strut strut,strut.rate 0.32,0.1 "" 0.3 0.25 -0.3 -0.25 <<'XXX'
gicgen: 1
model: strut
base: ground
parameters:
  p: {value: 0.3, tunable: true}
bodies:
  arm: {mass: 1, com: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  strut: {type: length, bodies: [ground, arm], points: [[0.5, 0, p], [0.5, 0, 0]], range: [0.1, 0.6]}
outputs:
  tip: {type: position, body: arm, point: [1, 0, 0]}
XXX

# a rocker at a crank, drawn above or below its hinge, with a rod of another length than in the drawing
sweep rocker crank,crank.rate 0.1,0.2 "" 0.5 0.4 -0.5 -0.4 <<'XXX'
gicgen: 1
model: rocker
base: ground
parameters:
  p: {value: 0.5, tunable: true}
bodies:
  crank: {mass: 1, com: [0, 0, 0.2], inertia: [0.1, 0.1, 0.1]}
  rocker: {mass: 1, com: [1, 0, 0.5], inertia: [0.1, 0.1, 0.1]}
joints:
  a: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  b: {type: revolute, bodies: [ground, rocker], point: [1, 0, 0], axis: [0, 1, 0]}
  rod: {type: distance, bodies: [crank, rocker], points: [[0, 0, 0.4], [1, 0, p]], length: 1.05}
coordinates:
  crank: {type: angle, bodies: [ground, crank], axis: [0, 1, 0]}
outputs:
  rod: {type: reaction, joint: rod}
XXX

# places and masses that are a table's values
sweep table q,q.rate 0.1,1 "" 1 0 2 1.5 <<'XXX'
gicgen: 1
model: curve
base: ground
parameters:
  p: {value: 1, tunable: true}
tables:
  f: {x: [0, 1, 2], y: [0.5, 1, 2]}
bodies:
  arm: {mass: "f(p)", com: [0.5, 0, 0], inertia: [0.1, 0.1, 0.1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, "1 - f(p)"], axis: [0, 1, 0]}
coordinates:
  q: {type: angle, bodies: [ground, arm], axis: [0, 1, 0]}
outputs:
  tip: {type: position, body: arm, point: [1, 0, 0]}
XXX

# the augmented form with a link between heavy bodies that becomes light: right within 1e-8, or refused
cat >masses.veh <<'XXX'
gicgen: 1
model: masses
base: ground
parameters:
  m: {value: 1, tunable: true}
bodies:
  b0: {mass: 1000, com: [0.3, 0.1, -0.5], inertia: [40, 30, 20]}
  b1: {mass: m, com: [0.9, 0.2, -1], inertia: ["m * 0.1", "m * 0.1", "m * 0.1"]}
  b2: {mass: 1000, com: [1.7, 0.3, -1], inertia: [40, 30, 20]}
joints:
  j0: {type: revolute, bodies: [ground, b0], point: [0, 0, 0], axis: [0, 1, 0.3]}
  j1: {type: revolute, bodies: [b0, b1], point: [0.6, 0, -1], axis: [0, 1, 0]}
  j2: {type: revolute, bodies: [b1, b2], point: [1.2, 0, -1.2], axis: [0.1, 1, 0]}
coordinates:
  q0: {type: angle, bodies: [ground, b0], axis: [0, 1, 0.3], range: [-7, 7]}
  q1: {type: angle, bodies: [b0, b1], axis: [0, 1, 0], range: [-7, 7]}
  q2: {type: angle, bodies: [b1, b2], axis: [0.1, 1, 0], range: [-7, 7]}
XXX
names=q0,q1,q2,q0.rate,q1.rate,q2.rate state=0.3,0.2,0.7,1,2,3
printf '%s\n%s\n' $names $state >states
for m in 1 1e-3 1e-5 1e-6 1e-7 2e-9 1e-12; do
    sed "s/^  m: .*/  m: $m/" masses.veh >baked.veh
    printf '%s,m\n%s,%s\n' $names $state $m >states.p
    "$gicgen" --dump-model baked.veh >dump && "$reference" dump states -o accelerations.csv 2>err
    verdict $? "reference, m = $m"
    for options in "tape --solve augmented" "tcc --solve augmented" tape; do
        rm -f found.csv
        # shellcheck disable=SC2086  # a list of words
        "$gicrun" --quiet --engine $options --eval states.p masses.veh -o found.csv 2>err
        { [ "$options" != tape ] && refused found.csv "1e9 times the mass"; } ||
            "$agree" dump accelerations.csv found.csv --tolerance 1e-8 >out
        verdict $? "m = $m at set-up, $options"
    done
done

# ---- numbers that roundings tell apart -----------------------------------------------------------------------------------------

# chain SMALL: hinges that are parallel but for SMALL rad, points that are SMALL m off a line, masses that differ by SMALL
chain() {
    awk -v e="$1" 'BEGIN {
        OFMT = CONVFMT = "%.17g"
        print "gicgen: 1\nmodel: chain\nbase: ground\nbodies:"
        print "  a: {mass: 1, com: [0.5, 0, " e "], inertia: [1, 1, 1]}"
        print "  b: {mass: " (1 + e) ", com: [1, " e ", -0.5], inertia: [1, " (1 + e) ", 1]}"
        print "  c: {mass: 1, com: [1.5, 0, -1], inertia: [0.5, 0.5, 1]}"
        print "joints:"
        print "  g: {type: revolute, bodies: [ground, a], point: [0, 0, 0], axis: [0, 1, " e "]}"
        print "  h: {type: revolute, bodies: [a, b], point: [1, " e ", " e "], axis: [" (-e) ", 1, 0]}"
        print "  i: {type: cylindrical, bodies: [b, c], point: [" (1 + e) ", 0, -1], axis: [" e ", 0, -1]}"
        print "coordinates:"
        print "  u: {type: angle, bodies: [ground, a], axis: [0, 1, " e "]}"
        print "  v: {type: angle, bodies: [a, b], axis: [" (-e) ", 1, 0]}"
        print "  w: {type: translation, bodies: [b, c], axis: [" e ", 0, -1], points: [[" (1 + e) ", 0, -1], [" (1 + e) ", 0, -1]]}"
        print "  x: {type: angle, bodies: [b, c], axis: [" e ", 0, -1]}"
        print "outputs:\n  g: {type: reaction, joint: g}\n  h: {type: reaction, joint: h}\n  i: {type: reaction, joint: i}"
    }'
}
printf 'u,v,w,x,u.rate,v.rate,w.rate,x.rate\n0,0,0,0,1,1,1,1\n0.3,-0.2,0.1,0.4,1,2,-1,0.5\n' >states
for small in 0 1e-17 1e-16 3e-16 1e-15 1.1e-15 3e-15 1e-14 1e-12 1e-8; do
    chain $small >chain.veh
    "$gicgen" --dump-model chain.veh >dump && "$reference" dump states -o accelerations.csv 2>err
    for options in "--recovery auto" "--recovery newton" "--recovery closed" "--solve augmented"; do
        # shellcheck disable=SC2086  # a list of words
        "$gicrun" --quiet --engine tape $options --eval states chain.veh -o found.csv 2>err &&
            "$agree" dump accelerations.csv found.csv --tolerance 1e-12 --reactions >out
        verdict $? "$small apart, $options"
    done
done

# ---- points next to those about which bodies are solved -----------------------------------------------------------------------

# slider DISTANCE MASS INERTIA: one that turns, drawn at that DISTANCE from the point that its coordinate is measured from
slider() {
    cat >slider.veh <<XXX
gicgen: 1
model: slider
base: ground
bodies:
  sledge: {mass: $2, com: [$1, 0, 0.5], inertia: [$3, $3, $3]}
  arm: {mass: 2, com: [0, 0, -0.5], inertia: [0.1, 0.1, 0.1]}
joints:
  guide: {type: cylindrical, bodies: [ground, sledge], point: [0, 0, 0], axis: [1, 0, 0]}
  hinge: {type: revolute, bodies: [sledge, arm], point: [$1, 0, 0], axis: [0, 1, 0]}
coordinates:
  x: {type: translation, bodies: [ground, sledge], axis: [1, 0, 0], points: [[0, 0, 0], [$1, 0, 0]], range: [-2, 2]}
  turn: {type: angle, bodies: [ground, sledge], axis: [1, 0, 0], range: [-7, 7]}
  q: {type: angle, bodies: [sledge, arm], axis: [0, 1, 0], range: [-7, 7]}
outputs:
  tip: {type: position, body: arm, point: [0, 0, -1]}
XXX
}
cat >states <<'XXX'
x,turn,q,x.rate,turn.rate,q.rate
0,0,0,1,1,1
0.5,1,2,1,-1,0.5
-0.5,3.141592653589793,-1.5707963267948966,1,0,2
XXX
for away in 0 1e-13 1e-11 1e-9 1e-6 1e-3 0.01 0.1 1; do
    for inertia in "1 0.1" "0.001 1" "100 0.001"; do
        # shellcheck disable=SC2086  # two numbers
        slider $away $inertia
        rm -f right.csv
        "$gicrun" --quiet --engine gic --eval states slider.veh -o right.csv 2>err
        verdict $? "slider $away m away, mass and inertia $inertia"
        for options in tape "tape --recovery newton" "tape --solve augmented" tcc; do
            rm -f found.csv
            # shellcheck disable=SC2086  # a list of words
            "$gicrun" --quiet --engine $options --eval states slider.veh -o found.csv 2>err &&
                near right.csv found.csv 1e-9 >out && test ! -s err
            verdict $? "slider $away m away, mass and inertia $inertia, $options"
        done
    done
done

# ---- constants of formulas ---------------------------------------------------------------------------------------------------------

# push FORMULA: acceleration of 1 kg that it pushes
push() {
    cat >push.veh <<XXX
gicgen: 1
model: push
base: ground
gravity: [0, 0, 0]
bodies:
  sledge: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  guide: {type: prismatic, bodies: [ground, sledge], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, sledge], axis: [1, 0, 0]}
forces:
  push: {type: force, coordinate: x, value: "$1"}
XXX
    printf 'x,x.rate\n0,0\n' >states
    for engine in tape gic; do
        rm -f found.csv
        "$gicrun" --quiet --engine $engine --eval states push.veh -o found.csv 2>err
        awk -F, -v is="$1" -v engine=$engine -v right="$(awk "BEGIN { printf \"%.17g\", $2 }")" '
            NR == 2 { d = $1 - right; if (!(d * d < 1e-28)) { print is, engine ": " $1 " instead of " right; bad = 1 } }
            END { exit bad || NR < 2 }' found.csv >out
        verdict $? "$1, $engine"
    done
}
for turns in 1 1e3 1e6 1e7 1e9 1e12 123456789012345 1e15 1e22; do
    push "sin($turns)" "sin($turns)"
    push "cos($turns)" "cos($turns)"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
