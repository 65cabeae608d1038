#!/bin/sh
# SPDX-License-Identifier: MIT
# test_residual.sh GICGEN GICRUN GICSWEEP GICRUN_WRONG_POSE GICRUN_WRONG_VELOCITY GICRUN_WRONG_ACCELERATION GICRUN_WRONG_RATE: an
# error in a pose, a velocity, an acceleration or a rate ends in GIC_ERROR_RESIDUAL (-15), whichever way code is generated
# and run: by cc, tcc and the tape, in closed form and by Newton's iteration, reduced and augmented, for a scene and for
# all, in lanes and batches, in single precision, from set-up, steps, right-hand sides, outputs, poses and the self-test.
# The errors are planted (GIC_PLANT_* of the templates); code without them passes.
gicgen=$(realpath "$1")
right=$(realpath "$2")
gicrun=$right
gicsweep=$(realpath "$3")
# shellcheck disable=SC2034  # `eval` uses them, by the name of the error
{
    wrong_pose=$(realpath "$4")
    wrong_velocity=$(realpath "$5")
    wrong_acceleration=$(realpath "$6")
    wrong_rate=$(realpath "$7")
}
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
GICGEN_CACHE=
export GICGEN_CACHE
cc=${CC:-cc}
# gicrun's own -O2 comes after what --cc says; errors are found at the first steps, and compiling takes the time
echo "exec $cc \"\$@\" -O0" >cc.sh
unoptimized="sh $work/cc.sh"
model=$root/models/hmmwv.veh
scene=$root/models/scenes/paper_run.scene
text="are not fulfilled: the code has an error"
# rates of the HMMWV: r 3, e 4, four springs and the rack 5, v 3, omega 3, five rates
base=12
spring=18

# fails NAME PROGRAM OPTION...: a run ends with the status
fails() {
    name=$1
    gicrun=$2
    shift 2
    run "$@" -o results.csv
    check "$name: exit status" exits 1
    check "$name: message" says "$text"
}

# ---- gicrun: errors from the beginning --------------------------------------------------------------------------------

for engine in tcc tape; do
    for way in "" "--general" "--recovery newton" "--solve augmented"; do
        for error in pose velocity acceleration rate; do
            case $way/$error in --[rs]*/velocity | --[rs]*/acceleration) continue ;; esac
            eval "planted=\$wrong_$error"
            # shellcheck disable=SC2086,SC2154  # options are words
            fails "$engine $way: $error" "$planted" --engine $engine $way "$model" "$scene"
        done
    done
done
gicrun=$right
for way in "" "--general" "--recovery newton" "--solve augmented" "--lanes 4"; do
    for plant in MOTION=1 MOTION=24 MOTION=18 RATE=0 RATE=4 RATE=$base RATE=$spring; do
        case $way/$plant in # one of each is enough where an optimizing compiler is slow
        /*) ;;
        *MOTION=1 | *RATE="$spring") ;;
        *) continue ;;
        esac
        # shellcheck disable=SC2086
        fails "cc $way: $plant" "$right" --engine cc --cc "$unoptimized" $way --cflags "-DGIC_PLANT_$plant" "$model" "$scene"
    done
done

# ---- an error that begins under way: not only outputs look -------------------------------------------------------------

sed 's/^output_step: .*/output_step: 4/' "$scene" >late.scene
sed 's/ab3/rk4/' late.scene >late_rk4.scene
for late in late late_rk4; do
    fails "$late" "$right" --engine cc --cc "$unoptimized" --general --cflags "-DGIC_PLANT_RATE=$spring -DGIC_PLANT_AFTER=0.5" \
        "$model" $late.scene
    # no later than 200 evaluations on
    time=$(sed -n 's/.*the run ends at t = \([0-9.]*\) s.*/\1/p' err)
    awk "BEGIN { exit !($time >= 0.5 && $time <= 0.5 + 202 * 0.005) }"
    verdict $? "$late: found at $time s"
done

# ---- rows of states -----------------------------------------------------------------------------------------------------

printf 'angle,angle.rate\n0,0\n1,2\n-0.5,1\n' >states.csv
run --eval states.csv --engine cc --cc "$unoptimized" "$root/models/pendulum.veh" -o rows.csv
check "rows of states" exits 0
for plant in MOTION=3 RATE=1; do
    run --eval states.csv --engine cc --cc "$unoptimized" --cflags "-DGIC_PLANT_$plant" "$root/models/pendulum.veh" -o rows.csv
    check "rows of states, $plant: exit status" exits 1
    check "rows of states, $plant: message" says "in 3 of 3 rows .*$text"
    [ "$(cut -d, -f1 rows.csv | tail -n 3 | tr -d '\n')" = "" ] && [ "$(grep -c -- ',-15,' rows.csv)" -eq 3 ]
    verdict $? "rows of states, $plant: no results, status -15"
done

# ---- sweeps: in lanes and one by one -------------------------------------------------------------------------------------

printf 'gicscene: 1\nduration: 0.5\nstep: 0.005\noutput_step: 0.1\noutputs: [chassis.z]\ninitial: {speed: 5}\n' >sweep.scene
for engine in "" "--engine cc"; do
    for plant in NOTHING MOTION=1 "RATE=$spring"; do
        rm -f sweep.csv*
        # shellcheck disable=SC2086
        OMP_NUM_THREADS=1 "$gicsweep" -q $engine --cc "$unoptimized" --cflags "-DGIC_PLANT_$plant" --vary speed=4:6:6 "$model" \
            sweep.scene -o sweep.csv >out 2>err
        expected=-15
        [ "$plant" = NOTHING ] && expected=0
        awk -F, -v expected="$expected" 'NR > 1 && $3 != expected { ++other } END { exit !(NR == 7 && !other) }' sweep.csv
        verdict $? "sweep $engine $plant: status of every run"
    done
done

# ---- a program of one's own: which function, and what is left ------------------------------------------------------------

cat >own.c <<'XXX'
#include "hmmwv.h"

#include <stdio.h>
#include <string.h>

static hmmwv car, before;

/* Which functions end with GIC_ERROR_RESIDUAL: letters. Prints "!" where one changed what it must not. */
int main(void)
{
    gic_real rate[HMMWV_STATES], state[HMMWV_STATES], pose[7 * HMMWV_BODIES + 7];
    gic_self_test test;
    int i;
    if (hmmwv_setup(&car) == GIC_ERROR_RESIDUAL)
        putchar('s');
    hmmwv_snapshot(&car, &before);
    for (i = 0; i < HMMWV_STATES; ++i) {
        rate[i] = 7;
        state[i] = car.state[i];
    }
    if (hmmwv_rhs(&car, 0, state, rate) == GIC_ERROR_RESIDUAL) {
        putchar('r');
        for (i = 0; i < HMMWV_STATES; ++i)
            if (rate[i] != 7)
                putchar('!');
    }
    if (hmmwv_step(&car, (gic_real)0.001, GIC_RK4) == GIC_ERROR_RESIDUAL)
        putchar('k');
    if (hmmwv_step(&car, (gic_real)0.001, GIC_AB3) == GIC_ERROR_RESIDUAL) {
        putchar('a');
        if (hmmwv_time(&car) != 0 || memcmp(car.state, before.state, sizeof car.state) || car.head.flip != before.head.flip)
            putchar('!');
    }
    if (hmmwv_outputs(&car) == GIC_ERROR_RESIDUAL)
        putchar('o');
    if (hmmwv_poses(&car, pose) == GIC_ERROR_RESIDUAL)
        putchar('p');
    if (hmmwv_self_test(&car, &test) == GIC_ERROR_RESIDUAL)
        putchar('t');
    printf("%s\n", test.constraint > 1e-4 ? " constraint" : test.motion > 1e-4 ? " motion" : "");
    return 0;
}
XXX
cp "$root"/runtime/gic_runtime.[ch] .
for way in newton closed; do # single precision has other limits
    "$gicgen" --recovery $way "$model" -o hmmwv.c || exit 1
    for real in "" "-DGIC_FLOAT" "-DGIC_RECOVERY_ERROR=1e-6"; do
        [ "$way$real" = "closed-DGIC_RECOVERY_ERROR=1e-6" ] && continue
        for plant in NOTHING=1 MOTION=1 MOTION=24 MOTION=18 RATE=$base; do
            case $plant in
            NOTHING*) expected="" ;;
            MOTION=1) expected="srkaopt constraint" ;;
            MOTION*) expected="srkaopt motion" ;;
            RATE*) expected="rkaot" ;;
            esac
            by=1e-3
            case $real/$plant in *FLOAT/MOTION=1) ;; *FLOAT*) by=0.1 ;; esac
            # shellcheck disable=SC2086
            $cc -std=c99 $real "-DGIC_PLANT_$plant" "-DGIC_PLANT_BY=R($by)" -o own own.c hmmwv.c gic_runtime.c -lm 2>err && found=$(./own)
            [ "$found" = "$expected" ]
            verdict $? "own program, $way $real $plant: '$found', not '$expected'"
        done
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
