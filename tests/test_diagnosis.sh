#!/bin/sh
# SPDX-License-Identifier: MIT
# test_diagnosis.sh GICGEN: what is said about mechanisms whose coordinates don't determine them: everywhere, at the design only, or
# from some value of a coordinate on. The values are derived by hand beside each mechanism.
gicgen=$(realpath "$1")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
passed=0
failed=0

check() {
    if [ "$1" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $2"
    fi
}

# model NAME: NAME.veh from standard input, on the ground
model() {
    name=$1
    { printf '%s\n' "gicgen: 1" "model: $name" "base: ground"; cat; } >"$name.veh"
}

# run STATUS: generates the last model; $name.err holds the messages
run() {
    "$gicgen" "$name.veh" -o "$name.c" >"$name.out" 2>"$name.err"
    status=$?
    [ $status -eq "$1" ]
    check $? "$name: exit status $status instead of $1"
    [ ! -s "$name.out" ]
    check $? "$name: words on standard output"
}

# refused PLACE WORD...: one error at PLACE (the key after which it is looked for), with all the words; nothing written
refused() {
    place=$1
    shift
    run 1
    [ "$(grep -c 'error:' "$name.err")" -eq 1 ] && [ "$(grep -c 'warning:' "$name.err")" -eq 0 ]
    check $? "$name: not one error: $(cat "$name.err")"
    at_place error "$place"
    for word in "$@"; do
        grep -q -e "$word" "$name.err"
        check $? "$name: says nothing about $word: $(cat "$name.err")"
    done
    [ "$(grep -c '^  remedy: ..*' "$name.err")" -eq 1 ]
    check $? "$name: no remedy"
    [ ! -e "$name.c" ] && [ ! -e "$name.h" ]
    check $? "$name: output in spite of an error"
}

# at_place KIND KEY: messages of this kind stand at the line of KEY, which is shown, with a caret under its first letter
at_place() {
    line=$(grep -n "^ *$2:" "$name.veh" | cut -d: -f1)
    grep -q "^$name\.veh:$line:3: $1: " "$name.err" && grep -q "^  *$2: " "$name.err" && grep -q '^ *^$' "$name.err"
    check $? "$name: not at line $line: $(cat "$name.err")"
}

# silent WORD...: the messages don't accuse them
silent() {
    for word in "$@"; do
        ! grep -q "'$word'" "$name.err"
        check $? "$name: accuses $word: $(cat "$name.err")"
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
    printf '%s\n' "$@" | paste -d ' ' - "$name.values" | awk '{ d = $1 - $2; if (NF != 2 || d > 1e-3 || d < -1e-3) bad = 1 }
        END { exit bad }'
    check $? "$name: warnings at $(tr '\n' ' ' <"$name.values")instead of $*"
    [ "$(grep -c 'warning:' "$name.err")" -eq $# ] && [ "$(grep -c 'error:' "$name.err")" -eq 0 ]
    check $? "$name: not $# warnings: $(cat "$name.err")"
    [ -s "$name.c" ] && [ -s "$name.h" ]
    check $? "$name: no output after a warning"
}

# good: not a word
good() {
    run 0
    [ ! -s "$name.err" ] && [ -s "$name.c" ] && [ -s "$name.h" ]
    check $? "$name: $(cat "$name.err")"
}

# pendulum NAME X Y Z LOW HIGH: 1 m along x, hinged about y in the origin, with a strut of that range from (X, Y, Z) to its tip
pendulum() {
    model "$1" <<END_MODEL
bodies:
  rod: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  strut: {type: length, bodies: [ground, rod], points: [[$2, $3, $4], [1, 0, 0]], range: [$5, $6]}
END_MODEL
}

# four_bar NAME TYPE RANGE: crank 2 m (upright), coupler 2 m (level), rocker sqrt(5) m, ground 3 m; TYPE of the last joint
four_bar() {
    model "$1" <<END_MODEL
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
END_MODEL
}

# ---- singular everywhere ------------------------------------------------------------------------------------------

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
