#!/bin/sh
# SPDX-License-Identifier: MIT
# test_lanes.sh GICGEN: of every model that gicgen --batch does not refuse, vehicles in lanes have the bits of the code
# for one vehicle where both call libm: states, outputs, status; with lanes of any width, either number type, gcc and clang, threads, as C++.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

cp "$root"/runtime/gic_runtime.[ch] "$root/runtime/gic_batch.h" "$root/runtime/gic_lanes.h" "$root"/runtime/gic_road*.h "$root/tests/data/embed/lanes.c" "$work/"
# reactions are refused; what else tuned geometry moves is not
sed "s|\.\./\.\./\.\./models|$root/models|; /type: reaction/d" "$root/tests/data/tuning/car.veh" >"$work/car.veh"
cd "$work" || exit 1

# agrees MODEL.veh OPTIONS LANES COMPILER...: eight vehicles, LANES of them in a vector, have the same bits; $good of them
# have outputs at the end; $run runs programs of another processor
good=8
run=
agrees() {
    file=$1
    options=$2
    lanes=$3
    shift 3
    name=$(sed -n 's/^model: *//p' "$file")
    case $name in hatchback) step=0.00025 ;; *) step=0.001 ;; esac
    # shellcheck disable=SC2086  # a list of words
    "$gicgen" $options "$file" -o "$name.c" && "$gicgen" --batch 8 --lanes "$lanes" $options "$file" &&
        rm -f lanes && "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -ffp-contract=off -DGIC_BATCH_LIBM -DBATCH="${name}_batch_model" -DSTEP=$step -I. \
            lanes.c "$name.c" "${name}_batch.c" gic_runtime.c -lm -o lanes && said=$($run ./lanes) && [ "$said" = "8 $good 8 of 8" ]
    verdict $? "$file $options, $lanes lanes: $* $said"
}

# a compiler that knows no vectors
"$gicgen" "$root/models/hmmwv.veh" && "$gicgen" --batch 8 "$root/models/hmmwv.veh" && tcc -I. -c hmmwv_batch.c -o x.o 2>err
[ $? -ne 0 ] && grep -q '#error.*needs the vector extensions of gcc or clang' err
verdict $? "tcc: $(cat err)"
# a body that stands still
printf '%s\n' "gicgen: 1" "model: hinged" "base: ground" bodies: \
    "  bracket: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}" "  rod: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}" \
    joints: "  weld: {type: fixed, bodies: [ground, bracket]}" \
    "  pivot: {type: revolute, bodies: [bracket, rod], point: [0, 0, 0], axis: [0, 1, 0]}" coordinates: \
    "  angle: {type: angle, bodies: [bracket, rod], axis: [0, 1, 0], range: [-1, 1]}" >hinged.veh
for model in "$root"/models/*.veh "$root"/tests/data/laws/*.veh car.veh hinged.veh; do
    if "$gicgen" --batch 8 "$model" -o - >out 2>err; then
        agrees "$model" '' 4 gcc -std=c11 -O0
    else
        grep -qE "error: code for many vehicles at once can't have outputs of reactions" err
        verdict $? "$model: $(cat err)"
    fi
done

hmmwv=$root/models/hmmwv.veh
agrees "$hmmwv" '' 2 gcc -std=c11 -O2
agrees "$hmmwv" '' 8 gcc -std=c11 -O2 -DGIC_FLOAT -Wdouble-promotion
agrees "$hmmwv" '' 16 clang -std=c11 -O1
agrees "$hmmwv" '--solve augmented' 4 clang -std=c11 -O1 -DGIC_FLOAT
agrees "$hmmwv" '' 4 gcc -std=c11 -O1 -fopenmp
for how in 'g++ -std=c++11' 'clang++ -std=c++11 -DGIC_FLOAT'; do
    $how -x c++ -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O1 -I. -c hmmwv_batch.c -o x.o
    verdict $? "$how hmmwv_batch.c"
done
vehicle=$root/models/hmmwv_vehicle.veh
agrees "$vehicle" '' 2 gcc -std=c11 -O2
agrees "$vehicle" '' 8 gcc -std=c11 -O2 -DGIC_FLOAT -Wdouble-promotion
agrees "$vehicle" '' 16 clang -std=c11 -O1
agrees "$vehicle" '--solve augmented' 4 gcc -std=c11 -O1 -fopenmp
agrees "$vehicle" '--recovery newton' 4 gcc -std=c11 -O1
for how in 'g++ -std=c++11' 'clang++ -std=c++11 -DGIC_FLOAT'; do
    $how -x c++ -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O1 -I. -c hmmwv_vehicle_batch.c -o x.o
    verdict $? "$how hmmwv_vehicle_batch.c"
done
# no allocation, ever
gcc -std=c11 -O0 -w -I. -c hmmwv_vehicle_batch.c -o x.o && ! nm -u x.o | grep -E ' (malloc|calloc|realloc|aligned_alloc|free)$'
verdict $? "code for many vehicles allocates nothing"
"$gicgen" --batch 8 "$hmmwv" -o again.c && sed 's/again.h/hmmwv_batch.h/' again.c | cmp - hmmwv_batch.c
verdict $? "the same input gives other bytes"

# NEON's vectors of two doubles and four floats
run=qemu-aarch64
agrees "$vehicle" '' 4 aarch64-linux-gnu-gcc -std=c11 -O2 -static -DGIC_FLOAT
agrees "$vehicle" '' 2 aarch64-linux-gnu-gcc -std=c11 -O2 -static
check "of two doubles" [ "$(aarch64-linux-gnu-objdump -d lanes | grep -c 'fmul[^v]*v[0-9]*\.2d')" -gt 100 ]
run=

# code for one scene: nothing but rolling, in which one side is the image of the other; the same on a road that is the same
# on both sides; steering, so that both sides are computed
for kind in rolling across steering; do
    case $kind in rolling) more= ;; across) more='road: {type: bumps, bumps: [{x: 4, length: 2, height: 0.06}]}' ;;
    steering) more='inputs: {rack: {knots: {times: [0, 1], values: [0, 0.01]}}}' ;; esac
    printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'integrator: ab3' 'outputs: [chassis.x, chassis.z]' "$more" >$kind.scene
done
good=5
agrees "$vehicle" '--scene rolling.scene' 4 gcc -std=c11 -O1 -DSCENE
agrees "$vehicle" '--scene across.scene' 8 clang -std=c11 -O1 -DSCENE
good=7 # whatever moves to the side, and an input that the scene moves
agrees "$vehicle" '--scene steering.scene' 4 gcc -std=c11 -O0 -DSCENE
good=6 # without inputs
agrees "$hmmwv" '--scene rolling.scene --recovery newton' 4 gcc -std=c11 -O1 -DSCENE
agrees "$hmmwv" '--scene across.scene' 8 gcc -std=c11 -O1 -DSCENE -fopenmp
good=8
"$gicgen" "$vehicle" && gcc -std=c11 -DBATCH=hmmwv_vehicle_batch_model -I. lanes.c hmmwv_vehicle.c hmmwv_vehicle_batch.c gic_runtime.c -lm -o lanes
verdict $? "code of any scene beside lanes of one: compiles"
./lanes
[ $? -eq 1 ]
verdict $? "code of any scene beside lanes of one"

# code of another model is noticed
"$gicgen" "$root/models/quarter_car.veh" -o quarter_car.c
sed 's/^gravity:.*/gravity: [0, 0, -1.62]/' "$root/models/quarter_car.veh" >moon.veh
"$gicgen" --batch 8 moon.veh -o quarter_car_batch.c &&
    gcc -std=c11 -DBATCH=quarter_car_batch_model -I. lanes.c quarter_car.c quarter_car_batch.c gic_runtime.c -lm -o lanes
./lanes
[ $? -eq 1 ]
verdict $? "lanes of one model and vehicles of another"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
