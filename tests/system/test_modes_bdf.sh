#!/bin/sh
# SPDX-License-Identifier: MIT
# test_modes_bdf.sh GICRUN: eigenvalues of `gicrun --modes` against frequency and decay of the vehicle's own small motions
# by CVODE with the engine gic, of which nothing is linearized: tests/vehicle/small_motions.py.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# moves NAME MODEL BASE
moves() {
    /usr/bin/python3 -B "$root/tests/vehicle/small_motions.py" "$gicrun" "$2" "$3" >said 2>&1
    verdict $? "$1: small motions of CVODE are those of --modes"
    cat said
}
# 2 kg on a bushing of 2e6 N/m and 400 Ns/m and, soft beside it, a pendulum on a spring
cat >mount.veh <<'END'
gicgen: 1
model: mount
base: ground
bodies:
  b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
  p: {mass: 1, com: [0, 0, -0.5], inertia: [0.1, 0.1, 0.1]}
joints:
  j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}
  k: {type: revolute, bodies: [b, p], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}
  q: {type: angle, bodies: [b, p], axis: [0, 1, 0], range: [-1, 1]}
forces:
  rubber: {type: bushing, bodies: [ground, b], point: [0, 0, 0], stiffness: [2e6, 0, 0, 0, 0, 0], damping: [400, 0, 0, 0, 0, 0]}
  spring: {type: spring_damper, coordinate: q, stiffness: 30, damping: 1, free: 0}
outputs:
  x: {type: coordinate, coordinate: x}
END
moves mount mount.veh ground
for model in quarter_car hmmwv hmmwv14 solid_axle trailing_arm five_link; do
    m=$root/models
    sed "s|{file: |{file: $m/|; s|\[parts/|[$m/parts/|; s|, parts/|, $m/parts/|g; s|^\( *include: \)\([^{[]\)|\1$m/\2|" "$m/$model.veh" >$model.veh
    moves $model $model.veh chassis
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
