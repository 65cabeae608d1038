#!/bin/sh
# SPDX-License-Identifier: MIT
# stiff.sh GICBENCH OUT.svg [OPTION...]: work-precision diagrams of stiff vehicles: the hatchback on its bushings for a second in a
# crosswind, and hmmwv14 with light upper arms over the road of its scene; explicit and implicit, constant and variable steps,
# and CVODE's BDF. OPTIONs of gicbench: --quick, --engines tcc; by cc, the default, it compiles for minutes.
gicbench=$1
picture=$2
shift 2
models=$(cd "$(dirname "$0")/../../models" && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cat >"$work/crosswind.scene" <<'END'
gicscene: 1
duration: 1
step: 0.001
output_step: 0.05
integrator: ros3
keep_jacobian: 4
initial: {position: [0, 0, 0.55], equilibrium: true, speed: 15, gear: 3, states: {engine.speed: 290}}
inputs: {crosswind: 20}
END
sed 's/^integrator: .*/integrator: ros3\nkeep_jacobian: 4/; s/^output_step: .*/output_step: 0.1/' "$models/scenes/hmmwv14.scene" >"$work/light_arms.scene"
"$gicbench" --precision --plot "$picture" "$@" "$models/hatchback.veh" "$work/crosswind.scene" "$models/hmmwv14.veh" "$work/light_arms.scene"
