#!/bin/sh
# SPDX-License-Identifier: MIT
# test_guards.sh GICGEN GICRUN STATES REFERENCE AGREE: what only rare states reach. A pitch of a quarter turn, a wheel that
# lies flat, a port that is no number, an arm that is nearly stretched, a coordinate that `massless` leaves next to no
# inertia: each on both sides of the bound that FORMAT.md, SCENE.md or TIRES.md states, with compiled and interpreted
# engines; a torque about one axis alone.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# ---- a pitch of a quarter turn: its sine may be rounded to more than 1

cat >top.veh <<'XXX'
gicgen: 1
model: top
base: top
bodies:
  top: {mass: 2, com: [0, 0, 0], inertia: [1, 2, 3]}
outputs:
  attitude: {type: roll_pitch_yaw, body: top}
XXX
# Euler parameters of 2000 attitudes, nose up or down
awk 'BEGIN {
    print "r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z"
    pi = atan2(0, -1); srand(1)
    for (i = 0; i < 2000; ++i) {
        y = 3 * rand() - 1.5; r = 3 * rand() - 1.5; p = (i % 2 ? 1 : -1) * pi / 4
        printf "0,0,0,%.17g,%.17g,%.17g,%.17g,0,0,0,0,0,0\n", cos(y) * cos(p) * cos(r) + sin(y) * sin(p) * sin(r),
            cos(y) * cos(p) * sin(r) - sin(y) * sin(p) * cos(r), cos(y) * sin(p) * cos(r) + sin(y) * cos(p) * sin(r),
            sin(y) * cos(p) * cos(r) - cos(y) * sin(p) * sin(r) } }' >upright.csv
for engine in tcc tape gic gcp1; do
    "$gicrun" -q --engine $engine --eval upright.csv top.veh -o out.csv 2>err
    # the arc sine of 1 - 1e-16 is 1.5e-8 away from a quarter turn
    check "$engine: a pitch of a quarter turn" awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) {
            if ($i ~ /attitude.pitch/) pitch = i; if ($i == "status") status = i } next }
        { p = $pitch; if (p < 0) p = -p; d = p - atan2(1, 0); if (d < 0) d = -d; good += $status == 0 && $pitch != "" && d < 1e-7 }
        END { exit good != 2000 }' out.csv
done

# ---- a wheel that lies flat (TIRES.md section 3: norm(s x n) counts as 1e-6 where it is less), against the reference.
# Directions of 1e-7 have 9 digits.

sed 's/^gravity.*/gravity: [0, 0, -9.81]/; /^outputs/,$d' "$root/tests/data/tires/gyro.veh" >gyro.veh
"$gicgen" --dump-model gyro.veh >dump && { cat gyro.veh && echo outputs: && sh "$root/tests/lib/wheels.sh" dump; } >flat.veh &&
    "$states" dump --count 40 --seed 3 2>err | sed 's/,,/,/' | awk -F, -v OFS=, -v OFMT=%.17g -v CONVFMT=%.17g '
    BEGIN { split("0 1e-9 1e-7 3e-7 -3e-7 -9e-7 2e-6 1e-4 0.03 0.06", tilt, " ") }
    NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; print; next }
    { roll = (NR % 2 ? 1 : -1) * (atan2(1, 0) + tilt[NR % 10 + 1])
      $at["e0"] = cos(roll / 2); $at["e1"] = sin(roll / 2); $at["e2"] = $at["e3"] = 0
      $at["r.z"] = 0.003 * (NR % 7); print }' >flat.csv && "$reference" dump flat.csv -o wanted.csv 2>err
verdict $? "a wheel that lies flat: $(cat err)"
for engine in tcc tape gic gcp1; do
    "$gicrun" -q --engine $engine --eval flat.csv flat.veh -o found.csv 2>err
    "$agree" dump wanted.csv found.csv --wheels --tolerance 1e-8 >out 2>&1
    verdict $? "$engine: a wheel that lies flat: $(tail -n 2 out)"
done

# ---- ports that are no numbers (FORMAT.md section 14), although nothing feels them: across the rail

cat >cart.veh <<'XXX'
gicgen: 1
model: cart
base: ground
bodies:
  cart: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0]}
ports:
  hook: {body: cart}
XXX
cat >ports.c <<'XXX'
#include "cart.h"
#include <math.h>
int main(void)
{
    static cart self;
    double rate[CART_STATES];
    int i, bad = cart_setup(&self) != GIC_OK;
    for (i = 0; i < 6; ++i) {
        self.port[i] = i % 2 ? INFINITY : NAN;
        bad += cart_rhs(&self, 0, self.state, rate) != GIC_ERROR_INPUT;
        bad += cart_step(&self, 0.01, GIC_RK4) != GIC_ERROR_INPUT;
        bad += cart_outputs(&self) != GIC_ERROR_INPUT;
        self.port[i] = 1;
        bad += cart_step(&self, 0.01, GIC_RK4) != GIC_OK;
    }
    return bad;
}
XXX
"$gicgen" cart.veh -o cart.c 2>err && ${CC:-cc} -I. -I"$root/runtime" ports.c cart.c "$root/runtime/gic_runtime.c" -lm -o ports 2>err
verdict $? "a program with a port: $(cat err)"
./ports
verdict $? "ports that are no numbers"

# ---- an arm of 1 m that a length between it and a point 1.5 m from its hinge turns, nearly stretched. The determinant is
# the sine between the two, 1 at the design (FORMAT.md section 14).

cat >arm.veh <<'XXX'
gicgen: 1
model: arm
base: ground
gravity: [0, 0, 0]
bodies:
  arm: {mass: 2, position: [0, 0, 0], com: [1, 0, 0], inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 0, 1]}
coordinates:
  l: {type: length, bodies: [ground, arm], points: [[1.5, 0, 0], [0, 1, 0]]}
XXX
awk 'BEGIN { print "l,l.rate"; n = split("0.5 0.1 0.05 0.02 0.0105 0.0095 0.0085 0.0075 0.003 0.001 0.0003", s, " ")
    for (i = 1; i <= n; ++i) printf "%.17g,0\n", sqrt(3.25 + 3 * sqrt(1 - s[i] * s[i])) }' >stretched.csv
for engine in tcc tape; do
    for way in closed:00000-6-6-6-6-6-6 newton:0000000-6-6-6-6; do
        "$gicrun" -q --engine $engine --recovery "${way%%:*}" --eval stretched.csv arm.veh -o out.csv 2>err
        found=$(awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "status") at = i; next } { printf "%s", $at }' out.csv)
        check "$engine ${way%%:*}: nearly stretched ($found)" [ "$found" = "${way#*:}" ]
    done
done

# ---- a torque of 1e5 N m about x, no force and no other torque: what an engine checks of its own equations of motion is
# relative to that torque. The acceleration is k angle / J.

cat >twist.veh <<'XXX'
gicgen: 1
model: twist
base: ground
gravity: [0, 0, 0]
bodies:
  wheel: {mass: 1.3, com: [0, 0, 0], inertia: [0.37, 0.23, 0.19]}
joints:
  hinge: {type: revolute, bodies: [ground, wheel], point: [0, 0, 0], axis: [1, 0, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, wheel], axis: [1, 0, 0], range: [-3, 3]}
forces:
  spring: {type: spring_damper, coordinate: angle, stiffness: 123456.7, damping: 1.1}
XXX
awk 'BEGIN { print "angle,angle.rate"; for (i = 1; i <= 40; ++i) printf "%.17g,0\n", i / 37 }' >twist.csv
for axis in '1, 0, 0' '0, 1, 0' '0, 0, 1'; do
    sed "s/axis: \[1, 0, 0\]/axis: [$axis]/; s/inertia: .*/inertia: [0.37, 0.37, 0.37]}/" twist.veh >turned.veh
    for engine in tcc tape gic gcp1; do
        "$gicrun" -q --engine $engine --eval twist.csv turned.veh -o out.csv 2>err
        check "$engine: a torque about $axis alone" awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "status") at = i; next }
            { a = -123456.7 * (NR - 1) / 37 / 0.37; d = $1 / a - 1; if (d < 0) d = -d; good += $at == 0 && $1 != "" && d < 1e-13 }
            END { exit good != 40 }' out.csv
    done
done

# ---- what `massless` leaves: light bodies far out, a heavy one near the axis: m r^2 of 2e-10 of all is none, of 2e-8 is

lever() {
    cat <<XXX
gicgen: 1
model: lever
base: ground
bodies:
  lever: {mass: 3, position: [0, 0, 0], com: [1, 0, 0], inertia: [1e-12, 1e-12, 1e-12]}
  weight: {mass: 6, position: [0, 0, 0], com: [$1, 0, 0], inertia: [1e-14, 1e-14, 1e-14]}
joints:
  hinge: {type: revolute, bodies: [ground, lever], point: [0, 0, 0], axis: [0, 0, 1]}
  weld: {type: fixed, bodies: [lever, weight], point: [0, 0, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, lever], axis: [0, 0, 1]}
XXX
}
printf 'gicscene: 1\nduration: 0.01\nstep: 0.001\nmassless: {below: 4}\n' >light.scene
lever 1e-5 >lever.veh
run lever.veh light.scene -o out.csv
check "2e-10 of its inertia is none" exits 1
check "which is said" says "a coordinate has no inertia"
lever 1e-4 >lever.veh
run lever.veh light.scene -o out.csv
check "2e-8 of it is some" exits 0

# ---- a base that is held elsewhere: its wheels go with it, turned as it is

rig() {
    cat <<XXX
gicscene: 1
duration: 0.02
step: 0.001
output_step: 0.01
base: fixed
$1
outputs: [chassis, wheel_f_l]
XXX
}
rig '' >rig.scene
rig 'initial: {position: [10, 20, 30], orientation: {yaw: 1.5707963267948966}}' >turned.scene
"$gicrun" -q --engine tape "$root/models/hmmwv.veh" rig.scene -o rig.csv 2>err &&
    "$gicrun" -q --engine tape "$root/models/hmmwv.veh" turned.scene -o turned.csv 2>>err
verdict $? "held bases"
check "held elsewhere" awk -F, 'function off(a, b) { return !((a - b) * (a - b) < 1e-24) }
    FNR == 1 { for (i = 1; i <= NF; ++i) { name = $i; sub(/ .*/, "", name); at[name] = i }; next }
    FNR == 2 { x = $at["wheel_f_l.x"] - $at["chassis.x"]; y = $at["wheel_f_l.y"] - $at["chassis.y"]; z = $at["wheel_f_l.z"] - $at["chassis.z"]
        if (NR == FNR) { x0 = x; y0 = y; z0 = z } else
        bad = off(x, -y0) || off(y, x0) || off(z, z0) || off($at["chassis.x"], 10) || off($at["chassis.y"], 20) || off($at["chassis.z"], 30) }
    END { exit bad || NR != 8 || x0 == 0 }' rig.csv turned.csv

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
