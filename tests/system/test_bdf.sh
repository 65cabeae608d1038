#!/bin/sh
# SPDX-License-Identifier: MIT
# test_bdf.sh GICRUN: the integrator bdf: stiff problems with closed and published solutions, vehicles and their events
# against tight explicit steps, its exact Jacobian against differences by other engines, what it costs, and what is said
# where SUNDIALS is not there.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1
models=$root/models
# places FILE: its columns in m
places() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /\[m\]$/) column[++n] = i }
        { for (k = 1; k <= n; ++k) printf "%s%s", $column[k], k < n ? "," : "\n" }' "$1"
}
count() { sed -n "s/^  $1 *\([0-9]*\).*/\1/p" err; }

# ---- a body of 2 kg on a bushing of 2e6 N/m and 4e5 Ns/m: eigenvalues -5.0003 and -1.99995e5 1/s. Let go from 1 mm, x =
# (b e^(a t) - a e^(b t)) / (b - a) mm. Errors are those of some hundred steps, each below the tolerance
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
  rubber: {type: bushing, bodies: [ground, b], point: [0, 0, 0], stiffness: [2e6, 0, 0, 0, 0, 0], damping: [4e5, 0, 0, 0, 0, 0]}
  push: {type: load, body: b, force: [push, 0, 0]}
outputs: {x: {type: coordinate, coordinate: x}}
END
awk 'BEGIN { print "time [s],x.value [m]"; s = sqrt(1e10 - 1e6); a = -1e6 / (1e5 + s); b = -1e5 - s
    for (k = 0; k <= 10; ++k) { t = k / 10
        printf "%.17g,%.17g\n", t, 0.001 * (b * exp(a * t) - a * exp(b * t)) / (b - a) } }' >mount.csv
cat >mount.scene <<'END'
{gicscene: 1, duration: 1, output_step: 0.1, integrator: bdf, initial: {coordinates: {x: 0.001}}, outputs: [x.value]}
END
before=1
for digits in 4 6 8 10 12; do
    run mount.veh mount.scene --tolerance 1e-$digits -o at.csv
    off=$(apart at.csv mount.csv)
    check "a stiff mount at 1e-$digits: $off off" within "$off" "2e-$((digits - 2))"
    check "a stiff mount at 1e-$digits: no more than with two digits less" within "$off" "$before"
    before=$off
done
run -q mount.veh mount.scene --tolerance 1e-8 --engine tape -o tape.csv
run -q mount.veh mount.scene --tolerance 1e-8 --engine tcc -o tcc.csv
check "the mount by differences: $(apart tape.csv tcc.csv)" within "$(apart tape.csv tcc.csv)" 1e-7
# explicit steps are below 3 / 2e5 s, whatever the tolerance
run mount.veh mount.scene --tolerance 1e-6 -o at.csv
cheap=$(count right-hand\ sides)
check "the mount's Jacobian is evaluated now and then: $(count Jacobians)" test "$(count Jacobians)" -gt 0 -a "$(count Jacobians)" -lt "$cheap"
run mount.veh mount.scene --tolerance 1e-6 --integrator rkck -o at.csv
check "a hundredth of the work of rkck: $cheap, $(count right-hand\ sides)" test $((100 * cheap)) -lt "$(count right-hand\ sides)"

# ---- van der Pol's oscillator, mu = 1000, over more than a period: published (Test Set for IVP Solvers, problem vdpol)
# y1(2000) = 1.706167732170469, y2(2000) = -8.928097010248125e-4
cat >pol.veh <<'END'
gicgen: 1
model: pol
base: ground
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}}
states:
  z: {initial: 2, rate: w}
  w: {initial: 0, rate: "1000 * (1 - z * z) * w - z"}
signals: {z_s: z, w_s: w}
forces: {f: {type: force, coordinate: x, value: "-1000 * x - 10 * rate(x)"}}
outputs:
  z: {type: signal, signal: z_s}
  w: {type: signal, signal: w_s}
END
echo '{gicscene: 1, duration: 2000, output_step: 2000, integrator: bdf, outputs: [z, w]}' >pol.scene
for digits in 6 9; do
    run -q pol.veh pol.scene --tolerance 1e-$digits -o pol.csv
    off=$(tail -n 1 pol.csv | awk -F, '{ a = $2 - 1.706167732170469; b = $3 + 8.928097010248125e-4
        print (a < 0 ? -a : a) + (b < 0 ? -b : b) }')
    check "van der Pol at 1e-$digits: $off off" within "${off:-1}" "1e-$((digits - 3))"
done

# ---- inputs: a push of 2 ms between output times is not passed over
cat >push.scene <<'END'
gicscene: 1
duration: 1
output_step: 0.5
integrator: bdf
tolerance: 1e-9
inputs: {push: {knots: {times: [0.412, 0.413, 0.414], values: [0, 3000, 0]}}}
END
sed 's/4e5/4e3/' mount.veh >soft.veh
run -q soft.veh push.scene -o push.csv
run -q soft.veh push.scene --integrator rkck --tolerance 1e-12 -o fine.csv
check "a short push: $(apart push.csv fine.csv)" within "$(apart push.csv fine.csv)" 1e-8
check "a short push moves it" test "$(sed 1d push.csv | cut -d, -f2 | sort -u | wc -l)" -eq 3

# ---- vehicles: a road, tires and jumps (contacts), a whole drive (gears), all arms on rubber; places against those of
# rkck at 1e-10. Steps are some thousand, each with an error below the tolerance (1 + |x|)
while read -r car model scene seconds; do
    awk -v d="$seconds" '/^(integrator|step|ratio|output_step|duration|sleep|steady|locate|keep_jacobian):/ { next } { print }
        END { print "duration: " d "\noutput_step: " d / 10 }' "$models/scenes/$scene.scene" |
        sed "s|{file: |{file: $models/scenes/|" >drive.scene
    run "$models/$model.veh" drive.scene --engine tcc --integrator rkck --tolerance 1e-10 -o fine.csv
    check "$car: rkck runs" exits 0
    places fine.csv >fine
    for digits in 5 8; do
        run "$models/$model.veh" drive.scene --engine tcc --integrator bdf --tolerance 1e-$digits -o at.csv
        check "$car at 1e-$digits: runs" exits 0
        places at.csv >coarse
        off=$(apart coarse fine)
        check "$car at 1e-$digits: $off off" within "$off" "1e-$((digits - 3))"
    done
done <<'END'
HMMWV hmmwv paper_run 2
HMMWV_on_tires hmmwv_tires tires_jump 1.5
hatchback hatchback hatchback_lane_change 1
complete_HMMWV hmmwv_vehicle full_run 4
END

# ---- what is refused
echo '{gicscene: 1, duration: 1, step: 0.1, integrator: bdf, keep_jacobian: 4}' >kept.scene
run mount.veh kept.scene
check 'a Jacobian that is kept is refused' says 'kept.scene:1:.*bdf decides itself how long it keeps a Jacobian'
check 'with a remedy' says 'remedy: remove it'
# a program without the plug-in beside it
mkdir alone
cp "$gicrun" alone/gicrun
gicrun=$work/alone/gicrun
run mount.veh mount.scene -o none.csv
check 'without SUNDIALS there is a message' says 'error: the integrator bdf needs SUNDIALS: it was not there when'
check 'with a remedy' says 'remedy: .*apt-get install libsundials-dev.*adams or rkck'
check 'status 1' exits 1
check 'and no results' test ! -e none.csv
run -q mount.veh mount.scene --integrator rkck -o some.csv
check 'other integrators need none' exits 0

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
