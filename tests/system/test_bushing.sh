#!/bin/sh
# SPDX-License-Identifier: MIT
# test_bushing.sh GICGEN GICRUN GICSWEEP: bushings (FORMAT.md section 7.5). Frequencies, rest under load, large turns about
# an axis, damping and momenta in closed form; nothing at the design; energy at large angles, by the order of the integrator;
# turns of 3 rad and more; a matrix against elements of one axis each; tunable stiffness; runs of every engine and way of
# generating against the engine gic, a sweep in lanes, a batch; images in the mirror against both sides written out;
# mistakes. Accelerations against quad precision are in test_accelerations, random mechanisms in test_random_mechanisms.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicsweep=$(realpath "$3")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

# block LINE...: a block of 2 kg, held by what the lines say
block() {
    printf 'gicgen: 1\nmodel: block\ngravity: [0, 0, 0]\nbase: block\nbodies: {block: {mass: 2, com: [0, 0, 0], inertia: [4, 5, 6]}}\n'
    printf '%s\n' "$@"
}
# scene DURATION STEP LINE...
scene() {
    printf 'gicscene: 1\nduration: %s\nstep: %s\noutput_step: 0.1\nintegrator: rk4\n' "$1" "$2"
    shift 2
    printf '%s\n' "$@"
}
outputs='outputs: {at: {type: position, body: block}, turned: {type: orientation, body: block}, v: {type: velocity, body: block}, w: {type: angular_velocity, body: block}, e: {type: energy}}'

# ---- six frequencies: sqrt(k / m) and sqrt(k / I) of each axis
block 'forces: {hold: {type: bushing, bodies: [ground, block], point: [0, 0, 0], stiffness: [2, 8, 18, 64, 125, 216]}}' >six.veh
"$gicrun" --modes six.veh >out 2>err
for frequency in 0.1592 0.3183 0.4775 0.6366 0.7958 0.9549; do # 1 to 6 rad/s
    grep -q "$frequency   0.0000 " out
    verdict $? "a mode at $frequency Hz"
done
cat >six.py <<'END'
import sys
import numpy as np
d = np.load(sys.argv[1])
A, n = d["A"], 6
assert A.shape == (12, 12), A.shape
wanted = np.zeros((12, 12))
wanted[:6, 6:] = np.eye(6)
wanted[6:, :6] = -np.diag([1, 4, 9, 16, 25, 36])
wanted[6:, 6:] = -np.diag([0.5, 1, 1.5, 0.25, 0.2, 0.5])
assert np.allclose(A, wanted, rtol=1e-13, atol=1e-13), A - wanted
END
sed 's/stiffness/damping: [1, 2, 3, 1, 1, 3], stiffness/' six.veh >damped.veh
"$gicrun" --linearize damped.veh -o six.npz >out 2>err && /usr/bin/python3 -B six.py six.npz >said 2>&1
verdict $? 'a linear model at the design'
# ---- the design: nothing acts, and nothing is without a value
echo "$outputs" >>six.veh
scene 0.5 0.1 >rest.scene
"$gicrun" -q six.veh rest.scene -o rest.csv 2>err && ! grep -q 'nan\|inf' rest.csv && [ "$(tail -n +2 rest.csv | cut -d, -f2- | sort -u)" = 0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0 ]
verdict $? 'nothing moves from the design'

# ---- rest: a force (3, 4, 6) N and a torque k t n, as far as a turn t goes, about an axis across all three
# turn_of FILE: the rotation vector at its end
turn_of() {
    column turned.e0 "$1" | tail -n 1 | tr '\n' ' '
    for i in 1 2 3; do column turned.e$i "$1" | tail -n 1 | tr '\n' ' '; done
}
for turn in 0 1e-9 1e-3 0.2 0.25 0.26 1.5 2.9; do
    block 'forces:' "  hold: {type: bushing, bodies: [ground, block], point: [0, 0, 0], stiffness: [1, 2, 3, 7, 7, 7], damping: [3, 4, 5, 9, 9, 9]}" \
        "  load: {type: load, body: block, force: [3, 4, 6], torque: [\"7 * $turn / 3\", \"14 * $turn / 3\", \"14 * $turn / 3\"]}" "$outputs" >load.veh
    scene 0.1 0.1 'initial: {equilibrium: true}' >load.scene
    "$gicrun" -q load.veh load.scene -o load.csv 2>err && turn_of load.csv | awk -v t="$turn" '
        { s = sin(t / 2); right[1] = cos(t / 2); right[2] = s / 3; right[3] = right[4] = 2 * s / 3
          for (i = 1; i <= 4; ++i) { d = $i - right[i]; if (!(d * d <= 1e-18)) bad = 1 } } END { exit bad || NR != 1 }'
    verdict $? "rest at a turn of $turn: $(turn_of load.csv)"
    tail -n 1 load.csv | awk -F, '{ for (i = 2; i <= 4; ++i) { d = $i - (i == 4 ? 2 : i == 3 ? 2 : 3); if (!(d * d <= 1e-18)) exit 1 } }'
    verdict $? "displacement at a turn of $turn"
done
# a preload moves the block away, by as much as a load does
block 'forces: {hold: {type: bushing, bodies: [ground, block], point: [0, 0, 0], orientation: {axis: [0, 0, 1], angle: 1.5707963267948966}, stiffness: [1, 2, 4, 7, 7, 7], damping: [3, 4, 5, 9, 9, 9], force: [3, 4, 6]}}' "$outputs" >preload.veh
"$gicrun" -q preload.veh load.scene -o preload.csv 2>err
tail -n 1 preload.csv | awk -F, '{ d = $2 + 2; e = $3 - 3; f = $4 - 1.5; exit !(NF > 4 && d * d + e * e + f * f < 1e-18) }'
verdict $? "a preload along axes of its own: $(tail -n 1 preload.csv)"

# ---- turning about one axis: t = 2.5 cos(w t), a large angle that is still linear; with damping, a decay
block 'forces: {hold: {type: bushing, bodies: [ground, block], point: [0, 0, 0], stiffness: [1, 1, 1, 3, 5, 24]}}' "$outputs" >swing.veh
sed 's/stiffness/damping: [0, 0, 0, 0, 0, 12], stiffness/' swing.veh >creep.veh
scene 3 0.001 'initial: {orientation: {yaw: 2.5}}' >swing.scene
"$gicrun" -q swing.veh swing.scene -o swing.csv 2>err
column turned.e3 swing.csv | awk '{ t = 2.5 * cos(2 * 0.1 * (NR - 1)); d = $1 - sin(t / 2); if (!(d * d <= 1e-22)) bad = 1 } END { exit bad || NR != 31 }'
verdict $? 'a large swing about one axis'
"$gicrun" -q creep.veh swing.scene -o creep.csv 2>err
column turned.e3 creep.csv | awk '{ s = 0.1 * (NR - 1); q = sqrt(3); t = 2.5 * exp(-s) * (cos(q * s) + sin(q * s) / q); d = $1 - sin(t / 2); if (!(d * d <= 1e-22)) bad = 1 }
    END { exit bad || NR != 31 }'
verdict $? 'with damping'

# ---- two bodies that tumble on a bushing at large angles: energy by the integrator's order, momenta kept
cat >pair.veh <<'END'
gicgen: 1
model: pair
gravity: [0, 0, 0]
base: one
bodies:
  one: {mass: 3, com: [0, 0, 0], inertia: [1, 2, 2.5]}
  two: {mass: 2, com: [0.5, 0, 0], inertia: [0.5, 0.6, 0.9], orientation: {axis: [1, 0, 1], angle: 0.5}}
joints: {ball: {type: spherical, bodies: [one, two], point: [0.25, 0, 0]}}
coordinates:
  a: {type: angle, bodies: [one, two], axis: [1, 0, 0]}
  b: {type: angle, bodies: [one, two], axis: [0, 1, 0]}
  c: {type: angle, bodies: [one, two], axis: [0, 0, 1]}
forces:
  mount:
    {type: bushing, bodies: [one, two], point: [0.25, 0.1, 0], orientation: {axis: [0, 1, 0], angle: 0.4},
     stiffness: [[100], [20, 200], [0, 0, 50], [0, 5, 0, 3], [0, 0, 1, 1, 4], [2, 0, 0, 0, -1, 2]]}
outputs:
  v1: {type: velocity, body: one}
  v2: {type: velocity, body: two}
  p1: {type: position, body: one}
  p2: {type: position, body: two}
  q1: {type: orientation, body: one}
  q2: {type: orientation, body: two}
  w1: {type: angular_velocity, body: one, in: one}
  w2: {type: angular_velocity, body: two, in: two}
  e: {type: energy}
END
for step in 0.004 0.002; do
    scene 2 $step 'initial: {angular_velocity: [1, 2, 0.5], rates: {a: 2.5, b: 1.5, c: -2}}' >pair.scene
    "$gicrun" -q pair.veh pair.scene -o pair.csv 2>err
    column e.kinetic pair.csv >kinetic
    column e.potential pair.csv | paste -d' ' kinetic - | awk 'NR == 1 { first = $1 + $2 } { d = $1 + $2 - first; if (d < 0) d = -d; if (!(d <= most)) most = d; if ($2 > 1) ++strained }
        END { print most, strained }'
done >drifts
awk 'NR == 1 { a = $1; n = $2 } END { exit !(NR == 2 && n > 10 && a < 1e-5 && a / $1 > 12) }' drifts
verdict $? "energy, fourth order: $(tr '\n' ' ' <drifts)"
column e.power pair.csv | awk '{ if (!($1 * $1 <= 1e-24)) bad = 1 } END { exit bad }'
verdict $? 'nothing takes energy'
cat >momentum.py <<'END'
import csv
import sys
import numpy as np
rows = list(csv.reader(open(sys.argv[1])))
at = {name.split(" ")[0]: i for i, name in enumerate(rows[0])}
def vector(row, name, parts):
    return np.array([float(row[at[f"{name}.{p}"]]) for p in parts])
def turned(e, v):
    return v + 2 * np.cross(e[1:], np.cross(e[1:], v) + e[0] * v)
J = [np.diag([1, 2, 2.5]), np.diag([0.5, 0.6, 0.9])]
m = [3, 2]
first = None
for row in rows[1:]:
    p, L = np.zeros(3), np.zeros(3)
    for k in range(2):
        v = m[k] * vector(row, f"v{k + 1}", "xyz")
        q = vector(row, f"q{k + 1}", ["e0", "e1", "e2", "e3"])
        p += v
        L += np.cross(vector(row, f"p{k + 1}", "xyz"), v) + turned(q, J[k] @ vector(row, f"w{k + 1}", "xyz"))
    if first is None:
        first = p, L
    assert np.allclose(p, first[0], atol=1e-9) and np.allclose(L, first[1], atol=2e-7), (row[0], p - first[0], L - first[1])
END
/usr/bin/python3 -B momentum.py pair.csv >said 2>&1
verdict $? 'momentum and angular momentum'

# ---- along one axis it is a spring and damper of one axis
cat >slide.veh <<'END'
gicgen: 1
model: slide
base: ground
parameters: {k: {value: 40, tunable: true}, c: {value: 3, tunable: true}}
bodies: {b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: cylindrical, bodies: [ground, b], point: [0, 0, 0], axis: [0, 0, 1]}}
coordinates:
  z: {type: translation, bodies: [ground, b], axis: [0, 0, 1], range: [-2, 2]}
  t: {type: angle, bodies: [ground, b], axis: [0, 0, 1], range: [-2, 2]}
forces:
  rubber: {type: bushing, bodies: [ground, b], point: [0, 0, 0], stiffness: [1, 1, k, 1, 1, k / 4], damping: [0, 0, c, 0, 0, c / 3], force: [0, 0, soft(dz)], torque: [0, 0, "-2 * rz^3 - 0.5 * rz_rate"]}
tables: {soft: {x: [-1, 0, 1], y: [5, 0, -7], interpolation: cubic}}
END
sed '/^  rubber/c\
  along: {type: force, coordinate: z, value: "soft(z) - k * z - c * rate(z)"}\
  about: {type: force, coordinate: t, value: "-k / 4 * t - (c / 3 + 0.5) * rate(t) - 2 * t^3"}' slide.veh >axes.veh
scene 1 0.002 'initial: {coordinates: {t: 1}, rates: {z: 1}}' 'parameters: {k: 60, c: 1}' >slide.scene
"$gicrun" -q slide.veh slide.scene -o slide.csv 2>err && "$gicrun" -q axes.veh slide.scene -o axes.csv 2>err && off=$(apart slide.csv axes.csv)
check "against elements along and about one axis: ${off:-no run}" within "${off:-1}" 1e-12

# ---- 3 rad: cosine -0.99
awk 'BEGIN { print "r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z"
    for (k = 0; k < 6; ++k) { t = k == 0 ? 2.9999 : k == 1 ? 3.0002 : k == 2 ? 3.14159265358979 : k == 3 ? 3.2831 : k == 4 ? 3.2833 : 3.9
        printf "0,0,0,%.17g,%.17g,0,%.17g,0,0,0,0,0,0\n", cos(t / 2), 0.6 * sin(t / 2), 0.8 * sin(t / 2) } }' >turns
for engine in tape gic gcp1; do
    "$gicrun" --engine $engine --eval turns swing.veh -o turns.csv 2>err
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "status") k = i; next } { printf "%s ", $k ? "refused" : "good" }' turns.csv >said
    [ "$(cat said)" = 'good refused refused refused good good ' ]
    verdict $? "turns of about 3 rad and more, $engine: $(cat said)"
    sed 's/stiffness: \[1, 1, 1, 3, 5, 24\]/stiffness: [1, 1, 1, 0, 0, 0]/' swing.veh >loose.veh
    "$gicrun" --engine $engine --eval turns loose.veh -o turns.csv 2>err
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "status") k = i; next } $k != 0 || /nan/ { exit 1 }' turns.csv
    verdict $? "where no rotation counts, $engine"
done

# ---- runs against the engine gic
model=$root/tests/data/laws/bushing.veh
scene 1 0.001 'initial: {speed: 3, angular_velocity: [0.1, 0.2, 0.3], rates: {turn_l: 3, swing_l: 1, steer_r: -2}}' 'parameters: {kt: 200}' \
    'inputs: {push: {sine: {amplitude: 100, frequency: 1}}}' >mounts.scene
every_way 'two sides' 1e-10 "$model" mounts.scene
scene 1 0.001 'initial: {speed: 3, rates: {turn_l: 1, turn_r: 1}}' >straight.scene
some_ways 'straight on' 1e-10 "$model" straight.scene '' --general '--engine tape'
awk 'BEGIN { split("side turn_l swing_l steer_l turn_r swing_r steer_r", name)
    printf "r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z"; for (i = 1; i <= 7; ++i) printf ",%s,%s.rate", name[i], name[i]
    for (k = 0; k < 9; ++k) { printf "\n0,0,1,%g,%g,%g,%g,%g,%g,%g,%g,%g,%g", k % 2 ? 1 : 0.6, 0, k % 2 ? 0 : 0.8, 0, 0.1 * (k - 4), 0.25, 1, 5 - k, k % 3, 0
        for (i = 1; i <= 7; ++i) printf ",%g,%g", (i == 1 ? 0.01 : 0.1) * ((k * i) % 5 - 2), (k + i) % 4 - 2 }
    print "" }' >places
for engine in gic gcp1 gcp2; do
    "$gicrun" --engine $engine --eval places "$model" -o $engine.csv 2>err
done
for engine in gcp1 gcp2; do
    off=$(apart $engine.csv gic.csv)
    check "accelerations of $engine against gic: ${off:-none}" within "${off:-1}" 1e-9
done
for engine in auto gic; do
    "$gicsweep" -q "$model" mounts.scene --vary parameter/k=1e5:3e5:5 --engine $engine -o sweep.$engine 2>err
done
off=$(apart sweep.auto sweep.gic)
check "a sweep in lanes against gic: ${off:-no run}" within "${off:-1}" 1e-8
"$gicgen" "$model" -o mounts.c && "$gicgen" --batch 4 "$model" -o batch.c && "$gicgen" --derivatives "$model" -o tangent.c 2>said
verdict $? 'a batch, and derivatives'
for file in mounts batch tangent; do
    cc -std=c99 -Wall -Wextra -Werror -pedantic -fsyntax-only -I. -I"$root/runtime" $file.c 2>said
    verdict $? "no warnings: $file.c"
done

# ---- the mirror
half='hub_l: {type: bushing, bodies: [chassis, wheel_l], point: [0.1, 1, 0.2], orientation: {axis: [1, 0, 1], angle: 0.3},'
cat >half.veh <<END
gicgen: 1
model: halves
base: chassis
bodies:
  chassis: {mass: 100, com: [0, 0, 0], inertia: [10, 10, 10]}
  wheel_l: {mass: 10, com: [0, 1, 0], inertia: [1, 2, 1.5]}
joints: {ball_l: {type: spherical, bodies: [chassis, wheel_l], point: [0, 0.8, 0]}}
coordinates:
  a_l: {type: angle, bodies: [chassis, wheel_l], axis: [1, 0, 0]}
  b_l: {type: angle, bodies: [chassis, wheel_l], axis: [0, 1, 0]}
  c_l: {type: angle, bodies: [chassis, wheel_l], axis: [0, 0, 1]}
forces:
  $half stiffness: [[100], [20, 200], [5, -7, 50], [1, 5, 2, 30], [1, 2, 1, 1, 40], [2, 4, -3, 1, -1, 20]], damping: [[1], [0.5, 2], [0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1]],
    force: [dy * rx, 1 + rz_rate, dx - dy^2], torque: [5 + dy_rate, ry, rx - 2 * rz]}
END
{
    sed 's/^model: .*/model: wholes/' half.veh
    printf '  hub_r: {type: bushing, bodies: [chassis, wheel_r], point: [0.1, -1, 0.2], orientation: {axis: [-1, 0, -1], angle: 0.3},\n'
    printf '    stiffness: [[100], [-20, 200], [5, 7, 50], [-1, 5, -2, 30], [1, -2, 1, -1, 40], [-2, 4, 3, 1, 1, 20]], damping: [[1], [-0.5, 2], [0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1]],\n'
    printf '    force: ["dy * rx", "-1 + rz_rate", "dx - dy^2"], torque: ["-5 + dy_rate", ry, "rx - 2 * rz"]}\n'
} >whole.veh
scene 0.5 0.001 'initial: {angular_velocity: [0.1, 0.2, 0.3], rates: {a_l: 1, b_l: 2, c_l: 3, a_r: -1, b_r: 1}}' >half.scene
"$gicrun" -q half.veh half.scene -o half.csv 2>err && "$gicrun" -q --engine gic whole.veh half.scene -o whole.csv 2>err && off=$(apart half.csv whole.csv)
check "a mirror image against both sides written out: ${off:-no run}" within "${off:-1}" 1e-10

# ---- mistakes
# refused PLACE MESSAGE REMEDY ELEMENT [MORE]: one message and no output
refused() {
    printf 'gicgen: 1\nmodel: m\nbase: car\nbodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\nforces: {soft: {type: bushing, bodies: [ground, car], %s}}\n%s\n' \
        "$4" "$5" >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "bad.veh:$1: error: $2" said &&
        grep -qF "  remedy: $3" said
    verdict $? "refused: $2"
}
refused 5:10 "force 'soft' does nothing: it has no stiffness, damping, force or torque" 'add `stiffness: [x, y, z, about x' 'point: [0, 0, 0]'
refused 5:10 "force 'soft' (bushing) lacks the key 'point'" 'add `point: ' 'stiffness: [1, 1, 1, 1, 1, 1]'
refused 5:84 "stiffness of force 'soft' must be a list of 6 numbers, or of 6 rows of 1 to 6 numbers" 'write [x, y, z, about x' 'point: [0, 0, 0], stiffness: [1, 1, 1]'
refused 5:84 "stiffness of force 'soft' must be a list of 6 numbers, or of 6 rows of 1 to 6 numbers" 'write [x, y, z, about x' 'point: [0, 0, 0], stiffness: 5'
refused 5:88 "stiffness of force 'soft' must not be negative (-1)" 'write zero or a positive number' 'point: [0, 0, 0], stiffness: [1, -1, 1, 1, 1, 1]'
refused 5:82 "damping of force 'soft': the matrix is not positive semidefinite" 'check the signs' 'point: [0, 0, 0], damping: [[1], [2, 3], [0, 0, 1], [0, 0, 0, 1], [0, 0, 0, 0, 1], [0, 0, 0, 0, 0, 1]]'
refused 5:81 "force of force 'soft': 'rx' is a quantity of this element here, and the name of a signal" 'give the signal another name' \
    'point: [0, 0, 0], force: [rx, 0, 0]' 'signals: {rx: 1}'
refused 6:37 "output 'f': force 'soft' has components of force and moment, no single force" 'write its law as formulas under `signals`' \
    'point: [0, 0, 0], stiffness: [1, 1, 1, 1, 1, 1]' 'outputs: {f: {type: force, element: soft}}'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
