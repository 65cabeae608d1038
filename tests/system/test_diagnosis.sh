#!/bin/sh
# SPDX-License-Identifier: MIT
# test_diagnosis.sh GICGEN: what is said about mechanisms whose coordinates don't determine them: everywhere, at the
# design only, or from some value of a coordinate on. The values are derived by hand beside each mechanism.
gicgen=$(realpath "$1")
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# model NAME: NAME.veh from standard input, on the ground
model() {
    name=$1
    { printf '%s\n' "gicgen: 1" "model: $name" "base: ground"; cat; } >"$name.veh"
}

# run STATUS: generates the last model; $name.err holds the messages
run() {
    rm -f "$name.c" "$name.h"
    "$gicgen" "$name.veh" -o "$name.c" >"$name.out" 2>"$name.err"
    status=$?
    [ $status -eq "$1" ]
    verdict $? "$name: exit status $status instead of $1"
    [ ! -s "$name.out" ]
    verdict $? "$name: words on standard output"
}

# refused KEY WORD...: one error at the line of KEY, with all the words; nothing written
refused() {
    key=$1
    shift
    run 1
    [ "$(grep -c 'error:' "$name.err")" -eq 1 ] && [ "$(grep -c 'warning:' "$name.err")" -eq 0 ]
    verdict $? "$name: not one error: $(cat "$name.err")"
    at_place error "$key"
    for word in "$@"; do
        grep -q -F -e "$word" "$name.err"
        verdict $? "$name: says nothing about $word: $(cat "$name.err")"
    done
    [ "$(grep -c '^  remedy: ..*' "$name.err")" -eq 1 ]
    verdict $? "$name: no remedy"
    [ ! -e "$name.c" ] && [ ! -e "$name.h" ]
    verdict $? "$name: output in spite of an error"
}

# at_place KIND KEY: messages of this kind stand at the line of KEY, which is shown, with a caret under its first letter
at_place() {
    line=$(grep -n "^ *$2:" "$name.veh" | cut -d: -f1)
    grep -q "^$name\.veh:$line:3: $1: " "$name.err" && grep -A 1 "^    $2: " "$name.err" | grep -q '^    ^$'
    verdict $? "$name: not at line $line: $(cat "$name.err")"
}

# silent NAME...: the messages don't accuse them
silent() {
    for word in "$@"; do
        ! grep -q "'$word'" "$name.err"
        verdict $? "$name: accuses $word: $(cat "$name.err")"
    done
}

# warned COORDINATE VALUE...: one warning a value, and code all the same
warned() {
    coordinate=$1
    shift
    run 0
    at_place warning "$coordinate"
    sed -n "s/.*warning: coordinate '$coordinate' stops being independent at \([-0-9.e]*\), inside its range.*/\1/p" \
        "$name.err" >"$name.values"
    printf '%s\n' "$@" | paste -d ' ' - "$name.values" |
        awk '{ d = $1 - $2; if (NF != 2 || d > 1e-3 || d < -1e-3) bad = 1 } END { exit bad }'
    verdict $? "$name: warnings at $(tr '\n' ' ' <"$name.values")instead of $*"
    [ "$(grep -c 'warning:' "$name.err")" -eq $# ] && [ "$(grep -c 'error:' "$name.err")" -eq 0 ]
    verdict $? "$name: not $# warnings: $(cat "$name.err")"
    [ -s "$name.c" ] && [ -s "$name.h" ]
    verdict $? "$name: no output after a warning"
    cp "$name.veh" "$name.asked"
    cp "$name.err" "$name.said"
    heed_entries
    heed_ends
    mv "$name.asked" "$name.veh"
}

# heed_entries: the coordinates that the warnings name, in place of the one warned of
heed_entries() {
    sed -n "s/^  remedy: .*: \`\($coordinate: {.*}\)\`$/\1/p" "$name.said" >"$name.entries"
    [ "$(wc -l <"$name.entries")" -eq "$(grep -c 'warning:' "$name.said")" ]
    verdict $? "$name: no coordinate instead"
    while read -r entry; do
        sed "s/^  $coordinate: .*/  $entry/" "$name.asked" >"$name.veh"
        run 0
    done <"$name.entries"
}

# heed_ends: ranges that end before the values
heed_ends() {
    cp "$name.asked" "$name.veh"
    while read -r value; do
        for end in 's/range: \[[^,]*,/range: ['"$(echo "$value" | awk '{ print $1 + 0.01 }')"',/' \
            's/\(range: .*, \)[^]]*\]/\1'"$(echo "$value" | awk '{ print $1 - 0.01 }')"']/'; do
            sed "/^  $coordinate:/$end" "$name.veh" >"$name.tried"
            "$gicgen" "$name.tried" -o "$name.c" >/dev/null 2>"$name.err" && cp "$name.tried" "$name.veh" && break
        done
    done <"$name.values"
    good
}

# good: not a word
good() {
    run 0
    [ ! -s "$name.err" ] && [ -s "$name.c" ] && [ -s "$name.h" ]
    verdict $? "$name: $(cat "$name.err")"
}

# pendulum NAME X Y Z LOW HIGH: 1 m along x, hinged about y in the origin, with a strut of that range from (X, Y, Z)
# to its tip
pendulum() {
    model "$1" <<END
bodies:
  rod: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  strut: {type: length, bodies: [ground, rod], points: [[$2, $3, $4], [1, 0, 0]], range: [$5, $6]}
END
}

# four_bar NAME TYPE RANGE: crank 2 m (upright), coupler 2 m (level), rocker sqrt(5) m, ground 3 m; TYPE of the last
# joint
four_bar() {
    model "$1" <<END
bodies:
  crank: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}
  coupler: {mass: 1, com: [1, 0, 2], inertia: [1, 1, 1]}
  rocker: {mass: 1, com: [2.5, 0, 1], inertia: [1, 1, 1]}
joints:
  first: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [crank, coupler], point: [0, 0, 2], axis: [0, 1, 0]}
  third: {type: revolute, bodies: [ground, rocker], point: [3, 0, 0], axis: [0, 1, 0]}
  last: {type: $2, bodies: [coupler, rocker], point: [2, 0, 2], axis: [0, 1, 0]}
coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: [0, 1, 0], range: $3}
END
}

# ---- singular everywhere -------------------------------------------------------------------------------------

# a slide does not turn, and its place is not determined by an angle
model cart <<'END'
bodies:
  cart: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  rod: {mass: 1, com: [1, 3, 0], inertia: [1, 1, 1]}
joints:
  guide: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 3, 0], axis: [0, 1, 0]}
coordinates:
  turn: {type: angle, bodies: [ground, cart], axis: [1, 0, 0]}
  swing: {type: angle, bodies: [ground, rod], axis: [0, 1, 0]}
END
refused turn "'guide'" "'turn'" "the pose of 'cart' is not determined" "in every configuration" "(5 of 6 "
silent pivot swing rod

# two coordinates along the tube, none about it
model tubes <<'END'
bodies:
  sleeve: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  tube: {type: cylindrical, bodies: [ground, sleeve], point: [0, 0, 0], axis: [1, 0, 0]}
coordinates:
  slide: {type: translation, bodies: [ground, sleeve], axis: [1, 0, 0]}
  again: {type: length, bodies: [ground, sleeve], points: [[-1, 0, 0], [0, 0, 0]]}
END
refused again "'slide'" "'again'" "the pose of 'sleeve' is not determined" "in every configuration"
silent tube

# kingpin NAME X: the knuckle's upper links meet in one point above the lower ball joint; the tie rod ends X from the
# line between
kingpin() {
    model "$1" <<END
bodies:
  arm: {mass: 1, com: [0, 0.5, 0], inertia: [1, 1, 1]}
  knuckle: {mass: 1, com: [0, 1, 0.5], inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [1, 0, 0]}
  ball: {type: spherical, bodies: [arm, knuckle], point: [0, 1, 0]}
  upper: {type: distance, bodies: [ground, knuckle], points: [[0.3, 0.2, 1], [0, 1, 1]]}
  brace: {type: distance, bodies: [ground, knuckle], points: [[-0.3, 0.2, 1], [0, 1, 1]]}
  tie: {type: distance, bodies: [ground, knuckle], points: [[$2, 0.2, 0.4], [$2, 1, 0.5]]}
coordinates:
  travel: {type: angle, bodies: [ground, arm], axis: [1, 0, 0], range: [-0.1, 0.1]}
END
}
kingpin through_kingpin 0
refused tie "'tie'" "'ball'" "the pose of 'knuckle' is not determined" "in every configuration" "(5 of 6 "
silent hinge travel arm
kingpin beside_kingpin 0.15
good

# ---- singular at the design only -----------------------------------------------------------------------------

# the strut through the pivot does not feel a first turn of the rod
pendulum through -2 0 0 2.5 3.2
refused strut "'strut'" "the pose of 'rod' is not determined" "the design configuration is singular" "there, and only there" "(5 of 6 "

# coupler and rocker on one line
model dead_centre <<'END'
bodies:
  crank: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
  rocker: {mass: 1, com: [4, 0, 0], inertia: [1, 1, 1]}
joints:
  first: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [ground, rocker], point: [5, 0, 0], axis: [0, 1, 0]}
  coupler: {type: distance, bodies: [crank, rocker], points: [[1, 0, 0], [3, 0, 0]]}
coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: [0, 1, 0]}
END
refused coupler "'coupler'" "the pose of 'rocker' is not determined" "the design configuration is singular"
silent first turn crank

# ---- singular inside a range ---------------------------------------------------------------------------------

# strut and rod on one line: 2 + 1 and 2 - 1
pendulum far_end 0 0 -2 1.2 3.5
warned strut 3
pendulum near_end 0 0 -2 0.8 2.5
warned strut 1
# out of the plane by 0.5: sqrt(3^2 + 0.25) and sqrt(1 + 0.25); the low end is looked at first
pendulum skew 0 0.5 -2 1.0 3.5
warned strut 1.118034 3.041381
pendulum short_of_it 0 0.5 -2 1.13 3.03
good

# coupler and rocker on one line: the crank's tip is s = 2 + sqrt(5) from the rocker's pivot, so that the crank's
# angle c above the ground link has cos c = (2^2 + 3^2 - s^2) / 12, c = 1.995469; the coordinate is pi / 2 - c, and
# the mirror image pi / 2 + c
four_bar far_crank point_on_line '[-0.7, 3.8]'
warned turn -0.424673 3.566265
four_bar near_crank point_on_line '[-0.42, 3.56]'
good
# the same without a coupler of its own
model two_bodies <<'END'
bodies:
  crank: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}
  rocker: {mass: 1, com: [2.5, 0, 1], inertia: [1, 1, 1]}
joints:
  first: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [ground, rocker], point: [3, 0, 0], axis: [0, 1, 0]}
  coupler: {type: distance, bodies: [crank, rocker], points: [[0, 0, 2], [2, 0, 2]]}
coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: [0, 1, 0], range: [-0.7, 3.8]}
END
warned turn -0.424673 3.566265

# the shoulder turns back where strut and rod are on one line, and is told to be an angle there is not yet
model strut_and_rod <<'END'
bodies:
  upper: {mass: 1, com: [0, 0, -0.5], inertia: [0.1, 0.1, 0.1]}
  lower: {mass: 1, com: [0, 0, -1.5], inertia: [0.1, 0.1, 0.1]}
joints:
  shoulder: {type: revolute, bodies: [ground, upper], point: [0, 0, 0], axis: [0, 1, 0]}
  elbow: {type: revolute, bodies: [upper, lower], point: [0, 0, -1], axis: [0, 1, 0]}
coordinates:
  swing: {type: angle, bodies: [ground, upper], axis: [0, 1, 0], range: [-1, 1]}
  strut: {type: length, bodies: [ground, lower], points: [[1, 0, -1], [0, 0, -2]], range: [1.2, 1.7]}
END
run 0
grep -q "remedy: .*: .swing: {type: angle, bodies: \[upper, lower\], axis: \[0, 1, 0\]}" "$name.err"
verdict $? "$name: another angle: $(cat "$name.err")"

# ---- too many, too few ---------------------------------------------------------------------------------------

model too_few <<'END'
bodies:
  rod: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, 1, 0]}
END
refused rod "'rod' has 1 degree of freedom more" "'pivot'" "add a dual coordinate"

model too_many <<'END'
bodies:
  rod: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  swing: {type: angle, bodies: [ground, rod], axis: [0, 1, 0]}
  strut: {type: length, bodies: [ground, rod], points: [[0, 0.5, -2], [1, 0, 0]]}
END
refused strut "'pivot'" "'swing'" "'strut'" "7 conditions" "'rod', 1 more"

# as many equations as unknowns, but not where they are needed
model misplaced <<'END'
bodies:
  one: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
  two: {mass: 1, com: [1, 1, 0], inertia: [1, 1, 1]}
joints:
  first: {type: revolute, bodies: [ground, one], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [ground, two], point: [0, 1, 0], axis: [0, 1, 0]}
coordinates:
  swing: {type: angle, bodies: [ground, one], axis: [0, 1, 0]}
  strut: {type: length, bodies: [ground, one], points: [[0, 0.5, -2], [1, 0, 0]]}
END
refused strut "'first'" "'swing'" "'strut'" "'one', 1 more" "'two' is under-determined"
silent second

# a plane loop of four revolutes says three times that it is plane
four_bar revolutes revolute '[-0.4, 0.5]'
refused last "'first'" "'second'" "'third'" "'last'" "'turn'" "'crank'" "'coupler'" "'rocker'" "21 conditions" "3 more" \
    "make joint 'last' (revolute, 5) a point_on_line (2)"
four_bar line point_on_line '[-0.4, 0.5]'
good

# ---- lengths that do not fit ---------------------------------------------------------------------------------

# The crank's tip stands 1 above its pivot, sqrt(10) from the rocker's, whose own tip turns on 2: the tips are between
# sqrt(10) - 2 = 1.16 and sqrt(10) + 2 = 5.16 apart.
fitted() {
    model "$1" <<END
bodies:
  crank: {mass: 1, com: [0, 0, 0.5], inertia: [1, 1, 1]}
  rocker: {mass: 1, com: [3, 0, 1], inertia: [1, 1, 1]}
joints:
  first: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  second: {type: revolute, bodies: [ground, rocker], point: [3, 0, 0], axis: [0, 1, 0]}
  coupler: {type: distance, bodies: [crank, rocker], points: [[0, 0, 1], [3, 0, 2]], length: $2}
coordinates:
  turn: {type: angle, bodies: [ground, crank], axis: [0, 1, 0], range: [-0.05, 0.05]}
END
}
for length in 9 5.2 1.1 0.5; do
    fitted "unfit" $length
    refused coupler "can't be assembled" "'rocker'" "'coupler'"
done
for length in 5 1.4; do
    fitted "fit" $length
    good
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
