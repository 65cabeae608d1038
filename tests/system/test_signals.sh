#!/bin/sh
# SPDX-License-Identifier: MIT
# test_signals.sh GICGEN GICRUN: formulas of forces that read outputs and signals (FORMAT.md section 7.1). Drag against
# the closed solutions of coasting with linear and with quadratic drag; runs against the engine gic, which orders and
# evaluates formulas by itself; a vehicle whose forces read tires and powertrain; images of formulas in the mirror; names
# with a prefix; scenes that stop by a signal; entries that nothing reads. Accelerations against quad precision are in
# test_accelerations, random mechanisms with such formulas in test_random_mechanisms.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

# ---- coasting: m v' = -b v, and m v' = -c v^2 with v = v0 / (1 + c v0 t / m); a wind moves the air
cat >coast.veh <<'END'
gicgen: 1
model: coast
gravity: [0, 0, 0]
base: car
bodies: {car: {mass: 1000, com: [0, 0, 0], inertia: [1, 1, 1]}}
parameters: {b: {value: 0, tunable: true}, c: {value: 0, tunable: true}}
inputs: {wind: {unit: m/s}}
signals: {air_speed: {value: v.x - wind, unit: m/s}}
forces: {drag: {type: load, body: car, in: car, force: ["-b * air_speed - c * air_speed * abs(air_speed)", 0, 0]}}
outputs:
  v: {type: velocity, body: car, in: car}
  air_speed: {type: signal, signal: air_speed}
END
coast() {
    cat >coast.scene <<END
gicscene: 1
duration: 10
step: 0.01
output_step: 1
integrator: rk4
initial: {speed: $1}
parameters: {b: $2, c: $3}
inputs: {wind: $4}
END
    "$gicrun" -q coast.veh coast.scene -o coast.csv || echo "FAIL: it does not run"
}
# RK4's error at these steps is below (b h / m)^4: 1e-12; 1e-11 leaves room for rounding
solved() {
    column air_speed coast.csv | awk -v b="$2" -v c="$3" -v v="$1" -v tolerance=1e-11 '
        { t = NR - 1; right = c ? v / (1 + c * v * t / 1000) : v * exp(-b * t / 1000)
          d = $1 - right; if (d < 0) d = -d; if (!(d <= tolerance * v)) bad = 1 }
        END { exit bad || NR != 11 }'
}
coast 30 50 0 0
check "linear drag" solved 30 50 0
coast 30 0 0.5 0
check "quadratic drag" solved 30 0 0.5
coast 25 0 0.5 -5
check "with a wind" solved 30 0 0.5

# ---- two sides, elements that read others before and after them
model=$root/tests/data/laws/signals.veh
cat >reader.scene <<'END'
gicscene: 1
duration: 2
step: 0.001
output_step: 0.1
integrator: rk4
initial: {speed: 10, rates: {yaw: 1, swing_l: 0.5}}
inputs: {wind: {sine: {amplitude: 3, frequency: 1}}}
END
every_way 'both sides' 1e-11 "$model" reader.scene
mkdir again && "$gicgen" "$model" -o reader.c && "$gicgen" "$model" -o again/reader.c && cmp -s reader.c again/reader.c
verdict $? "the same code twice"

# ---- an image reads the other side, and what changes its sign in the mirror with the other sign
cat >half.veh <<'END'
gicgen: 1
model: halves
base: chassis
bodies:
  chassis: {mass: 100, com: [0, 0, 0], inertia: [10, 10, 10]}
  arm_l: {mass: 5, com: [0, 1, 0], inertia: [1, 1, 1]}
joints: {hinge_l: {type: revolute, bodies: [chassis, arm_l], point: [0, 0.5, 0], axis: [1, 0, 0]}}
coordinates: {swing_l: {type: angle, bodies: [chassis, arm_l], axis: [1, 0, 0]}}
signals: {out_l: "tip_l.y + 0.5 * tip_l.z - 0.25 * rate_l.x"}
forces:
  hook_l: {type: load, body: arm_l, force: ["-tip_l.y", "-out_l", 10], torque: [0.1 * rate_l.z, "-rate_l.y", -rate_l.x]}
  twist_l: {type: force, coordinate: swing_l, value: "-tilt.roll + 0.5 * seen_l"}
  spring_l: {type: spring_damper, coordinate: swing_l, stiffness: 100}
outputs:
  tip_l: {type: position, body: arm_l, point: [0, 1.5, 0]}
  rate_l: {type: angular_velocity, body: arm_l}
  tilt: {type: roll_pitch_yaw, body: chassis}
  seen_l: {type: force, element: spring_l}
  out_l: {type: signal, signal: out_l}
END
cat >whole.veh <<'END'
gicgen: 1
model: wholes
base: chassis
bodies:
  chassis: {mass: 100, com: [0, 0, 0], inertia: [10, 10, 10]}
  arm_l: {mass: 5, com: [0, 1, 0], inertia: [1, 1, 1]}
  arm_r: {mass: 5, com: [0, -1, 0], inertia: [1, 1, 1]}
joints:
  hinge_l: {type: revolute, bodies: [chassis, arm_l], point: [0, 0.5, 0], axis: [1, 0, 0]}
  hinge_r: {type: revolute, bodies: [chassis, arm_r], point: [0, -0.5, 0], axis: [1, 0, 0]}
coordinates:
  swing_l: {type: angle, bodies: [chassis, arm_l], axis: [1, 0, 0]}
  swing_r: {type: angle, bodies: [chassis, arm_r], axis: [-1, 0, 0]}
signals: {out_l: "tip_l.y + 0.5 * tip_l.z - 0.25 * rate_l.x", out_r: "-tip_r.y + 0.5 * tip_r.z + 0.25 * rate_r.x"}
forces:
  hook_l: {type: load, body: arm_l, force: ["-tip_l.y", "-out_l", 10], torque: [0.1 * rate_l.z, "-rate_l.y", -rate_l.x]}
  hook_r: {type: load, body: arm_r, force: ["tip_r.y", "out_r", 10], torque: [0.1 * rate_r.z, "-rate_r.y", -rate_r.x]}
  twist_l: {type: force, coordinate: swing_l, value: "-tilt.roll + 0.5 * seen_l"}
  twist_r: {type: force, coordinate: swing_r, value: "tilt.roll + 0.5 * seen_r"}
  spring_l: {type: spring_damper, coordinate: swing_l, stiffness: 100}
  spring_r: {type: spring_damper, coordinate: swing_r, stiffness: 100}
outputs:
  tip_l: {type: position, body: arm_l, point: [0, 1.5, 0]}
  tip_r: {type: position, body: arm_r, point: [0, -1.5, 0]}
  rate_l: {type: angular_velocity, body: arm_l}
  rate_r: {type: angular_velocity, body: arm_r}
  tilt: {type: roll_pitch_yaw, body: chassis}
  seen_l: {type: force, element: spring_l}
  seen_r: {type: force, element: spring_r}
  out_l: {type: signal, signal: out_l}
  out_r: {type: signal, signal: out_r}
END
cat >lean.scene <<'END'
gicscene: 1
duration: 1
step: 0.002
output_step: 0.1
integrator: rk4
initial: {angular_velocity: [0.5, 0.25, 1], rates: {swing_l: 1, swing_r: -0.5}}
END
"$gicrun" -q half.veh lean.scene -o half.csv && "$gicrun" -q --engine gic whole.veh lean.scene -o whole.csv &&
    off=$(apart half.csv whole.csv)
check "a mirror image against both sides written out: ${off:-no run}" within "${off:-1}" 1e-11

# ---- names with a prefix; another model's include
printf 'gicgen: 1\nmodel: pair\ninclude: {file: coast.veh, prefix: a_}\n' >pair.veh
if "$gicgen" pair.veh -o pair.c 2>said; then
    sed 's/speed: 30/speed: 25/; s/\([bc]\): /a_\1: /g; s/wind/a_wind/' coast.scene >pair.scene
    "$gicrun" -q pair.veh pair.scene -o pair.csv && [ "$(column a_air_speed pair.csv)" = "$(column air_speed coast.csv)" ]
fi
verdict $? "a file with a prefix: $(head -n 1 said)"

# ---- tires and powertrain, read by forces; code for the scene against code for all and gic
cp -r "$root/models/parts" "$root/models/tires" .
cp "$root"/models/hmmwv*.veh .
cat >driven.veh <<'END'
gicgen: 1
model: driven
include: hmmwv_vehicle.veh
signals:
  load_l: {value: contact_l.fz * 1e-3, unit: kN}
  revs: power.engine_speed / 100
forces:
  push: {type: load, body: chassis, in: chassis,
         force: ["-10 * load_l - revs", "0.05 * grip_r.fy", "-power.gear - 100 * grip_l.kappa - spin_l.spin"]}
outputs:
  contact_l: {type: wheel, wheel: tire_f_l}
  grip_l: {type: tire, wheel: tire_f_l}
  spin_l: {type: tire, wheel: tire_r_l}
  power: {type: powertrain}
  load_l: {type: signal, signal: load_l}
END
sed 's/^duration: .*/duration: 4/' "$root/models/scenes/full_run.scene" >driven.scene
# a step of AB3 takes roundings of stiff tires along: 1e-8, as without signals
some_ways 'tires and powertrain' 1e-8 driven.veh driven.scene '' --general '--engine tape'

# ---- scenes see signals as they see outputs
printf 'until: air_speed < 20\n' >>coast.scene
sed -i 's/^duration: .*/duration: 100/' coast.scene
"$gicrun" -q coast.veh coast.scene -o until.csv && column air_speed until.csv | tail -n 1 |
    awk '{ exit !($1 > 20 - 1e-6 && $1 < 20 + 1e-6) }'
verdict $? "a run until a signal has a value: $(column air_speed until.csv | tail -n 1)"
sed '/air_speed: {type/d; s/force: .*/force: [-v.x, 0, 0]}}/' coast.veh >unread.veh
"$gicgen" unread.veh -o unread.c 2>said && grep -q "unread.veh:8:11: warning: nothing in the model reads signal 'air_speed'" said
verdict $? "a signal that nothing reads: $(head -n 1 said)"

# ---- entries that nothing reads: one warning each at its place, none of a mirror image whose original is read
cat >idle.veh <<'END'
gicgen: 1
model: idle
base: car
bodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
parameters:
  alone: {value: 1, tunable: true}
  plain: 2
  mass: {value: 3, tunable: true}
  high: {value: 1, tunable: true}
  after: 2 * mass
  side_l: {value: 1, tunable: true}
  pair_l: {value: 1, tunable: true}
tables:
  spare: {x: [0, 1], y: [0, 1]}
  curve: {x: [0, 1], y: [0, 1]}
  spring: {x: [-1, 1], y: [-1, 1]}
inputs: {spare: {}, wind: {}}
points: {top: [0, 0, high]}
forces:
  push: {type: load, body: car, point: top, force: ["mass * curve(wind)", "side_l", 0]}
  hold: {type: spring_damper, bodies: [ground, car], points: [[0, 0, -1], [0, 0, 0]], table: spring}
END
"$gicgen" --dump-model idle.veh -o idle.json 2>said
sed -n 's/^idle.veh:\([0-9]*:[0-9]*\): warning: /\1: /p' said >warned
cat >wanted <<'END'
17:10: nothing in the model reads input 'spare'
6:3: nothing in the model reads tunable parameter 'alone'
10:3: nothing in the model reads tunable parameter 'after'
12:3: nothing in the model reads tunable parameter 'pair_l'
14:3: nothing in the model reads table 'spare'
END
cmp -s warned wanted && [ -s idle.json ] && [ "$(grep -c '  remedy: take it away, unless a scene reads it' said)" -eq 5 ]
verdict $? "entries that nothing reads: $(cat said)"
quiet() { "$gicgen" --dump-model "$1" -o quiet.json 2>said && ! grep -q 'warning: nothing' said; }
for shipped in "$root"/models/*.veh "$root"/models/tutorial/[0-9]*.veh; do
    check "$(basename "$shipped") reads all that it has" quiet "$shipped"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
