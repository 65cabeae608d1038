#!/bin/sh
# SPDX-License-Identifier: MIT
# test_implicit_many.sh GICSWEEP GICRUN: implicit steps of many vehicles: sweeps have gicrun's digits, vehicles of batches the bits
# that they have alone, in lanes too, and what is refused.
gicsweep=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
car=$root/models/quarter_car.veh

# scene SPRING: with its spring, m
scene() {
    printf 'gicscene: 1\nduration: 0.4\nstep: 0.004\noutput_step: 0.02\nintegrator: %s\nkeep_jacobian: 3\nspread_jacobian: %s\noutputs: [carriage.z, wheel.z]\n' "$integrator" "$shares"
    echo "initial: {coordinates: {spring: $1}}"
}
# the columns of a sweep's row in a run of gicrun: end, least, greatest of both outputs
ranges() {
    awk -F, 'NR > 1 { for (i = 2; i <= 3; ++i) { end[i] = $i; if (NR == 2 || $i + 0 < low[i] + 0) low[i] = $i
                      if (NR == 2 || $i + 0 > high[i] + 0) high[i] = $i } }
             END { print end[2] "," low[2] "," high[2] "," end[3] "," low[3] "," high[3] }' "$1"
}
while read -r integrator shares; do
    scene 0.25 >sweep.scene
    "$gicsweep" --engine tcc "$car" sweep.scene --vary state/spring=0.24:0.28:3 -o sweep.csv 2>err
    check "$integrator, shares $shares: a sweep" [ $? -eq 0 ]
    for run in 0 2; do
        row=$(sed -n "$((run + 2))p" sweep.csv)
        scene "$(echo "$row" | cut -d, -f2)" >one.scene
        "$gicrun" -q --general "$car" one.scene -o one.csv 2>err
        check "$integrator, shares $shares: run $run has gicrun's digits" [ "$(echo "$row" | cut -d, -f5-)" = "$(ranges one.csv)" ]
    done
    cp sweep.csv "$integrator.$shares.csv"
done <<'END'
ros3 false
imex true
exp3 false
imex false
END
! cmp -s imex.true.csv imex.false.csv
check "with shares it is another Jacobian" [ $? -eq 0 ]
"$gicsweep" "$car" sweep.scene --vary state/spring=0.24:0.28:2 -o other.csv 2>err
check "no lanes, which it says" says "note: each run by itself instead of lanes: implicit steps are made run by run"
cut -d, -f3- other.csv | sed -n 2p >first
check "the digits are the same" sh -c 'cut -d, -f3- sweep.csv | sed -n 2p | cmp -s - first'
rm -f none.csv
"$gicsweep" --engine tape "$car" sweep.scene --vary state/spring=0.24:0.28:2 -o none.csv 2>err
check "no implicit steps with the tape" sh -c '[ ! -e none.csv ] && grep -q "tape.* does not take implicit steps (imex) yet" err'
# ---- auto: a body on a spring of 1000 rad/s at its own stiffness, which one choice serves; runs start in equilibria of their own
cat >stiff.veh <<'END'
gicgen: 1
model: stiff
gravity: [1, 0, 0]
base: ground
parameters: {k: {value: 1e6, unit: N/m, tunable: true}}
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}}
forces: {f: {type: spring_damper, coordinate: x, stiffness: k, damping: 200, free: 0}}
inputs: {push: {unit: N}}
outputs: {x: {type: coordinate, coordinate: x}}
END
sed -i '/^inputs/d' stiff.veh
while read -r step named method; do
    for start in 'initial: {equilibrium: true}' 'initial: {rates: {x: 1e-3}}'; do
        printf 'gicscene: 1\nduration: 0.4\nstep: %s\noutput_step: 0.02\nintegrator: auto\n%s\n' "$step" "$start" >auto.scene
        sed "s/^step: .*/step: $named/; s/auto/$method/" auto.scene >named.scene
        "$gicrun" stiff.veh auto.scene -o one.csv 2>&1 | grep 'integrator auto' >gicrun.said
        for scene in auto named; do
            "$gicsweep" stiff.veh $scene.scene --vary parameter/k=5e5:1.2e6:5 -o $scene.csv 2>$scene.err
            verdict $? "$method, $scene, $start"
        done
        grep 'integrator auto' auto.err | cmp - gicrun.said && grep -q "integrator auto: $method, steps of $named s$" gicrun.said
        check "$method, $start: what it takes is gicrun's choice for the scene" [ $? -eq 0 ]
        cmp auto.csv named.csv
        check "$method, $start: each run is that of its name" [ $? -eq 0 ]
    done
done <<'END'
0.02 0.02 ros3
0.001 0.0005 ab3
END
# parts, begun again: the choice is a part of the plan
"$gicsweep" -q stiff.veh auto.scene --vary parameter/k=5e5:1.2e6:5 --slurm plan --parts 3 2>err
check "a plan" grep -q 'integrator.ab3, steps of 0.0005' plan/plan
for part in 1 2 3 2; do
    "$gicsweep" -q stiff.veh auto.scene --vary parameter/k=5e5:1.2e6:5 --shard $part/3 -o plan 2>err
    check "part $part" [ $? -eq 0 ]
done
"$gicsweep" -q --merge plan -o merged.csv && cmp merged.csv auto.csv
check "parts have the bytes of one sweep" [ $? -eq 0 ]
sed -i 's/^step: .*/step: 0.02/' auto.scene
"$gicrun" --engine tape stiff.veh auto.scene -o one.csv 2>&1 | grep -A 2 'integrator auto' >gicrun.said
"$gicsweep" --engine tape stiff.veh auto.scene --vary parameter/k=5e5:1.2e6:2 -o tape.csv 2>err
grep -A 2 'integrator auto' err | cmp - gicrun.said && grep -q 'no implicit steps with this engine' gicrun.said
check "without implicit steps it takes others, and says so" [ $? -eq 0 ]

# batches: a model without fast states, and one with
cat >many.py <<'END'
import sys
import gicgen

for path in sys.argv[1:]:
    model = gicgen.Model(path, integrator="ros3")
    for lanes in 1, 4:
        many = model.batch(5, lanes=lanes)
        for method in "ros2", "ros3", "imex", "ab3", "imex":  # by turns: nothing of the one is left in the other
            cars = [model.instance() for v in range(5)]
            for v, car in enumerate(cars):
                state = many.states[v].copy()
                state[0] += 1e-3 * (v + 1)
                many.states[v] = state
                car.states.array[:] = state
                car.restart()
            many.restart()
            for k in range(2):
                many.step(0.002, 7, method)
                for v, car in enumerate(cars):
                    car.step(0.002, 7, method)
                    assert (many.states[v] == car.states.array).all(), (path, lanes, method, v)
        # one that fails disturbs no other
        many = model.batch(5, lanes=lanes)
        many.states.array[(1, 0) if lanes == 1 else (0, 1, 0)] = float("nan")
        many.restart()
        many.step(0.002, 3, "ros3", check=False)
        car = model.instance()
        car.step(0.002, 3, "ros3")
        assert many.status[1] != 0 and (many.status[[0, 2, 3, 4]] == 0).all()
        assert all((many.states[v] == car.states.array).all() for v in (0, 2, 3, 4))
# Jacobians by shares, which a scene asks for: as in a run, and in lanes
model = gicgen.Model(sys.argv[1], integrator="imex")
last = {}
for name in "shared.scene", "whole.scene":
    car = model.instance(name)
    car.step(0.004, 100, "imex")
    run = model.run(name)
    last[name] = car.states.array.copy()
    for output in "carriage.z", "wheel.z":
        assert run[output][-1] == car.outputs[output], (name, output)
    for lanes in 1, 4:
        many = model.batch(5, name, lanes=lanes)
        many.step(0.004, 100, "imex")
        assert all((many.states[v] == car.states.array).all() for v in range(5)), (name, lanes)
assert (last["shared.scene"] != last["whole.scene"]).any()
# exponential steps: those of a run, vehicle by vehicle
model = gicgen.Model(sys.argv[1], integrator="exp3")
car = model.instance("whole.scene")
car.step(0.004, 100, "exp3")
run = model.run("whole.scene")
for output in "carriage.z", "wheel.z":
    assert run[output][-1] == car.outputs[output], output
many = model.batch(3, "whole.scene")
many.step(0.004, 100, "exp3")
assert all((many.states[v] == car.states.array).all() for v in range(3))
for wrong in lambda: model.batch(4, lanes=4), lambda: gicgen.Model(sys.argv[1], integrator="imex").instance().step(0.004, 1, "exp3"):
    try:
        wrong()
    except gicgen.Error as error:
        assert "no exponential steps" in str(error), error
    else:
        raise AssertionError("exponential steps without their code")
plain = gicgen.Model(sys.argv[1])
plain.instance("shared.scene").step(0.004, 1, "ab3")  # code without implicit steps needs no shares
for lanes in 1, 4:
    try:
        gicgen.Model(sys.argv[1], integrator="imex", solve="augmented").batch(4, "shared.scene", lanes=lanes)
    except gicgen.Error as error:
        assert "not made by shares" in str(error), error
    else:
        raise AssertionError("shares of a model that has none")
for what in plain.instance(), plain.batch(2):
    try:
        what.step(0.002, 1, "ros3")
    except gicgen.Error as error:
        assert "its code has no implicit steps" in str(error), error
    else:
        raise AssertionError("implicit steps without their code")
END
integrator=imex
for shares in true false; do
    [ $shares = true ] && name=shared || name=whole
    scene 0.26 | sed 's/keep_jacobian: 3/keep_jacobian: 8/' >"$name".scene
done
GICGEN_LIBRARY=$(dirname "$gicrun")/libgic.so PYTHONPATH=$root/runtime/python /usr/bin/python3 many.py "$car" "$root/tests/data/laws/states.veh" >out 2>err
verdict $? "vehicles of batches have the bits that they have alone"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
