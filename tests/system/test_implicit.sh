#!/bin/sh
# SPDX-License-Identifier: MIT
# test_implicit.sh GICGEN GICRUN: implicit steps (ros2, ros3, imex) and exponential ones (exp3) of models. A body on a stiff bushing against its closed form
# and its static displacement; van der Pol's oscillator and Prothero and Robinson's problem as models; orders of whole
# vehicles, with Jacobians that are kept; contacts, gears, controllers; a parked vehicle that must not creep; energy over
# a long run; bits of all compilers; embedded code in both number types; what is refused. The methods themselves are in
# unit/test_rosenbrock.c and unit/test_exponential.c.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
# shellcheck source=tests/lib/scenes.sh
. "$(dirname "$0")/../lib/scenes.sh"
cd "$work" || exit 1
models=$root/models

# order NAME MODEL REFERENCE STEPS LEAST MOST FILE: of a scene whose step is @, at STEPS and twice as many a tenth of
# the run, against rows of a reference
order() {
    for part in 1 2; do
        step=$(awk -v d="$(sed -n 's/^duration: //p' "$7")" -v n="$4" -v p=$part 'BEGIN { printf "%.17g", d / 10 / n / p }')
        sed "s/@/$step/" "$7" >order.scene
        "$gicrun" -q "$2" order.scene -o order.csv 2>err || break
        eval "off$part=\$(apart order.csv '$3')"
    done
    found=$(awk -v a="${off1:-0}" -v b="${off2:-0}" 'BEGIN { print (b > 0 ? log(a / b) / log(2) : 0) }')
    check "$1: errors ${off1:-none} and ${off2:-none}, order $found" within "$5" "$found"
    check "$1: order $found" within "$found" "$6"
    unset off1 off2
}

# ---- a body of 2 kg on a bushing of 2e6 N/m and 400 Ns/m, 159 Hz: x = e^(-100 t) (cos w t + 100 / w sin w t) / 1000
cat >mount.veh <<'END'
gicgen: 1
model: mount
gravity: [0, 0, 0]
base: ground
bodies: {b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}}
inputs: {push: {unit: N}}
forces:
  rubber: {type: bushing, bodies: [ground, b], point: [0, 0, 0], stiffness: [2e6, 0, 0, 0, 0, 0], damping: [400, 0, 0, 0, 0, 0]}
  push: {type: load, body: b, force: [push, 0, 0]}
outputs: {x: {type: coordinate, coordinate: x}}
END
awk 'BEGIN { print "time [s],x.value [m]"; w = sqrt(1e6 - 1e4); for (k = 0; k <= 10; ++k) { t = k / 500
    printf "%.17g,%.17g\n", t, 0.001 * exp(-100 * t) * (cos(w * t) + 100 / w * sin(w * t)) } }' >mount.csv
for method in 2 3; do
    scene 0.02 @ "integrator: ros$method" 'initial: {coordinates: {x: 0.001}}' 'outputs: [x.value]' >mount.scene
    order "a body on a bushing, ros$method" mount.veh mount.csv 200 $method.0 $method.2 mount.scene 2>err
    # at steps of 25 radians the displacement is the static one
    scene 20 0.025 "integrator: ros$method" 'inputs: {push: 3000}' 'outputs: [x]' >static.scene
    run -q mount.veh static.scene -o static.csv
    x=$(tail -n 1 static.csv | cut -d, -f2)
    check "the static displacement by ros$method: $x" within "$(awk "BEGIN { d = $x / 0.0015 - 1; print d < 0 ? -d : d }")" 1e-12
done

# ---- without damping its energy goes down by |R(i w h)|^2 in each step, with the method's stability function R
sed 's/damping: \[400,/damping: [0,/' mount.veh >swing.veh
for method in 2 3; do
    # w = 1000 rad/s, w h = 0.2, 500 steps
    scene 0.1 0.0002 "integrator: ros$method" 'initial: {coordinates: {x: 0.001}}' 'outputs: [x]' >swing.scene
    run -q swing.veh swing.scene -o swing.csv
    off=$(tail -n 1 swing.csv | awk -F, -v order=$method '{ y = 0.2
        if (order == 2) { g = 1 - sqrt(0.5); re = 1; im = (1 - 2 * g) * y }
        else { g = 0.435866521508459; re = 1 - (0.5 - 4 * g + 6 * g * g) * y * y
            im = (1 - 4 * g) * y - (1 / 6 - 2 * g + 6 * g * g - 4 * g * g * g) * y * y * y }
        right = 1; for (k = 0; k < 500; ++k) right *= (re * re + im * im) / (1 + g * g * y * y) ^ (order == 2 ? 2 : 4)
        d = ($2 * $2 * 1e6 + $3 * $3) / right - 1; print (d < 0 ? -d : d) }')
    check "energy on a bushing without damping, ros$method: ${off:-no run}" within "${off:-1}" 1e-9
done

# ---- imex: the same body, its static displacement, and without damping the recurrence of the backward formula
scene 0.02 @ 'integrator: imex' 'initial: {coordinates: {x: 0.001}}' 'outputs: [x.value]' >mount.scene
order 'a body on a bushing, imex' mount.veh mount.csv 200 1.9 2.2 mount.scene 2>err
scene 20 0.025 'integrator: imex' 'keep_jacobian: 50' 'inputs: {push: 3000}' 'outputs: [x]' >static.scene
run -q mount.veh static.scene -o static.csv
x=$(tail -n 1 static.csv | cut -d, -f2)
check "the static displacement by imex: $x" within "$(awk "BEGIN { d = $x / 0.0015 - 1; print d < 0 ? -d : d }")" 1e-12
scene 0.1 0.0002 'integrator: imex' 'keep_jacobian: 9' 'initial: {coordinates: {x: 0.001}}' 'outputs: [x]' >swing.scene
run -q swing.veh swing.scene -o swing.csv
# of c = x - i v / w; the first step is one of ros2: (1 + (1 - 2 g) z) / (1 - g z)^2, z = 0.2 i
off=$(tail -n 1 swing.csv | awk -F, '{ y = 0.2; g = 1 - sqrt(0.5)
    p = 1 - g * g * y * y; q = -2 * g * y; s = (1 - 2 * g) * y
    a = 1; b = 0; c = (p + s * q) / (p * p + q * q); d = (s * p - q) / (p * p + q * q)
    for (k = 1; k < 500; ++k) { u = 4 * c - a; v = 4 * d - b; a = c; b = d
        c = (3 * u - 2 * y * v) / (9 + 4 * y * y); d = (3 * v + 2 * y * u) / (9 + 4 * y * y) }
    e = ($2 * $2 * 1e6 + $3 * $3) / (c * c + d * d) - 1; print (e < 0 ? -e : e) }')
check "energy on a bushing without damping, imex: ${off:-no run}" within "${off:-1}" 1e-9
# A force that gets 17 times as stiff as when its Jacobian was made: the step does not bear that, and says so. With
# Jacobians of their own steps do.
sed 's/rubber: .*/rubber: {type: force, coordinate: x, value: "-2e6 * x - 2e14 * x * x * x - 400 * rate(x)"}/' mount.veh >harder.veh
scene 2 0.001 'integrator: imex' 'keep_jacobian: 1000' 'inputs: {push: {sine: {amplitude: 3000, frequency: 0.1, start: -10}}}' 'outputs: [x]' >harder.scene
run -q harder.veh harder.scene -o harder.csv
{ [ "$status" -ne 0 ] && says 'error: ' && says 'x'; }
verdict $? "a Jacobian that is too old: $(head -n 1 err)"
sed 's/^keep.*/keep_jacobian: 2/' harder.scene >fresh.scene
run -q harder.veh fresh.scene -o harder.csv
off=$(tail -n 1 harder.csv | awk -F, '{ p = 3000 * sin(0.4 * 3.14159265358979312); d = (2e6 * $2 + 2e14 * $2 ^ 3) / p - 1; print (d < 0 ? -d : d) }')
check "a force that gets stiffer, imex: ${off:-no run}" within "${off:-1}" 1e-4

# ---- exp3: where rates are linear nothing but rounding is off, at steps of a radian, and of 25 for what is at rest
scene 0.02 0.001 'integrator: exp3' 'initial: {coordinates: {x: 0.001}}' 'outputs: [x.value]' >mount.scene
run -q mount.veh mount.scene -o own.csv
off=$(apart own.csv mount.csv)
check "a body on a bushing, exp3: $off m of 0.001" within "$off" 1e-15
scene 20 0.025 'integrator: exp3' 'inputs: {push: 3000}' 'outputs: [x]' >static.scene
run -q mount.veh static.scene -o static.csv
x=$(tail -n 1 static.csv | cut -d, -f2)
check "the static displacement by exp3: $x" within "$(awk "BEGIN { d = $x / 0.0015 - 1; print d < 0 ? -d : d }")" 1e-12
scene 0.1 0.0002 'integrator: exp3' 'initial: {coordinates: {x: 0.001}}' 'outputs: [x]' >swing.scene
run -q swing.veh swing.scene -o swing.csv
off=$(tail -n 1 swing.csv | awk -F, '{ d = $2 * $2 * 1e6 + $3 * $3 - 1; print (d < 0 ? -d : d) }')
check "energy on a bushing without damping, exp3: ${off:-no run}" within "${off:-1}" 1e-12
# a force that is 17 times as stiff as the matrix of the first step has it: 4100 rad/s, of which steps of 1 ms bear 1200
sed 's/imex/exp3/; s/^keep.*/keep_jacobian: 1000/' harder.scene >aged.scene
run -q harder.veh aged.scene -o harder.csv
{ [ "$status" -ne 0 ] && says 'error: ' && says 'x'; }
verdict $? "exponentials that are too old: $(head -n 1 err)"
sed 's/^keep.*/keep_jacobian: 2/' aged.scene >fresh.scene
run -q harder.veh fresh.scene -o harder.csv
off=$(tail -n 1 harder.csv | awk -F, '{ p = 3000 * sin(0.4 * 3.14159265358979312); d = (2e6 * $2 + 2e14 * $2 ^ 3) / p - 1; print (d < 0 ? -d : d) }')
check "a force that gets stiffer, exp3: ${off:-no run}" within "${off:-1}" 1e-4

# ---- light upper arms with their masses, 5 ms: nearer to variable steps than AB3 with the same
sed 's/^output_step: .*/output_step: 0.1/' "$models/scenes/hmmwv14.scene" >light.scene
run -q --integrator adams --tolerance 1e-11 "$models/hmmwv14.veh" light.scene -o light.csv
for method in ros3 ab3; do
    run -q --integrator $method "$models/hmmwv14.veh" light.scene -o "$method.csv"
done
far=$(apart ros3.csv light.csv)
check "hmmwv14 at 5 ms, ros3: $far" within "$far" 0.005
check "hmmwv14 at 5 ms, ros3: $far, ab3: $(apart ab3.csv light.csv)" within "$(awk "BEGIN { print 5 * $far }")" "$(apart ab3.csv light.csv)"

# ---- a pendulum on a bushing that turns by 2 rad: I q'' = -k q at any angle, q = 2 cos w t, and its energy as above; the
# Jacobian is exact there, so that steps are those of the stability functions at any amplitude
cat >turning.veh <<'END'
gicgen: 1
model: turning
gravity: [0, 0, 0]
base: ground
bodies: {b: {mass: 2, com: [0, 0, -0.5], inertia: [1, 0.5, 1]}}
joints: {j: {type: revolute, bodies: [ground, b], point: [0, 0, 0], axis: [0, 1, 0]}}
coordinates: {q: {type: angle, bodies: [ground, b], axis: [0, 1, 0], range: [-3, 3]}}
forces:
  rubber: {type: bushing, bodies: [ground, b], point: [0, 0, 0], stiffness: [0, 0, 0, 0, 1e4, 0], damping: [0, 0, 0, 0, 0, 0]}
outputs: {q: {type: coordinate, coordinate: q}}
END
for method in 2 3; do
    # 0.5 + 2 * 0.25 = 1 kg m^2: w = 100 rad/s, w h = 0.2, 500 steps
    scene 1 0.002 "integrator: ros$method" 'initial: {coordinates: {q: 2}}' 'outputs: [q]' >turning.scene
    run -q turning.veh turning.scene -o turning.csv
    off=$(tail -n 1 turning.csv | awk -F, -v order=$method '{ y = 0.2
        if (order == 2) { g = 1 - sqrt(0.5); re = 1; im = (1 - 2 * g) * y }
        else { g = 0.435866521508459; re = 1 - (0.5 - 4 * g + 6 * g * g) * y * y
            im = (1 - 4 * g) * y - (1 / 6 - 2 * g + 6 * g * g - 4 * g * g * g) * y * y * y }
        right = 1; for (k = 0; k < 500; ++k) right *= (re * re + im * im) / (1 + g * g * y * y) ^ (order == 2 ? 2 : 4)
        d = ($2 * $2 * 1e4 + $3 * $3) / 4e4 / right - 1; print (d < 0 ? -d : d) }')
    check "energy of a pendulum on a bushing at 2 rad, ros$method: $off" within "${off:-1}" 1e-9
    # and its place in the limit, by AB3 too: cos 100 at 0.05 ms, errors of order 2 and 3 in w h = 0.005 over 2e4 steps
    scene 1 0.00005 "integrator: ros$method" 'initial: {coordinates: {q: 2}}' 'outputs: [q.value]' >limit.scene
    run -q turning.veh limit.scene -o limit.csv
    run -q --integrator ab3 turning.veh limit.scene -o explicit.csv
    awk 'BEGIN { print "time,q"; for (k = 0; k <= 10; ++k) printf "%.17g,%.17g\n", k / 10, 2 * cos(10 * k) }' >cosine.csv
    most=$([ $method = 2 ] && echo 1e-3 || echo 1e-5)
    check "in the limit the place is that of the cosine, ros$method: $(apart limit.csv cosine.csv)" within "$(apart limit.csv cosine.csv)" "$most"
    check "and that of ab3, ros$method: $(apart limit.csv explicit.csv)" within "$(apart limit.csv explicit.csv)" "$most"
done

scene 1 0.05 'integrator: exp3' 'initial: {coordinates: {q: 2}}' 'outputs: [q.value]' >turning.scene
run -q turning.veh turning.scene -o turning.csv
off=$(apart turning.csv cosine.csv)
check "a pendulum on a bushing at 2 rad in steps of 5 radians, exp3: $off" within "$off" 1e-11

# ---- van der Pol's oscillator and Prothero and Robinson's problem as a model's own states
cat >problems.veh <<'END'
gicgen: 1
model: problems
base: ground
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}}
parameters: {mu: {value: 1000, tunable: true}, stiff: {value: 1e6, tunable: true}}
inputs: {phi: {}}
states:
  z: {initial: 2, rate: w}
  w: {initial: -0.66, rate: "mu * ((1 - z * z) * w - z)"}
  follows: {rate: "stiff * (phi - follows)"}
signals: {z_s: z, w_s: w, follows_s: follows}
forces: {f: {type: force, coordinate: x, value: "-1000 * x - 10 * rate(x) + follows"}}
outputs:
  z: {type: signal, signal: z_s}
  w: {type: signal, signal: w_s}
  follows: {type: signal, signal: follows_s}
END
scene 0.5 0.01 'integrator: adams' 'tolerance: 1e-12' 'outputs: [z, w]' 'inputs: {phi: 0}' >pol.scene
run -q problems.veh pol.scene -o pol.csv
# order 1 of the algebraic part w and 2 of z at least; w is on z (1 - z^2) w = z
for method in 2 3; do
    scene 0.5 @ "integrator: ros$method" 'outputs: [z, w]' >stiff.scene
    order "van der Pol, mu 1000, ros$method" problems.veh pol.csv 40 1.6 4.2 stiff.scene
    # a lag of 1 us at steps of 10 ms: follows = sin 3t to a step's error of the lag itself, 3 us
    scene 1 0.01 "integrator: ros$method" 'outputs: [follows]' 'parameters: {mu: 1}' 'inputs: {phi: {sine: {amplitude: 1, frequency: 0.5, start: -2}}}' >lag.scene
    run problems.veh lag.scene -o lag.csv
    off=$(awk -F, 'NR > 2 { p = 3.14159265358979312; d = $2 - (sin(p * $1) - p * 1e-6 * cos(p * $1)); if (d < 0) d = -d; if (d > most) most = d } END { print most + 0 }' lag.csv)
    check "Prothero and Robinson, ros$method: ${off:-none}" within "${off:-1}" 1e-7
done

# ---- whole vehicles: base, loops, driven steering, tires and powertrain; Jacobians kept for 1 and for 7 steps
# reference MODEL SCENE FILE: by variable steps
reference() {
    sed "/^step:/d; s/^integrator:.*/integrator: adams/; /^keep/d" "$2" >reference.scene
    "$gicrun" -q --tolerance 1e-12 "$1" reference.scene -o "$3" 2>err
}
cat >waves <<'END'
initial: {position: [0, 0, 0.474], velocity: [5, 0, 0]}
road: {type: sine, amplitude: 0.01, wavelength: 6, phase_per_y: 1}
END
cat >steering <<'END'
initial: {equilibrium: true, speed: 10, gear: 3, states: {engine.speed: 140}}
inputs: {rack: {sine: {amplitude: 0.02, frequency: 1}}, accelerator: 0.3}
END
for method in 2 3; do
    for keep in 1 7; do
        scene 0.4 @ "integrator: ros$method" "keep_jacobian: $keep" >car.scene
        cat waves >>car.scene
        [ -e car.csv ] || reference "$models/hmmwv.veh" car.scene car.csv
        order "a vehicle, ros$method, kept $keep steps" "$models/hmmwv.veh" car.csv 32 $((method - 1)).85 $method.3 car.scene
    done
    scene 0.4 @ "integrator: ros$method" >complete.scene
    cat steering >>complete.scene
    [ -e complete.csv ] || reference "$models/hmmwv_vehicle.veh" complete.scene complete.csv
    order "tires and powertrain, ros$method" "$models/hmmwv_vehicle.veh" complete.csv 32 $((method - 1)).85 $method.3 complete.scene
done
for keep in 1 7; do
    scene 0.4 @ 'integrator: imex' "keep_jacobian: $keep" >imex.scene
    cat waves >>imex.scene
    order "a vehicle, imex, kept $keep steps" "$models/hmmwv.veh" car.csv 32 1.85 2.3 imex.scene
done
scene 0.4 @ 'integrator: imex' >imex.scene
cat steering >>imex.scene
order 'tires and powertrain, imex' "$models/hmmwv_vehicle.veh" complete.csv 32 1.85 2.3 imex.scene
for keep in 2 7 1000; do # the last one: all
    scene 0.4 @ 'integrator: exp3' "keep_jacobian: $keep" >exp3.scene
    cat waves >>exp3.scene
    order "a vehicle, exp3, kept $keep steps" "$models/hmmwv.veh" car.csv 12 2.85 3.3 exp3.scene
done
# with tires its error is that of a bend of the engine's table, as rk4's is: a tenth of that of ros3
for method in ros3 exp3; do
    sed "s/@/0.00125/; s/^integrator: .*/integrator: $method/" complete.scene >tenth.scene
    run -q "$models/hmmwv_vehicle.veh" tenth.scene -o "$method.csv"
done
off=$(apart exp3.csv complete.csv)
check "tires and powertrain, exp3: $off, ros3: $(apart ros3.csv complete.csv)" within "$(awk "BEGIN { print 10 * $off }")" "$(apart ros3.csv complete.csv)"
# the hatchback on its bushings, let go in a crosswind: its place after a second has no more error by exp3 at 1 ms than
# by ab3 at a quarter of it, but for what bends of tables within steps do by chance
for how in 'rk4 0.00003125' 'ab3 0.00025' 'exp3 0.001'; do
    scene 1 "${how#* }" "integrator: ${how% *}" 'inputs: {crosswind: 20}' 'outputs: [body]' >wind.scene
    "$gicrun" -q "$models/hatchback.veh" wind.scene -o "wind_${how% *}.csv" 2>err
done
for method in ab3 exp3; do tail -n 1 "wind_$method.csv" | cut -d, -f1-4 >"end_$method.csv"; done
tail -n 1 wind_rk4.csv | cut -d, -f1-4 >end_rk4.csv
by_ab3=$(apart end_ab3.csv end_rk4.csv)
by_exp3=$(apart end_exp3.csv end_rk4.csv)
check "hatchback, place by exp3 at 1 ms: $by_exp3, by ab3 at 0.25 ms: $by_ab3" within "$by_exp3" "$(awk "BEGIN { print 1.5 * $by_ab3 }")"
# as RK4 in the limit
for how in 'rk4 0.0001' 'ros3 0.0001'; do
    sed "s/@/${how#* }/; s/^integrator.*/integrator: ${how% *}/" car.scene | sed '/^keep/d' >limit.scene
    "$gicrun" -q "$models/hmmwv.veh" limit.scene -o "${how% *}.csv" 2>err
done
off=$(apart rk4.csv ros3.csv)
check "ros3 is rk4 at short steps: $off" within "$off" 3e-7

# wheels that leave the ground and land, in parts of steps
scene 1.5 0.0025 'integrator: ros3' 'locate: true' 'outputs: [chassis]' >jump.scene
rest_of "$models/scenes/tires_jump.scene" >>jump.scene
sed '/^locate/d' jump.scene >variable.scene
reference "$models/hmmwv_tires.veh" variable.scene jump.csv
run "$models/hmmwv_tires.veh" jump.scene -o own.csv
check 'contacts located by implicit steps' says 'contacts located'
off=$(apart own.csv jump.csv)
check "a jump: $off" within "$off" 5e-3
run --integrator imex "$models/hmmwv_tires.veh" jump.scene -o own.csv
check 'contacts located by imex' says 'contacts located'
off=$(apart own.csv jump.csv)
check "a jump, imex: $off" within "$off" 2e-2
run --integrator exp3 "$models/hmmwv_tires.veh" jump.scene -o own.csv
check 'contacts located by exp3' says 'contacts located'
off=$(apart own.csv jump.csv)
check "a jump, exp3: $off" within "$off" 5e-3
# sampled controllers: parts of steps
"$gicrun" -q "$models/controllers/skyhook.veh" "$models/controllers/skyhook.scene" -o rk4.csv --integrator rk4 2>err
"$gicrun" -q "$models/controllers/skyhook.veh" "$models/controllers/skyhook.scene" -o ros3.csv --integrator ros3 2>err
off=$(apart rk4.csv ros3.csv)
check "controllers: ros3 against rk4: $off" within "$off" 2e-3
"$gicrun" -q "$models/controllers/skyhook.veh" "$models/controllers/skyhook.scene" -o exp3.csv --integrator exp3 2>err
off=$(apart rk4.csv exp3.csv)
check "controllers: exp3 against rk4: $off" within "$off" 2e-3
for step in 0.001 0.0005; do
    sed "s/^step: .*/step: $step/" "$models/controllers/skyhook.scene" >samples.scene
    "$gicrun" -q "$models/controllers/skyhook.veh" samples.scene -o imex.csv --integrator imex 2>err
    apart rk4.csv imex.csv >off$step
done
by=$(awk -v a="$(cat off0.001)" -v b="$(cat off0.0005)" 'BEGIN { print (b > 0 ? a / b : 0) }')
check "controllers: imex against rk4: $(cat off0.001), with half the step $(cat off0.0005)" within 3.5 "$by"

# ---- parked on a slope at 10 ms, without creep
for method in ros2 ros3 imex exp3; do
    scene 20 0.01 "integrator: $method" 'outputs: [chassis]' >park.scene
    rest_of "$models/scenes/tires_park.scene" >>park.scene
    run -q "$models/hmmwv_tires.veh" park.scene -o park.csv
    creep=$(awk -F, 'NR > 6 { if (NR == 7 || $2 < low) low = $2; if (NR == 7 || $2 > high) high = $2 } END { print high - low }' park.csv)
    check "parked for 10 s, $method: ${creep:-no run} m" within "${creep:-1}" 1e-7
done

# ---- a pendulum keeps its energy but for the error of the method, over 1000 s
for method in 2 3; do
    for step in 0.01 0.005; do
        scene 1000 $step "integrator: ros$method" 'outputs: [energy]' 'initial: {coordinates: {angle: 0.5}}' >long.scene
        run -q "$models/pendulum.veh" long.scene -o long.csv
        awk -F, 'NR == 2 { e = $2 + $3 } { d = $2 + $3 - e } END { print d < 0 ? -d : d }' long.csv >drift$step
    done
    by=$(awk -v a="$(cat drift0.01)" -v b="$(cat drift0.005)" 'BEGIN { print a / b }')
    check "energy of a long run, ros$method: $(cat drift0.01) and $(cat drift0.005) J" within $((method * 2)) "$by"
done

# ---- the same bits: compilers, code that changes on the way, twice
sed 's/@/0.001/' complete.scene >bits.scene
for engine in tcc auto 'cc --cc gcc' 'cc --cc clang'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" -q --engine $engine "$models/hmmwv_vehicle.veh" bits.scene -o bits.csv 2>err
    [ -e first.csv ] || mv bits.csv first.csv
    [ -e bits.csv ] || continue
    check "the bits of $engine" cmp -s bits.csv first.csv
done

# ---- what is refused: one message, one remedy, no results
# refused MESSAGE REMEDY OPTION... MODEL SCENE
refused() {
    wanted=$1
    remedy=$2
    shift 2
    rm -f none.csv
    run "$@"
    { [ "$status" -ne 0 ] && says "$wanted" && says "$remedy" && [ ! -e none.csv ] && [ "$(grep -c error: err)" -le 1 ]; }
    verdict $? "refused: $wanted"
}
scene 1 0.01 'integrator: ab3' 'keep_jacobian: 4' >bad.scene
refused 'ab3 needs no Jacobian' 'ros2' "$models/pendulum.veh" bad.scene -o none.csv
scene 1 0.01 'integrator: ros2' 'keep_jacobian: 0' >bad.scene
refused 'keep_jacobian must be a whole number from 1 to 1000' 'for example 4' "$models/pendulum.veh" bad.scene -o none.csv
scene 1 0.01 'integrator: exp3' 'keep_jacobian: 1' >bad.scene
refused 'exp3 has no new Jacobian for each step' 'write 2 or more' "$models/pendulum.veh" bad.scene -o none.csv
scene 1 0.01 'integrator: exp3' 'keep_jacobian: 16' 'spread_jacobian: true' >bad.scene
refused 'spread_jacobian is for implicit steps by these' 'imex' "$models/pendulum.veh" bad.scene -o none.csv
scene 1 0.01 'integrator: ros3' >good.scene
for engine in tape gic gcp1; do
    refused "the engine '$engine' does not take implicit steps (ros3) yet" 'take `--engine tcc` or `cc`' --engine $engine "$models/pendulum.veh" good.scene -o none.csv
done
refused 'a page of --drive does not take implicit steps' 'rk4' --drive none.csv.html "$models/hmmwv_vehicle.veh" good.scene
scene 1 0.01 'integrator: ros4' >bad.scene
refused "there is no integrator 'ros4'" 'ros2, ros3' "$models/pendulum.veh" bad.scene -o none.csv
# code and units of a scene: neither another integrator than the scene's, nor one that has not been chosen
for integrator in ros2 ros3 exp3 auto; do
    scene 1 0.01 "integrator: $integrator" >good.scene
    wanted="does not take implicit steps ($integrator) yet"
    [ $integrator != auto ] || wanted='does not choose an integrator (auto) yet'
    for way in '-o none.c' '--fmu 3 -o none.fmu' '--report none.html'; do
        case "$integrator $way" in [re]*--fmu*) continue ;; esac # test_fmu_implicit.sh
        # shellcheck disable=SC2086  # options
        "$gicgen" --scene good.scene $way "$models/hmmwv.veh" >out 2>err
        { [ $? -eq 1 ] && grep -q "^good.scene:.*error: .*$wanted" err && grep -q 'remedy: ' err && [ -z "$(ls none.* 2>/dev/null)" ]; }
        verdict $? "gicgen --scene $way with $integrator is refused"
    done
done
for way in '--batch 4' "--scene $models/scenes/paper_run.scene" --sequence; do
    # shellcheck disable=SC2086  # options
    "$gicgen" --implicit $way "$models/hmmwv.veh" -o none.c >out 2>err
    { [ $? -eq 2 ] && grep -q 'without --batch and --scene' err && [ ! -e none.c ]; }
    verdict $? "--implicit $way is refused"
done

"$gicgen" --exponential "$models/hmmwv.veh" -o none.c >out 2>err
{ [ $? -eq 2 ] && grep -q 'exponential goes with --implicit' err && [ ! -e none.c ]; }
verdict $? '--exponential without --implicit is refused'

# ---- embedded: both number types, other compilers, no heap
for name in hmmwv_vehicle pendulum; do "$gicgen" --implicit --exponential "$models/$name.veh" -o $name.c || exit 1; done
cp "$root"/runtime/gic_runtime.[ch] .
cat >drive.c <<'END'
#include "hmmwv_vehicle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static hmmwv_vehicle car, copy;

/* a second of braking, with a copy on the way */
int main(void)
{
    static const gic_method methods[4] = {GIC_ROS2, GIC_ROS3, GIC_IMEX, GIC_EXP3};
    int i, k;
    for (i = 0; i < 4; ++i) {
        const gic_method method = methods[i];
        if (hmmwv_vehicle_setup(&car) != GIC_OK)
            return 1;
        car.implicit.keep = 3;
        car.input[HMMWV_VEHICLE_INPUT_BRAKE] = (gic_real)0.3;
        for (k = 0; k < 100; ++k) {
            if (k == 50)
                hmmwv_vehicle_snapshot(&car, &copy);
            if (hmmwv_vehicle_step(&car, (gic_real)0.01, method) != GIC_OK)
                return printf("%s %s\n", hmmwv_vehicle_status_text(car.head.status), hmmwv_vehicle_status_state(&car));
        }
        for (k = 50; k < 100; ++k)
            if (hmmwv_vehicle_step(&copy, (gic_real)0.01, method) != GIC_OK)
                return 3;
        if (memcmp(car.state, copy.state, sizeof car.state) != 0 || car.implicit.jacobian_count != 34)
            return printf("%d Jacobians\n", (int)car.implicit.jacobian_count);
        printf("%.9g ", (double)car.state[HMMWV_VEHICLE_STATE_R_Z]);
    }
    return 0;
}
END
# without the functions of --derivatives there is less code, and the same bits
mkdir -p both && "$gicgen" --implicit --exponential --derivatives "$models/hmmwv_vehicle.veh" -o both/hmmwv_vehicle.c &&
    sed -e 's/%.9g/%a/' drive.c >bits.c && ! grep -q 'hmmwv_vehicle_tangent\|hmmwv_vehicle_jacobian(' hmmwv_vehicle.c &&
    grep -q 'int hmmwv_vehicle_jacobian(' both/hmmwv_vehicle.c
verdict $? '--implicit by itself has no functions for derivatives'
for way in . both; do
    gcc -std=c99 -w -I"$way" -I. bits.c "$way"/hmmwv_vehicle.c gic_runtime.c -o bits -lm >said 2>&1 && ./bits >"$way/said.bits" 2>&1
done
[ -s both/said.bits ] && cmp said.bits both/said.bits >said 2>&1
verdict $? "the same bits with --derivatives and without: $(cat both/said.bits)"
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror'
while read -r how; do
    # shellcheck disable=SC2086  # lists of words
    { $how $warnings -I. -c pendulum.c -o /dev/null && $how $warnings -I. drive.c hmmwv_vehicle.c gic_runtime.c -o drive -lm && ./drive; } >said 2>&1
    verdict $? "$how: $(tail -n 1 said)"
done <<'END'
gcc -std=c99
gcc -std=c99 -DGIC_FLOAT -Wdouble-promotion
gcc -std=c99 -O2 -ffast-math
g++ -std=c++11 -x c++
clang -std=c99
END

# no free coordinate, or no coordinate: nothing is unknown, and C has no empty tables
cat >driven.veh <<'END'
gicgen: 1
model: driven
base: ground
bodies: {m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {rail: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], driven: true}}
END
sed 's/prismatic/fixed/; s/, axis: .*/}}/; /^coordinates/d' driven.veh >still.veh
for name in driven still; do
    for how in '' --derivatives; do
        # shellcheck disable=SC2086  # lists of words
        "$gicgen" --implicit $how $name.veh -o none.c >said 2>&1 && gcc -std=c99 $warnings -I. -c none.c -o /dev/null >>said 2>&1
        verdict $? "$name, --implicit $how: $(head -1 said)"
    done
done

# (W - reach A) u = b multiplied out, W with the mass matrix in rows of velocities, with all states of the Jacobian, at states of a run and reaches up to 0.1 s
cat >residual.c <<'END'
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include NAME_H

static NAME car;
int main(void)
{
    const gic_implicit *how = MODEL.implicit;
    const int n = MODEL.slow_count + MODEL.fast_count;
    double *jacobian = calloc((size_t)(n * how->columns + how->mass_count + n * n + 3 * n), sizeof *jacobian), worst = 0;
    double *mass = jacobian + n * how->columns, *factor = mass + how->mass_count, *b = factor + n * n, *u = b + n, *state = u + n;
    int i, k, moment, r, counted = 0;
    if (MODEL.setup(&car) != GIC_OK)
        return 1;
    for (moment = 0; moment < 40; ++moment) {
        for (i = 0; i < n; ++i)
            state[i] = ((double *)(void *)((char *)&car + MODEL.state_offset))[i];
        if (how->jacobian(&car, gic_time(&car), state, jacobian) != GIC_OK)
            return 2;
        for (r = -5; r <= -1; ++r) {
            const double reach = pow(10, r);
            double size = 0, off = 0;
            if (!how->factorize(jacobian, reach, factor))
                continue;
            for (i = 0; i < n; ++i)
                b[i] = sin(3 * i + moment);
            how->solve(jacobian, reach, factor, b, u);
            for (i = 0; i < n; ++i) {
                double sum = u[i] - b[i], terms = fabs(u[i]) + fabs(b[i]);
                for (k = 0; k < how->mass_count; ++k)
                    if (how->mass_row[k] == i && how->mass_column[k] == i)
                        sum = -b[i], terms = fabs(b[i]);
                for (k = 0; k < how->mass_count; ++k)
                    if (how->mass_row[k] == i) {
                        sum += mass[k] * u[how->mass_column[k]];
                        terms += fabs(mass[k] * u[how->mass_column[k]]);
                    }
                for (k = 0; k < n; ++k) {
                    sum -= reach * jacobian[how->columns * i + k] * u[k];
                    terms += fabs(reach * jacobian[how->columns * i + k] * u[k]);
                }
                off = fabs(sum) > off ? fabs(sum) : off;
                size = terms > size ? terms : size;
            }
            worst = off / size > worst ? off / size : worst;
            ++counted;
        }
        if (gic_step(&MODEL, &car, 1e-4, GIC_ROS3) != GIC_OK)
            return 3;
    }
    printf("%d systems, %.2g\n", counted, worst);
    return !(counted == 200 && worst < 1e-12);
}
END
"$gicgen" --implicit "$models/formula_student.veh" -o formula_student.c && "$gicgen" --implicit "$root/tests/data/laws/bushing.veh" -o mounts.c &&
    "$gicgen" --implicit "$models/andrews.veh" -o andrews.c
for name in hmmwv_vehicle formula_student mounts andrews pendulum; do
    gcc -std=c99 -w -I. "-DNAME_H=\"$name.h\"" -DNAME=$name -DMODEL=${name}_model residual.c $name.c gic_runtime.c -o residual -lm >said 2>&1 && ./residual >said 2>&1
    verdict $? "$name: solutions multiplied out: $(tail -n 1 said)"
done
# without loads, and at rest, nothing is left out of the derivatives of forces: they are the mass matrix times the exact
# Jacobian, which shares neither with them. The base turned by nothing, thirds, a quarter turn and anyhow.
cat >rest.veh <<'END'
gicgen: 1
model: rest
gravity: [0, 0, 0]
base: hull
bodies:
  hull: {mass: 900, com: [0.1, 0.02, 0.3], inertia: [300, 900, 1000]}
  frame: {mass: 20, com: [1, 0, 0.2], inertia: [1.2, 0.8, 1.9]}
  arm: {mass: 4, com: [1.1, 0.4, 0.2], inertia: [0.1, 0.05, 0.1], position: [1, 0.2, 0.2]}
  rod: {mass: 7, com: [-1, 0.3, 0.2], inertia: [0.3, 0.2, 0.1], position: [-1, 0, 0.2]}
joints:
  hinge: {type: revolute, bodies: [frame, arm], point: [1, 0.2, 0.2], axis: [1, 0.2, 0]}
  pin: {type: revolute, bodies: [hull, rod], point: [-1, 0, 0.2], axis: [0.6, 0.8, 0]}
coordinates:
  x: {type: translation, bodies: [hull, frame], axis: [1, 0, 0], range: [-0.1, 0.1]}
  y: {type: translation, bodies: [hull, frame], axis: [0, 1, 0], range: [-0.1, 0.1]}
  z: {type: translation, bodies: [hull, frame], axis: [0, 0, 1], range: [-0.1, 0.1]}
  a: {type: angle, bodies: [hull, frame], axis: [1, 0, 0], range: [-0.3, 0.3]}
  b: {type: angle, bodies: [hull, frame], axis: [0, 1, 0], range: [-0.3, 0.3]}
  c: {type: angle, bodies: [hull, frame], axis: [0, 0, 1], range: [-0.3, 0.3]}
  arm: {type: angle, bodies: [frame, arm], axis: [1, 0.2, 0], range: [-0.5, 0.5]}
  rod: {type: angle, bodies: [hull, rod], axis: [0.6, 0.8, 0], range: [-0.5, 0.5]}
states:
  lag: {rate: "500 * (rate(arm) - lag) + 30 * rod"}
forces:
  front: {type: bushing, bodies: [hull, frame], point: [1.3, 0.3, 0.2], stiffness: [3e6, 2e6, 1e6, 300, 200, 100], damping: [900, 600, 300, 1, 2, 3]}
  back: {type: bushing, bodies: [hull, frame], point: [0.7, -0.3, 0.2], stiffness: [2e6, 5e6, 1e6, 0, 0, 0], damping: [100, 600, 300, 0, 0, 0]}
  spring: {type: spring_damper, bodies: [hull, arm], points: [[1, 0.5, 0.7], [1, 0.5, 0.2]], stiffness: 2e5, damping: 900, free: 0.5}
  about: {type: spring_damper, bodies: [frame, rod], axis: [0, 1, 0], stiffness: 700, damping: 3}
  along: {type: force, coordinate: rod, value: "-400 * rod - 2 * rate(rod) + 10 * lag"}
  air: {type: load, body: arm, force: [0, "-30 * rate(rod)", 0], torque: [0, 0, 5 * lag], point: [1, 0.5, 0.2]}
outputs: {hull: {type: position, body: hull, point: [0, 0, 0]}}
END
cat >rest_main.c <<'END'
#include "rest.h"
#include <math.h>
#include <stdio.h>

enum { ROOM = 14 * 14, COLUMNS = REST_JACOBIAN_COLUMNS };
static rest car;
static rest_direction along;
static double exact[REST_JACOBIAN_ROWS * COLUMNS], own[REST_STATES * COLUMNS + ROOM];

/* W times the exact derivative of a rate, and the sum of its magnitudes */
static double weighed(const gic_implicit *how, int row, int column, double *size)
{
    const double *mass = own + REST_STATES * COLUMNS;
    double sum = 0;
    int k, any = 0;
    *size = 1;
    for (k = 0; k < how->mass_count; ++k)
        if (how->mass_row[k] == row) {
            const double part = mass[k] * exact[COLUMNS * how->mass_column[k] + column];
            sum += part, *size += fabs(part), any = 1;
        }
    return any ? sum : exact[COLUMNS * row + column];
}

int main(void)
{
    static const double turn[4][4] = {{1, 0, 0, 0}, {0.5, 0.5, 0.5, 0.5}, {0.70710678118654757, 0, 0, 0.70710678118654757}, {0.1, -0.7, 0.5, 0.5}};
    const gic_implicit *how = rest_model.implicit;
    double worst = 0, size;
    int t, i, k;
    for (t = 0; t < 4; ++t) {
        if (rest_setup(&car) != GIC_OK)
            return 1;
        for (i = 0; i < 4; ++i)
            car.state[3 + i] = turn[t][i];
        if (rest_jacobian(&car, 0, car.state, &along, exact) != GIC_OK || rest_rhs(&car, 0, car.state, car.rate) != GIC_OK ||
            how->jacobian(&car, 0, car.state, own) != GIC_OK)
            return 2;
        for (i = 0; i < REST_STATES; ++i)
            for (k = 0; k < REST_STATES; ++k) {
                const double off = fabs(weighed(how, i, k, &size) - own[COLUMNS * i + k]) / size;
                worst = off > worst ? off : worst;
            }
    }
    printf("%d masses, %.2g\n", (int)how->mass_count, worst);
    return !(how->mass_count > 0 && worst < 1e-8);
}
END
"$gicgen" --implicit --derivatives rest.veh -o rest.c && gcc -std=c99 -w -I. rest_main.c rest.c gic_runtime.c -o rest -lm >said 2>&1 && ./rest >said 2>&1
verdict $? "derivatives of forces: $(tail -n 1 said)"

check 'no heap' sh -c '! nm drive | grep -q " U .*\(malloc\|calloc\|realloc\)"'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
