#!/bin/sh
# SPDX-License-Identifier: MIT
# test_equilibrium.sh GICGEN GICRUN REFERENCE: static equilibrium, `gicrun --equilibrium` and scenes that start from it.
# Accelerations at what is found: by engines that share no formula with the search, and in quad precision, below the
# 1e-9 m/s^2 (rad/s^2) that is promised; wheels carry the weight; closed solutions; what is said where there is none.
gicgen=$1
gicrun=$2
reference=$3
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/lib/checking.sh"
silent() { ! [ -s "$work/err" ]; }
# scene LINE...: a scene with them
scene() { printf 'gicscene: 1\nduration: 1\nstep: 0.005\nintegrator: rk4\noutput_step: 0.1\n'; printf '%s\n' "$@"; }
# still FILE: no acceleration of the base, of a coordinate, of a wheel or the engine of 1e-9, in every row
still() { awk -F, 'NR == 1 {for (i = 1; i <= NF; ++i)
        if ($i ~ /^(a|alpha)\.[xyz]|^[a-z_]*\.(acceleration|(spin|speed)\.rate)/) c[++n] = i}
    NR > 1 {for (k = 1; k <= n; ++k) if (!($c[k] != "" && $c[k] * $c[k] < 1e-18)) bad = 1}
    END {exit bad || NR < 2 || !n}' "$1"; }
# rests MODEL [SCENE [ROAD]]: found, and all agree on it; $work/rest is the state
rests() {
    run --equilibrium "$1" ${2:+"$2"} -o "$work/rest" && exits 0 || return 1
    for engine in tcc gic gcp1; do
        "$gicrun" --engine $engine --eval "$work/rest" "$1" ${2:+"$2"} -o "$work/eval" && still "$work/eval" ||
            return 1
    done
    "$gicgen" --dump-model "$1" >"$work/dump" && "$reference" "$work/dump" "$work/rest" ${3:+--road "$3"} \
        -o "$work/quad" 2>"$work/err" && still "$work/quad"
}
# no noise: printed numbers are 0 or above 1e-12, which a vehicle does not feel
clean() { sed -n '/^initial:/,$p; /^coordinate /,/^$/p' "$work/out" | tr -c '0-9.eE+\n-' ' ' | awk '
    { for (i = 1; i <= NF; ++i) if ($i ~ /^-?[0-9][0-9.]*(e[-+]?[0-9]+)?$/) { ++n; if ($i != 0 && $i * $i < 1e-24) bad = 1 } }
    END { exit bad || n < 5 }'; }
# column FILE NAME: of the first row
column() { awk -F, -v name="$2" 'NR == 1 {for (i = 1; i <= NF; ++i) {sub(/ \[.*/, "", $i); if ($i == name) c = i}}
    NR == 2 {print $c}' "$1"; }
# near A B TOLERANCE
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN {d = a - b; exit !(d * d <= t * t && a != "" && b != "")}' || {
    echo "$1 is not $2 within $3" >>"$work/err"
    false
}; }
# carried: the wheels in $work/eval carry the weight of $work/dump to 1e-9 of it
carried() {
    mass=$(grep -o '"mass": *[0-9.e+-]*' "$work/dump" | awk -F: '{sum += $2} END {printf "%.17g", sum}')
    load=$(awk -F, 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ /\.fz /) c[++n] = i}
        NR == 2 {for (k = 1; k <= n; ++k) sum += $c[k]; printf "%.17g", sum}' "$work/eval")
    weight=$(awk -v m="$mass" 'BEGIN {printf "%.17g", 9.81 * m}')
    near "$load" "$weight" "$(awk -v w="$weight" 'BEGIN {print 1e-9 * w}')"
}

for name in hmmwv hmmwv_full hmmwv14 five_link solid_axle trailing_arm; do
    check "$name rests" rests "$root/models/$name.veh"
    check "$name: the wheels carry its weight" carried
done
for name in quarter_car andrews pendulum; do
    check "$name rests" rests "$root/models/$name.veh"
done
check 'the pendulum hangs down' near "$(column "$work/rest" angle)" 1.5707963267948966 1e-12

# on its road, wherever it starts
run --equilibrium "$root/models/hmmwv_tmeasy.veh"
check 'no roundings of slips are printed' clean
hmmwv=$root/models/hmmwv.veh
run --equilibrium "$hmmwv" -o "$work/flat"
check 'no roundings are printed' clean
check 'the tables are printed' prints '^tire_f_l  *[0-9.]* N  *0.0228'
check 'as the model says it is 0.06 mm above design' near "$(column "$work/flat" r.z)" 0.474062 1e-6
check 'x, y and yaw are neutral' prints '^neutral  *x, y, yaw:'
check 'the sum of the loads is the weight' awk '/^sum/ {found = $2 == $5} END {exit !found}' "$work/out"
scene 'road: {type: sine, amplitude: 0.05, wavelength: 5, start: 1, phase_per_y: 0.3}' >"$work/a.scene"
check 'hmmwv rests on waves' rests "$hmmwv" "$work/a.scene" sine:0.05,5,1,0.3
check 'and the wheels carry its weight' carried
scene 'initial: {position: [3, 2, 2.5], orientation: {yaw: 0.5, pitch: 0.3, roll: 0.2}, speed: 10}' >"$work/a.scene"
check 'hmmwv rests where it falls to' rests "$hmmwv" "$work/a.scene"
check 'as high as elsewhere' near "$(column "$work/rest" r.z)" "$(column "$work/flat" r.z)" 1e-12
scene 'initial: {position: [7, -3, 0.5], orientation: {yaw: 2}}' >"$work/a.scene"
check 'hmmwv rests where it stands upright' rests "$hmmwv" "$work/a.scene"
check 'x stays' near "$(column "$work/rest" r.x)" 7 1e-4
check 'y stays' near "$(column "$work/rest" r.y)" -3 1e-4
check 'yaw stays' near "$(column "$work/rest" e3)" 0.8414709848 1e-6

# on tires: where wheels are free, parked on a slope, with an engine that idles, steered
for name in hmmwv_tires hmmwv_tmeasy; do
    check "$name rests" rests "$root/models/$name.veh"
    check "$name: the wheels carry its weight" carried
done
tires=$root/models/hmmwv_tires.veh
scene 'road: {type: slope, x: 0.15, y: 0.05}' 'inputs: {brake: 1}' >"$work/a.scene"
run --equilibrium "$tires" "$work/a.scene" -o "$work/rest"
check 'brakes hold it on a slope' exits 0
check 'by slips that are printed' prints '^tire_f_l.slip_x  *0.00'
check 'its attitude is printed in degrees' awk -v e0="$(column "$work/rest" e0)" -v e1="$(column "$work/rest" e1)" \
    -v e2="$(column "$work/rest" e2)" -v e3="$(column "$work/rest" e3)" '
    function off(a, b) {return a - b > 1e-4 || b - a > 1e-4}
    / yaw .* deg, pitch .* deg, roll .* deg$/ {found = 1; degree = atan2(0, -1) / 180; s = 2 * (e0 * e2 - e1 * e3)
        pitch = atan2(s, sqrt(1 - s * s)) / degree; if (pitch * pitch < 25) bad = 1
        if (off($2, atan2(2 * (e1 * e2 + e0 * e3), 1 - 2 * (e2 * e2 + e3 * e3)) / degree) || off($5, pitch) ||
            off($8, atan2(2 * (e2 * e3 + e0 * e1), 1 - 2 * (e1 * e1 + e2 * e2)) / degree)) bad = 1}
    END {exit bad || !found}' "$work/out"
check 'it stays where it was' near "$(column "$work/rest" r.x)" 0 0.2
for engine in gic gcp1; do
    "$gicrun" --engine $engine --eval "$work/rest" "$tires" "$work/a.scene" -o "$work/eval"
    check "engine $engine agrees" still "$work/eval"
done
{ cat "$work/a.scene"; sed -n '/^initial:/,$p' "$work/out"; } >"$work/b.scene"
run --equilibrium "$tires" "$work/b.scene"
check 'what is printed for scenes rests' prints 'found in 0 steps$'
scene 'road: {type: slope, x: 0.15, y: 0.05}' 'inputs: {brake: 1}' 'initial: {equilibrium: true}' 'outputs: [chassis]' |
    sed 's/step: 0.005/step: 0.001/' >"$work/b.scene"
run "$tires" "$work/b.scene"
check 'a run stays parked there' awk -F, 'NR == 2 {split($0, first)}
    NR > 2 {for (i = 2; i <= NF; ++i) {d = $i - first[i]; if (!(d * d < 1e-18)) bad = 1}}
    END {exit bad || NR != 12}' "$work/out"
sed 's/brake: 1/brake: 0/' "$work/a.scene" >"$work/b.scene"
run --equilibrium "$tires" "$work/b.scene"
check 'without brakes it rolls away' exits 1
check 'and the message says so' says 'remedy: the vehicle rolls or slides away'
scene 'inputs: {rack: 0.03}' >"$work/a.scene"
check 'steered it rests' rests "$tires" "$work/a.scene"
scene 'inputs: {selector: 0}' 'initial: {gear: 0}' >"$work/a.scene"
check 'the engine idles' rests "$root/models/hmmwv_vehicle.veh" "$work/a.scene"
check 'near its idle speed' near "$(column "$work/rest" engine.speed)" 83.8 4
scene 'initial: {equilibrium: true, speed: 20}' 'outputs: [chassis, slip_f_l]' | sed 's/step: 0.005/step: 0.001/' \
    >"$work/a.scene"
run "$tires" "$work/a.scene"
check 'wheels roll at the start' awk -F, 'NR == 2 {exit !($10 * $10 < 1e-12)}' "$work/out"
check 'as fast as it goes' near "$(tail -n 1 "$work/out" | cut -d, -f2)" 20 0.2

# driven coordinates stand at their value of time 0, whatever they do then
sed "s|parts/|$root/models/parts/|g; s/^  rack: *{type: translation,/& driven: true,/; /coordinate: rack, stiffness/d
    /element: rack/d" "$hmmwv" >"$work/steered.veh"
scene 'inputs: {rack: {sine: {amplitude: 0.02, frequency: 1, offset: 0.03, start: -3.1}}}' >"$work/a.scene"
check 'the steered vehicle rests' rests "$work/steered.veh" "$work/a.scene"
check 'with the rack where it is' near "$(column "$work/rest" rack)" 0.0417557050458 1e-12
check 'at rest' [ "$(column "$work/rest" rack.rate),$(column "$work/rest" rack.acceleration)" = 0,0 ]

# a scene that starts there: nothing moves, with any engine; rates and speed are as given
scene 'initial: {equilibrium: true, position: [5, 0, 0.6]}' 'outputs: [chassis, spring_f_l.value]' >"$work/a.scene"
for engine in auto gic; do
    run --engine $engine "$hmmwv" "$work/a.scene"
    check "a run from equilibrium stays there ($engine)" awk -F, 'NR == 2 {split($0, first)}
        NR > 2 {for (i = 2; i <= NF; ++i) {d = $i - first[i]; if (!(d * d < 1e-20)) bad = 1}}
        END {exit bad || NR != 12}' "$work/out"
done
scene 'initial: {equilibrium: true, speed: 3}' 'outputs: [chassis]' >"$work/a.scene"
run "$hmmwv" "$work/a.scene"
check 'a run from equilibrium with a speed' near "$(tail -n 1 "$work/out" | cut -d, -f2)" 3 1e-3
scene 'initial: {equilibrium: maybe}' >"$work/a.scene"
run "$hmmwv" "$work/a.scene"
check 'equilibrium is true or false' exits 1
check 'and the message shows where' says 'a.scene:6:24: error'
# what is printed for scenes is one
run --equilibrium "$hmmwv"
{ scene; sed -n '/^initial:/,$p' "$work/out"; } >"$work/a.scene"
run --equilibrium "$hmmwv" "$work/a.scene" -o "$work/again"
check 'the printed state is at rest' near "$(column "$work/again" r.z)" "$(column "$work/flat" r.z)" 1e-14
check 'no step is needed' prints 'found in [01] steps$'
# and can be run, as it stands there, and with sides that differ by less than is worth a word
for name in five_link hmmwv hmmwv14 hmmwv_tires solid_axle trailing_arm; do
    run -q --equilibrium "$root/models/$name.veh"
    { scene; sed -n '/^initial:/,$p' "$work/out"; } >"$work/a.scene"
    run "$root/models/$name.veh" "$work/a.scene" -o "$work/again"
    check "$name: what is printed can be run" exits 0
done
for start in 'speed: 5, coordinates: {rack: 1e-17}' 'velocity: [5, 1e-12, 0]' 'orientation: {yaw: 1e-11}' \
    'rates: {spring_f_l: 1e-10}'; do
    scene "initial: {$start}" >"$work/a.scene"
    run "$hmmwv" "$work/a.scene" -o "$work/again"
    check "sides that differ a little: $start" exits 0
done
for engine in tape tcc gic gcp2; do
    run --engine $engine --equilibrium "$root/models/quarter_car.veh"
    check "the residual by $engine" prints "(engine $engine)$"
done
run --equilibrium "$hmmwv" -o -
check 'the state alone on standard output' [ "$(wc -l <"$work/out"),$(head -c 3 "$work/out")" = 2,r.x ]

# a coordinate and a parameter of one name: 40 N m/rad of a spring, 0.25 kg m^2 about the axis
cat >"$work/twice.veh" <<'XXX'
gicgen: 1
model: twice
base: ground
parameters: {angle: {value: 40, unit: N m/rad, tunable: true}}
bodies:
  rod: {mass: 1, com: [0, 0, 0], inertia: [0.25, 0.25, 0.25]}
joints:
  pivot: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, -1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, rod], axis: [0, -1, 0], range: [-1, 1]}
forces:
  spring: {type: spring_damper, coordinate: angle, stiffness: angle, free: 0.1}
XXX
run --equilibrium "$work/twice.veh" -o "$work/rest"
check 'a parameter called like a coordinate' [ "$(head -1 "$work/rest" | sed 's/ \[[^]]*\]//g')" = \
    angle,angle.rate,parameter/angle ]
"$gicrun" --eval "$work/rest" "$work/twice.veh" -o "$work/eval" && still "$work/eval"
check 'is read again' [ $? -eq 0 ]
printf 'parameter/angle,state/angle,angle.rate\n50,0.2,0\n' >"$work/rest"
"$gicrun" --eval "$work/rest" "$work/twice.veh" -o "$work/eval"
check 'each as what it says' near "$(column "$work/eval" angle.acceleration)" -20 1e-12

# balanced on its tip; outside its range
scene 'initial: {coordinates: {angle: 4.71238898038469}}' >"$work/a.scene"
run --equilibrium "$root/models/pendulum.veh" "$work/a.scene"
check 'the upright pendulum is found' exits 0
check 'and called unstable' says 'unstable: eigenvalue 3.132'
check 'outside its range' says "coordinate 'angle' leaves its range"
run -q --equilibrium "$root/models/pendulum.veh" "$work/a.scene"
check 'unless it shall be quiet' exits 0
check 'when the table, asked for alone, is printed' test -s "$work/out"
run -q --equilibrium "$root/models/pendulum.veh" "$work/a.scene" -o "$work/rest"
check 'and nothing, where the result goes to a file' test ! -s "$work/out"

# a little beside its tip, where Newton's method would climb back, it falls and hangs: at pi/2
for angle in 4.64 4.70 4.78; do
    scene "initial: {coordinates: {angle: $angle}}" >"$work/a.scene"
    run --equilibrium "$root/models/pendulum.veh" "$work/a.scene" -o "$work/rest"
    turns=$(awk -v a="$(column "$work/rest" angle)" 'BEGIN {x = (a - atan2(1, 0)) / (8 * atan2(1, 1)); print x - int(x)}')
    check "from $angle rad it falls" near "$turns" 0 1e-9
done

# a wheel that just touches, where the length of its contact has no derivative
cat >"$work/touch.veh" <<'END'
gicgen: 1
model: touch
gravity: [0, 0, 0]
base: ground
bodies:
  sled: {mass: 100, com: [0, 0, 0.5], inertia: [10, 10, 10]}
  lift: {mass: 50, com: [0, 0, 0.5], inertia: [5, 5, 5]}
joints:
  track: {type: prismatic, bodies: [ground, sled], axis: [1, 0, 0]}
  post: {type: prismatic, bodies: [sled, lift], axis: [0, 0, 1]}
coordinates:
  along: {type: translation, bodies: [ground, sled], axis: [1, 0, 0], range: [-100, 100]}
  height: {type: translation, bodies: [sled, lift], axis: [0, 0, 1], range: [-0.5, 1]}
forces:
  spring: {type: spring_damper, coordinate: height, stiffness: 10000, damping: 100}
tires:
  all: {type: tmeasy, radius: 0.5, stiffness: 200000, damping: 200, load: 4000, dfx0: [80000, 150000],
        fxm: [4000, 7000], fxs: [3000, 5500], dfy0: [70000, 120000], fym: [3800, 6500], fys: [3100, 5200],
        sxm: [0.12, 0.14], sxs: [0.5, 0.6], sym: [0.18, 0.22], sys: [0.6, 0.7],
        trail: [0.15, 0.14], sq0: [0.2, 0.24], sqe: [0.4, 0.5]}
wheels:
  wheel: {body: lift, center: [0, 0, 0.5], tire: all, spin_inertia: 1.5}
END
run --equilibrium "$work/touch.veh" -o "$work/rest"
check 'a wheel that just touches' exits 0
check 'it rests there' near "$(column "$work/rest" height)" 0 1e-12
# 490.5 N on 210000 N/m: 2.34 mm, of 10 mm of fade the share 0.234: S = 0.138
sed '/^gravity/d' "$work/touch.veh" >"$work/faded.veh"
run --equilibrium "$work/faded.veh"
check 'a tire that deflects less than its fade' grep -qF "wheel 'wheel' deflects by 2.34 mm, less than its fade of 10 mm: the stiffnesses by slip are 0.14 of" "$work/out"
sed -i 's/spin_inertia: 1.5/&, fade: 0.001/' "$work/faded.veh"
run --equilibrium "$work/faded.veh"
check 'more than its fade' sh -c '! grep -q fade "$1"' sh "$work/out"

# where there is none
# refused TEXT REMEDY [SCENE]: status 1, nothing printed or written
refused() {
    rm -f "$work/rest"
    run --equilibrium "$work/bad.veh" ${3:+"$3"} -o "$work/rest"
    exits 1 && says "error: $1" && says "remedy: $2" && ! [ -s "$work/out" ] && ! [ -e "$work/rest" ]
}
sed "s|parts/|$root/models/parts/|g" "$hmmwv" >"$work/bad.veh"
scene 'initial: {position: [0, 0, 100]}' >"$work/a.scene"
check 'far above the road' refused 'no static equilibrium found: after .* is -9.81, of z' \
    'no wheel touches the road' "$work/a.scene"
sed -i '/^wheels/,/^$/d; /type: wheel/d' "$work/bad.veh"
check 'without wheels' refused 'no static equilibrium found: .* is -9.81, of z' 'nothing carries the base'
sed "s|parts/|$root/models/parts/|g; s/stiffness: 167070.9/stiffness: 1/" "$hmmwv" >"$work/bad.veh"
check 'springs that are too soft' refused \
    'no static equilibrium found: the largest acceleration left is [-+.e0-9]*, of [a-z_]*, and further on: .* near a singular configuration' \
    'forces push the mechanism beyond its limits'
sed "s|parts/|$root/models/parts/|g; s/^model:.*/&\ngravity: [0.1, 0, -9.81]/" "$hmmwv" >"$work/bad.veh"
check 'a vehicle that rolls away' refused 'no static equilibrium found: after .* is 0.1, of x' \
    'nothing holds the vehicle against that'
cat >"$work/bad.veh" <<'END'
gicgen: 1
model: pushed
base: ground
bodies:
  cart: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  track: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  place: {type: translation, bodies: [ground, cart], axis: [1, 0, 0]}
forces:
  push: {type: force, coordinate: place, value: 6}
END
check 'a cart that is pushed' refused 'no static equilibrium found: .* is 3, of place' 'what pushes there'
sed -i 's/value: 6/value: 6 - 24 * place/' "$work/bad.veh"
check 'a cart that is held' rests "$work/bad.veh"
check 'moves to 6 N / 24 N per m' near "$(column "$work/rest" place)" 0.25 1e-15
sed -i '/translation/s/axis: \[1, 0, 0\]}$/axis: [1, 0, 0], driven: true}/; /^forces/,$d' "$work/bad.veh"
check 'nothing that could move' refused "model 'pushed' has no freedom" 'free a coordinate'

run --equilibrium --modes "$hmmwv"
check 'one of the two' exits 2

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
