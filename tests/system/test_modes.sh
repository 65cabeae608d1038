#!/bin/sh
# SPDX-License-Identifier: MIT
# test_modes.sh GICGEN GICRUN STATES RANDOM_VEHICLE LINEARIZED QUAD_LINEAR: small motions, `gicrun --modes`. Derivatives
# are exact: matrices at random states, and eigenvalues, against differences in quad precision of the independent
# solution. Both are rounded to double once, so that 1e-12 of a row's largest entry is generous (found: 1e-14) and small
# against every mistake. Eigenvalues of a damped spring in closed form; the table in models/hmmwv.veh, which was found
# independently, to its two places.
gicgen=$1
gicrun=$2
states=$3
random_vehicle=$4
linearized=$5
quad_linear=$6
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/lib/checking.sh"
# scene LINE...: a scene with them
scene() { printf 'gicscene: 1\nduration: 1\nstep: 0.01\n'; printf '%s\n' "$@"; }

# matrices MODEL ROWS [SCENE ROAD]: at random states, moving and turning; ROWS: how many, or `N,N...`: which of them
matrices() {
    "$gicgen" --dump-model "$1" >"$work/dump" && "$states" "$work/dump" --count 16 --seed 3 |
        awk -v rows=",$2," 'NR == 1 || index(rows, "," NR - 1 ",") || (rows + 0 == rows && NR - 1 <= rows)' \
            >"$work/states" &&
        "$linearized" "$1" "$work/states" ${3:+"$3"} >"$work/matrices" &&
        "$quad_linear" "$work/dump" "$work/states" --matrices "$work/matrices" --tolerance 1e-12 ${4:+--road "$4"} \
            >"$work/out" 2>"$work/err"
}

for name in pendulum quarter_car andrews hmmwv_full trailing_arm solid_axle five_link hmmwv14; do
    check "derivatives of $name" matrices "$root/models/$name.veh" 1
done
scene 'road: {type: sine, amplitude: 0.05, wavelength: 5, start: 1, phase_per_y: 0.3}' >"$work/sine.scene"
check 'derivatives of hmmwv on waves' matrices "$root/models/hmmwv.veh" 2 "$work/sine.scene" sine:0.05,5,1,0.3
# wheels with tires: one that moves near the road, one that stands still, where slips turn abs() around
for name in hmmwv_tires hmmwv_tmeasy hmmwv_vehicle; do
    check "derivatives of $name" matrices "$root/models/$name.veh" 2,16
done
check 'derivatives of every function of formulas' matrices "$root/tests/data/laws/cart.veh" 3
for seed in 3 21; do
    "$random_vehicle" --seed $seed >"$work/random.veh"
    check "derivatives of random vehicle $seed" matrices "$work/random.veh" 1
done
# the comparison can fail
sed 's/stiffness: 283000/stiffness: 283001/' "$root/models/quarter_car.veh" >"$work/other.veh"
"$gicgen" --dump-model "$root/models/quarter_car.veh" >"$work/dump"
"$states" "$work/dump" --count 4 --seed 3 >"$work/states"
"$linearized" "$work/other.veh" "$work/states" >"$work/matrices"
check 'a stiffness that is 4e-6 off shows' [ "$("$quad_linear" "$work/dump" "$work/states" --matrices \
    "$work/matrices" --tolerance 1e-12 >"$work/out"; echo $?)" -eq 1 ]

# eigenvalues MODEL [SCENE [SPEED]]: of the table on file
eigenvalues() {
    "$gicgen" --dump-model "$1" >"$work/dump" &&
        "$gicrun" --equilibrium "$1" ${2:+"$2"} -o "$work/rest" >"$work/out" 2>"$work/err" &&
        "$gicrun" --modes "$1" ${2:+"$2"} -o "$work/modes" >"$work/out" 2>"$work/err" &&
        awk -F, -v OFS=, -v speed="${3:-0}" 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ "^v.x ") c = i}
            NR == 2 && c {$c = speed} {print}' "$work/rest" >"$work/states" &&
        "$quad_linear" "$work/dump" "$work/states" --modes "$work/modes" --tolerance 1e-11 >"$work/out" 2>"$work/err"
}
# a coordinate that is called like a displacement of the base
sed "s/^  rack: *{type: translation,/  roll: {type: translation,/; s/coordinate: rack/coordinate: roll/; s|parts/|$root/models/parts/|g" \
    "$root/models/hmmwv.veh" >"$work/other.veh"
run --modes "$work/other.veh" -o "$work/modes"
check 'a coordinate called roll' [ "$(head -1 "$work/modes" | tr , '\n' | grep -c '^share\.roll$\|^share\.coordinate/roll$')" = 2 ]
for name in hmmwv quarter_car andrews; do
    check "eigenvalues of $name" eigenvalues "$root/models/$name.veh"
done
scene 'initial: {velocity: [20, 0, 0]}' >"$work/moving.scene"
check 'eigenvalues of hmmwv at 20 m/s' eigenvalues "$root/models/hmmwv.veh" "$work/moving.scene" 20

# a mass on a spring: lambda = -c / 2 m +- i sqrt(k / m - (c / 2 m)^2), or two real ones; f = sqrt(k / m) / 2 pi
cat >"$work/spring.veh" <<'END'
gicgen: 1
model: spring
base: ground
bodies:
  swings: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
  creeps: {mass: 2, com: [0, 1, 0], inertia: [1, 1, 1]}
  floats: {mass: 2, com: [0, 2, 0], inertia: [1, 1, 1]}
joints:
  swings: {type: prismatic, bodies: [ground, swings], axis: [1, 0, 0]}
  creeps: {type: prismatic, bodies: [ground, creeps], axis: [1, 0, 0]}
  floats: {type: prismatic, bodies: [ground, floats], axis: [1, 0, 0]}
coordinates:
  swings: {type: translation, bodies: [ground, swings], axis: [1, 0, 0], range: [-5, 5]}
  creeps: {type: translation, bodies: [ground, creeps], axis: [1, 0, 0], range: [-5, 5]}
  floats: {type: translation, bodies: [ground, floats], axis: [1, 0, 0], range: [-5, 5]}
forces:
  swings: {type: spring_damper, coordinate: swings, stiffness: 200, damping: 24}
  creeps: {type: spring_damper, coordinate: creeps, stiffness: 18, damping: 20}
END
run --modes "$work/spring.veh" -o "$work/modes"
check 'springs have modes' exits 0
check 'eigenvalues, frequencies, damping and time constants of springs' awk -F, '
    function near(i, value) {d = $i - value; if (!($i != "" && d * d < 1e-24)) bad = 1}
    NR == 4 {near(1, -1); near(2, 0); if ($3 $4 != "") bad = 1; near(5, 1); near(7, 1)}
    NR == 5 {near(1, -9); near(5, 1 / 9); near(7, 1)}
    NR == 6 {near(1, -6); near(2, 8); near(3, 10 / 6.283185307179586); near(4, 0.6); near(5, 1 / 6); near(6, 1)}
    (NR == 2 || NR == 3) && $1 $2 $3 != "00" {bad = 1}
    END {exit bad || NR != 6}' "$work/modes"
check 'what nothing holds is neutral' prints '^ *0  2 eigenvalues that are zero: neutral in floats$'
check 'what moves is named' prints '8.0000i .* swings 100 %$'

run --modes "$root/models/hmmwv.veh"
check 'the modes of the HMMWV are printed' exits 0
check 'x, y and yaw are neutral' prints '6 eigenvalues that are zero: neutral in x, y, yaw$'
# the table in the model's head comment, and what moves
for mode in '-3.21 7.51 z' '-4.95 11.04 roll' '-5.50 12.54 pitch' '-9.44 9.79 rack' '-20.45 48.75 spring_f' \
    '-21.05 50.49 spring_f' '-28.87 47.43 spring_r' '-27.60 49.99 spring_r'; do
    check "the mode $mode" awk -v mode="$mode" 'BEGIN {split(mode, m, " ")}
        $2 == "+-" && sprintf("%.2f", $1) == m[1] && sprintf("%.2f", $3) == m[2] && $8 ~ "^" m[3] {found = 1}
        END {exit !found}' "$work/out"
done
check 'all of them are in the comment' [ "$(sed '/^constant steps/,$d' "$work/out" | grep -c '+-')" -eq 8 ]
run --modes "$root/models/hmmwv.veh" "$work/moving.scene"
check 'at a speed it says that this is no equilibrium' prints 'the largest acceleration is'
# a body that flies straight ahead and turns: in its own frame its velocity turns the other way, by omega x u
printf 'gicgen: 1\nmodel: top\nbase: top\ngravity: [0, 0, 0]\nbodies:\n  top: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}\n' \
    >"$work/top.veh"
scene 'initial: {velocity: [2, 0, 0], angular_velocity: [0, 0, 3]}' >"$work/turning.scene"
run --modes "$work/top.veh" "$work/turning.scene"
check 'a velocity that turns is no steady one' prints 'the largest acceleration is -6 m/s^2 or rad/s^2 of y, then 0'
run --modes "$root/models/hmmwv.veh" -o -
check 'CSV on standard output, and nothing else' [ "$(awk -F, 'NR == 1 && /^real / {n = NF} NF != n' "$work/out" | wc -l)" -eq 0 ]

# with tires: yaw and sideslip of a bicycle with the same axles; what moves is named
scene 'initial: {speed: 20}' >"$work/moving.scene"
bicycle() {
    "$gicgen" --dump-model "$1" >"$work/dump" && "$gicrun" --equilibrium "$1" -o "$work/rest" >"$work/out" &&
        awk -F, -v OFS=, 'NR == 1 {print; for (i = 1; i <= NF; ++i) {sub(/ .*/, "", $i); at[$i] = i}}
            NR == 2 {for (k = -1; k <= 1; k += 2) {$at["v.x"] = 20
                for (name in at) if (name ~ /slip_y$/) $at[name] = k * 0.001; else if (name ~ /slip_x$/) $at[name] = 0
                else if (name ~ /spin$/) $at[name] = 20 / 0.455
                print}}' "$work/rest" >"$work/states" &&
        "$gicrun" --engine gic --eval "$work/states" "$1" -o "$work/eval" &&
        "$gicrun" --modes "$1" "$work/moving.scene" -o "$work/modes" &&
        /usr/bin/python3 -B "$root/tests/data/modes/bicycle.py" "$work/dump" "$work/eval" "$work/modes" 20 >>"$work/out" 2>&1
}
for name in hmmwv_tires hmmwv_tmeasy; do
    check "yaw and sideslip of $name" bicycle "$root/models/$name.veh"
done
run --modes "$root/models/hmmwv_tires.veh" "$work/moving.scene"
check 'tires and spins are named' prints 'tire_f_l.slip_y 4'
check 'spins oscillate with slips' prints 'i .*slip_x 2.*spin 2'
check 'the accelerations that remain are named' prints 'largest acceleration is -0.0[0-9]* m/s^2 or rad/s^2 of x, then'
check 'windups of free brakes are neutral' prints 'neutral in x, y, yaw, tire_f_l.brake'

# equal eigenvalues: two equal oscillators side by side, and a cab on four mounts, whose motions along x and y are alike. Each of
# the six motions moves in one pair of modes altogether: shares of a number over all modes are 1
oscillator() {
    echo "$2: {type: translation, bodies: [ground, $1], axis: [1, 0, 0]}"
}
cat >"$work/twins.veh" <<END
gicgen: 1
model: twins
base: ground
bodies:
  a: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  b: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  a: {type: prismatic, bodies: [ground, a], axis: [1, 0, 0]}
  b: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}
coordinates:
  $(oscillator a x)
  $(oscillator b y)
forces:
  a: {type: spring_damper, coordinate: x, stiffness: 1, damping: 0.1}
  b: {type: spring_damper, coordinate: y, stiffness: 1, damping: 0.1}
END
cat >"$work/cab.veh" <<END
gicgen: 1
model: cab
base: ground
bodies:
  cab: {mass: 100, com: [0, 0, 1], inertia: [10, 10, 10]}
coordinates:
  $(oscillator cab x)
  y: {type: translation, bodies: [ground, cab], axis: [0, 1, 0]}
  z: {type: translation, bodies: [ground, cab], axis: [0, 0, 1]}
  r: {type: angle, bodies: [ground, cab], axis: [1, 0, 0]}
  p: {type: angle, bodies: [ground, cab], axis: [0, 1, 0]}
  w: {type: angle, bodies: [ground, cab], axis: [0, 0, 1]}
forces:
$(for x in 1 -1; do for y in 1 -1; do
    echo "  mount_$((x + 2))_$((y + 2)): {type: bushing, bodies: [ground, cab], point: [$x, $y, 0], stiffness: [1e4, 1e4, 1e4, 0, 0, 0]}"
done; done)
END
shares() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^share/) at[i] = $i }
        NR > 1 { for (i in at) sum[i] += $i }
        END { for (i in at) { ++n; if (sum[i] < 1 - 1e-9 || sum[i] > 1 + 1e-9) { print at[i], sum[i]; bad = 1 } } exit bad || !n }' "$1"
}
for name in twins cab; do
    run --modes -q "$work/$name.veh" -o "$work/$name.csv"
    check "equal eigenvalues of $name" shares "$work/$name.csv"
done

# critically damped: eigenvectors of the fourfold -1 are dependent, and the shares are those of all four together; beside
# another motion, which has no part in it. 1e-6: what rounding makes of a double eigenvalue is 1e-8
critical() {
    sed "s/coordinate: x, stiffness: 1, damping: 0.1/coordinate: x, stiffness: 1, damping: 2/; s/coordinate: y, stiffness: 1, damping: 0.1/coordinate: y, stiffness: $1, damping: $2/" \
        "$work/twins.veh" >"$work/critical.veh"
    run --modes -q "$work/critical.veh" -o "$work/critical.csv"
    awk -F, -v own="$3" 'function off(a, b) { return a < b - 1e-6 || a > b + 1e-6 }
        NR == 1 { for (i = 1; i <= NF; ++i) { if ($i == "share.x") x = i; if ($i == "share.y") y = i } next }
        { real = !off($1, -1); n += real; if (off($x, real ? own : 0) || off($y, real ? 1 - own : 1)) bad = 1 }
        END { exit bad || n != (own < 1 ? 4 : 2) }' "$work/critical.csv"
}
check 'two critically damped motions' critical 1 2 0.5
check 'one beside an undamped one' critical 4 0 1
check 'one beside a damped one' critical 4 1 1

run --modes --eval "$work/states" "$root/models/hmmwv.veh"
check '--modes and --eval are one too many' exits 2
run --modes "$root/models/hmmwv.veh" --plot "$work/a.svg"
check 'no picture of modes' exits 2

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
