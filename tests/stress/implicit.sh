#!/bin/sh
# SPDX-License-Identifier: MIT
# implicit.sh GICRUN: steps of ros2 and ros3 from 1 ms to 10 s on every model, with one Jacobian a step and for many
#
# From where it is drawn, and with rates. A run ends, with finite results, or with its time, what is wrong and a remedy;
# the longest step that is good, and the shortest that is not, are told.
gicrun=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
models=$(echo models/*.veh)
[ "$STRESS" != short ] || models="models/quarter_car.veh models/pendulum.veh models/andrews.veh models/hmmwv.veh models/hmmwv_tires.veh"
for model in $models; do
    tried=0
    good=0
    longest=0
    shortest=none
    verdict=ok
    for step in 0.001 0.003 0.01 0.03 0.1 0.3 1 10; do
        for integrator in ros2 ros3; do
            for keep in 1 8; do
                awk -v h=$step 'BEGIN { printf "gicscene: 1\nstep: %s\noutput_step: %s\nduration: %.6g\n", h, h, 20 * h }' >"$work/now.scene"
                printf 'integrator: %s\nkeep_jacobian: %s\n' $integrator $keep >>"$work/now.scene"
                tried=$((tried + 1))
                timeout 300 "$gicrun" -q --engine tcc "$model" "$work/now.scene" -o "$work/out.csv" 2>"$work/err"
                status=$?
                if grep -qiw 'nan\|-nan\|inf\|-inf' "$work/out.csv"; then
                    verdict="no number in the results of $integrator, $step s"
                elif [ $status -eq 0 ]; then
                    good=$((good + 1))
                    longest=$(awk -v a="$longest" -v b=$step 'BEGIN { print (b > a ? b : a) }')
                elif [ $status -eq 1 ] && grep -q 'remedy: ' "$work/err" &&
                    grep -Eq "(the run ends at t = [0-9.e+-]* s: |is unstable)" "$work/err"; then
                    shortest=$(awk -v a="$shortest" -v b=$step 'BEGIN { print (a == "none" || b < a ? b : a) }')
                else
                    verdict="$integrator, $step s, status $status: $(head -n 1 "$work/err")"
                fi
            done
        done
    done
    [ "$verdict" = ok ] || found=1
    echo "implicit steps | $(basename "$model" .veh) | $tried | $good | $((tried - good)) | longest good step $longest s, shortest refused $shortest s | $verdict"
done
exit $found
