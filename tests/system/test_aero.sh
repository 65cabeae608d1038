#!/bin/sh
# SPDX-License-Identifier: MIT
# test_aero.sh GICGEN GICRUN: forces of the air (FORMAT.md section 7.2). Coasting and falling against closed solutions;
# values of the law worked out here; rest, and a wind as fast as the car: nothing, and nothing in linear models; those in
# a wind in closed form; runs of every engine and way of generating against the engine gic; images in the mirror against
# both sides written out; mistakes. Accelerations against quad precision are in test_accelerations, random mechanisms with
# air in test_random_mechanisms.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

# ---- coasting: m v' = -c v^2, c = 1.2 * 2.5 * 0.4 / 2 = 0.6, so v = v0 / (1 + c v0 t / m), whichever way the car points
cat >coast.veh <<'END'
gicgen: 1
model: coast
gravity: [0, 0, 0]
base: car
bodies: {car: {mass: 1000, com: [0, 0, 0], inertia: [1, 2, 3]}}
inputs: {wind: {unit: m/s}}
forces: {drag: {type: aero, body: car, area: 2.5, density: 1.2, drag: 0.4, wind: [wind, 0, 0]}}
outputs:
  v: {type: velocity, body: car}
  a: {type: acceleration, body: car}
END
# coast SPEED WIND TURN
coast() {
    cat >coast.scene <<END
gicscene: 1
duration: 10
step: 0.01
output_step: 1
integrator: rk4
initial: {speed: $1, angular_velocity: $3}
inputs: {wind: $2}
END
    "$gicrun" -q coast.veh coast.scene -o coast.csv || echo "FAIL: it does not run"
}
# solved SPEED WIND: RK4's error at these steps is below (c v h / m)^4 = 1e-15 of the speed
solved() {
    column v.x coast.csv | awk -v v="$1" -v wind="$2" '
        { t = NR - 1; u = v - wind; right = wind + u / (1 + 0.6 * (u < 0 ? -u : u) * t / 1000)
          d = $1 - right; if (d < 0) d = -d; if (!(d <= 1e-12 * (v < 0 ? -v : v + 1))) bad = 1 }
        END { exit bad || NR != 11 }'
}
for way in '30 0 [0, 0, 0]' '25 -5 [0, 0, 0]' '10 40 [0, 0, 0]' '30 10 [1, 2, 3]' '-20 0 [0, 0, 0.5]'; do
    speed=${way%% *}
    rest=${way#* }
    coast "$speed" "${rest%% *}" "${rest#* }"
    check "coasting at $way" solved "$speed" "${rest%% *}"
done
coast 20 20 '[0, 0, 0]'
[ "$(column v.x coast.csv | sort -u)" = 20 ] && [ "$(column a.x coast.csv | sort -u)" = 0 ]
verdict $? 'carried by the wind'
coast 0 0 '[0, 0, 0]'
[ "$(column v.x coast.csv | sort -u)" = 0 ] && ! grep -q nan coast.csv
verdict $? 'at rest'

# ---- falling, turning: v = -w tanh(g t / w), w = sqrt(m g / c)
sed 's/^gravity: .*/gravity: [0, 0, -10]/; s/mass: 1000/mass: 80/' coast.veh >fall.veh
sed 's/^duration: .*/duration: 30/; s/^output_step: .*/output_step: 3/; s/speed: [-0-9]*/speed: 0/; s/angular_velocity: .*}/angular_velocity: [1, 2, 0.5]}/' \
    coast.scene >fall.scene
"$gicrun" -q fall.veh fall.scene -o fall.csv
column v.z fall.csv | awk '{ t = 3 * (NR - 1); w = sqrt(800 / 0.6); e = exp(-20 * t / w); right = -w * (1 - e) / (1 + e)
    d = $1 - right; if (d < 0) d = -d; if (!(d <= 1e-10 * w)) bad = 1 } END { exit bad || NR != 11 }'
verdict $? 'falling'

# ---- the law itself, at motions along axes, across and backward, and at none
cat >law.veh <<'END'
gicgen: 1
model: law
gravity: [0, 0, 0]
base: car
bodies: {car: {mass: 2, com: [0, 0, 0], inertia: [4, 5, 6]}}
forces:
  air: {type: aero, body: car, area: 2, length: 3, density: 1, drag: 0.5 + 0.1 * airspeed, wind: [1, 2, 3],
        force: [0.1, "0.2 * sideslip", 0.3 * incidence], moment: [0.1 * incidence, 0.2, "0.3 * sideslip"]}
outputs:
  a: {type: acceleration, body: car}
END
awk 'BEGIN { print "r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z"
    for (x = -2; x <= 2; ++x) for (y = -1; y <= 1; ++y) for (z = -1; z <= 1; ++z)
        printf "0,0,0,1,0,0,0,%d,%d,%d,0,0,0\n", 1 + x, 2 + y, 3 + z }' >states
"$gicrun" --eval states law.veh -o law.csv
paste -d, states law.csv | awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) { name = $i; sub(/ .*/, "", name); at[name] = i } next }
    function near(got, want) { d = got - want; if (!(got ~ /^-?[0-9]/ && d * d <= 1e-28 * (1 + want * want))) { bad = 1; print NR, got, want } }
    { u = $8 - 1; v = $9 - 2; w = $10 - 3; V = sqrt(u * u + v * v + w * w)
      slip = u || v ? atan2(v, u) : 0; rise = V ? atan2(-w, sqrt(u * u + v * v)) : 0; cd = 0.5 + 0.1 * V
      near($at["a.x"], (0.1 * V * V - cd * V * u) / 2)
      near($at["a.y"], (0.2 * slip * V * V - cd * V * v) / 2)
      near($at["a.z"], (0.3 * rise * V * V - cd * V * w) / 2) }
    END { exit bad || NR != 46 }' >said
verdict $? "values of the law"

# ---- linear models: a sail on a spring in a wind w rests at c w^2 / k; its damping is 2 c w, what the wind does as much
cat >sail.veh <<'END'
gicgen: 1
model: sail
gravity: [0, 0, 0]
base: ground
inputs: {wind: {unit: m/s, default: 0}}
bodies: {sail: {mass: 4, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {rail: {type: prismatic, bodies: [ground, sail], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, sail], axis: [1, 0, 0], range: [-1, 2]}}
forces:
  hold: {type: spring_damper, coordinate: x, stiffness: 100}
  air: {type: aero, body: sail, area: 2, density: 1, drag: 0.5, force: [0.1 * sideslip^2, 0, incidence], wind: [wind, 0, 0]}
END
cat >sail.py <<'END'
import sys
import numpy as np
d = np.load(sys.argv[1])
c, w = float(sys.argv[2]), float(sys.argv[3])
assert list(d["states"]) == ["x", "x.rate"], list(d["states"])
for name, wanted in [("z0", [c * w * w / 100, 0]), ("A", [[0, 1], [-25, -2 * c * w / 4]]), ("B", [[0], [2 * c * w / 4]])]:
    assert np.allclose(d[name], wanted, rtol=1e-12, atol=0 if w == 0 else 1e-13), (name, d[name], wanted)
END
"$gicrun" --linearize sail.veh -o sail.npz >out 2>err && /usr/bin/python3 -B sail.py sail.npz 0.5 0 >said 2>&1
verdict $? 'a linear model at rest'
# moving air comes from the front of a sail that stands: sideslip is half a turn then
sed 's/default: 0/default: 6/; s/0.1 \* sideslip^2/0.1/' sail.veh >blown.veh
"$gicrun" --linearize blown.veh -o blown.npz >out 2>err && /usr/bin/python3 -B sail.py blown.npz 0.6 6 >said 2>&1
verdict $? 'a linear model in a wind'
"$gicrun" --modes sail.veh >out 2>err && grep -q '0.7958   0.0000 ' out
verdict $? 'modes at rest'

# ---- runs against the engine gic
model=$root/tests/data/laws/aero.veh
cat >wings.scene <<'END'
gicscene: 1
duration: 1
step: 0.001
output_step: 0.1
integrator: rk4
initial: {speed: 30, angular_velocity: [0.1, 0.2, 1], rates: {flap_l: 0.5}}
inputs: {gust: {sine: {amplitude: 8, frequency: 1}}}
END
every_way 'both sides' 1e-10 "$model" wings.scene

# straight on, where code for the scene leaves one side out
sed 's/angular_velocity: .*}/position: [0, 0, 1]}/; s/gust: .*/gust: 0}/' wings.scene >straight.scene
some_ways 'straight on' 1e-10 "$model" straight.scene '' --general '--engine tape'

# the engines that integrate other coordinates have other errors of their steps: accelerations at states of a run
awk 'BEGIN { print "r.x,r.y,r.z,e0,e1,e2,e3,flap_l,flap_r,v.x,v.y,v.z,omega.x,omega.y,omega.z,flap_l.rate,flap_r.rate"
    for (k = 0; k < 9; ++k) printf "0,0,1,%g,%g,%g,%g,%g,%g,%g,%g,%g,%g,%g,%g,%g,0\n", k % 2 ? 1 : 0.6, 0, k % 2 ? 0 : 0.8, 0,
        0.1 * (k - 4), 0.25, k * 10 - 40, 5 - k, k % 3, 0, 0.5 * k, 1, 2 - k }' >flight
for engine in gic gcp1 gcp2; do
    "$gicrun" --engine $engine --eval flight "$model" -o $engine.csv
done
for engine in gcp1 gcp2; do
    off=$(apart $engine.csv gic.csv)
    check "accelerations of $engine against gic: ${off:-none}" within "${off:-1}" 1e-10
done

# ---- the mirror: sideslip and what lies across change their sign, the wind does not
cat >half.veh <<'END'
gicgen: 1
model: halves
base: chassis
inputs: {gust: {default: 4}}
bodies:
  chassis: {mass: 100, com: [0, 0, 0], inertia: [10, 10, 10]}
forces:
  wing_l: {type: aero, body: chassis, point: [0.5, 1, 0.2], area: 0.5, length: 0.3, drag: "0.1 + sideslip",
           force: [0.1, "0.2 + sideslip", 0.3 * incidence], moment: [0.1 + sideslip, 0.2, "0.3 * sideslip"], wind: [1, gust, 0]}
END
cat >whole.veh <<'END'
gicgen: 1
model: wholes
base: chassis
inputs: {gust: {default: 4}}
bodies:
  chassis: {mass: 100, com: [0, 0, 0], inertia: [10, 10, 10]}
forces:
  wing_l: {type: aero, body: chassis, point: [0.5, 1, 0.2], area: 0.5, length: 0.3, drag: "0.1 + sideslip",
           force: [0.1, "0.2 + sideslip", 0.3 * incidence], moment: [0.1 + sideslip, 0.2, "0.3 * sideslip"], wind: [1, gust, 0]}
  wing_r: {type: aero, body: chassis, point: [0.5, -1, 0.2], area: 0.5, length: 0.3, drag: "0.1 - sideslip",
           force: [0.1, "-0.2 + sideslip", 0.3 * incidence], moment: ["-0.1 + sideslip", 0.2, "0.3 * sideslip"], wind: [1, gust, 0]}
END
sed '/^inputs/d; s/rates: {.*}}/position: [0, 0, 1]}/' wings.scene >half.scene
"$gicrun" -q half.veh half.scene -o half.csv && "$gicrun" -q --engine gic whole.veh half.scene -o whole.csv &&
    off=$(apart half.csv whole.csv)
check "a mirror image against both sides written out: ${off:-no run}" within "${off:-1}" 1e-11

# a coefficient without a value at rest is no error of the generator: the run says that a result is not finite
printf 'gicgen: 1\nmodel: m\nbase: car\nbodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\n%s\n' \
    'forces: {air: {type: aero, body: car, area: 1, drag: 1 / airspeed}}' >still.veh
printf 'gicscene: 1\nduration: 0.1\nstep: 0.01\n' >still.scene
"$gicrun" -q still.veh still.scene -o still.csv 2>said
[ $? -eq 1 ] && grep -q 'not a finite number' said
verdict $? "a coefficient that has no value at rest"

# ---- mistakes
# refused PLACE MESSAGE REMEDY ELEMENT [MORE]: one message and no output
refused() {
    printf 'gicgen: 1\nmodel: m\nbase: car\nbodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\nforces: {air: {type: aero, %s}}\n%s\n' \
        "$4" "$5" >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "bad.veh:$1: error: $2" said &&
        grep -qF "  remedy: $3" said
    verdict $? "refused: $2"
}
refused 5:10 "force 'air' has no coefficient" 'add `drag: number`' 'body: car, area: 1'
refused 5:76 "force 'air' has coefficients of a moment and no length that they refer to" 'add `length: number`' 'body: car, area: 1, drag: 1,            moment: [1, 0, 0]'
refused 5:76 "force 'air' has a length and no coefficients of a moment" 'take it away' 'body: car, area: 1, drag: 1,            length: 2'
refused 5:10 "force 'air' (aero) lacks the key 'area'" 'add `area: ' 'body: car, drag: 1'
refused 5:45 "area of force 'air' must be greater than zero, not 0" 'write a positive number' 'body: car, area: 0, drag: 1'
refused 5:54 "drag of force 'air': 'sideslip' is a quantity of this element here, and the name of a signal" 'give the signal another name' \
    'body: car, area: 1, drag: sideslip' 'signals: {sideslip: 1}'
refused 5:55 "wind of force 'air': there is no 'airspeed'" 'names known here: ' 'body: car, area: 1, wind: [airspeed, 0, 0], drag: 1'
refused 6:37 "output 'f': force 'air' has components of force and moment, no single force" 'write its law as formulas under `signals`' 'body: car, area: 1, drag: 1' 'outputs: {f: {type: force, element: air}}'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
