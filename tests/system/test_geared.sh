#!/bin/sh
# SPDX-License-Identifier: MIT
# test_geared.sh GICGEN GICRUN: joints `screw` and `rack_and_pinion` (FORMAT.md section 4), over several turns, whether the
# turn or the way is the coordinate: places, rest and frequencies in closed form; states far apart, in any order; energy; a
# ratio that is tunable; runs of every engine and way of generating against the engine gic; the mirror; mistakes.
# Accelerations and reactions against quad precision are in test_accelerations.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

scene() {
    printf 'gicscene: 1\nduration: %s\nstep: %s\noutput_step: 0.1\nintegrator: rk4\n' "$1" "$2"
    shift 2
    printf '%s\n' "$@"
}

# ---- a steering wheel and its rack: 0.01 m a radian, or a screw on the wheel's own axis
# steering NAME COORDINATE JOINT
steering() {
    cat <<END
gicgen: 1
model: $1
gravity: [0, 0, 0]
base: ground
inputs: {load: {unit: N}}
bodies:
  rack: {mass: 3, com: [0.2, 0, 0.1], inertia: [0.5, 0.01, 0.5]}
  wheel: {mass: 2, com: [0, 0.3, 0.4], inertia: [0.1, 0.02, 0.1]}
joints:
  rail: {type: prismatic, bodies: [ground, rack], axis: [0, 1, 0]}
  column: {type: revolute, bodies: [ground, wheel], point: [0, 0.3, 0.4], axis: [-1, 0, 2]}
  teeth: $3
coordinates: {turn: $2}
forces:
  center: {type: spring_damper, bodies: [ground, rack], points: [[0.2, -1, 0.1], [0.2, 0, 0.1]], stiffness: 1000}
  push: {type: load, body: rack, force: [0, load, 0]}
outputs:
  rack: {type: position, body: rack}
  wheel: {type: orientation, body: wheel}
  teeth: {type: reaction, joint: teeth, in: rack}
  e: {type: energy}
END
}
teeth='{type: rack_and_pinion, bodies: [rack, wheel], point: [0.2, 0.3, 0], axes: [[-1, 0, 2], [0, 1, 0]], ratio: 0.01}'
by_turn='{type: angle, bodies: [ground, wheel], axis: [-1, 0, 2], range: [-14, 14]}'
by_way='{type: translation, bodies: [ground, rack], axis: [0, 1, 0], range: [-0.14, 0.14]}'
steering turned "$by_turn" "$teeth" >turned.veh
steering moved "$by_way" "$teeth" >moved.veh
for engine in auto gic gcp1 'auto --recovery newton'; do
    # states in an order that no drive would have, whole turns apart
    for turn in 0 6.283185307179586 12.566370614359172 -12.566370614359172 3 -3.5 13.9 -13.9 0.001; do echo $turn; done >turns
    awk 'BEGIN { print "turn,turn.rate" } { print $1 ",0" }' turns >turned.states
    awk 'BEGIN { print "turn,turn.rate" } { printf "%.17g,0\n", $1 * 0.01 }' turns >moved.states
    for model in turned moved; do
        # shellcheck disable=SC2086  # options
        "$gicrun" --engine $engine --eval $model.states $model.veh -o eval.csv 2>err
        # (3 r^2 + 0.1) turn'' = -1000 r^2 turn, and the rack the same by r
        { echo && cat turns; } | paste -d, - eval.csv | awk -F, -v r="$([ $model = turned ] && echo 1 || echo 0.01)" '
            NR == 1 { for (i = 2; i <= NF; ++i) { if ($i ~ /^status/) k = i; if ($i ~ /^turn.acceleration/) a = i } next }
            { right = -0.1 * $1 / 0.1003 * r; d = $a - right; if ($k != 0 || !(d * d <= 1e-18 * r * r)) bad = 1 } END { exit bad || NR != 10 }'
        verdict $? "turns in any order, $model, $engine"
    done
done
# runs from there
for turn in 0 6.283185307179586 -12.5 13.9; do
    way=$(awk "BEGIN { printf \"%.17g\", 0.01 * $turn }")
    for model in turned moved; do
        scene 0.1 0.1 "initial: {coordinates: {turn: $([ $model = turned ] && echo "$turn" || echo "$way")}}" >start.scene
        "$gicrun" -q $model.veh start.scene -o start.csv 2>err
        sed -n 2p start.csv | awk -F, -v t="$turn" '{ d = $3 - 0.01 * t; s = sin(t / 2)
            f = ($6 * $6 + $7 * $7 + $8 * $8) - s * s; exit !(NF > 8 && d * d < 1e-28 && f * f < 1e-24) }'
        verdict $? "rack and wheel at a turn of $turn, $model"
    done
done

# ---- frequency: a mass of 3 kg + I / r^2 on 1000 N/m; energy; the wheel's torque is the rack's force times r
scene 2 0.001 'initial: {rates: {turn: 6}}' >turned.scene
scene 2 0.001 'initial: {rates: {turn: 0.06}}' >moved.scene
for model in turned moved; do
    "$gicrun" -q $model.veh $model.scene -o $model.csv 2>err
    column rack.y $model.csv | awk '{ w = sqrt(1000 / (3 + inertia)); t = 0.1 * (NR - 1); d = $1 - 0.06 / w * sin(w * t); if (!(d * d <= 1e-20)) bad = 1 }
        END { exit bad || NR != 21 }' inertia="$(awk 'BEGIN { printf "%.17g", 0.1 / 1e-4 }')"
    verdict $? "oscillation, $model"
    awk -F, 'NR > 1 { e = $(NF - 2) + $(NF - 1); if (NR == 2) first = e; d = (e - first) / first; if (!(d * d <= 1e-18)) bad = 1 } END { exit bad || NR != 22 }' $model.csv
    verdict $? "energy, $model"
    every_way "$model" 1e-9 $model.veh $model.scene
done
off=$(awk -F, 'NR == FNR { y[FNR] = $3; next } FNR > 1 { d = $3 - y[FNR]; if (d < 0) d = -d; if (!(d <= most)) most = d } END { print most + 0 }' turned.csv moved.csv)
check "turn or way as the coordinate: $off" within "$off" 1e-11

# ---- a ball screw of 5 mm a turn, whose spindle turns by half a radian and more in a step, without any force: the way is
# linear in time, and the engine that judges does not take rounding for an error (gcp1 integrates the turn itself)
cat >ball.veh <<'END'
gicgen: 1
model: ball
gravity: [0, 0, 0]
base: ground
bodies:
  nut: {mass: 2, com: [0, 0, 0], inertia: [0.1, 0.1, 0.1]}
  spindle: {mass: 1, com: [0, 0.1, 0], inertia: [0.01, 0.001, 0.01]}
joints:
  rail: {type: prismatic, bodies: [ground, nut], axis: [0, 1, 0]}
  bearing: {type: revolute, bodies: [ground, spindle], point: [0, 0, 0], axis: [0, 1, 0]}
  thread: {type: screw, bodies: [spindle, nut], point: [0, 0, 0], axis: [0, 1, 0], ratio: 0.0008}
coordinates: {turn: {type: translation, bodies: [ground, nut], axis: [0, 1, 0], range: [-0.5, 0.5]}}
outputs: {way: {type: coordinate, coordinate: turn}}
END
for speed in 50 500 512 700; do
    scene 0.4 0.001 "initial: {rates: {turn: $(awk "BEGIN { print $speed * 0.0008 }")}}" >ball.scene
    : >ball.csv
    "$gicrun" -q --engine gic ball.veh ball.scene -o ball.csv 2>err
    awk -F, -v v="$(awk "BEGIN { print $speed * 0.0008 }")" 'NR > 1 { d = $2 - v * $1; if (!(d * d <= 1e-24)) bad = 1 }
        END { exit bad || NR != 6 }' ball.csv
    verdict $? "a ball screw at $speed rad/s"
done

# ---- rest: a load of 20 N moves the rack by 20 mm against 1000 N/m, and turns the wheel by 2 rad
scene 0.1 0.1 'inputs: {load: 20}' 'initial: {equilibrium: true}' >rest.scene
sed 's/stiffness: 1000/stiffness: 1000, damping: 50/' turned.veh >rest.veh
"$gicrun" -q rest.veh rest.scene -o rest.csv 2>err
sed -n 2p rest.csv | awk -F, '{ d = $3 - 0.02; e = $6 * $6 + $7 * $7 + $8 * $8 - sin(1) ^ 2; exit !(NF > 8 && d * d < 1e-18 && e * e < 1e-16) }'
verdict $? "rest under a load: $(sed -n 2p rest.csv)"

# ---- a tunable ratio
sed "s/ratio: 0.01/ratio: r/; s/^inputs/parameters: {r: {value: 0.005, tunable: true}}\ninputs/" turned.veh >tuned.veh
{ cat turned.scene; echo 'parameters: {r: 0.01}'; } >tuned.scene
"$gicrun" -q tuned.veh tuned.scene -o tuned.csv 2>err && off=$(apart tuned.csv turned.csv)
check "a tunable ratio: ${off:-no run}" within "${off:-1}" 1e-11

# ---- a screw: a bolt in a nut, both of which move; a right-hand thread and its image
cat >bolt.veh <<'END'
gicgen: 1
model: bolt
gravity: [0, 0, 0]
base: ground
bodies:
  bolt_l: {mass: 2, com: [0, 1, 0], inertia: [0.1, 0.2, 0.3]}
joints:
  guide_l: {type: cylindrical, bodies: [ground, bolt_l], point: [0, 1, 0], axis: [0, 1, 0]}
  thread_l: {type: screw, bodies: [ground, bolt_l], point: [0, 1, 0], axis: [0, 1, 0], ratio: 0.1}
coordinates:
  turn_l: {type: angle, bodies: [ground, bolt_l], axis: [0, 1, 0], range: [-9, 9]}
forces: {spring_l: {type: spring_damper, coordinate: turn_l, stiffness: 0.88}}
outputs:
  a_l: {type: position, body: bolt_l}
  turn_l: {type: coordinate, coordinate: turn_l}
END
scene 2 0.001 'initial: {rates: {turn_l: 8, turn_r: 8}}' >bolt.scene
# 0.2 + 2 * 0.1^2 = 0.22 kg m^2 on 0.88 N m/rad: 2 rad/s; y = 1 + 0.1 turn on the left, -(1 + 0.1 turn) on the right
"$gicrun" -q bolt.veh bolt.scene -o bolt.csv 2>err
awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { if (index($i, "a_l.y ") == 1) l = i; if (index($i, "a_r.y ") == 1) r = i } next }
    { t = $1; turn = 4 * sin(2 * t); d = $l - 1 - 0.1 * turn; e = $r + 1 + 0.1 * turn; if (!(d * d <= 1e-20 && e * e <= 1e-20)) bad = 1 } END { exit bad || NR != 22 }' bolt.csv
verdict $? 'a screw and its image'
every_way 'a screw' 1e-10 bolt.veh bolt.scene
model=$root/tests/data/laws/geared.veh
scene 1 0.001 'initial: {rates: {turn: 12}, angular_velocity: [0.1, 0.2, 0.3]}' >geared.scene
every_way 'a car' 1e-10 "$model" geared.scene
"$gicgen" "$model" -o geared.c && "$gicgen" --batch 4 "$model" -o batch.c && "$gicgen" --derivatives "$model" -o tangent.c 2>said
verdict $? 'a batch, and derivatives'
for file in geared batch tangent; do
    cc -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only -I. -I"$root/runtime" $file.c 2>said
    verdict $? "no warnings: $file.c"
done

# ---- ball screws: leads from 1 mm to 5 m, all at rest or alone, so that accelerations vanish or not
# nut RATIO COORDINATE: a nut of 5 kg on a spindle of 0.01 kg m^2
nut() {
    cat <<END
gicgen: 1
model: nut
gravity: [0, 0, 0]
base: ground
bodies:
  spindle: {mass: 2, com: [0, 0, 0], inertia: [0.01, 0.1, 0.1]}
  nut: {mass: 5, com: [0.1, 0, 0], inertia: [0.1, 0.1, 0.1]}
joints:
  bearing: {type: revolute, bodies: [ground, spindle], point: [0, 0, 0], axis: [1, 0, 0]}
  guide: {type: prismatic, bodies: [ground, nut], axis: [1, 0, 0]}
  thread: {type: screw, bodies: [nut, spindle], point: [0, 0, 0], axis: [1, 0, 0], ratio: $1}
coordinates:
  $2
inputs: {push: {unit: N}}
forces: {push: {type: load, body: nut, force: [push, 0, 0]}}
outputs:
  nut: {type: position, body: nut}
  spin: {type: angular_velocity, body: spindle}
END
}
way='s: {type: translation, bodies: [ground, nut], axis: [1, 0, 0], range: [-1, 1]}'
# Spindles of up to half a radian a step. F (5 + 0.01 / ratio^2) = a; from the speed v: s = v t + a t^2 / 2
for lead in '1.5915494309189535e-4 0.05 0.1' '7.957747154594768e-4 0.4 0.1' '-0.005 0.5 1' '0.1 0.25 0' '1 1 1'; do
    read -r ratio speed push <<END
$lead
END
    nut "$ratio" "$way" >nut.veh
    scene 0.2 0.001 "initial: {rates: {s: $speed}}" "inputs: {push: $push}" >nut.scene
    "$gicrun" -q nut.veh nut.scene -o nut.csv 2>err &&
        awk -F, -v r="$ratio" -v v="$speed" -v f="$push" 'NR > 1 { a = f / (5 + 0.01 / r ^ 2); d = $2 - 0.1 - v * $1 - a * $1 * $1 / 2; if (!(d * d <= 1e-26)) bad = 1 } END { exit bad || NR != 4 }' nut.csv
    verdict $? "a ball screw of ratio $ratio at $speed m/s"
done
# one body on a screw: gravity across or none, the axis along x, z or askew, drawn at its mass centre or beside
for axis in '[1, 0, 0]' '[0, 0, 1]' '[0.6, 0, 0.8]'; do
    for gravity in '[0, 0, 0]' '[0, 0, -9.81]' '[0, 0, 1.62]'; do
        for ratio in 0.1 1 -1 0.005; do
            cat >bolt.veh <<END
gicgen: 1
model: bolt
gravity: $gravity
base: ground
bodies:
  bolt: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  guide: {type: cylindrical, bodies: [ground, bolt], point: [0, 0, 0], axis: $axis}
  thread: {type: screw, bodies: [ground, bolt], point: [0, 0, 0], axis: $axis, ratio: $ratio}
coordinates:
  turn: {type: angle, bodies: [ground, bolt], axis: $axis, range: [-100, 100]}
outputs:
  turn: {type: coordinate, coordinate: turn}
END
            "$gicgen" bolt.veh -o bolt.c 2>err
            verdict $? "a bolt along $axis, gravity $gravity, ratio $ratio"
        done
    done
done

# a rack and its pinion of 1 m, 50 m from the drawing in one call, by every engine: eight turns, less 0.265
cat >rack.veh <<END
gicgen: 1
model: rack
base: ground
bodies:
  rack: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  pinion: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, rack], axis: [1, 0, 0]}
  hub: {type: revolute, bodies: [ground, pinion], point: [0, 0, 1], axis: [0, 1, 0]}
  teeth: {type: rack_and_pinion, bodies: [rack, pinion], point: [0, 0, 1], axes: [[0, 1, 0], [1, 0, 0]], ratio: 1}
coordinates: {way: {type: translation, bodies: [ground, rack], axis: [1, 0, 0], range: [-60, 60]}}
END
printf 'way,way.rate\n50,0\n-50,0\n6.283185307179586,0\n' >far.csv
for engine in auto tape gic gcp1 gcp2; do
    "$gicrun" --engine $engine --eval far.csv rack.veh -o far.out 2>err &&
        awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { if ($i ~ /^pinion.e0/) a = i; if ($i ~ /^pinion.e2/) b = i; if ($i ~ /^rack.x/) x = i } next }
            { c = cos($x) - ($a * $a - $b * $b); s = sin($x) - 2 * $a * $b; t = sin($x) + 2 * $a * $b; s = s * s < t * t ? s : t; if (!(c * c + s * s <= 1e-24)) bad = 1 } END { exit bad || NR != 4 }' far.out
    verdict $? "a rack goes 50 m in one call, $engine: $(head -1 err)"
done

# ---- mistakes
# refused PLACE MESSAGE REMEDY JOINT: one message and no output
refused() {
    steering bad "$by_turn" "$4" >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "bad.veh:$1: error: $2" said && grep -qF "  remedy: $3" said
    verdict $? "refused: $2"
}
refused 12:113 "ratio of joint 'teeth' is 0: nothing would move" 'write the way' '{type: rack_and_pinion, bodies: [rack, wheel], point: [0, 0, 0], axes: [[-1, 0, 2], [0, 1, 0]], ratio: 0}'
refused 12:3 "joint 'teeth' (screw) lacks the key 'ratio'" 'add `ratio: number`' '{type: screw, bodies: [rack, wheel], point: [0, 0, 0], axis: [0, 1, 0]}'
refused 12:93 "axes of joint 'teeth': the angle between them is 0 degrees" 'turn one of them' '{type: rack_and_pinion, bodies: [rack, wheel], point: [0, 0, 0], axes: [[0, 1, 0], [0, 1, 0]], ratio: 1}'

# a coordinate that equal screws in a chain hold still: it is to be changed, no joint
cat >still.veh <<'END'
gicgen: 1
model: still
base: ground
bodies:
  s: {mass: 2, com: [0, 0, 0], inertia: [0.01, 0.5, 0.5]}
  n: {mass: 3, com: [0.2, 0, 0], inertia: [0.5, 0.5, 0.5]}
joints:
  c1: {type: cylindrical, bodies: [ground, s], point: [0, 0, 0], axis: [1, 0, 0]}
  k1: {type: screw, bodies: [ground, s], point: [0, 0, 0], axis: [1, 0, 0], ratio: 0.005}
  r2: {type: prismatic, bodies: [ground, n], point: [0.2, 0, 0], axis: [1, 0, 0]}
  k2: {type: screw, bodies: [s, n], point: [0.2, 0, 0], axis: [1, 0, 0], ratio: 0.005}
coordinates:
  x: {type: translation, bodies: [ground, n], axis: [1, 0, 0]}
END
"$gicgen" still.veh -o still.c >out 2>said
[ $? -eq 1 ] && grep -qF "still.veh:13:3: error: with the coordinates that are chosen, joint 'k2', joint 'k1' fix the same motion" said &&
    grep -q "remedy: change coordinate 'x': .x: {type: angle, bodies: .ground, s., axis" said
verdict $? 'a coordinate that joints hold still'
sed 's/^  x: .*/  x: {type: angle, bodies: [ground, s], axis: [1, 0, 0]}/' still.veh >still2.veh && "$gicgen" still2.veh -o still.c 2>said
verdict $? 'the remedy'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
