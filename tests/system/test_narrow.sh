#!/bin/sh
# SPDX-License-Identifier: MIT
# test_narrow.sh GICGEN GICRUN: code for one scene against code for any, and its refusal of everything else.
#
# The two do the same operations but for those with constants, so a number of the results may differ by rounding, which
# a run of a second lets grow: 1e-9 of the largest in its column (a force of 1e-7 N beside 100 N) is far below what any
# term that is left out by mistake would make.
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/lib/checking.sh"
models=$root/models
: >"$work/out"
: >"$work/err"

# near FILE FILE: the same columns and, to 1e-9 of the largest of each column, the same numbers; with rows
near() {
    awk -F, 'FNR == 1 { if (NR == 1) head = $0; else if ($0 != head) bad = 1; next }
        NR == FNR { for (i = 1; i <= NF; ++i) { a[FNR, i] = $i; s = $i < 0 ? -$i : $i; if (s > m[i]) m[i] = s }; rows = FNR; next }
        { for (i = 1; i <= NF; ++i) { d = a[FNR, i] - $i; if (d < 0) d = -d; if (!(d <= 1e-9 * (1 + m[i]))) bad = 1 }; other = FNR }
        END { exit bad || rows < 2 || rows != other }' "$1" "$2"
}

# same MODEL SCENE [OPTION...]: generated code for the scene does what code for any scene and the interpreted engine do
same() {
    model=$1
    scene=$2
    shift 2
    run --general "$@" "$models/$model.veh" "$scene" -o "$work/general"
    check "$model, $scene: general" exits 0
    for engine in tcc cc; do
        run --engine $engine "$@" "$models/$model.veh" "$scene" -o "$work/narrow"
        check "$model, $scene: $engine" exits 0
        check "$model, $scene: $engine as the general code" near "$work/general" "$work/narrow"
    done
}

same hmmwv_vehicle "$root/tests/data/narrow/coast.scene" --cflags -O1
same hmmwv_vehicle "$root/tests/data/narrow/steer.scene" --cflags -O1
same hmmwv_vehicle "$root/tests/data/narrow/straight.scene" --cflags -O1
same hmmwv "$root/tests/data/narrow/bounce.scene" --cflags -O1
same hmmwv "$root/tests/data/narrow/bumps.scene" --cflags -O1
same hmmwv_vehicle "$root/tests/data/narrow/brake.scene" --cflags -O1
sed 's/^duration.*/duration: 2/' "$models/scenes/suspension_rig.scene" >"$work/rig.scene"
same hmmwv "$work/rig.scene" --cflags -O1

# a rig, whose model is another one: the interpreted engines, which know nothing of how it is narrowed
# shellcheck disable=SC2043  # one engine, for now
for engine in gic; do
    run --engine $engine "$models/hmmwv.veh" "$work/rig.scene" -o "$work/other"
    check "rig: $engine" exits 0
    check "rig: as $engine" near "$work/narrow" "$work/other"
done
# straight ahead the interpreted engine keeps its distance: rounding grows, but not like a term left out
run --engine gic "$models/hmmwv.veh" "$root/tests/data/narrow/bumps.scene" -o "$work/other"
run --engine cc --cflags -O1 "$models/hmmwv.veh" "$root/tests/data/narrow/bumps.scene" -o "$work/narrow"
check "straight ahead: as gic" near "$work/narrow" "$work/other"
same quarter_car "$models/scenes/quarter_car.scene" --cflags -O1
same pendulum "$models/scenes/pendulum.scene" --cflags -O1

# operations of all together FILE: adds and multiplies of a right-hand side
operations() { sed -n 's/^ \*   all together  *\([0-9]*\) *\([0-9]*\) .*/\1 \2/p' "$1" | awk '{ print $1 + $2 }'; }

scene=$root/tests/data/narrow/coast.scene
"$gicgen" "$models/hmmwv_vehicle.veh" -o "$work/general.c" && "$gicgen" --scene "$scene" "$models/hmmwv_vehicle.veh" -o "$work/narrow.c"
check "code for a scene" [ $? -eq 0 ]
check "takes fewer operations" [ "$(operations "$work/narrow.c")" -lt "$(operations "$work/general.c")" ]
check "looks no road up" [ "$(grep -c 'road_height\|road_friction' "$work/narrow.c")" -eq 0 ]
check "says what it takes for granted" grep -q "the transmission is in neutral" "$work/narrow.c"
cp "$work/narrow.c" "$work/first.c"
"$gicgen" --scene "$scene" "$models/hmmwv_vehicle.veh" -o "$work/narrow.c"
check "the same bytes again" cmp -s "$work/narrow.c" "$work/first.c"
warnings="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -I$root/runtime -I$work"
for how in "gcc -std=c99" "clang -std=c99" "gcc -std=c99 -DGIC_FLOAT" "g++ -x c++"; do
    # shellcheck disable=SC2086  # words
    $how $warnings -c -o "$work/object.o" "$work/narrow.c" 2>"$work/err"
    check "compiled by $how" [ $? -eq 0 ]
done
# shellcheck disable=SC2086  # words
gcc -std=c99 -O1 $warnings -o "$work/refuse" "$root/tests/data/narrow/refuse.c" "$work/narrow.c" "$root/runtime/gic_runtime.c" -lm &&
    "$work/refuse" >"$work/out"
check "every false assumption is refused" [ $? -eq 0 ]
# shellcheck disable=SC2086  # a list of words
"$gicgen" --scene "$root/tests/data/narrow/bumps.scene" "$models/hmmwv.veh" -o "$work/narrow.c" &&
    gcc -std=c99 -O1 $warnings -o "$work/uneven" "$root/tests/data/narrow/uneven.c" "$work/narrow.c" "$root/runtime/gic_runtime.c" -lm &&
    "$work/uneven" >"$work/out"
check "what is not the same on both sides is refused" [ $? -eq 0 ]
# so it is under tires, front and rear ones side by side or not: roads of the other side are a micrometre higher
cat >"$work/tires.scene" <<'END'
gicscene: 1
duration: 1
step: 0.001
initial: {velocity: [10, 0, 0]}
road: {type: bumps, bumps: [{x: 5, length: 2, height: 0.05, tracks: both}]}
END
cat >"$work/tires.c" <<'END'
#include "narrow.h"
#include <stdio.h>
static gic_real higher;
static void height(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y, gic_real out[3])
{
    (void)road, (void)lane, (void)time;
    out[0] = GIC_R(0.001) * x + (y > 0 ? higher : 0), out[1] = GIC_R(0.001), out[2] = 0;
}
static gic_real friction(const gic_road *road, int32_t lane, gic_real time, gic_real x, gic_real y)
{
    (void)road, (void)lane, (void)time, (void)x;
    return y > 0 ? 1 - higher : 1;
}
int main(void)
{
    static const gic_road even = {height, NULL, NULL, NULL, GIC_ROAD_OWN};
    static const gic_road_plane level = {{gic_plane_height, NULL, NULL, NULL, GIC_ROAD_PLANE}, 0, 0, 0},
                                tilted = {{gic_plane_height, NULL, NULL, NULL, GIC_ROAD_PLANE}, 0, 0, GIC_R(1e-3)};
    const gic_road *const good[] = {NULL, &even, &level.head};
    const gic_road_plane rubs = {{gic_plane_height, friction, NULL, NULL, GIC_ROAD_PLANE}, 0, 0, 0};
    static hmmwv_tires car, first;
    int i, failed = hmmwv_tires_setup(&first) != GIC_OK;
    for (i = 0; i < 3; ++i) {
        car = first;
        car.head.road = good[i];
        failed += hmmwv_tires_step(&car, GIC_R(0.001), GIC_AB3) != GIC_OK;
    }
    car = first;
    car.head.road = &tilted.head;
    failed += 2 * (hmmwv_tires_step(&car, GIC_R(0.001), GIC_AB3) != GIC_ERROR_ASSUMPTION);
    higher = GIC_R(1e-6);
    car = first;
    car.head.road = &even;
    failed += 4 * (hmmwv_tires_step(&car, GIC_R(0.001), GIC_AB3) != GIC_ERROR_ASSUMPTION);
    car = first;
    car.head.road = &rubs.head;
    failed += 8 * (hmmwv_tires_step(&car, GIC_R(0.001), GIC_AB3) != GIC_ERROR_ASSUMPTION);
    printf("%d\n", failed);
    return failed != 0;
}
END
sed -i 's/#include <stdio.h>/#include "gic_road.h"\n&/' "$work/tires.c"
for lanes in '' '--lanes 2'; do
    # shellcheck disable=SC2086  # words
    "$gicgen" $lanes --scene "$work/tires.scene" "$models/hmmwv_tires.veh" -o "$work/narrow.c" &&
        gcc -std=gnu99 -O1 $warnings -Wno-psabi -o "$work/tires" "$work/tires.c" "$work/narrow.c" "$root/runtime/gic_runtime.c" "$root/runtime/gic_road.c" -lm 2>"$work/err" &&
        "$work/tires" >"$work/out"
    check "roads that differ are refused under tires $lanes: $(cat "$work/out")" [ $? -eq 0 ]
done

# in lanes the same bits, where elementary functions are libm's: those of gic_lanes.h are made to call them, for the test
mkdir "$work/libm" && cp "$root"/runtime/*.h "$work/libm" && {
    cat "$root/runtime/gic_lanes.h"
    for f in sin cos tan asin acos atan exp log tanh atan2 pow; do
        x=x
        case $f in atan2 | pow) x="x, y" ;; esac
        LANE=$(echo "LANE_$f" | tr '[:lower:]' '[:upper:]')
        printf '#undef %s\n#define %s(%s) GIC_LANES_NAME(own_%s_, GIC_LANES)(%s)\n' "$LANE" "$LANE" "$x" "$f" "$x"
    done
    for f in sin cos tan asin acos atan exp log tanh; do
        echo "LANE_FUNCTION gic_lane GIC_LANES_NAME(own_${f}_, GIC_LANES)(gic_lane x) { int l; FOR_LANES(l) x[l] = GIC_MATH($f)(x[l]); return x; }"
    done
    for f in atan2 pow; do
        echo "LANE_FUNCTION gic_lane GIC_LANES_NAME(own_${f}_, GIC_LANES)(gic_lane x, gic_lane y) { int l; FOR_LANES(l) x[l] = GIC_MATH($f)(x[l], y[l]); return x; }"
    done
} >"$work/libm/gic_lanes.h"
# lanes MODEL SCENE WIDTH ROWS COMPILER...: so many calls solve subsets, or compute wheels, side by side
lanes() {
    model=$1
    of=$2
    width=$3
    rows=$4
    shift 4
    name="$model, $(basename "$of"), $width lanes, $*"
    for how in plain lanes; do
        [ $how = plain ] && more= || more="--lanes $width"
        # shellcheck disable=SC2086  # words
        "$gicgen" $more --scene "$of" "$models/$model.veh" -o "$work/$model.c" &&
            "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -Wno-psabi -ffp-contract=off -DMODEL="${model}_model" \
                -I"$work/libm" -I"$work" -o "$work/$how" "$root/tests/data/narrow/lanes.c" "$work/$model.c" "$root/runtime/gic_runtime.c" -lm &&
            "$work/$how" >"$work/$how.bits"
        check "$name: $how" [ $? -eq 0 ]
    done
    check "$name: has lanes" [ "$(grep -c "status = .*ROW_[0-9]*(.*_row_\|status = .*_wheels_.*(self, [0-9]" "$work/$model.c")" -eq "$rows" ]
    check "$name: the same bits" cmp "$work/plain.bits" "$work/lanes.bits"
    check "$name: of numbers that move" [ "$(sort -u "$work/lanes.bits" | wc -l)" -gt 500 ]
}
lanes hmmwv_vehicle "$root/tests/data/narrow/steer.scene" 4 4 gcc -std=c99 -O0 -DDUAL=6
lanes hmmwv_vehicle "$root/tests/data/narrow/brake.scene" 2 2 clang -std=c99 -O0 -DDUAL=5 -DROAD
lanes hmmwv "$models/scenes/paper_run.scene" 4 3 gcc -std=c99 -O0 -DGIC_FLOAT
lanes hmmwv "$root/tests/data/narrow/bumps.scene" 4 1 gcc -std=c99 -O0 -DROAD

# side NAME SCENE MODEL: is one side computed for both, and if not, why?
side() { "$gicgen" --scene "$2" "$3" -o - 2>&1 | grep -q "one side for both .* $1"; }
sed 's/10, 0, 0/10, 0.1, 0/' "$root/tests/data/narrow/bounce.scene" >"$work/drift.scene"
check "refused: drift" side "refused: the vehicle does not move straight ahead" "$work/drift.scene" "$models/hmmwv.veh"
sed 's/tracks: both/tracks: left/' "$root/tests/data/narrow/bumps.scene" >"$work/left.scene"
check "refused: road" side "refused: the road" "$work/left.scene" "$models/hmmwv.veh"
sed "s|parts/|$models/parts/|g; s/^forces:/forces:\n  spring_f_r: {type: spring_damper, coordinate: spring_f_r, stiffness: 167071, damping: 17490.8, free: 0.31903}/" \
    "$models/hmmwv.veh" >"$work/spring.veh"
check "refused: a spring" side "refused: forces are not the same" "$root/tests/data/narrow/bumps.scene" "$work/spring.veh"
sed "s|parts/|$models/parts/|g; s/^wheels:/wheels:\n  tire_f_r: {body: wheel_f_r, center: centre_f_r, radius: 0.47, stiffness: 283000, damping: 500}/" \
    "$models/hmmwv.veh" >"$work/wheel.veh"
check "refused: a wheel" side "refused: wheel 'tire_f_" "$root/tests/data/narrow/bumps.scene" "$work/wheel.veh"
check "taken" side "model, initial state" "$root/tests/data/narrow/bumps.scene" "$models/hmmwv.veh"
"$gicgen" --scene "$scene" --sequence "$models/hmmwv_vehicle.veh" >"$work/out" 2>"$work/err"
check "--scene with another task" [ $? -eq 2 ]
sed 's/chassis, spring/chassis, sprong/' "$scene" >"$work/wrong.scene"
"$gicgen" --scene "$work/wrong.scene" "$models/hmmwv_vehicle.veh" -o "$work/wrong.c" >"$work/out" 2>"$work/err"
check "a mistake in the scene" [ $? -eq 1 ]
check "is explained" says "wrong.scene:.*no output 'sprong_f_l'"
check "and leaves no file" [ ! -e "$work/wrong.c" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
