#!/bin/sh
# SPDX-License-Identifier: MIT
# test_wheel_lanes.sh GICGEN GICRUN: wheels side by side in lanes. The code compiles without a warning by gcc and clang,
# as C99 and C++, with either number type; runs behave as those of single wheels must (tests/data/tires/runs.py: lock-up,
# standstill, parking, a jump); along a run of the complete vehicle results are those of single wheels to 1e-9 of their
# size, which is what some thousand steps make of a few units of the last place; so they are with other tires at the
# rear, with three wheels, and with one of five in the air; the same input gives the same bytes.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
here=$(cd "$(dirname "$0")/.." && pwd)
models=$(cd "$here/../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$here/lib/checking.sh"
cd "$work" || exit 1
: >out
: >err
cp "$here"/../runtime/gic_runtime.[ch] "$here/../runtime/gic_lanes.h" "$here"/../runtime/gic_road*.h .

compiles() {
    "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror -ffp-contract=off -I. -c "$code.c" \
        -o x.o >out 2>&1
}
for code in hmmwv_tires hmmwv_tmeasy hmmwv_vehicle; do
    # some warnings come only where a compiler optimizes, whatever the number of lanes; others are the language's
    for lanes in 2 4 16; do
        optimize=-O0
        [ $lanes -ne 4 ] || optimize=-O1
        "$gicgen" --lanes $lanes "$models/$code.veh"
        check "$code, $lanes lanes, gcc" compiles gcc -std=c99 $optimize
        check "$code, $lanes lanes, clang, float" compiles clang -std=c99 $optimize -DGIC_FLOAT
    done
    check "$code, g++" compiles g++ -std=c++11 -x c++ -O0 -DGIC_FLOAT
    check "$code, clang++" compiles clang++ -std=c++11 -x c++ -O0
done
cp hmmwv_vehicle.c before.c
"$gicgen" --lanes 16 "$models/hmmwv_vehicle.veh"
check "the same bytes again" cmp before.c hmmwv_vehicle.c
"$gicgen" --lanes 4 "$models/hmmwv.veh"
check "no vectors without tires" sh -c '! grep -q gic_lanes hmmwv.c'

# the runs of test_wheel_runs.sh
# whatever engine it is told
cat >lanes <<END
#!/bin/sh
count=\$#
while [ \$count -gt 0 ]; do
    if [ "\$1" = --engine ]; then
        count=\$((count - 1))
        shift
    else
        set -- "\$@" "\$1"
    fi
    shift
    count=\$((count - 1))
done
exec "$gicrun" --engine cc --lanes 4 "\$@"
END
chmod +x lanes
python3 "$here/data/tires/runs.py" "$gicgen" ./lanes "$models" "$work" >said 2>err
check "runs come to their ends" [ $? -eq 0 ]
grep -v '^ok' said
passed=$((passed + $(grep -c '^ok' said)))
failed=$((failed + $(grep -c '^FAIL' said)))

# alike TOLERANCE: two tables of results, relative to the largest of the column and 1
alike() {
    paste -d, single.csv lanes.csv | awk -F, -v tolerance="$1" '
        NR == 1 { columns = NF / 2; next }
        { for (i = 1; i <= columns; ++i) {
              size = $i < 0 ? -$i : $i
              difference = $i - $(columns + i)
              if (size > largest[i]) largest[i] = size
              if (difference < 0) difference = -difference
              if (!(difference <= worst[i])) worst[i] = difference } }
        END { for (i = 1; i <= columns; ++i) {
                  if (!(worst[i] <= tolerance * (1 + largest[i]))) bad = 1
                  relative = worst[i] / (1 + largest[i])
                  if (relative > all) all = relative }
              print "largest difference " all >"out"
              exit bad || NR < 3 }'
}
sed 's/^duration:.*/duration: 3/' "$models/scenes/full_run.scene" >run.scene
"$gicrun" -q --engine cc "$models/hmmwv_vehicle.veh" run.scene -o single.csv
for how in '2' '4' '8'; do
    "$gicrun" -q --engine cc --lanes "$how" "$models/hmmwv_vehicle.veh" run.scene -o lanes.csv
    check "3 s of the vehicle, $how lanes" alike 1e-9
done
"$gicrun" -q --engine cc --lanes 4 --cc clang --cflags '-O3 -ffp-contract=fast' "$models/hmmwv_vehicle.veh" run.scene \
    -o lanes.csv
check "3 s of the vehicle, clang, fused" alike 1e-9

# other numbers of the same kind of tire at the rear: all four wheels in one vector
sed 's/^PDX1 = 0.77751/PDX1 = 0.7/; s/^PKY1 = -10.289/PKY1 = -9/; s/^VERTICAL_STIFFNESS = .*/VERTICAL_STIFFNESS = 9e5/
    s/^RBX1 = .*/RBX1 = 10/; s/^QDZ1 = .*/QDZ1 = 0.09/' "$models/tires/hmmwv_pac2002.tir" >rear.tir
sed "s|parts/|$models/parts/|; /^  tire_r_l:/,/^ *{/s/tire: all/tire: rear/; s|^wheels:|tires:\\n  rear: {file: $work/rear.tir}\\n&|" \
    "$models/hmmwv_tires.veh" >two.veh
printf 'gicscene: 1\nduration: 2\nstep: 0.004\nratio: 4\noutput_step: 0.1\ninitial: {velocity: [20, 0, 0]}\ninputs:\n  brake: {knots: {times: [0.5, 0.7], values: [0, 1]}}\n' \
    >two.scene
"$gicgen" --lanes 4 two.veh -o two.c
check "two tires, one function" [ "$(grep -c 'static int hmmwv_tires_wheels_' two.c)" -eq 1 ]
"$gicrun" -q --engine cc --general two.veh two.scene -o single.csv
"$gicrun" -q --engine cc --lanes 4 two.veh two.scene -o lanes.csv
check "two tires, braking" alike 1e-9

# three and five wheels: a lane and three lanes are left over; one of five is in the air
cat >box.veh <<END
gicgen: 1
model: box
base: box
bodies:
  box: {mass: 4000, com: [0, 0, 1], inertia: [3000, 3000, 3000]}
tires:
  all: {file: $models/tires/hmmwv_pac2002.tir}
wheels:
  front: {body: box, center: [1, 0, 0.45], tire: all, spin_inertia: 7}
  left: {body: box, center: [-1, 1, 0.45], tire: all, spin_inertia: 7}
  right: {body: box, center: [-1, -1, 0.45], tire: all, spin_inertia: 7}
  # spare: {body: box, center: [-1.5, 0, 0.6], tire: all, spin_inertia: 7}
  # flag: {body: box, center: [-1.5, 0, 2], tire: all, spin_inertia: 7}
outputs:
  front: {type: tire, wheel: front}
  left: {type: tire, wheel: left}
  right: {type: tire, wheel: right}
  energies: {type: energy}
END
sed 's/# \(spare\|flag\)/\1/; s/^model: box/model: five/' box.veh >five.veh
printf 'gicscene: 1\nduration: 0.5\nstep: 0.004\nratio: 4\noutput_step: 0.02\ninitial: {velocity: [10, 1, 0]}\n' >box.scene
for code in box five; do
    "$gicrun" -q --engine cc --general $code.veh box.scene -o single.csv
    "$gicrun" -q --engine cc --lanes 4 $code.veh box.scene -o lanes.csv
    check "wheels left over: $code" alike 1e-9
done

# usage
"$gicrun" --lanes 3 x.veh >out 2>err
check "three lanes" [ $? -eq 2 ]
check "three lanes: why" says "--lanes takes 2, 4, 8 or 16, not '3'"
"$gicrun" --lanes 4 x.veh x.scene >out 2>err
check "lanes of another engine" [ $? -eq 2 ]
check "lanes of another engine: why" says "--lanes goes with --engine cc, not with 'auto'"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
