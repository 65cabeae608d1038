#!/bin/sh
# SPDX-License-Identifier: MIT
# test_ipopt.sh GICRUN: runtime/examples/ipopt.c where Ipopt is there: quadratic problems in closed form, with a bound and a
# constraint; the least time through a double lane change (tests/vehicle/least_time.py).
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
solve=$(dirname "$gicrun")/gic_ipopt
if [ ! -x "$solve" ]; then
    echo "no Ipopt on this system: coinor-libipopt-dev is not installed"
    exit 0
fi

# a mass without friction, pushed so that x = a t^2 + b t^3
cat >"$work/mass.veh" <<'END'
gicgen: 1
model: mass
gravity: [0, 0, 0]
base: ground
parameters:
  a: {value: 0.5, tunable: true}
  b: {value: 0.25, tunable: true}
bodies:
  cart: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-10, 10]}
forces:
  push: {type: force, coordinate: x, value: "2 * a + 6 * b * time"}
outputs:
  cart: {type: position, body: cart}
END
printf 'gicscene: 1\nduration: 1\nstep: 0.1\nintegrator: rk4\n' >"$work/mass.scene"
value() { awk -F, -v name="$1" '$1 == name { print $3 }' "$work/found"; }
near() { awk -v a="$(value "$1")" -v b="$2" 'BEGIN { exit !(a != "" && (a - b) ^ 2 < 1e-8) }'; }
mass() { "$solve" "$work/mass.veh" "$work/mass.scene" "$@" >"$work/found" 2>"$work/err"; }
# x = a t^2 + b t^3: at the end a + b; least (a + b - 2)^2 + (a - 1)^2 is at a = b = 1
check 'a run' mass '(cart.x - 2)^2 + (a - 1)^2' parameter/a=-5:5 parameter/b=-5:5
check 'the least value' near '' 0
check 'a' near parameter/a 1
check 'b' near parameter/b 1
# with a + b = 3: a = 1, b = 2; with b at most 1.5: a = 1.5
check 'a run' mass '(a - 1)^2' 'cart.x=3:3' parameter/a=-5:5 parameter/b=-5:5
check 'a constraint' near parameter/b 2
check 'a run' mass '(a - 1)^2' 'cart.x=3:3' parameter/a=-5:5 parameter/b=-5:1.5
check 'a constraint and a bound' near parameter/a 1.5
check 'the formula is told' sh -c "grep -q '^\"cart.x\",0.7[45][0-9]*,[32][0-9.]*,3,3' '$work/found'"
# out of reach: a + b is 2 at most
out_of_reach() { ! mass '(a - 1)^2' 'cart.x=5:6' parameter/a=-1:1 parameter/b=-1:1 && grep -q 'cart.x = 2.* not 5 to 6' "$work/err" && near '"cart.x"' 2; }
check 'a bound that can not be kept' out_of_reach

# mistakes
check 'no bounds' eval '! "$solve" "$work/mass.veh" "$work/mass.scene" a parameter/a'
check 'no such number' eval '! "$solve" "$work/mass.veh" "$work/mass.scene" a parameter/z=0:1'

# ---- the least time through a double lane change, and its picture
/usr/bin/python3 -B "$root/tests/vehicle/least_time.py" "$gicrun" "$root/models" "$work" "$solve" >"$work/said" 2>&1
verdict $? 'the least time'
run -q "$root/models/optimize/least_time.veh" "$root/models/optimize/least_time_found.scene" -o "$work/found.csv" --plot "$work/found.svg"
drawn() { exits 0 && [ "$(grep -c '<path\|<polyline' "$work/found.svg")" -ge 6 ] && ! grep -q 'nan' "$work/found.svg"; }
check 'a picture' drawn

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
