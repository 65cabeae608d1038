#!/bin/sh
# SPDX-License-Identifier: MIT
# test_rounding.sh GICGEN GICRUN QUAD_LINEAR: nothing hangs on the sign of a number that is zero but for rounding.
# Eigenvalues at kinks: in closed form, and against central differences in quad precision of the independent solution.
# Rests of standing and of moving scenes: by two commands, and by another engine.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
quad_linear=$(realpath "$3")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
cd "$work" || exit 1

# ---- eigenvalues at kinks ---------------------------------------------------------------------------------------

# Five slides of 2 kg that rest on a kink each; the mean of both sides counts:
#   bumper  touches a spring: k = 200 + 100 / 2                -> +- i sqrt(125)
#   damper  one way: k = 200, c = 24 / 2                       -> -3 +- i sqrt(91)
#   valve   linear table of slopes 10 and 30: k = 18, c = 20   -> -1, -9
#   rub     |v| times a preload: k = 200                       -> +- 10 i
#   root    sqrt(v^2), and -3 v to the right, 5 v to the left: k = 200, c = (3 - 5) / 2 = -1
#                                                              -> 1 / 4 +- i sqrt(100 - 1 / 16)
{
    printf 'gicgen: 1\nmodel: kinks\nbase: ground\nparameters:\n  off: {value: 0, unit: "1", tunable: true}\n'
    printf 'tables:\n  valve: {x: [-1, 0, 1], y: [-10, 0, 30], interpolation: linear, beyond: linear}\n'
    slides='bumper damper valve rub root'
    echo 'bodies:'
    # shellcheck disable=SC2086  # a list of words
    printf '  %s: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}\n' $slides
    echo 'joints:'
    for slide in $slides; do echo "  $slide: {type: prismatic, bodies: [ground, $slide], axis: [1, 0, 0]}"; done
    echo 'coordinates:'
    for slide in $slides; do
        echo "  $slide: {type: translation, bodies: [ground, $slide], axis: [1, 0, 0], range: [-5, 5]}"
    done
    echo 'forces:'
    for slide in $slides; do
        [ "$slide" = valve ] && k=18 || k=200
        echo "  $slide: {type: spring_damper, coordinate: $slide, stiffness: $k}"
    done
    echo '  one_way: {type: force, coordinate: damper,
    value: "-if(rate(damper) + off > 0, 24, 0) * abs(rate(damper) + off)"}
  opens: {type: force, coordinate: valve, value: "-valve(rate(valve) + off)"}
  rubs: {type: force, coordinate: rub, value: "-7 * abs(rate(rub) + off)"}
  squares: {type: force, coordinate: root, value: "-7 * sqrt((rate(root) + off)^2)
    - if(not (rate(root) + off < 0) and rate(root) > -1, 3, 5) * abs(rate(root) + off)"}
  touches: {type: force, coordinate: bumper, value: "-100 * max(0, bumper + off)"}'
} >kinks.veh
awk 'BEGIN {printf "%.9f %.9f\n%.9f %.9f\n%.9f %.9f\n%.9f %.9f\n%.9f %.9f\n%.9f %.9f\n",
    0, sqrt(125), -3, sqrt(91), -1, 0, -9, 0, 0, 10, 1 / 4, sqrt(100 - 1 / 16)}' | LC_ALL=C sort >wanted

# kinks_at OFF: eigenvalues with the kinks so far from rest, to 9 places
kinks_at() {
    printf 'gicscene: 1\nduration: 1\nstep: 0.01\nparameters: {off: %s}\n' "$1" >off.scene
    run --modes kinks.veh off.scene -o modes
    exits 0 && awk -F, 'NR > 1 {printf "%.9f %.9f\n", $1, $2}' modes | sed 's/^-\(0\.0* \)/\1/' | LC_ALL=C sort >said
}
for off in 0 1e-25 -1e-25 1e-17 -1e-17 1e-12 -1e-12; do
    check "five kinks $off from where it rests" kinks_at $off
    check "their eigenvalues, $off beside them" cmp said wanted
done
kinks_at 1e-3
cp said above
check 'off a kink eigenvalues are those of one side' [ "$(cmp -s above wanted; echo $?)" -eq 1 ]
kinks_at -1e-3
check 'and of the other' [ "$(cmp -s above said; echo $?)" -eq 1 ]
: >said

# a force that jumps has no small motions about that place
sed 's/"-100 \* max.*"/"if(rate(bumper) > 0, -1, 0)"/' kinks.veh >jump.veh
run --modes jump.veh -o modes
check 'a jump is told of' says 'warning: an acceleration jumps where the rate of bumper passes'
run --modes kinks.veh -o modes
check 'a kink is no jump' [ ! -s err ]

# critical damping, c^2 = 4 k m, is a double eigenvalue: two rows, whichever way it rounds; less is a pair
for damping in 40 39.999999999999 40.000000000001 39.999; do
    sed "/^forces:/,\$d" kinks.veh >critical.veh
    { echo 'forces:'; for slide in $slides; do
        echo "  $slide: {type: spring_damper, coordinate: $slide, stiffness: 200, damping: $damping}"; done; } >>critical.veh
    run --modes critical.veh -o modes
    [ $damping = 39.999 ] && rows=5 || rows=10
    check "critical damping, $damping N s/m" awk -F, -v rows="$rows" 'NR > 1 {if (!(($1 + 10)^2 < 1e-6)) bad = 1
        if (rows == 10 && $2 $3 $4 != "0") bad = 1; if (rows == 5 && !(($2^2 + $1^2 - 100)^2 < 1e-12)) bad = 1}
        END {exit bad || NR != rows + 1}' modes
done

# A vehicle on a slope of 15 percent, made by gravity, for the reference's road is flat. With little brake its windups are
# above 0.7, where they slip one way.
sed "s|parts/|$models/parts/|" "$models/hmmwv_tires.veh" >car.veh
echo 'gravity: [-1.45, 0.4, -9.67]' >>car.veh
"$gicgen" --dump-model car.veh >dump 2>said
# scene BRAKE: at rest, up to what `initial` holds
scene() { printf 'gicscene: 1\nduration: 0.2\nstep: 0.002\ninputs: {brake: %s}\n' "$1"; }
# alike A B WITHIN: tables of eigenvalues, relative to their size and 1
alike() {
    paste -d, "$1" "$2" | awk -F, -v within="$3" 'NR > 1 {
            n = NF / 2
            if (!(sqrt(($1 - $(n + 1))^2 + ($2 - $(n + 2))^2) <= within * (1 + sqrt($1^2 + $2^2)))) {
                print "row", NR ":", $1, $2, "and", $(n + 1), $(n + 2)
                bad = 1
            }
        }
        END {exit bad || NR < 20}' >said
}
for brake in 0.7 0.13; do
    { scene $brake; echo 'initial: {equilibrium: true}'; } >parked.scene
    run --equilibrium car.veh parked.scene
    check "brake $brake holds it" exits 0
    sed -n '/^initial:/,$p' out >initial
    [ $brake = 0.7 ] || check 'its windups slip' [ "$(awk '/brake:/ && $2 * $2 > 0.49' initial | wc -l)" -gt 0 ]
    "$gicrun" --equilibrium car.veh parked.scene -o rest >out 2>err
    run --modes car.veh parked.scene -o modes
    "$quad_linear" dump rest --modes modes --tolerance 1e-9 >out 2>err
    verdict $? "eigenvalues with brake $brake, by differences in quad precision"
    for turn in '0 0 0 0' '1 1 1 1' '-1 -1 -1 -1' '1 -1 -1 1' '-1 1 1 1'; do
        { scene $brake; awk -v turn="$turn" 'BEGIN {split(turn, t, " ")}
            /\.spin:/ {$0 = "    " $1 " " (t[++n] == 0 ? 0 : t[n] "e-25")} {print}' initial; } >turned.scene
        run --modes car.veh turned.scene -o turned
        check "brake $brake, spins of ($turn) 1e-25 rad/s" alike modes turned 1e-7
    done
done
: >said

# ---- one rest for one scene -------------------------------------------------------------------------------------

# starting WAY INITIAL: a scene on the level, its base seen
starting() {
    { scene 0; echo "initial: {$2}"; echo 'outputs: [chassis, chassis_orientation, spring_f_l, spring_f_r]'; } >"$1.scene"
}
car=$models/hmmwv_tires.veh
# columns FILE NAME...: of its first row
columns() {
    awk -F, -v names="$(shift; echo " $* ")" 'NR == 1 {for (i = 1; i <= NF; ++i) {sub(/ .*/, "", $i); if (index(names, " " $i " ")) n[++k] = i}}
        NR == 2 {for (i = 1; i <= k; ++i) print $n[i]}' "$1"
}
# near A B: numbers, line by line
near() {
    paste "$1" "$2" | awk '{d = $1 - $2; if (!(NF == 2 && d * d <= 4e-18)) {print; bad = 1}} END {exit bad || NR != 8}' >said
}
for way in 0 1e-25 -1e-25 1 -18 18; do
    starting still "speed: $way"
    starting run "speed: $way, equilibrium: true"
    "$gicrun" --equilibrium "$car" still.scene -o rest >out 2>err
    "$gicrun" -q "$car" run.scene -o results >out 2>err
    columns rest r.x r.y r.z e0 e1 e2 e3 spring_f_l >a
    columns results chassis.x chassis.y chassis.z chassis_orientation.e0 chassis_orientation.e1 chassis_orientation.e2 \
        chassis_orientation.e3 spring_f_l.value >b
    check "speed $way: a run starts at the equilibrium that is printed" near a b
    "$gicrun" -q --engine gic "$car" run.scene -o results >out 2>err
    columns results chassis.x chassis.y chassis.z chassis_orientation.e0 chassis_orientation.e1 chassis_orientation.e2 \
        chassis_orientation.e3 spring_f_l.value >b
    check "speed $way: with gic, too" near a b
    cp a "rest$way"
    # an engine that shares no code finds no acceleration there
    "$gicrun" --engine gic --eval rest "$car" -o evaluated >out 2>err &&
        awk -F, 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ /^(a|alpha)\.|acceleration|slip.*rate/ && $i !~ /output/) n[++k] = i}
            NR == 2 {for (i = 1; i <= k; ++i) if (!($n[i]^2 < 1e-18)) bad = 1} END {exit bad || k != 18}' evaluated
    verdict $? "speed $way: nothing accelerates there"
    columns rest spring_f_l spring_f_r spring_r_l spring_r_r | awk '{v[NR] = $1}
        END {exit !((v[1] - v[2])^2 < 1e-24 && (v[3] - v[4])^2 < 1e-24)}'
    verdict $? "speed $way: left is as right"
    # what is printed for scenes starts there as well; on the level road a speed from an equilibrium is level
    run --equilibrium "$car" still.scene
    { scene 0; sed -n '/^initial:/,$p' out; echo "  velocity: [$way, 0, 0]"; echo 'outputs: [chassis, chassis_orientation]'; } >printed.scene
    "$gicrun" -q "$car" printed.scene -o printed >out 2>err
    cut -d, -f1-8 results | sed -n '$p' | tr , '\n' >a
    cut -d, -f1-8 printed | sed -n '$p' | tr , '\n' >b
    [ "$(wc -l <b)" -eq 8 ] && paste a b | awk '{d = $1 - $2; if (!(d * d < 1e-14)) {print; bad = 1}} END {exit bad}' >said
    verdict $? "speed $way: a run from what is printed ends where that with \`equilibrium: true\` ends"
done
check 'a speed of 1e-25 m/s stands' near rest0 rest1e-25
check 'one of -1e-25, too' near rest0 rest-1e-25
check 'moving scenes rest on locked wheels at every speed' near rest1 rest18
check 'forwards and backwards' near rest-18 rest18
: >said

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
