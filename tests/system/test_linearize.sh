#!/bin/sh
# SPDX-License-Identifier: MIT
# test_linearize.sh GICRUN: linear models, `gicrun --linearize`. A pendulum and a quarter car in closed form, to 1e-12, for
# a few roundings; all matrices against differences of another engine, see linear_difference.py for the tolerance; one
# model in three kinds of files; mistakes.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
python=/usr/bin/python3
python() { "$python" -B "$@" >"$work/said" 2>&1; }

# ---- closed forms

# J theta'' = torque - m g l sin(theta), J = m l^2 + 3, held by the torque at 30 degrees
cat >"$work/pendulum.veh" <<'END'
gicgen: 1
model: pendulum
gravity: [0, 0, -10]
base: ground
parameters:
  l: {value: 2, unit: m, tunable: true}
  m: {value: 4, unit: kg, tunable: true}
inputs:
  torque: {unit: N m, default: 40}
bodies:
  bob: {mass: m, position: [0, 0, 0], com: [0, 0, "-l"], inertia: [3, 3, 3]}
joints:
  hinge: {type: revolute, bodies: [ground, bob], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, bob], axis: [0, 1, 0], range: [-3, 3]}
ports:
  push: {body: bob, point: [0, 0, -2]}
forces:
  motor: {type: force, coordinate: angle, value: torque}
outputs:
  bob: {type: position, body: bob, point: [0, 0, -2]}
  hinge: {type: reaction, joint: hinge}
END
run --linearize "$work/pendulum.veh" -o "$work/pendulum.npz"
check 'a pendulum has a linear model' exits 0
check 'it says what and where' prints '^  2 states, 7 inputs, 9 outputs, 2 parameters in '
cat >"$work/pendulum.py" <<'END'
import sys
import numpy as np
d = np.load(sys.argv[1])
l, m, g, s, c = 2, 4, 10, 0.5, np.sqrt(0.75)
J = m * l * l + 3
k = -m * g * l * c / J
def near(name, found, wanted):
    assert np.allclose(found, wanted, rtol=1e-12, atol=1e-12), (name, found, wanted)
assert list(d["states"]) == ["angle", "angle.rate"] and list(d["state_units"]) == ["rad", "rad/s"]
assert list(d["inputs"]) == ["torque"] + ["push.%s.%s" % (a, b) for a in ("force", "torque") for b in "xyz"]
assert list(d["parameters"]) == ["l", "m"] and list(d["parameter_units"]) == ["m", "kg"]
near("z0", d["z0"], [np.pi / 6, 0])
near("A", d["A"], [[0, 1], [k, 0]])
# a push at the bob, which stands at (-l s, 0, -l c), has the lever of the other direction
near("B", d["B"], [[0] * 7, np.array([1, -l * c, 0, l * s, 0, 1, 0]) / J])
near("E", d["E"], [[0, 0], [-m * g * s / J, -g * l * s / J]])
out = {name: i for i, name in enumerate(d["outputs"])}
near("position", d["C"][[out["bob.x"], out["bob.z"]]], [[-l * c, 0], [l * s, 0]])
# the hinge carries the weight and what accelerates the bob: m (-l c theta'', l s theta'')
sign = np.sign(d["y0"][out["hinge.force.z"]])
near("weight", d["y0"][[out["hinge.force.x"], out["hinge.force.z"]]], [0, sign * m * g])
near("reaction", d["C"][[out["hinge.force.x"], out["hinge.force.z"]]],
     sign * np.array([[-m * l * c * k, 0], [m * l * s * k, 0]]))
near("reaction by the input", d["D"][[out["hinge.force.x"], out["hinge.force.z"]], 0],
     sign * np.array([-m * l * c, m * l * s]) / J)
near("reaction by the mass", d["F"][[out["hinge.force.x"], out["hinge.force.z"]], 1],
     sign * np.array([-m * l * c * -g * l * s / J, g + m * l * s * -g * l * s / J]))
END
check 'a pendulum in closed form' python "$work/pendulum.py" "$work/pendulum.npz"

# a quarter car on a road that is an input; coordinates: tire and spring
cat >"$work/quarter.veh" <<'END'
gicgen: 1
model: quarter
base: ground
parameters:
  k: {value: 20000, unit: N/m, tunable: true}
bodies:
  road: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  wheel: {mass: 50, com: [0, 0, 0.5], inertia: [1, 1, 1]}
  car: {mass: 400, com: [0, 0, 1], inertia: [1, 1, 1]}
joints:
  road: {type: prismatic, bodies: [ground, road], axis: [0, 0, 1]}
  wheel: {type: prismatic, bodies: [road, wheel], axis: [0, 0, 1]}
  car: {type: prismatic, bodies: [wheel, car], axis: [0, 0, 1]}
coordinates:
  road: {type: translation, bodies: [ground, road], axis: [0, 0, 1], range: [-1, 1], driven: true}
  tire: {type: translation, bodies: [road, wheel], axis: [0, 0, 1], range: [-1, 1]}
  spring: {type: translation, bodies: [wheel, car], axis: [0, 0, 1], range: [-1, 1]}
forces:
  tire: {type: spring_damper, coordinate: tire, stiffness: 200000, damping: 0}
  spring: {type: spring_damper, coordinate: spring, stiffness: k, damping: 1500}
outputs:
  car: {type: acceleration, body: car, point: [0, 0, 1]}
END
cat >"$work/quarter.py" <<'END'
import sys
import numpy as np
d = np.load(sys.argv[1])
k, c, K, m, M, g = 20000, 1500, 200000, 50, 400, 9.81
x = -M * g / k
def near(name, found, wanted):
    assert np.allclose(found, wanted, rtol=1e-12, atol=1e-11), (name, found, wanted)
assert list(d["states"]) == ["tire", "spring", "tire.rate", "spring.rate"]
assert list(d["inputs"]) == ["road", "road.rate", "road.acceleration"]
near("z0", d["z0"], [-(M + m) * g / K, x, 0, 0])
wheel, car = np.array([-K, k, 0, c]) / m, np.array([0, -k, 0, -c]) / M
near("A", d["A"], [[0, 0, 1, 0], [0, 0, 0, 1], wheel, car - wheel])
near("B", d["B"], [[0, 0, 0], [0, 0, 0], [0, 0, -1], [0, 0, 0]])
near("C", d["C"][2], car)
near("D", d["D"][2], [0, 0, 0])
near("E", d["E"][:, 0], [0, 0, x / m, -x / M - x / m])
near("F", d["F"][2], [-x / M])
END
run --linearize "$work/quarter.veh" -o "$work/quarter.npz"
check 'a quarter car in closed form' python "$work/quarter.py" "$work/quarter.npz"

# ---- against differences

# differs MODEL [SCENE TIME]
differs() {
    run --linearize -q ${3:+--at "$3"} "$1" ${2:+"$2"} -o "$work/linear.npz"
    exits 0 && python "$root/tests/tools/linear_difference.py" "$gicrun" "$1" "$work/linear.npz" ${2:+"$2"}
}
scenes=$root/models/scenes
cat >"$work/waves.scene" <<'END'
gicscene: 1
duration: 1
step: 0.005
initial: {velocity: [8, 0, 0]}
road: {type: sine, amplitude: 0.05, wavelength: 5, start: 1, phase_per_y: 0.3}
END
check 'reactions, at rest' differs "$root/models/quarter_car.veh"
check 'loops, in motion' differs "$root/models/andrews.veh" "$scenes/andrews.scene" 0.01
check 'a vehicle at rest' differs "$root/models/hmmwv.veh"
check 'tires, powertrain, steering, in a lane change' differs "$root/models/hmmwv_vehicle.veh" "$scenes/lane_change.scene" 3
check 'tires that brake' differs "$root/models/hmmwv_tmeasy.veh" "$scenes/tires_brake.scene" 2
check 'tunable geometry, on waves' differs "$root/tests/data/tuning/car.veh" "$work/waves.scene" 0.6
check 'tunable mechanisms' differs "$root/tests/data/tuning/hand.veh"
check 'inputs and parameters' differs "$root/tests/fmi/everything.veh"
# a run by implicit steps, with Jacobians by shares, a driver and gears: the point is where gicrun is then
sed '/^ratio/d; s/^integrator: .*/integrator: ros2\nkeep_jacobian: 4\nspread_jacobian: true/; s/^outputs:.*//' "$scenes/lane_change.scene" >"$work/implicit.scene"
check 'by implicit steps' differs "$root/models/hmmwv_vehicle.veh" "$work/implicit.scene" 3
cat >"$work/where.py" <<'END'
import csv
import sys

import numpy as np

linear = np.load(sys.argv[1])
head, *rows = csv.reader(open(sys.argv[2]))
row = next(row for row in rows if abs(float(row[0]) - linear["time"]) < 1e-9)
run = {name.split(" ")[0]: float(number) for name, number in zip(head, row)}
both = [(run[name], value) for name, value in zip(linear["outputs"], linear["y0"]) if name in run]
assert len(both) >= 3, head
assert all(abs(a - b) <= 1e-9 * (1 + abs(b)) for a, b in both), both
END
run -q --general --engine tcc "$root/models/hmmwv_vehicle.veh" "$work/implicit.scene" -o "$work/steps.csv"
check 'which begin at the state of that run' python "$work/where.py" "$work/linear.npz" "$work/steps.csv"
sed 's/^integrator: .*/integrator: auto/; /_jacobian/d' "$work/implicit.scene" >"$work/auto.scene"
run -q --linearize --at 3 "$root/models/hmmwv_vehicle.veh" "$work/auto.scene" -o "$work/none.npz"
check 'auto is refused' sh -c "grep -q 'linearize does not choose an integrator (auto) yet' '$work/err' && [ ! -e '$work/none.npz' ]"
# the comparison can fail
sed 's/stiffness: 283000/stiffness: 283003/' "$root/models/quarter_car.veh" >"$work/other.veh"
run --linearize "$root/models/quarter_car.veh" -o "$work/linear.npz"
check 'a stiffness that is 1e-5 off shows' [ "$(python "$root/tests/tools/linear_difference.py" "$gicrun" \
    "$work/other.veh" "$work/linear.npz"; echo $?)" -eq 1 ]

# ---- files

for kind in csv npz mat; do
    run -q --linearize --at 0.6 "$root/tests/data/tuning/car.veh" "$work/waves.scene" -o "$work/car.$kind"
    check "a file .$kind" exits 0
done
check 'the three have the same numbers and names' python "$root/tests/tools/linear_files.py" "$work/car"
cp "$work/car.npz" "$work/first.npz"
run -q --linearize --at 0.6 "$root/tests/data/tuning/car.veh" "$work/waves.scene" -o "$work/car.npz"
check 'the same bytes again' cmp "$work/first.npz" "$work/car.npz"
run --linearize --at 0.6 "$root/tests/data/tuning/car.veh" "$work/waves.scene"
check 'CSV on standard output, and nothing else' cmp "$work/out" "$work/car.csv"
run --linearize "$root/models/hmmwv.veh" -o "$work/car.csv"
check 'neutral directions are named' prints '^  neutral: x, y, yaw$'
run --linearize --at 0.0129 "$root/tests/data/tuning/car.veh" "$work/waves.scene" -o "$work/car.csv"
check 'constant steps end at the last one before' grep -q '^time,s,0.01,' "$work/car.csv"

# ---- jumps

# a sledge in a tail wind: the air comes from behind, where sideslip jumps from pi to -pi
cat >"$work/sledge.veh" <<'END'
gicgen: 1
model: sledge
base: sledge
gravity: [0, 0, 0]
bodies:
  sledge: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
forces:
  air: {type: aero, body: sledge, area: 1, force: [0, SIDE, 0], wind: [4, 0, 0]}
END
printf 'gicscene: 1\nduration: 1\nstep: 0.1\n' >"$work/plain.scene"
jumps() { # SIDE: how the coefficient follows sideslip
    sed "s/SIDE/$1/" "$work/sledge.veh" >"$work/wind.veh"
    run --linearize --at 0 "$work/wind.veh" "$work/plain.scene" -o "$work/wind.npz"
    check "sideslip from behind, $1" exits 0
}
jumps '"0.1 * sideslip"'
check 'a jump is said' says 'a rate or an output jumps'
jumps '"sin(sideslip)"'
silent() { ! says jumps; }
check 'what has no jump is not said' silent

# ---- mistakes

rm -f "$work"/car.*
ends() { exits "$1" && says "$2" && [ ! -e "$work/car.npz" ]; }
mistake() { # STATUS TEXT OPTION...: said, and no file is left
    wanted=$1
    text=$2
    shift 2
    run "$@"
    check "$text" ends "$wanted" "$text"
}
car=$root/tests/data/tuning/car.veh
mistake 2 "0 or more, unlike '-1'" --linearize --at -1 "$car" "$work/waves.scene" -o "$work/car.npz"
mistake 2 "0 or more, unlike 'soon'" --linearize --at soon "$car" "$work/waves.scene" -o "$work/car.npz"
mistake 2 'no scene given' --linearize --at 1 "$car" -o "$work/car.npz"
mistake 2 '\-\-at goes with --linearize' --modes --at 1 "$car" "$work/waves.scene"
mistake 2 'one of --eval, --equilibrium, --modes, --linearize, --trim, --gradient, --identify, --optimize, --kc' --modes --linearize "$car"
mistake 2 "must end in .csv, .npz or .mat, unlike '" --linearize "$car" -o "$work/car.txt"
mistake 2 "does not go with --engine 'gic'" --linearize --engine gic "$car" -o "$work/car.npz"
mistake 1 'remedy: --at takes a time from 0 to 1$' --linearize --at 1.5 "$car" "$work/waves.scene" -o "$work/car.npz"
mistake 1 'No such file or directory' --linearize "$root/models/hmmwv.veh" -o "$work/none/car.npz"
sed 's/value: torque}/value: "torque + sqrt(abs(angle))"}/; s/default: 40/default: 0/' "$work/pendulum.veh" >"$work/root.veh"
printf 'gicscene: 1\nduration: 1\nstep: 0.1\n' >"$work/plain.scene"
mistake 1 'the derivative of the rate of angle.rate by angle does not exist' \
    --linearize --at 0 "$work/root.veh" "$work/plain.scene" -o "$work/car.npz"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
