#!/bin/sh
# SPDX-License-Identifier: MIT
# test_coupled.sh GICGEN GICRUN: joints `gear` and `coupler` (FORMAT.md section 4.1): a pair of gears, a rack of variable ratio, a
# planetary set and a driven wheel against closed forms at nice numbers, by every engine and way of generating; energy; tunable
# ratios; the mirror; formulas without a value; mistakes. Accelerations and reactions against quad precision are in
# test_accelerations, derivatives in test_tangent, random mechanisms in test_random_mechanisms.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

# eval_all NAME MODEL FORMULA: at `states` of turn and turn.rate all engines and ways find the acceleration that awk's FORMULA
# says; t, w: value and rate
eval_all() {
    for way in '' '--engine gic' '--engine gcp1' '--engine gcp2' '--engine tape' '--general' '--recovery newton' \
        '--recovery closed' '--solve augmented'; do
        # shellcheck disable=SC2086  # options
        "$gicrun" $way --eval states "$2" -o eval.csv 2>err
        paste -d, states eval.csv | awk -F, 'NR == 1 { for (i = 3; i <= NF; ++i) { if ($i ~ /^status/) k = i; if ($i ~ /^turn.acceleration/) a = i } next }
            { t = $1; w = $2; right = '"$3"'; d = $a - right; s = 1 + right * right
              if ($k != 0 || !(d * d <= 1e-24 * s)) { bad = 1; print } } END { exit bad || NR < 5 }' >off
        verdict $? "$1 ${way:-by default}: $(head -1 off)"
    done
}
{
    echo turn,turn.rate
    for turn in 0 1.5707963267948966 3.141592653589793 -1.5707963267948966 12.566370614359172 -12.566370614359172 1 -1 0.3; do
        printf '%s,0\n%s,1\n%s,-7\n' $turn $turn $turn
    done
} >states

# ---- two gears: 0.2 kg m^2 and 0.05 times the ratio squared, under 0.8 N m
# gears NAME VALUE
gears() {
    cat <<END
gicgen: 1
model: $1
gravity: [0, 0, 0]
base: ground
parameters: {ratio: {value: 2, tunable: true}, idle: {value: 1, tunable: true}}
bodies:
  one: {mass: 2, com: [0, 0, 0], inertia: [0.1, 0.1, 0.2]}
  two: {mass: 3, com: [1, 0, 0], inertia: [0.1, 0.1, 0.05]}
joints:
  a: {type: revolute, bodies: [ground, one], point: [0, 0, 0], axis: [0, 0, 1]}
  b: {type: revolute, bodies: [ground, two], point: [1, 0, 0], axis: [0, 0, 1]}
  teeth: {type: gear, bodies: [ground, two], axis: [0, 0, 1], value: "$2"}
coordinates: {turn: {type: angle, bodies: [ground, one], axis: [0, 0, 1], range: [-14, 14]}}
forces: {push: {type: force, coordinate: turn, value: "0.8 * idle"}}
outputs:
  turn: {type: coordinate, coordinate: turn}
  two: {type: angular_velocity, body: two}
  teeth: {type: reaction, joint: teeth, in: two}
  e: {type: energy}
END
}
for ratio in 1 -1 2 -0.5 0; do
    gears two "$ratio * turn + 3" >two.veh
    eval_all "gears of ratio $ratio" two.veh "0.8 / (0.2 + 0.05 * ($ratio) ^ 2)"
done
# constant, to the last digit or but for rounding; powers whose second derivative is 0 times a power of 0
for formula in '(turn + 1) - turn' 'sin(turn)^2 + cos(turn)^2' 'sqrt(1 + turn^2)^2 - turn^2' 'turn * idle - idle * turn'; do
    gears still "$formula" >still.veh
    eval_all "a wheel that stands still: $formula" still.veh "0.8 / 0.2"
done
gears power 'turn^idle' >power.veh
eval_all "a power whose exponent is tunable and 1" power.veh "0.8 / 0.25"
# angular velocity and torque of the second wheel, energy
gears two '-2 * turn' >two.veh
printf 'gicscene: 1\nduration: 2\nstep: 0.01\noutput_step: 0.5\nintegrator: rk4\ninitial: {rates: {turn: 3}}\n' >two.scene
"$gicrun" -q two.veh two.scene -o two.csv 2>err
for number in 'two.z -2*(3+2*t)' 'teeth.torque.z -0.2' 'turn.value 3*t+t*t' 'e.kinetic 0.5*0.4*(3+2*t)^2' 'e.power 0.8*(3+2*t)'; do
    column "${number%% *}" two.csv | awk '{ t = 0.5 * (NR - 1); d = $1 - ('"${number#* }"'); if (!(d * d <= 1e-20)) bad = 1 } END { exit bad || NR != 5 }'
    verdict $? "gears: $number"
done
every_way gears 1e-11 two.veh two.scene
# a ratio by the scene: 0.2 + 9 * 0.05 = 0.65
gears tuned 'ratio * turn' >tuned.veh
{ cat two.scene; echo 'parameters: {ratio: 3, idle: 1.3}'; } >tuned.scene
for engine in auto gic gcp1 'auto --solve augmented'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" -q --engine $engine tuned.veh tuned.scene -o tuned.csv 2>err
    column turn.acceleration tuned.csv | awk '{ d = $1 - 1.6; if (!(d * d <= 1e-20)) bad = 1 } END { exit bad || NR != 5 }'
    verdict $? "a tunable ratio, $engine"
done

# ---- a rack of variable ratio: y = r (turn), 0.1 kg m^2 and 3 kg on a spring of 1000 N/m
# steering NAME FORMULA
steering() {
    cat <<END
gicgen: 1
model: $1
gravity: [0, 0, 0]
base: ground
inputs: {other: {unit: m}}
tables: {curve: {x: [0, 1], y: [0, 1]}}
states: {held: {rate: "other"}}
bodies:
  rack: {mass: 3, com: [0.2, 0, 0.1], inertia: [0.5, 0.01, 0.5]}
  wheel: {mass: 2, com: [0, 0.3, 0.4], inertia: [0.1, 0.1, 0.1]}
joints:
  rail: {type: prismatic, bodies: [ground, rack], axis: [0, 1, 0], point: [0.9, 0, 0.1]}
  column: {type: revolute, bodies: [ground, wheel], point: [0, 0.3, 0.4], axis: [-1, 0, 2]}
  teeth: {type: coupler, bodies: [ground, rack], axis: [0, 1, 0], value: $2}
coordinates: {turn: {type: angle, bodies: [ground, wheel], axis: [-1, 0, 2], range: [-14, 14]}}
forces:
  center: {type: spring_damper, bodies: [ground, rack], points: [[0.2, -9, 0.1], [0.2, 0, 0.1]], stiffness: 1000}
  used: {type: force, coordinate: turn, value: 0 * (other + held + curve(other))}
outputs:
  rack: {type: position, body: rack}
  turn: {type: coordinate, coordinate: turn}
  e: {type: energy}
END
}
plain() { sed '/^inputs/d; /^tables/d; /^states/d; /^  used/d'; }
steering rack '"0.01 * turn + 2e-4 * turn^3"' | plain >rack.veh
y='(0.01 * t + 2e-4 * t ^ 3)' s='(0.01 + 6e-4 * t ^ 2)' b='(12e-4 * t)'
eval_all 'a cubic ratio' rack.veh "-(1000 * $y * $s + 3 * $s * $b * w * w) / (0.1 + 3 * $s ^ 2)"
steering rack '"0.05 * sin(turn)"' | plain >sine.veh # at quarter turns the rack stands still
eval_all 'a crank' sine.veh '-(1000 * 0.05 * sin(t) * 0.05 * cos(t) - 3 * 0.05 * cos(t) * 0.05 * sin(t) * w * w) / (0.1 + 3 * (0.05 * cos(t)) ^ 2)'
for formula in 'exp(turn / 20) / 50' '0.1 * tanh(turn / 4)' '0.1 * atan(turn)' '0.02 * sqrt(200 + turn * abs_of)' '0.1 * atan2(sin(turn), 2 + cos(turn))' \
    '0.02 * log(20 + turn)' '0.01 * pow(20 + turn, 1.5)' '0.1 * asin(turn / 20)' '0.1 * acos(turn / 20)' '0.1 * tan(turn / 20)' '1 / (20 + turn)'; do
    steering other "\"$(echo "$formula" | sed 's/abs_of/turn/')\"" | plain >other.veh
    printf 'gicscene: 1\nduration: 1\nstep: 0.001\noutput_step: 0.1\nintegrator: rk4\ninitial: {coordinates: {turn: 1}, rates: {turn: 8}}\n' >other.scene
    "$gicrun" -q other.veh other.scene -o other.csv 2>err
    awk -F, 'NR > 1 { e = $(NF - 2) + $(NF - 1); if (NR == 2) first = e; d = (e - first) / first; if (!(d * d <= 1e-18)) bad = 1 } END { exit bad || NR != 12 }' other.csv
    verdict $? "energy of $formula"
    some_ways "$formula" 1e-10 other.veh other.scene '' '--solve augmented'
    some_ways "$formula" 1e-7 other.veh other.scene '--engine gcp1'
done
every_way 'a variable ratio' 1e-10 rack.veh other.scene

# ---- a driven wheel: the drive turns it and pushes the rack by the slope
steering drive '"0.01 * turn + 2e-4 * turn^3"' | plain |
    sed 's/range: \[-14, 14\]/range: [-14, 14], driven: true/; s/^outputs:/outputs:\n  drive: {type: drive_force, coordinate: turn}/' >drive.veh
echo 'turn,turn.rate,turn.acceleration
0,0,0
1,0,0
-1,2,0
2,-3,5' >driven
for way in '' '--engine gic' '--engine gcp1' '--solve augmented'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" $way --eval driven drive.veh -o eval.csv 2>err
    paste -d, driven eval.csv | awk -F, 'NR == 1 { for (i = 4; i <= NF; ++i) if ($i ~ /^output.drive /) k = i; next }
        { t = $1; w = $2; a = $3; y = 0.01 * t + 2e-4 * t ^ 3; s = 0.01 + 6e-4 * t ^ 2; b = 12e-4 * t
          d = $k - (0.1 * a + s * (3 * (s * a + b * w * w) + 1000 * y)); if (!(k && d * d <= 1e-24)) bad = 1 } END { exit bad || NR != 5 }'
    verdict $? "force of a drive ${way:-by default}"
done

# ---- a planetary set: the third wheel turns by the mean of two, 0.4 kg m^2 on wheels of 0.2 and 0.3
cat >planet.veh <<'END'
gicgen: 1
model: planet
gravity: [0, 0, 0]
base: ground
bodies:
  sun: {mass: 1, com: [0, 0, 0], inertia: [0.2, 0.2, 0.2]}
  ring: {mass: 1, com: [0, 0, 1], inertia: [0.3, 0.3, 0.3]}
  arm: {mass: 1, com: [0, 0, 2], inertia: [0.4, 0.4, 0.4]}
joints:
  a: {type: revolute, bodies: [ground, sun], point: [0, 0, 0], axis: [0, 0, 1]}
  b: {type: revolute, bodies: [ground, ring], point: [0, 0, 1], axis: [0, 0, 1]}
  c: {type: revolute, bodies: [ground, arm], point: [0, 0, 2], axis: [0, 0, 1]}
  set: {type: gear, bodies: [ground, arm], axis: [0, 0, 1], value: (turn + other) / 2}
coordinates:
  turn: {type: angle, bodies: [ground, sun], axis: [0, 0, 1], range: [-14, 14]}
  other: {type: angle, bodies: [ground, ring], axis: [0, 0, 1], range: [-14, 14]}
forces: {push: {type: force, coordinate: turn, value: 1.1}}
END
# [0.3 0.1; 0.1 0.4] times the accelerations is [1.1; 0]: 4 and -1
printf 'turn,turn.rate,other,other.rate\n0,0,0,0\n1,2,-3,4\n6.283185307179586,-1,12,1\n' >two
for way in '' '--engine gic' '--engine gcp2' '--solve augmented' '--recovery newton'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" $way --eval two planet.veh -o eval.csv 2>err
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { if ($i ~ /^turn.acceleration/) a = i; if ($i ~ /^other.acceleration/) b = i } next }
        { d = $a - 4; e = $b + 1; if (!(a && b && d * d + e * e <= 1e-22)) bad = 1 } END { exit bad || NR != 4 }' eval.csv
    verdict $? "a planetary set ${way:-by default}"
done

# ---- the mirror: a gear turns and a coupler moves as the image of the other side
cat >mirror.veh <<'END'
gicgen: 1
model: mirror
gravity: [0, 0, 0]
base: ground
bodies:
  arm_l: {mass: 1, com: [0, 1, 0], inertia: [0.2, 0.2, 0.2]}
  gear_l: {mass: 1, com: [1, 1, 0], inertia: [0.3, 0.3, 0.3]}
  slide_l: {mass: 1, com: [2, 1, 0], inertia: [0.4, 0.4, 0.4]}
joints:
  a_l: {type: revolute, bodies: [ground, arm_l], point: [0, 1, 0], axis: [1, 2, 0]}
  b_l: {type: revolute, bodies: [ground, gear_l], point: [1, 1, 0], axis: [0, 1, 2]}
  c_l: {type: prismatic, bodies: [ground, slide_l], axis: [0, 1, 1]}
  g_l: {type: gear, bodies: [ground, gear_l], axis: [0, 1, 2], value: 2 * turn_l}
  s_l: {type: coupler, bodies: [ground, slide_l], axis: [0, 1, 1], value: 0.1 * turn_l + 0.3 * sin(turn_l)}
coordinates: {turn_l: {type: angle, bodies: [ground, arm_l], axis: [1, 2, 0], range: [-9, 9]}}
forces: {spring_l: {type: spring_damper, coordinate: turn_l, stiffness: 2}}
outputs:
  g_l: {type: angular_velocity, body: gear_l}
  s_l: {type: position, body: slide_l}
END
printf 'gicscene: 1\nduration: 2\nstep: 0.01\noutput_step: 0.1\nintegrator: rk4\ninitial: {rates: {turn_l: 2, turn_r: 2}}\n' >mirror.scene
"$gicrun" -q mirror.veh mirror.scene -o mirror.csv 2>err
for pair in 'g_l.x g_r.x -1' 'g_l.y g_r.y 1' 'g_l.z g_r.z -1' 's_l.x s_r.x 1' 's_l.y s_r.y -1' 's_l.z s_r.z 1'; do
    # shellcheck disable=SC2086  # three words
    set -- $pair
    column "$1" mirror.csv >left && column "$2" mirror.csv >right
    paste left right | awk '{ d = $1 - ('"$3"') * $2; if (!(d * d <= 1e-20)) bad = 1; most = $1 > most ? $1 : most } END { exit bad || NR != 21 }'
    verdict $? "the image: $pair"
done

# ---- a car with all of it
model=$root/tests/data/laws/coupled.veh
printf 'gicscene: 1\nduration: 1\nstep: 0.002\noutput_step: 0.1\nintegrator: rk4\n%s\n%s\n' 'initial: {rates: {turn: 5, tilt: 0.5}, angular_velocity: [0.1, 0.2, 0.3]}' \
    'inputs: {way: {sine: {amplitude: 0.1, frequency: 1}}}' >car.scene
every_way 'a car' 1e-10 "$model" car.scene
some_ways 'a car' 1e-7 "$model" car.scene '--engine gcp1' '--engine gcp2'
"$gicgen" "$model" -o coupled.c && "$gicgen" --batch 4 "$model" -o batch.c && "$gicgen" --derivatives "$model" -o tangent.c 2>said
verdict $? 'a batch, and derivatives'
for file in coupled batch tangent; do
    cc -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only -I. -I"$root/runtime" $file.c 2>said
    verdict $? "no warnings: $file.c"
done

# ---- where the formula has no value a state is refused, without a number that is none
steering root '"0.02 * sqrt(2 + turn)"' | plain >root.veh
printf 'turn,turn.rate\n-1,1\n-3,1\n-2,1\n0,1\n' >beyond
for way in '' '--engine gic' '--recovery newton'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" $way --eval beyond root.veh -o eval.csv 2>err
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^status/) k = i; next } { good = good ($k == 0 ? "y" : "n") } END { exit good != "ynny" }' eval.csv && ! grep -qi nan eval.csv
    verdict $? "a root of a negative number ${way:-by default}"
done

# ---- mistakes
# refused PLACE MESSAGE REMEDY FORMULA: one message and no output
refused() {
    steering bad "$4" >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "bad.veh:$1: error: $2" said && grep -qF "  remedy: $3" said
    verdict $? "refused: $2"
}
smooth='write a smooth formula of coordinates'
refused 14:74 "value of joint 'teeth' has time" "$smooth" '0.1 * time'
refused 14:74 "value of joint 'teeth' has an input" "$smooth" 'turn + other'
refused 14:74 "value of joint 'teeth' has a state" "$smooth" 'turn + held'
refused 14:74 "value of joint 'teeth' has a rate" "$smooth" 'rate(turn)'
refused 14:74 "value of joint 'teeth' has a table" "$smooth" 'curve(turn)'
for kink in '"abs(turn)"' '"max(turn, 0)"' '"if(turn > 0, turn, 0)"'; do
    refused 14:74 "value of joint 'teeth' has \`abs\`, \`min\`" "$smooth" "$kink"
done
refused 14:74 "value of joint 'teeth' follows no coordinate" 'name a coordinate' 0.3
refused 14:74 "value of joint 'teeth' is not a finite number at the design" 'look for a division' '1 / turn'
for root in 'sqrt(turn)' 'turn^0.5' '"turn^1.5"' 'sqrt(turn * turn)' '"asin(1 - turn^2)"'; do
    refused 14:74 "value of joint 'teeth' has no finite derivative by 'turn' at the design" 'write a formula that is smooth' "$root"
done
refused 14:78 "value of joint 'teeth': there is no 'trun'" "did you mean 'turn'?" '2 * trun'
refused 15:3 "joint 'spare' (coupler) lacks the key 'value'" 'add `value: formula`' '1}
  spare: {type: coupler, bodies: [ground, rack], axis: [0, 1, 0]'
"$gicgen" --solve articulated two.veh -o bad.c >out 2>said
[ $? -eq 1 ] && [ ! -e bad.c ] && grep -q 'the articulated form .* does not know joints' said
verdict $? 'the articulated form'

# a formula without a value in a part of the range: no mistake of gicgen's, and right where it has one. y = log(1 + x) with x
# from 0 on at 1 m/s, no forces: (1 + (1 + y')^2) x'^2 stays 5, y' = 1 / (1 + x), by the place of b, x + y
cat >log.veh <<'END'
gicgen: 1
model: by_log
base: ground
bodies:
  a: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  b: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  a: {type: prismatic, bodies: [ground, a], axis: [1, 0, 0]}
  b: {type: prismatic, bodies: [a, b], axis: [1, 0, 0]}
  follows: {type: coupler, bodies: [a, b], axis: [1, 0, 0], value: log(x + 1)}
coordinates:
  x: {type: translation, bodies: [ground, a], axis: [1, 0, 0], range: [-2, 2]}
outputs:
  x: {type: coordinate, coordinate: x}
END
printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'integrator: rk4' 'output_step: 0.1' 'initial: {rates: {x: 1}}' >log.scene
"$gicrun" -q log.veh log.scene -o log.csv >out 2>said &&
    awk -F, 'NR > 1 { e = (1 + (1 + 1 / (1 + $2)) ^ 2) * $3 ^ 2 / 5 - 1; n += 1; bad += e * e > 1e-20 } END { exit !(n == 11 && !bad) }' log.csv
verdict $? 'a formula without a value in a part of the range'

# formulas that go far, or have a pole, a jump or a tangent upright, within the range: right where they are near, y = f(x) - f(0)
for formula in 'exp(20 * x)' 'tan(x)' 'asin(x)' '"atan2(x, 0.5)"' '1 / (x + 1.5)' '(x + 1)^1.5'; do
    sed "s|log(x + 1)|$formula|" log.veh >far.veh
    printf 'x,x.rate\n0.05,1\n' >near
    "$gicgen" far.veh -o far.c >out 2>said && "$gicrun" --eval near far.veh -o eval.csv 2>err && "$gicrun" --engine gic --eval near far.veh -o gic.csv 2>err &&
        paste -d, eval.csv gic.csv | awk -F, 'NR > 1 { for (i = 1; i <= NF / 2; ++i) { d = $i - $(i + NF / 2); s = $i * $i + 1; if (!(d * d <= 1e-18 * s)) exit 1 } n += 1 } END { exit n != 1 }'
    verdict $? "a steep formula: $formula"
done

# formulas that jump or bend within the range: a warning with the place; steep, even constant ones that do not: none
warned() {
    sed "s|log(x + 1)|$2|" log.veh >bends.veh
    "$gicgen" bends.veh -o bends.c >out 2>said
    if [ "$1" ]; then grep -q "bends.veh:10:6[78]: warning: value of joint 'follows' $1, inside its range .-2, 2." said; else ! grep -q 'jumps\|bends at' said; fi
    verdict $? "${1:-neither jumps nor bends}: $2"
}
warned 'jumps at x = 0' '"atan2(x, 0)"'
warned 'jumps at x = -1.571' '"atan2(sin(2 * x), cos(2 * x))"'
warned 'bends at x = 1' 'sqrt((x - 1)^2)'
warned 'bends at x = 0.5' '"(x^2 - x + 0.25)^0.5"'
warned '' 'x^3'
warned '' 'sin(x)^2 + cos(x)^2 + x'
warned '' 'tanh(1000 * x)'
warned '' '"atan2(x, 2)"'
warned '' '(x + 1)^1.5'
warned '' '1000 + 1e-3 * sin(100 * x)'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
