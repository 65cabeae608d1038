#!/bin/sh
# SPDX-License-Identifier: MIT
# test_step_watch.sh GICRUN GICSWEEP: runs that tires or stops keep within bounds although their steps are too long are
# reported, with time and quantity; others are not, and no run is changed by being watched.
gicrun=$(realpath "$1")
gicsweep=$(realpath "$2")
models=$(dirname "$0")/../../models
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# scene NAME INTEGRATOR RATIO STEP DURATION OUTPUT_STEP: a scene of the folder with those
scene() {
    {
        echo 'gicscene: 1'
        echo "step: $4"
        echo "integrator: $2"
        [ "$3" -eq 1 ] || echo "ratio: $3"
        echo "duration: $5"
        echo "output_step: $6"
        grep -Ev '^(gicscene|step|integrator|ratio|duration|output_step):' "$models/scenes/$1.scene"
    } >"$work/$1.scene"
}

# drive MODEL SCENE INTEGRATOR RATIO STEP DURATION: rows every 0.24 s in $work/run.csv
drive() {
    scene "$2" "$3" "$4" "$5" "$6" 0.24
    run -q --engine tcc "$models/$1.veh" "$work/$2.scene" -o "$work/run.csv"
}

rows() { [ "$(wc -l <"$work/run.csv")" -eq $((1 + $1)) ] && ! grep -qi 'nan\|inf' "$work/run.csv"; }

# off: how far accelerations of the springs are from those with a quarter of the step, root of the mean square relative
# to the latter: the very result of the steps, whatever the watch thinks of them
off() {
    paste -d , "$work/run.csv" "$work/fine.csv" | awk -F, 'NR == 1 {
        for (i = 1; i <= NF / 2; ++i)
            if ($i ~ /^spring_.*acceleration/) column[i] = i
        half = NF / 2
        next
    }
    {
        for (i in column) { a += ($i - $(i + half))^2; b += $(i + half)^2 }
    } END {printf "%.4g\n", sqrt(a / b)}'
}
less() { awk "BEGIN {exit !($1 < $2)}"; }
quiet() { [ ! -s "$work/err" ]; }

# Beyond a limit, where a run is reported, accelerations are off by more than half of what they are (in fact by several
# times that). A step of 0.9 times the limit and less is quiet, and they are off by less than 0.15: nearer to the limit
# AB3 hardly damps what it should. With AB3 it is 8.3 to 8.6 ms for what moves on the tires, and 2.2 ms for the tires
# themselves, with RK4 and TMeasy 19 ms for these.
# model, scene, integrator, ratio, duration; step, quantity; step
while read -r model scene integrator ratio duration long quantity short; do
    what="$model, $scene, $integrator"
    fine=$(awk "BEGIN {print $long / 4}")
    drive "$model" "$scene" "$integrator" "$ratio" "$fine" "$duration"
    check "$what, $fine s: runs" exits 0
    cp "$work/run.csv" "$work/fine.csv"
    drive "$model" "$scene" "$integrator" "$ratio" "$long" "$duration"
    check "$what, $long s: fails" exits 1
    check "$what, $long s: time and quantity" says \
        "error: from t = [0-9.]* s on the run is unstable.* steps of ${long}[0-9]* s .*: '$quantity', eigenvalue -"
    check "$what, $long s: a remedy" says 'remedy: take steps of at most about 0.0[0-9]* s'
    check "$what, $long s: all results are there" rows "$(awk "BEGIN {print int(1.5 + $duration / 0.24)}")"
    check "$what, $long s: they are wrong" less 0.5 "$(off)"
    fine=$(awk "BEGIN {print $short / 4}")
    drive "$model" "$scene" "$integrator" "$ratio" "$fine" "$duration"
    cp "$work/run.csv" "$work/fine.csv"
    drive "$model" "$scene" "$integrator" "$ratio" "$short" "$duration"
    check "$what, $short s: good" exits 0
    check "$what, $short s: quiet" quiet
    check "$what, $short s: results are right" less "$(off)" 0.15
done <<'END'
hmmwv_tires tires_brake ab3 6 4.8 0.01 spring_[fr]_[lr] 0.0075
hmmwv_tmeasy tires_brake ab3 6 4.8 0.01 spring_[fr]_[lr] 0.0075
hmmwv_tires tires_park ab3 1 4.8 0.003 tire_[fr]_[lr].[a-z_]* 0.002
hmmwv_tmeasy tires_park rk4 1 4.8 0.024 tire_[fr]_[lr].[a-z_]* 0.016
hmmwv_vehicle full_run ab3 6 7.2 0.01 spring_[fr]_[lr] 0.0075
END

# on a rough road motions are never resolved as well as that, and quiet where they are stable all the same
drive hmmwv_tires tires_rough ab3 4 0.01 4.8
check 'a rough road, too long steps: reported' says 'from t = 0 s on the run is unstable'
drive hmmwv_tires tires_rough ab3 4 0.0075 4.8
check 'a rough road, steps within the limit: quiet' quiet

# other engines find the same
for engine in tape gic auto; do
    scene tires_brake ab3 6 0.01 2.4 0.24
    run -q --engine $engine "$models/hmmwv_tires.veh" "$work/tires_brake.scene" -o "$work/run.csv"
    check "engine $engine: fails" exits 1
    check "engine $engine: the same finding" says "from t = 0 s on the run is unstable.*'spring_r_[lr]'"
done
# variable steps are watched by their own error
scene tires_brake adams 1 0.01 2.4 0.24
run -q --engine tcc "$models/hmmwv_tires.veh" "$work/tires_brake.scene" -o "$work/run.csv"
check 'variable steps: quiet' exits 0

# Implicit and exponential steps with an older Jacobian, or with fast states in steps of their own: what they keep moving,
# or keep still, as short steps don't. model, scene, integrator, ratio, duration; step, line of the scene; step
while read -r model scene integrator ratio duration long short line; do
    what="$model, $scene, $integrator, ratio $ratio, $line"
    for step in $long $short; do
        scene "$scene" "$integrator" "$ratio" "$step" "$duration" "$(awk "BEGIN { print 20 * $step }")"
        [ "$line" = - ] || echo "$line" >>"$work/$scene.scene"
        run -q --engine tcc "$models/$model.veh" "$work/$scene.scene" -o "$work/run.csv"
        if [ "$step" = "$long" ]; then
            check "$what, $step s: fails" exits 1
            check "$what, $step s: time, quantity" says "error: from t = [0-9.]* s on the run is wrong.* steps of ${step}[0-9]* s .* keep '[a-z_.]*' \\(moving\\|still\\), which small ones"
            check "$what, $step s: a remedy" says 'remedy: take .*, or shorter steps'
        else
            check "$what, $step s: good" exits 0
            check "$what, $step s: quiet" quiet
        fi
    done
done <<'END'
hmmwv_tires tires_park ros2 4 22.4 0.014 0.007 -
hmmwv_tires tires_park ros3 4 22.4 0.014 0.007 -
hmmwv_tires tires_park imex 4 22.4 0.014 0.007 -
hmmwv_tires tires_park exp3 4 22.4 0.014 0.007 -
hmmwv_tires tires_brake exp3 1 19.2 0.006 0.004 -
hmmwv_tires tires_brake exp3 1 19.2 0.008 0.004 -
END
# what they damp, or follow roughly, is none of that
for way in 'ros2 6 -' 'ros3 6 -' 'imex 6 keep_jacobian:_16' 'exp3 6 -'; do
    # shellcheck disable=SC2086  # words
    set -- $way
    scene full_run "$1" "$2" 0.006 30 0.12
    [ "$3" = - ] || echo "$3" | tr _ ' ' | sed 's/keep /keep_/' >>"$work/full_run.scene"
    run -q --engine tcc "$models/hmmwv_vehicle.veh" "$work/full_run.scene" -o "$work/run.csv"
    check "full_run, $way: good" exits 0
    check "full_run, $way: quiet" quiet
    scene tires_rough "$1" 4 0.004 4.8 0.12
    [ "$1" = exp3 ] || echo 'keep_jacobian: 8' >>"$work/tires_rough.scene"
    run -q --engine tcc "$models/hmmwv_tires.veh" "$work/tires_rough.scene" -o "$work/run.csv"
    check "a rough road, $1, a Jacobian for 8 steps: good" exits 0
    check "a rough road, $1: quiet" quiet
done

# Nothing changes by being watched: runs of fewer than 50 steps are not, and are the beginning of longer ones, in which
# both windows of 25 steps have something to keep.
for how in 'ab3 6 0.01 tcc' 'ab3 1 0.004 tape' 'rk4 1 0.017 tcc' 'ab3 6 0.01 gic' 'ab3 6 0.01 gcp1'; do
    # shellcheck disable=SC2086  # words
    set -- $how
    for steps in 49 75; do
        scene tires_park "$1" "$2" "$3" "$(awk "BEGIN {print $steps * $3}")" "$3"
        run -q --engine "$4" "$models/hmmwv_tires.veh" "$work/tires_park.scene" -o "$work/$steps.csv"
    done
    head -n 50 "$work/75.csv" >"$work/watched.csv"
    head -n 50 "$work/49.csv" >"$work/alone.csv"
    check "$how: the same bits" cmp "$work/watched.csv" "$work/alone.csv"
    check "$how: of a run that is watched closely" exits 1
done

# no scene of the folder has steps that are too long
tried=' '
while read -r model scenes; do
    for file in $scenes; do
        run -q --engine tcc "$models/$model.veh" "$models/scenes/$file.scene" -o "$work/run.csv"
        check "$model, $file: good" exits 0
        check "$model, $file: quiet" quiet
        tried="$tried$file "
    done
done <<'END'
hmmwv_vehicle acceleration_braking coasting constant_steer cruise full_run lane_change parked roll_over steady_circle
hmmwv_vehicle step_steer straight
hmmwv_tires tires_brake tires_coast tires_jump tires_park tires_rough
hmmwv_tmeasy tires_brake tires_coast tires_jump tires_park tires_rough
hmmwv paper_run rough_road suspension_rig spin field_track
formula_student formula_student_acceleration formula_student_skid_pad
motorcycle motorcycle_circle motorcycle_lane_change
semitrailer semitrailer_braking semitrailer_lane_change semitrailer_turn
hatchback hatchback_braking hatchback_lane_change hatchback_rough_road
hmmwv_full hmmwv_full
hmmwv14 hmmwv14
five_link five_link
solid_axle solid_axle
trailing_arm trailing_arm
andrews andrews
quarter_car quarter_car
pendulum pendulum
END
for file in "$models"/scenes/*.scene; do
    file=$(basename "$file" .scene)
    check "$file is among them" [ "${tried#* "$file" }" != "$tried" ]
done

# In a sweep such a run has the status of an unstable one, whether runs go each by itself, as those with tires do, or
# in lanes: both look at the same steps.
# sweep MODEL SCENE VARIED [OPTION...]: status and time of each of two runs
sweep() {
    model=$1
    scene=$2
    varied=$3
    shift 3
    "$gicsweep" "$@" "$models/$model.veh" "$work/$scene.scene" --vary "$varied" -o "$work/sweep.csv" 2>"$work/err"
    sed 1d "$work/sweep.csv" | cut -d, -f3,4 | tr '\n' ' '
    mv "$work/sweep.csv" "$work/last.csv"
}
unstable=$(sed -n 's/.*X(GIC_ERROR_UNSTABLE, \(-[0-9]*\),.*/\1/p' "$models/../runtime/gic_runtime.h")
# model, scene, varied; step and duration that are too long, step and duration that are good, integrator, time of outputs
while read -r model scene varied method long long_end good good_end output; do
    for how in "" "--cc /nonexistent"; do
        scene "$scene" "$method" 1 "$long" "$long_end" "$(awk "BEGIN {print $output * $long}")"
        # shellcheck disable=SC2086  # words
        found=$(sweep "$model" "$scene" "$varied" $how)
        check "a sweep of $model, $long s $how: unstable" [ "$found" = "$unstable,$long_end $unstable,$long_end " ]
        check "a sweep of $model, $long s $how: time and quantity" says "first is run 0: from t = .* s on the run is unstable.*: '"
        check "a sweep of $model, $long s $how: a remedy" says "remedy: take steps of at most about 0.0"
        [ -z "$how" ] || check "the same bytes, $long s" cmp "$work/last.csv" "$work/before.csv"
        mv "$work/last.csv" "$work/before.csv"
    done
    scene "$scene" "$method" 1 "$good" "$good_end" "$(awk "BEGIN {print $output * $good}")"
    check "a sweep of $model, $good s: good" [ "$(sweep "$model" "$scene" "$varied")" = "0,$good_end 0,$good_end " ]
done <<'END'
hmmwv_tmeasy tires_park brake=0.6:0.7:2 rk4 0.024 4.8 0.016 4.8 10
hmmwv rough_road speed=10:15:2 ab3 0.011 5.5 0.0095 4.75 20
END

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
