#!/bin/sh
# SPDX-License-Identifier: MIT
# test_driveline.sh GICGEN GICRUN STATES REFERENCE AGREE: powertrains. All that they compute at ROWS (default 60) random
# states, with generated code and the interpreted engines, against the independent reference in quad precision; runs of
# the engines against generated code; every change of gear along runs against POWERTRAIN.md section 4.
#
# Tolerances. States: generated code within 1e-12, interpreted engines 1e-10, as in test_accelerations.sh and
# test_engines.sh. Runs: gic 1e-9 of the largest value of an output, or of 1 (of a torque 1000) where that is larger,
# for it makes the same steps; gcp1 integrates other coordinates, with errors that variable steps keep at 1e-9 each.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
rig=$root/tests/data/powertrain/rig.veh
car=$root/models/hmmwv_vehicle.veh

# what is on trial is not the compiler
echo "exec ${CC:-cc} \"\$@\" -O0" >cc
cc="sh $work/cc"

# ---- states -----------------------------------------------------------------------------------------------------

for model in "$rig" "$car"; do
    "$gicgen" --dump-model "$model" >dump 2>said &&
        "$states" dump --count "${ROWS:-60}" --seed 1 -o states.csv 2>said &&
        { sh "$root/tests/lib/reactions.sh" dump "$model" && sh "$root/tests/lib/wheels.sh" dump; } >variant.veh &&
        "$reference" dump states.csv -o accelerations.csv 2>said
    verdict $? "reference at states of $model"
    for engine in cc:1e-12 gic:1e-10 gcp1:1e-10 gcp2:1e-10; do
        "$gicrun" --engine "${engine%:*}" --cc "$cc" --eval states.csv variant.veh -o results.csv >said 2>&1 &&
            "$agree" dump accelerations.csv results.csv --reactions --wheels --tolerance "${engine#*:}" >said
        verdict $? "${engine%:*} at states of $model"
    done
done

# a lock below 0 is none, and a number below 0 a mistake
sed "s/lock: 100 + 300 \* grip/lock: -100 - 300 * grip/" "$rig" >below.veh
sed "s/, lock: 100 + 300 \* grip//" "$rig" >open.veh
"$gicgen" --dump-model open.veh >open.dump 2>said && "$states" open.dump --count 20 --seed 2 -o open_states.csv 2>said
for engine in tape gic; do
    "$gicrun" -q --engine $engine --eval open_states.csv open.veh -o open.csv >said 2>&1 &&
        "$gicrun" -q --engine $engine --eval open_states.csv below.veh -o below.csv >said 2>&1 && [ -s open.csv ] && cmp open.csv below.csv >said
    verdict $? "a lock below 0 by $engine"
done
sed "s/lock: 100 + 300 \* grip/lock: -20/" "$rig" >mistaken.veh
"$gicgen" --dump-model mistaken.veh >mistaken.dump 2>said
[ $? -eq 1 ] && grep -q 'must not be negative, as -20 is' said
verdict $? 'a number below 0'

# what a table of states leaves out is as at set-up: the engine idles, in first gear
cut_columns() {
    awk -F, -v without="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) keep[i] = $i !~ without }
        { line = ""; for (i = 1; i <= NF; ++i) if (keep[i]) line = line (line == "" ? "" : ",") $i; print line }' "$2"
}
cut_columns '^(engine|transmission)\\.' states.csv >short.csv
awk 'NR == 1 { print $0 ",engine.speed,transmission.age,transmission.gear,transmission.before"; next }
    { printf "%s,%.17g,100,1,1\n", $0, 800 * 0.10471975511965977 }' short.csv >long.csv
for engine in cc gic gcp1; do
    "$gicrun" --engine $engine --cc "$cc" --eval short.csv "$car" -o short.out >said 2>&1 &&
        "$gicrun" --engine $engine --cc "$cc" --eval long.csv "$car" -o long.out >said 2>&1 &&
        cmp short.out long.out >said && ! cut_columns '^status|^message' short.out | grep -q ',,'
    verdict $? "$engine: missing columns are as at set-up"
    sed 's/,1,1$/,4,1/' long.csv >none.csv
    "$gicrun" --engine $engine --cc "$cc" --eval none.csv "$car" -o none.out >said 2>&1
    [ "$(grep -c ',-2,' none.out)" -eq "$(($(wc -l <none.csv) - 1))" ]
    verdict $? "$engine: a gear that does not exist"
done

# ---- runs -------------------------------------------------------------------------------------------------------

# near A B WITHIN: two results files, column by column
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

# shifts FILE GEARS REVERSE DURATION LATENCY SELECTOR UP DOWN: does the gear in results at every step follow from the
# turbine's speeds as POWERTRAIN.md section 4 has it, and does it change at least five times? A change is somewhere in the
# step before its row, so that the time since is known but for a step, and either of its bounds may decide. GEARS: how many forward
# ones; the last three are awk expressions of columns c["name"], UP and DOWN of the lower gear g of the two as well.
shifts() {
    awk -F, '
        NR == 1 {
            for (i = 1; i <= NF; ++i) {
                sub(/ .*/, "", $i)
                name[i] = $i
            }
            next
        }
        {
            for (i = 1; i <= NF; ++i)
                c[name[i]] = $i
            found = c["line.gear"]
            if (NR == 2) {
                gear = found
                began = before = -100
            }
            selector = '"$6"'
            wanted = selector > 0.5 ? 1 : selector < -0.5 ? -'"$3"' : 0
            for (side = 0; side < 2; ++side) {
                age = c["time"] - (side ? before : began)
                now = gear
                if (NR > 2 && age > '"$4"' - 1e-9) {
                    if (wanted != (gear > 0) - (gear < 0))
                        now = wanted
                    else if (age > '"$5"' - 1e-9 && gear > 0) {
                        g = gear - 1
                        if (g > 0 && c["line.turbine_speed"] < ('"$8"'))
                            now = gear - 1
                        g = gear
                        if (g < '"$2"' && c["line.turbine_speed"] > ('"$7"'))
                            now = gear + 1
                    }
                }
                if (found == now)
                    break
            }
            if (found != now) {
                print "at " c["time"] " gear " found " and not " now
                exit bad = 1
            }
            if (found != gear) {
                began = c["time"]
                before = last
                ++changes
            }
            last = c["time"]
            gear = found
        }
        END {
            if (!bad)
                print changes + 0, "changes of gear"
            exit bad || changes < 5
        }' "$1"
}

# wanting OUTPUTS MODEL: a model that includes another
wanting() {
    printf 'gicgen: 1\ninclude: %s\nmodel: wanting\noutputs:\n  line: {type: powertrain}\n%s' "$2" "$1"
}
wanting '  x: {type: position, body: chassis}
  v: {type: velocity, body: chassis}
  left: {type: tire, wheel: tire_f_l}
  right: {type: tire, wheel: tire_r_r}
' "$car" >car.veh
wanting '  pitch: {type: coordinate, coordinate: pitch}
  left: {type: tire, wheel: left}
  hind: {type: tire, wheel: hind}
' "$rig" >rig.veh

# up and down through all gears, into reverse, neutral and forward again
cat >drive.scene <<'END'
gicscene: 1
duration: 16.1
step: 0.0023
initial: {speed: 2, gear: 2, states: {engine.speed: 150}}
inputs:
  accelerator: {knots: {times: [0.2, 0.5, 7, 7.5], values: [0, 1, 1, 0]}}
  brake: {knots: {times: [7.5, 8, 11, 11.5], values: [0, 0.7, 0.7, 0]}}
  selector: {knots: {times: [12, 12.5, 13.5, 14, 14.7, 15], values: [1, -1, -1, 0, 0, 1]}}
outputs: [line, x, v, left, right, input.selector]
END
# speeds of shifts that follow the accelerator and a coordinate; the carriage is nearly held, so wheels spin
cat >shift.scene <<'END'
gicscene: 1
duration: 7
step: 0.0005
integrator: rk4
initial: {states: {engine.speed: 100}, rates: {pitch: 0.1}}
inputs:
  accelerator: {knots: {times: [0.1, 0.3, 3, 3.5, 5.8, 6], values: [0.2, 0.6, 0.6, 0.1, 0.1, 0.5]}}
  grip: {knots: {times: [4.5, 4.7, 5.4, 5.6], values: [0, 0.4, 0.4, 0]}}
outputs: [line, pitch, left, hind, input.accelerator, input.grip]
END

# through MODEL SCENE GEARS REVERSE DURATION LATENCY SELECTOR UP DOWN
through() {
    "$gicrun" --quiet --engine cc --cc "$cc" "$1" "$2" -o generated.csv >said 2>&1 &&
        shifts generated.csv "$3" "$4" "$5" "$6" "$7" "$8" "$9" >said
    verdict $? "$2 with generated code"
    "$gicrun" --quiet --engine gic "$1" "$2" -o interpreted.csv >said 2>&1 &&
        shifts interpreted.csv "$3" "$4" "$5" "$6" "$7" "$8" "$9" >said && near generated.csv interpreted.csv 1e-9 >said
    verdict $? "$2 with gic"
    "$gicrun" --quiet --engine gcp1 "$1" "$2" -o interpreted.csv >said 2>&1 &&
        shifts interpreted.csv "$3" "$4" "$5" "$6" "$7" "$8" "$9" >said && near generated.csv interpreted.csv 1e-4 >said
    verdict $? "$2 with gcp1"
}
through rig.veh shift.scene 4 0 0.4002 0.2 '1 - 2 * c["input.grip"]' \
    'g == 1 ? 300 : g == 2 ? 280 + 100 * c["input.accelerator"] : 300 + 50 * c["pitch.value"]' \
    'g == 1 ? 90 : g == 2 ? 100 + 50 * c["input.accelerator"] : 110'
through car.veh drive.scene 3 1 0.3 1 'c["input.selector"]' 261.79938779914943 125.66370614359172

# two rates; variable steps, at the ends of which gears change, so that what is rounding before is a step's length then
sed 's/^step: .*/step: 0.0046\nratio: 2/; s/^duration: .*/duration: 7.36/' drive.scene >dual.scene
"$gicrun" --quiet --engine cc --cc "$cc" car.veh dual.scene -o generated.csv >said 2>&1 &&
    "$gicrun" --quiet --engine gic car.veh dual.scene -o interpreted.csv >said 2>&1 &&
    near generated.csv interpreted.csv 1e-9 >said
verdict $? "dual rate with gic"
sed 's/^step: .*/output_step: 0.1/; s/^duration: .*/duration: 2/' drive.scene >variable.scene
for engine in cc gic; do
    "$gicrun" --quiet --engine $engine --cc "$cc" --integrator rkck --tolerance 1e-9 car.veh variable.scene \
        -o $engine.csv >said 2>&1
    verdict $? "variable steps with $engine"
done
for engine in cc gic; do
    awk -F, 'NR == 1 || $1 < 1.25' $engine.csv >$engine.before
    cut -d, -f5 $engine.csv >$engine.gear
done
near cc.before gic.before 1e-6 >said && cmp cc.gear gic.gear >said && [ "$(sort -u cc.gear | wc -l)" -eq 3 ]
verdict $? "variable steps agree until gear 2, which both reach in the same tenth of a second"

# ---- mistakes ---------------------------------------------------------------------------------------------------

# mistake MODEL CHANGE LINE:COLUMN TEXT: of sed at the scene drive.scene
mistake() {
    sed "$2" drive.scene >bad.scene
    "$gicrun" --engine tape "$1" bad.scene -o bad.csv >said 2>&1
    [ $? -eq 1 ] && grep -q "^bad.scene:$3: error: .*$4" said && [ ! -e bad.csv ]
    verdict $? "mistake: $4"
}
mistake car.veh 's/gear: 2/gear: 4/' 4:27 'gear must be a whole number from -1 to 3'
mistake car.veh 's/gear: 2/gear: 0.5/' 4:27 'gear must be a whole number from -1 to 3'
mistake "$root/models/hmmwv_tires.veh" 's/, states: .*/}/; /^ *accel/d; /^ *select/d; /^outputs/d' 4:27 'has no powertrain'
mistake car.veh 's/engine.speed/engine.age/' 4:39 "no fast state 'engine.age'"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
