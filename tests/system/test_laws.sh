#!/bin/sh
# SPDX-License-Identifier: MIT
# test_laws.sh GICGEN GICRUN STATES REFERENCE AGREE: formulas, tables, parameters, loads and ports. Accelerations against the
# reference, which evaluates the dumped formulas in quad precision; tunable parameters and ports against the same numbers
# written into the model; a scene's parameters against a model with other values.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

cart=$root/tests/data/laws/cart.veh
"$gicgen" --dump-model "$cart" >dump && "$states" dump --count 50 --seed 4 -o states.csv &&
    "$reference" dump states.csv -o accelerations.csv && "$gicrun" --eval states.csv "$cart" -o results.csv &&
    "$agree" dump accelerations.csv results.csv
verdict $? "accelerations"

# the port's numbers as a load, the tunable parameters' other values baked in
sed 's/^model: .*/model: tuned/; s/value: 4000/value: 5000/; s/value: 25,/value: -8,/; s/, tunable: true//
    s/^ports:/  hook: {type: load, body: arm_r, point: [0.5, -0.6, 0.25], in: mast, force: [11, -7, 30], torque: [2, 0.5, -3]}\nports:/' \
    "$cart" >tuned.veh
"$gicgen" "$cart" -o cart.c && "$gicgen" tuned.veh -o tuned.c &&
    cc -std=c99 -O1 -ffp-contract=off -I. -I"$root/runtime" "$root/tests/data/laws/ports.c" cart.c tuned.c "$root/runtime/gic_runtime.c" \
        -lm -o ports && ./ports
verdict $? "ports and tunable parameters"

# a scene's parameter is the model's with that value: the same run to rounding
scene='gicscene: 1
duration: 0.5
step: 0.005
integrator: rk4
output_step: 0.5'
echo "$scene" >plain.scene
printf '%s\nparameters: {k: 5500}\n' "$scene" >tuned.scene
sed 's/value: 4000/value: 5500/' "$cart" >stiff.veh
"$gicrun" --quiet stiff.veh plain.scene -o plain.csv && "$gicrun" --quiet "$cart" tuned.scene -o tuned.csv &&
    [ "$(tail -n 1 plain.csv)" = "$(tail -n 1 tuned.csv)" ]
verdict $? "parameters of a scene"
"$gicrun" --quiet "$cart" plain.scene -o soft.csv && [ "$(tail -n 1 plain.csv)" != "$(tail -n 1 soft.csv)" ]
verdict $? "a parameter changes the run"
printf '%s\nparameters: {half: 1}\n' "$scene" >fixed.scene
"$gicrun" --quiet "$cart" fixed.scene -o fixed.csv 2>message
[ $? -eq 1 ] && grep -q "fixed.scene:6:14: error: parameter 'half' is fixed" message && [ ! -e fixed.csv ]
verdict $? "a parameter that is not tunable: $(cat message)"

# a minus in front of what is known when the model is read
cat >signs.veh <<'END'
gicgen: 1
model: signs
base: top
parameters: {a: 2, b: -a, c: -(a + 1), d: a - -b}
bodies:
  top: {mass: a, com: [b, c, d], inertia: [1, 1, 1]}
END
sed 's/b, c, d/-2, -3, 0/' signs.veh >plain.veh
"$gicgen" --dump-model signs.veh | grep -o '"position": [^]]*]' >signs && "$gicgen" --dump-model plain.veh | grep -o '"position": [^]]*]' >plain &&
    [ -s signs ] && cmp signs plain
verdict $? "signs: $(cat signs)"

# ---- numbers that are none --------------------------------------------------------------------------------------

# slider FORMULA: a force by it
slider() {
    cat >slider.veh <<END
gicgen: 1
model: slider
base: ground
parameters: {k: 7, a: 0, p: {value: 1, tunable: true}}
inputs: {i: {}}
bodies: {b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0]}}
forces: {f: {type: force, coordinate: x, value: "$1"}}
outputs: {f: {type: force, element: f}}
END
}
while read -r formula; do
    slider "$formula"
    "$gicgen" slider.veh -o slider.c 2>message
    [ $? -eq 1 ] && grep -q "^slider.veh:9:50: error: value of force 'f': .* whatever the state" message && [ ! -e slider.c ] &&
        grep -q '^  remedy: look for a division by zero or a root of a negative number' message
    verdict $? "no number, $formula: $(cat message)"
done <<'END'
x/a + 1
(-8)^(1/3)
x*sqrt(-1)
acos(2)
1/0
0/0
exp(1000)
1e300*1e300*x
if(x > 0, 1/a, 2)
min(x, 1/a)
p/a
x + 0*(1/a)
END
# value FORMULA NUMBER: passed over, all the same
while read -r formula value; do
    slider "$formula"
    "$gicgen" slider.veh -o slider.c 2>message && cc -std=c99 -Wall -Wextra -Werror -fsyntax-only -I. -I"$root/runtime" slider.c &&
        "$gicrun" --quiet slider.veh plain.scene -o plain.csv 2>message && [ "$(tail -n 1 plain.csv | cut -d, -f2)" = "$value" ]
    verdict $? "passed over, $formula: $(cat message) $(tail -n 1 plain.csv)"
    rm -f slider.c
done <<'END'
min(1/a,5)*k 35
if(a>0,x/a,3) 3
if(i>0,i/i,3) 3
min(1/i,5) 5
atan(1/a)/pi 0.5
END
# inputs and parameters that a scene makes constant: in code for it alone as in any other
printf '%s\nparameters: {p: 0}\n' "$scene" >zero.scene
for formula in x/i 1/i 'sqrt(i - 1)*x' 'i*x/i' i/i x/p 'atan(x/i)'; do
    slider "$formula"
    for how in '' --general '--engine tape' '--engine gic' '--engine cc'; do
        # shellcheck disable=SC2086  # a list of words
        "$gicrun" --quiet $how slider.veh zero.scene -o none.csv 2>message
        [ $? -eq 1 ] && grep -q "error: the run can't start: a result is not a finite number" message && [ ! -e none.csv ] &&
            grep -q '^  remedy: does a formula divide by zero there' message
        verdict $? "no number in a scene, $formula $how: $(cat message)"
    done
done

# ---- outputs that 0 switches off have a value where their other factor has none, and an angle of atan2 is half a turn at
# either sign of zero: at states of gicgen's own validation too
while read -r formula right; do
    cat >still.veh <<END
gicgen: 1
model: still
base: ground
parameters: {k: 0}
inputs: {x: {default: 1}}
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {rail: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {q: {type: translation, bodies: [ground, b], axis: [1, 0, 0]}}
signals: {s: "$formula"}
outputs: {s: {type: signal, signal: s}}
END
    for how in '' --general '--engine tape' '--engine gic'; do
        # shellcheck disable=SC2086  # a list of words
        "$gicrun" --quiet $how still.veh plain.scene -o still.csv 2>message &&
            awk -F, -v right="$right" 'NR > 1 { d = $2 < 0 && right > 3 ? -$2 - right : $2 - right; if (!(d * d <= 1e-30)) bad = 1 } END { exit bad || NR < 3 }' still.csv
        verdict $? "$formula is $right $how: $(cat message)"
    done
done <<END
k/x 0
k*log(x) 0
k*x^-1 0
exp(k*log(x)) 1
1/x-1/x 0
log(x)-log(x) 0
0/x 0
atan2(-0,-1) 3.141592653589793
atan2(-k,-1) 3.141592653589793
atan2(k*x,-x) 3.141592653589793
END

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
