#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tuning.sh GICGEN GICRUN STATES REFERENCE AGREE: tunable geometry. Generated code that is set up with random values of its
# parameters does what the file with those values baked in says: accelerations, poses and reactions, with the equations of
# motion in either form, against the quad-precision reference on the dump of the baked file, and all outputs against the baked
# file's own code.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# gicrun's own flags for what is compared with the baked file; the others compile in a quarter of the time without
# optimization
echo "exec ${CC:-cc} \"\$@\" -O0" >cc

# draw FILE SEED: FILE with a value for each tunable parameter from between the two numbers behind it, no longer tunable;
# names and values in columns.csv. What is mirrored gets another value on the right.
draw() {
    sed "s|file: \.\./\.\./\.\.|file: $root|; s|^include: \.\./\.\./\.\.|include: $root|" "$1" |
        awk -v seed="$2" -v OFMT=%.17g -v CONVFMT=%.17g '
            BEGIN { srand(seed) }
            /tunable: true/ {
                name = $1
                sub(/:/, "", name)
                low = $(NF - 1)
                high = $NF
                sides = name ~ /_l$/ ? 2 : 1
                for (side = 1; side <= sides; ++side) {
                    value = sprintf("%.12g", low + rand() * (high - low))
                    line = $0
                    sub(/value: [^,}]*/, "value: " value, line)
                    sub(/, tunable: true/, "", line)
                    if (side == 2) {
                        sub(/_l$/, "_r", name)
                        sub(/_l:/, "_r:", line)
                    }
                    print line
                    names = names "," name
                    values = values "," value
                }
                next
            }
            { print }
            END { print names "\n" values >"columns.csv" }'
}

# same A B: no cell of two tables differs by more than 1e-12 of the largest magnitude in its row and kind of column, 1e-11 where
# that is an energy (the work of 2 t through 1 m against a gram)
same() {
    paste -d '\n' "$1" "$2" | awk -F, '
        NR == 1 { for (i = 1; i <= NF; ++i) name[i] = $i }
        NR > 2 && NR % 2 { for (i = 1; i <= NF; ++i) a[i] = $i }
        NR > 2 && !(NR % 2) {
            scale = 1
            for (i = 1; i <= NF - 3; ++i) if (name[i] !~ /^output/) { x = a[i] < 0 ? -a[i] : a[i]; if (x > scale) scale = x }
            for (i = 1; i <= NF - 3; ++i) {
                x = a[i] < 0 ? -a[i] : a[i]
                d = a[i] - $i
                if (d < 0) d = -d
                limit = 1e-12 * (x > scale ? x : scale)
                if (a[i] == "" || $i == "" || d > limit) { bad = 1; if (shown++ < 5) print name[i], a[i], $i }
            }
        }
        END { exit bad || NR < 4 }'
}

for model in car rig hand; do
    tuned=$root/tests/data/tuning/$model.veh
    for seed in 1 2 3; do
        draw "$tuned" "$seed" >baked.veh
        "$gicgen" --dump-model baked.veh >dump && "$states" dump --count 12 --seed "$seed" -o states.csv &&
            "$reference" dump states.csv -o accelerations.csv 2>/dev/null
        awk 'NR == FNR { column[NR] = $0; next } { print $0 column[FNR == 1 ? 1 : 2] }' columns.csv states.csv >tuned.csv
        "$gicrun" --eval tuned.csv "$tuned" -o results.csv &&
            "$gicrun" --eval states.csv baked.veh -o baked.csv && same baked.csv results.csv
        verdict $? "$model, values $seed: set up with them, against the values baked in"
        sh "$root/tests/lib/reactions.sh" dump "$tuned" >reacting.veh
        for solve in reduced augmented; do
            "$gicrun" --cc "sh $work/cc" --solve $solve --eval tuned.csv reacting.veh -o results.csv &&
                "$agree" dump accelerations.csv results.csv --reactions >said
            verdict $? "$model, values $seed, $solve form: set up with them, against the reference"
            tail -n 1 said
        done
    done
done

# what set-up says, in C, in single precision and in C++
for model in car hand; do
    "$gicgen" "$root/tests/data/tuning/$model.veh" -o "$model.c" || failed=$((failed + 1))
done
# the header names each with its unit in the file
sed -n 's/^  \([a-z_]*\): {value: .*unit: \([^,]*\), tunable.*/\1 \2/p' "$root/tests/data/tuning/car.veh" >units
named() {
    while read -r name unit; do
        grep -q "^ *CAR_PARAMETER_$(echo "$name" | tr '[:lower:]' '[:upper:]') = [0-9]*, /\* $unit \*/$" car.h ||
            { echo "$name [$unit] is not in the header" && return 1; }
    done <units
    [ "$(wc -l <units)" -gt 9 ]
}
named
verdict $? "units of parameters in the header"
for how in "cc -std=c99" "cc -std=c99 -DGIC_FLOAT" "c++ -x c++" "c++ -x c++ -DGIC_FLOAT"; do
    $how -O1 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -ffp-contract=off -I. -I"$root/runtime" \
        "$root/tests/data/tuning/statuses.c" car.c hand.c "$root/runtime/gic_runtime.c" -x none -lm -o statuses && ./statuses
    verdict $? "$how: what set-up says"
done

# a scene's parameters are the model's with those values: the same run to rounding, from the state that they move
draw "$root/tests/data/tuning/rig.veh" 4 >baked.veh
printf 'gicscene: 1\nduration: 0.2\nstep: 0.002\nintegrator: rk4\noutput_step: 0.2\n' >baked.scene
{
    cat baked.scene
    awk -F, '{ for (i = 2; i <= NF; ++i) if (NR == 1) name[i] = $i; else text = text (i > 2 ? ", " : "") name[i] ": " $i }
        END { print "parameters: {" text "}" }' columns.csv
} >tuned.scene
"$gicrun" --quiet baked.veh baked.scene -o baked.csv &&
    "$gicrun" --quiet "$root/tests/data/tuning/rig.veh" tuned.scene -o results.csv &&
    paste -d '\n' baked.csv results.csv | awk -F, '
        NR % 2 { for (i = 1; i <= NF; ++i) a[i] = $i }
        NR > 2 && !(NR % 2) { for (i = 1; i <= NF; ++i) { d = a[i] - $i; x = a[i]
            if (d * d > 1e-18 * (1 + x * x)) { print "column " i ": " a[i] " " $i; bad = 1 } } }
        END { exit bad || NR < 6 }'
verdict $? "parameters of a scene"

# where coordinates begin at their design, what set-up has assembled is what everything goes on from: the first outputs,
# by engines that keep recoveries, against the interpreted one, which keeps none, to 1e-9
sed "s/, initial: lift//; s|\.\./\.\./\.\./models|$root/models|" "$root/tests/data/tuning/rig.veh" >rest.veh
printf 'gicscene: 1\nduration: 0.004\nstep: 0.002\noutput_step: 0.002\nparameters: {tie: 0.395}\n' >rest.scene
"$gicrun" --quiet --engine gic rest.veh rest.scene -o sound.csv
verdict $? "set up at the design: gic"
for how in 'tcc' 'cc' 'tape' 'tcc --recovery newton' 'tcc --solve augmented' 'cc --lanes 2'; do
    # shellcheck disable=SC2086  # words
    "$gicrun" --quiet --engine $how rest.veh rest.scene -o found.csv && paste -d, sound.csv found.csv | awk -F, '
        NR > 1 { n = NF / 2; for (i = 1; i <= n; ++i) { d = $i - $(n + i); x = $i; if (!(d * d <= 1e-18 * (1 + x * x))) bad = 1 } }
        END { exit bad || NR < 3 || n < 3 }'
    verdict $? "set up at the design: $how"
done

# on a rig, whose base is held elsewhere than it is drawn, a quarter turn aside and leaning: the drawing moves with it. The
# interpreted engine on the baked file judges; to 1e-11 of 1 + the largest of a column, as rounding grows in 250 steps
same_run() {
    paste -d , "$1" "$2" | awk -F, 'NR == 1 { n = NF / 2; for (i = 1; i <= n; ++i) if ($i != $(i + n)) bad = 1; next }
        { for (i = 1; i <= n; ++i) { d = $i - $(i + n); x = $i < 0 ? -$i : $i; s = $i $(i + n)
            if (s ~ /[a-z]/ && s !~ /e-/ || !(d <= 1e-11 * (1 + x) && d >= -1e-11 * (1 + x))) bad = 1 } }
        END { exit bad || NR != 7 || n != 13 }'
}
draw "$root/tests/data/tuning/car.veh" 6 >baked.veh
cat >baked.scene <<'END'
gicscene: 1
duration: 0.5
step: 0.002
output_step: 0.1
integrator: rk4
base: fixed
initial: {position: [0.5, -1, 0.5], orientation: {yaw: 1.5707963267948966, roll: 0.1}}
driven: {rack: {sine: {amplitude: 0.01, frequency: 0.5, offset: 0.002, start: -2}}}
outputs: [chassis, wheel_f_l, wheel_r_r, spring_f_l]
END
{
    cat baked.scene
    awk -F, '{ for (i = 2; i <= NF; ++i) if (NR == 1) name[i] = $i; else text = text (i > 2 ? ", " : "") name[i] ": " $i }
        END { print "parameters: {" text "}" }' columns.csv
} >tuned.scene
"$gicrun" --quiet --engine gic baked.veh baked.scene -o baked.csv
verdict $? "on a rig: the baked file"
for how in "--engine gic" "--general" "--engine tcc"; do
    # shellcheck disable=SC2086  # a list of words
    "$gicrun" --quiet $how "$root/tests/data/tuning/car.veh" tuned.scene -o results.csv && same_run baked.csv results.csv
    verdict $? "on a rig: $how"
done
# the code of gicgen for this scene, in a program of one's own
{
    printf '#include "rigged.h"\n#include <math.h>\n#include <stdio.h>\nstatic const double value[CAR_PARAMETERS] = {'
    awk -F, 'NR == 1 { for (i = 2; i <= NF; ++i) name[i] = $i }
        NR == 2 { for (i = 2; i <= NF; ++i) printf "[CAR_PARAMETER_%s] = %s, ", toupper(name[i]), $i }' columns.csv
    cat <<'END'
};
static void drive(void *user, int32_t lane, double time, double *input)
{
    const double w = 3.141592653589793;
    (void)user, (void)lane;
    input[CAR_INPUT_RACK] = 0.002 + 0.01 * sin(w * time);
    input[CAR_INPUT_RACK_RATE] = 0.01 * w * cos(w * time);
    input[CAR_INPUT_RACK_ACCELERATION] = -0.01 * w * w * sin(w * time);
}
int main(void)
{
    static car rig;
    int status = car_setup_with(&rig, value);
    rig.head.input_function = drive;
    for (int i = 0; i <= 250 && status == GIC_OK; ++i) {
        if (i % 50 == 0 && (status = car_outputs(&rig)) == GIC_OK) {
            printf("%.17g", car_time(&rig));
            for (int k = 0; k < CAR_OUTPUTS; ++k)
                printf(",%.17g", rig.output[k]);
            printf("\n");
        }
        if (i < 250 && status == GIC_OK)
            status = car_step(&rig, 0.002, GIC_RK4);
    }
    return status;
}
END
} >rigged_main.c
head -n 1 baked.csv >results.csv
"$gicgen" --scene tuned.scene "$root/tests/data/tuning/car.veh" -o rigged.c &&
    cc -std=c99 -O1 -ffp-contract=off -Wall -Wextra -Werror -I. -I"$root/runtime" rigged_main.c rigged.c "$root/runtime/gic_runtime.c" -lm \
        -o rigged && ./rigged >>results.csv && same_run baked.csv results.csv
verdict $? "on a rig: the code of gicgen"
# on a post
sed "/^base:/d; /^initial:/d; /^driven:/d; s/^duration.*/duration: 0.1/; s/^output_step.*/output_step: 0.02/" tuned.scene >posts.scene
echo 'posts: {tire_f_l: {sine: {amplitude: 0.01, frequency: 2}}}' >>posts.scene
"$gicrun" --quiet --engine gic "$root/tests/data/tuning/car.veh" posts.scene -o other.csv &&
    "$gicrun" --quiet --engine tcc "$root/tests/data/tuning/car.veh" posts.scene -o results.csv && same_run other.csv results.csv &&
    "$gicgen" --scene posts.scene "$root/tests/data/tuning/car.veh" -o rigged.c
verdict $? "on a post"

# a vehicle that leaves a batch finds no recovery of what the instance was before
"$gicgen" "$root/tests/data/tuning/car.veh" -o car.c && "$gicgen" --batch 4 "$root/tests/data/tuning/car.veh" -o car_batch.c &&
    cc -std=c11 -O1 -ffp-contract=off -w -I. -I"$root/runtime" "$root/tests/data/tuning/store.c" car.c car_batch.c \
        "$root/runtime/gic_runtime.c" -lm -o store && ./store
verdict $? "a vehicle from a batch into a used instance"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
