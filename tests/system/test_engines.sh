#!/bin/sh
# SPDX-License-Identifier: MIT
# test_engines.sh GICGEN GICRUN STATES REFERENCE AGREE RANDOM_VEHICLE: the interpreted engines. Accelerations, poses and
# reactions against the independent reference in quad precision at ROWS (default 5) random states of every model, of one with
# every kind of force law and of VEHICLES (default 3) random vehicles; all outputs along scenes against generated code;
# failures.
#
# Tolerances. States: 1e-10. Engines work in world coordinates, where a place 100 m away is known to 1e-14 m, and a tire
# of 3e5 N/m makes 1e-12 of an acceleration from that. Scenes: 1e-9 of the largest value of an output, or of 1 (a
# force or torque: 1000) where that is larger: such differences, amplified by the motion over a run. gcp1 and gcp2
# integrate other coordinates, so that their runs differ by truncation errors: both sides run within a tolerance of 1e-10,
# and outputs agree to 1e-6, for errors add up and grow by the motion.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
random_vehicle=$(realpath "$6")
root=$(cd "$(dirname "$0")/../.." && pwd)
engines=${ENGINES:-gic gcp1 gcp2}
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# what is on trial is not the compiler
echo "exec ${CC:-cc} \"\$@\" -O0" >cc
cc="sh $work/cc"

# ---- states -----------------------------------------------------------------------------------------------------

# closed [SIZE]: the largest of the column `constraint` of results.csv is rounding. Engines solve to 1e-14 of a model's
# size, and residuals are metres: of one that is longer than 10 m, some 1e-13 of that.
closed() {
    awk -F, -v size="${1:-1}" 'BEGIN { most = size > 10 ? 1e-13 * size : 1e-12 }
        NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^constraint/) column = i; next }
        $column == "" || !($column <= most) { print "constraint residual " $column; bad = 1 }
        END { exit bad || NR < 2 }' results.csv
}

# at_states MODEL SEED: all engines; no compiler is needed
at_states() {
    "$gicgen" --dump-model "$1" >dump && "$states" dump --count "${ROWS:-5}" --seed "$2" -o states.csv &&
        sh "$root/tests/lib/reactions.sh" dump "$(realpath "$1")" >variant.veh &&
        "$reference" dump states.csv -o accelerations.csv 2>said || { verdict 1 "reference at states of $1"; return; }
    # along x, where vehicles are longest
    size=$(sed -n 's/.*"position": \[\([^,]*\),.*/\1/p' dump | awk '
        NR == 1 || $1 < low { low = $1 } NR == 1 || $1 > high { high = $1 } END { print high - low }')
    for engine in $engines; do
        "$gicrun" --engine "$engine" --cc false --eval states.csv variant.veh -o results.csv >said 2>&1 &&
            "$agree" dump accelerations.csv results.csv --reactions --tolerance 1e-10 >said && closed "$size" >said
        verdict $? "$engine at states of $1"
    done
}

# a driven rack, and outputs of every type in every kind of frame
outputs='  drive: {type: drive_force, coordinate: rack}
  spin: {type: angular_velocity, body: wheel_f_l}
  spin_own: {type: angular_velocity, body: wheel_f_l, in: chassis}
  hub: {type: velocity, body: wheel_r_r, point: centre_r_r, in: wheel_r_r}
  jerked: {type: acceleration, body: wheel_r_r, point: centre_r_r, in: chassis}
  ball: {type: acceleration, body: lca_f_l, point: ball_f_l}
  upright: {type: orientation, body: wheel_f_r}
  camber: {type: roll_pitch_yaw, body: wheel_f_r}
  push: {type: reaction, joint: ball_f_l}
  hold: {type: reaction, joint: arm_r_l, in: chassis}
  rail: {type: reaction, joint: rack_guide, in: rack}
  tie: {type: reaction, joint: tierod_f_r}'
sed "s|parts/|$root/models/parts/|g; s/^model: .*/model: steered/; s/^  rack: *{type: translation,/& driven: true,/" \
    "$root/models/hmmwv.veh" >steered.veh
echo "$outputs" >>steered.veh

for model in "$root"/models/*.veh "$root/tests/data/laws/cart.veh" steered.veh; do
    case $model in
    */hmmwv_tires.veh | */hmmwv_tmeasy.veh) ;; # below, with states of their wheels
    *) at_states "$model" 1 ;;
    esac
done
for seed in $(seq 1 "${VEHICLES:-3}"); do
    "$random_vehicle" --seed "$seed" >"random$seed.veh" && at_states "random$seed.veh" "$seed"
done

# set up with another value of a geometric parameter: as the file with that value. rod is a length that is not the drawing's
tuned() {
    model=$root/tests/data/tuning/$1.veh
    sed "s|file: \.\./\.\./\.\.|file: $root|; s|^include: \.\./\.\./\.\.|include: $root|; s/^  $2: {value: [^,]*/  $2: {value: $3/" \
        "$model" >baked.veh
    "$gicgen" --dump-model baked.veh >dump && "$states" dump --count "${ROWS:-5}" --seed 1 -o states.csv &&
        "$reference" dump states.csv -o accelerations.csv 2>said || { verdict 1 "reference at states of $1"; return; }
    awk -v name="$2" -v value="$3" '{ print $0 "," (NR == 1 ? name : value) }' states.csv >tuned.csv
    for engine in $engines; do
        "$gicrun" --engine "$engine" --eval tuned.csv "$model" -o results.csv >said 2>&1 &&
            "$agree" dump accelerations.csv results.csv --tolerance 1e-10 >said && closed >said
        verdict $? "$engine, $1 set up with $2 = $3"
    done
}
tuned car length 1.605
tuned hand rod 0.553

# ---- scenes -----------------------------------------------------------------------------------------------------

# near A B: two results files, column by column
near() {
    awk -F, -v within="$3" 'function abs(x) { return x < 0 ? -x : x }
        NR == FNR {
            rows = FNR
            for (i = 1; i <= NF; ++i) {
                value[FNR, i] = $i
                if (FNR == 1)
                    size[i] = $i ~ /\[N/ ? 1000 : 1
                else if (abs($i) > size[i])
                    size[i] = abs($i)
            }
            next
        }
        {
            for (i = 1; i <= NF; ++i)
                if (FNR == 1 ? $i != value[1, i] : !(abs($i - value[FNR, i]) <= within * size[i])) {
                    print value[1, i], "in row", FNR ":", value[FNR, i], $i
                    bad = 1
                }
        }
        END { exit bad || FNR != rows || rows < 3 }' "$1" "$2"
}

# along MODEL SCENE [OPTION...]: all engines
along() {
    model=$1
    scene=$2
    shift 2
    "$gicrun" --quiet --engine cc --cc "$cc" "$@" "$model" "$scene" -o generated.csv >said 2>&1
    verdict $? "$scene with generated code"
    precise="--integrator rkck --tolerance 1e-10"
    # shellcheck disable=SC2086  # options
    "$gicrun" --quiet --engine cc --cc "$cc" "$@" $precise "$model" "$scene" -o precise.csv >said 2>&1
    verdict $? "$scene with generated code, precisely"
    for engine in $engines; do
        case $engine in
        gcp*)
            # shellcheck disable=SC2086
            "$gicrun" --quiet --engine "$engine" "$@" $precise "$model" "$scene" -o interpreted.csv >said 2>&1 &&
                near precise.csv interpreted.csv 1e-6 >said
            ;;
        *)
            "$gicrun" --quiet --engine "$engine" "$@" "$model" "$scene" -o interpreted.csv >said 2>&1 &&
                near generated.csv interpreted.csv 1e-9 >said
            ;;
        esac
        verdict $? "$engine along $scene"
    done
}

sed 's/^duration: .*/duration: 1.5/' "$root/models/scenes/paper_run.scene" >paper_run.scene
along "$root/models/hmmwv.veh" paper_run.scene
for name in andrews five_link solid_axle quarter_car; do
    sed 's/^duration: .*/duration: 0.02/; s/^output_step: .*//' "$root/models/scenes/$name.scene" >"$name.scene"
    along "$root/models/$name.veh" "$name.scene"
done
# turning over more than a turn, so that every Euler parameter is the dependent one at some time; steering by knots
cat >spin.scene <<'END'
gicscene: 1
duration: 1.5
step: 0.002
integrator: rk4
output_step: 0.01
initial:
  position: [200, 50, 1.5]
  orientation: {yaw: 0.5, pitch: 0.3, roll: -0.4}
  velocity: [10, 2, 1]
  angular_velocity: [1, 2, 6]
  coordinates: {spring_f_l: 0.26}
  rates: {spring_r_r: 0.2}
road: {type: sine, amplitude: 0.03, wavelength: 5}
inputs:
  rack: {knots: {times: [0, 0.5, 1], values: [0, 0.03, -0.02]}}
END
along steered.veh spin.scene
cat >cart.scene <<'END'
gicscene: 1
duration: 0.5
step: 0.005
integrator: rk4
initial: {velocity: [3, 1, 0], coordinates: {sway: 0.01}, rates: {sway: 1}}
parameters: {k: 5500}
inputs: {gust: {sine: {amplitude: 20, frequency: 3}}}
END
along "$root/tests/data/laws/cart.veh" cart.scene
# a scene that sets geometric parameters
sed "s|^include: \.\./\.\./\.\.|include: $root|" "$root/tests/data/tuning/car.veh" >car.veh
cat >tuned.scene <<'END'
gicscene: 1
duration: 0.3
step: 0.002
integrator: rk4
parameters: {length: 1.605, upper: 0.703, load: 1800, radius_l: 0.46, toe: 0.012, bump: 0.285}
END
along car.veh tuned.scene
along "$root/models/hmmwv.veh" paper_run.scene --integrator rkck --tolerance 1e-6

# a crank that turns by up to a twentieth of a radian in a step, so that factors have to be renewed: constraints hold to rounding
cat >fast.veh <<'END'
gicgen: 1
model: fast
base: frame
bodies:
  frame: {mass: 10, com: [0, 0, 0], inertia: [1, 1, 1]}
  crank: {mass: 1, com: [0, 0, 0.25], inertia: [1, 1, 1]}
  rod: {mass: 1, com: [1.5, 0, 0.5], inertia: [1, 1, 1]}
  slider: {mass: 1, com: [3, 0, 0.5], inertia: [1, 1, 1]}
joints:
  bearing: {type: revolute, bodies: [frame, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  pin: {type: revolute, bodies: [crank, rod], point: [0, 0, 0.5], axis: [0, 1, 0]}
  guide: {type: prismatic, bodies: [frame, slider], axis: [1, 0, 0]}
  end: {type: point_on_line, bodies: [slider, rod], point: [3, 0, 0.5], axis: [0, 1, 0]}
coordinates:
  q: {type: angle, bodies: [frame, crank], axis: [0, 1, 0], range: [-1.2, 1.2]}
forces:
  push: {type: force, coordinate: q, value: "max(0, q) * 100"}
END
printf 'gicscene: 1\nduration: 0.6\nstep: 0.0005\nintegrator: rk4\ninitial: {rates: {q: 1}}\n' >fast.scene
for engine in $engines; do
    "$gicrun" --engine "$engine" fast.veh fast.scene -o fast.csv >said 2>&1 &&
        awk '/constraint residual/ { found = 1; bad = !($3 <= 1e-12) } END { exit bad || !found }' said
    verdict $? "$engine: constraints of fast motion"
done

# copies of an instance go their own ways: how often outputs are written leaves no trace
sed 's/^output_step: .*/output_step: 0.5/' paper_run.scene >seldom.scene
for engine in $engines; do
    "$gicrun" --quiet --engine "$engine" "$root/models/hmmwv.veh" paper_run.scene -o often.csv >said 2>&1 &&
        "$gicrun" --quiet --engine "$engine" "$root/models/hmmwv.veh" seldom.scene -o seldom.csv >said 2>&1 &&
        [ "$(tail -n 1 often.csv)" = "$(tail -n 1 seldom.csv)" ]
    verdict $? "$engine: outputs leave no trace"
done

# ---- wheels with tires ------------------------------------------------------------------------------------------

# rolling MODEL SEED: against generated code at states of any attitude, with any spin, slip and brake, on a wavy road
cat >wavy.scene <<'END'
gicscene: 1
duration: 1
step: 0.001
road: {type: sine, amplitude: 0.03, wavelength: 5, phase_per_y: 0.6}
END
rolling() {
    "$gicgen" --dump-model "$1" >dump && "$states" dump --count "${ROWS:-5}" --seed "$2" -o rolling.csv &&
        "$gicrun" --engine cc --cc "$cc" --eval rolling.csv "$1" wavy.scene -o generated.csv >said 2>&1
    verdict $? "states of $1 with generated code"
    for engine in $engines; do
        "$gicrun" --engine "$engine" --cc false --eval rolling.csv "$1" wavy.scene -o results.csv >said 2>&1 &&
            cut -d, -f"$(columns generated.csv)" generated.csv >wanted &&
            cut -d, -f"$(columns results.csv)" results.csv >found && near wanted found 1e-10 >said && closed >said
        verdict $? "$engine at rolling states of $1"
    done
}

# columns FILE: numbers of those that hold what is computed, without residual, status and message
columns() {
    head -n 1 "$1" | awk -F, '{ print "1-" NF - 3 }'
}

for model in hmmwv_tires hmmwv_tmeasy; do
    rolling "$root/models/$model.veh" 1
done

# wheels scene NAME: from standard input; a step of which stiff brakes and tires are well within reach
wheels() {
    { echo "gicscene: 1" && cat; } >"$1.scene"
    along "$2" "$1.scene"
}
tires=$root/models/hmmwv_tires.veh
wheels lock "$tires" <<'END'
duration: 1.5
step: 0.001
integrator: rk4
output_step: 0.01
initial: {speed: 8}
inputs: {brake: {knots: {times: [0.2, 0.4], values: [0, 1]}}, rack: 0.005}
END
wheels park "$tires" <<'END'
duration: 1
step: 0.001
integrator: rk4
output_step: 0.01
initial: {orientation: {pitch: -0.1}}
road: {type: slope, x: 0.1}
inputs: {brake: 0.5}
END
wheels jump "$tires" <<'END'
duration: 0.8
step: 0.001
integrator: rk4
output_step: 0.01
initial: {position: [0, 0, 0.75], velocity: [12, 0, 1], angular_velocity: [0.1, 0, 0.2]}
inputs: {drive_torque: 800}
END
wheels rough "$root/models/hmmwv_tmeasy.veh" <<'END'
duration: 1
step: 0.001
integrator: rk4
output_step: 0.01
initial: {speed: 10}
road: {type: sine, amplitude: 0.02, wavelength: 3, phase_per_y: 0.7}
inputs: {drive_torque: 1000, rack: {knots: {times: [0, 0.5], values: [0, 0.02]}}}
END
# dual rate: gic as generated code; gcp1, whose slow states are others, to the truncation error of 4 ms. Formulas of the
# second one read a free and a driven coordinate, which come to fast steps in different ways.
sed "s|parts/|$root/models/parts/|; s|drive_torque / 4|& - 2 * spin + 500 * rate(spring_f_r) + 9000 * rack, drive_body: lca_r_r|
    s|4000 \* brake|& * (1 + rate(rack) + spring_r_l)|" "$tires" >formulas.veh
cat >dual.scene <<'END'
gicscene: 1
duration: 1
step: 0.004
ratio: 4
initial: {speed: 10}
inputs: {brake: 0.02, drive_torque: 1000, rack: {knots: {times: [0, 0.5], values: [0, 0.02]}}}
END
for model in "$tires" formulas.veh; do
    "$gicrun" --quiet --engine cc --cc "$cc" "$model" dual.scene -o generated.csv >said 2>&1
    verdict $? "dual rate of $model with generated code"
    for engine in gic:1e-9 gcp1:1e-3; do
        "$gicrun" --quiet --engine "${engine%:*}" "$model" dual.scene -o interpreted.csv >said 2>&1 &&
            near generated.csv interpreted.csv "${engine#*:}" >said
        verdict $? "${engine%:*} with dual rate of $model"
    done
done

# a vehicle that turns about makes partitioning change its mind; the two solvers differ in the last digits
for engine in gcp1 gcp2; do
    "$gicrun" --engine "$engine" "$root/models/hmmwv.veh" "$root/models/scenes/spin.scene" -o "$engine.csv" 2>said
    verdict $? "$engine along the spin"
    [ "$(sed -n 's/^  parameter switches *//p' said)" -ge 8 ]
    verdict $? "$engine picks coordinates anew"
done
near gcp1.csv gcp2.csv 1e-6 >said && ! cmp -s gcp1.csv gcp2.csv
verdict $? "gcp1 and gcp2 use different solvers"
# the same with variable steps, which start afresh where it changes its mind: some thousand steps with errors of 1e-9
# each, which nothing damps
spin="$root/models/scenes/spin.scene"
"$gicrun" --quiet --cc "$cc" --integrator rkck --tolerance 1e-11 "$root/models/hmmwv.veh" "$spin" -o precise.csv >said 2>&1
verdict $? "the spin with generated code, precisely"
for integrator in adams rkck; do
    "$gicrun" --engine gcp1 --integrator $integrator --tolerance 1e-9 "$root/models/hmmwv.veh" "$spin" -o gcp1.csv 2>said &&
        [ "$(sed -n 's/^  parameter switches *//p' said)" -ge 8 ] && near precise.csv gcp1.csv 1e-5 >said
    verdict $? "gcp1 along the spin with $integrator"
done

# ---- failures ---------------------------------------------------------------------------------------------------

# a crank and its spring's line: at w = 1.75 they are in line, and the length ceases to be a coordinate
cat >crank.veh <<'END'
gicgen: 1
model: crank
base: ground
gravity: [0, 0, 0]
bodies:
  arm: {mass: 1, com: [0.5, 0, 0], inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 0, 1]}
coordinates:
  w: {type: length, bodies: [ground, arm], points: [[0, 0.75, 0], [1, 0, 0]]}
END
cat >crank.scene <<'END'
gicscene: 1
duration: 10
step: 0.001
initial: {rates: {w: 0.3}}
END
printf 'w,w.rate\n1.25,0\n1.8,0\n1.4,-1\n1e9,0\n' >crank.csv
for engine in $engines; do
    "$gicrun" --quiet --engine "$engine" crank.veh crank.scene -o crank.out 2>said
    status=$?
    case $engine in
    gcp*) [ $status -eq 0 ] ;; # w is no coordinate of theirs
    *) [ $status -eq 1 ] && grep -q "error: the run ends at t = .*: .*: subset 'arm'" said ;;
    esac && [ "$(wc -l <crank.out)" -gt 100 ] && ! grep -qi nan crank.out
    verdict $? "$engine: a run ends where coordinates cease to be independent"
    "$gicrun" --engine "$engine" --eval crank.csv crank.veh -o crank.eval 2>said
    [ "$(grep -c ',0,"ok"$' crank.eval)" -eq 2 ] && grep -q ',-5,.*arm' crank.eval && grep -q ',-4,' crank.eval
    verdict $? "$engine: states out of reach"
done
"$gicrun" --engine nothing crank.veh crank.scene >said 2>&1
[ $? -eq 2 ] && grep -q "no engine 'nothing'" said && grep -q 'remedy: one of auto, tcc, ' said
verdict $? "an engine that is not there"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
