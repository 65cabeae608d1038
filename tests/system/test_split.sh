#!/bin/sh
# SPDX-License-Identifier: MIT
# test_split.sh GICGEN GICRUN: implicit steps of which states with a share in stiff motions alone are implicit (gicgen --stiff, `implicit: stiff`
# of scenes): which states these are in small models where that is known; runs against closed forms, recurrences and variable steps;
# stability where too few implicit states would not do; the bits of all ways to the same code; what is refused.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1
models=$root/models

scene() {
    printf 'gicscene: 1\nduration: %s\nstep: %s\noutput_step: %s\n' "$1" "$2" "$(awk "BEGIN { print $1 / 10 }")"
    shift 2
    printf '%s\n' "$@"
}
# states MODEL STEP [OPTION...]: the implicit ones, between blanks
states() {
    model=$1
    step=$2
    shift 2
    "$gicgen" --implicit --stiff "$step" "$@" "$model" -o - 2>err | tr -d '\n' | sed 's/  *\*  */ /g; s/.*Implicit states, for steps of [0-9.e-]* s: \([^*]*[^ *]\) *\*\/.*/\1/'
}
# chosen NAME WANTED MODEL STEP [OPTION...]
chosen() {
    name=$1
    wanted=$2
    shift 2
    found=$(states "$@")
    check "$name: $found" [ "$found" = "$wanted" ]
}

# ---- a chain of bodies on the x axis: a on a soft spring, b on a stiff bushing on a, and c by itself on a soft spring
chain() { # MASS_A MASS_B STIFFNESS DAMPING
    cat <<END
gicgen: 1
model: chain
gravity: [0, 0, 0]
base: ground
bodies:
  a: {mass: $1, com: [0, 0, 0], inertia: [1, 1, 1]}
  b: {mass: $2, com: [0, 0, 0], inertia: [1, 1, 1]}
  c: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  a: {type: prismatic, bodies: [ground, a], axis: [1, 0, 0]}
  b: {type: prismatic, bodies: [a, b], axis: [1, 0, 0]}
  c: {type: prismatic, bodies: [ground, c], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, a], axis: [1, 0, 0], range: [-1, 1]}
  y: {type: translation, bodies: [a, b], axis: [1, 0, 0], range: [-1, 1]}
  z: {type: translation, bodies: [ground, c], axis: [1, 0, 0], range: [-1, 1]}
forces:
  soft: {type: spring_damper, coordinate: x, stiffness: $(awk "BEGIN { print 100 * $1 }"), damping: $1}
  rubber: {type: bushing, bodies: [a, b], point: [0, 0, 0], stiffness: [$3, 0, 0, 0, 0, 0], damping: [$4, 0, 0, 0, 0, 0]}
  alone: {type: spring_damper, coordinate: z, stiffness: 1, damping: 0}
outputs: {x: {type: coordinate, coordinate: x}, y: {type: coordinate, coordinate: y}, z: {type: coordinate, coordinate: z}}
END
}
chain 100 1 1e6 400 >light.veh
chosen 'a light body on a heavy one' 'y, y.rate' light.veh 0.004
chosen 'no stiff motion in short steps' 'none' light.veh 0.0001
# each body moves as far as the other: with y alone steps would have half of the stiffness of the pair
chain 1 1 1e8 4000 >equal.veh
chosen 'equal bodies' 'x, y, x.rate, y.rate' equal.veh 0.004
chosen 'equal bodies, the Jacobian of accelerations' 'x, y, x.rate, y.rate' equal.veh 0.004 --solve augmented
chain 1 1e-6 1 4e-4 >tiny.veh
chosen 'a body of a mg' 'y, y.rate' tiny.veh 0.004
chosen 'all stiff' 'x, y, z, x.rate, y.rate, z.rate' light.veh 1

# a light body between a heavy one and the ground, each with a coordinate of its own: the heavy one has a hundredth of the
# stiff motion, but the rubber's force in a step moves it; explicit, its slow motion of 8 rad/s is 0.8 % off at 1 ms and 16 % at
# 5 ms, which the check of slow motions finds
cat >between.veh <<'END'
gicgen: 1
model: between
base: ground
gravity: [0, 0, 0]
bodies:
  heavy: {mass: 300, com: [0, 0, 0], inertia: [1, 1, 1]}
  light: {mass: 3, com: [0, 1, 0], inertia: [1, 1, 1]}
joints:
  h: {type: prismatic, bodies: [ground, heavy], axis: [1, 0, 0]}
  l: {type: prismatic, bodies: [ground, light], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, heavy], axis: [1, 0, 0], range: [-10, 10]}
  y: {type: translation, bodies: [ground, light], axis: [1, 0, 0], range: [-10, 10]}
forces:
  fx: {type: force, coordinate: x, value: "-5e6 * (x - y) - 500 * (rate(x) - rate(y))"}
  fy: {type: force, coordinate: y, value: "-5e6 * (y - x) - 500 * (rate(y) - rate(x)) - 2e4 * y - 1000 * rate(y)"}
outputs:
  x: {type: coordinate, coordinate: x}
  y: {type: coordinate, coordinate: y}
END
for step in 0.001 0.005; do
    chosen "a heavy body behind a light one, $step s" 'x, y, x.rate, y.rate' between.veh $step
done
# its slow motion as a reference: steps of a hundredth by rk4
printf 'gicscene: 1\nduration: 2\nintegrator: rk4\nstep: 1e-5\noutput_step: 0.01\ninitial: {coordinates: {x: 0.05, y: 0.05}}\n' >between.scene
"$gicrun" -q between.veh between.scene -o right.csv 2>err
for method in ros2 ros3 imex; do
    printf 'gicscene: 1\nduration: 2\nintegrator: %s\nimplicit: stiff\nstep: 0.001\noutput_step: 0.01\ninitial: {coordinates: {x: 0.05, y: 0.05}}\n' $method >between.scene
    "$gicrun" -q between.veh between.scene -o own.csv 2>err
    apart=$(paste -d, right.csv own.csv | awk -F, 'NR > 1 { d = $2 - $(NF / 2 + 2); most = d * d > most ? d * d : most } END { print sqrt(most) / 0.05 }')
    check "the heavy body by $method: $apart of its way off" awk "BEGIN { exit !($apart < 1e-4) }"
done

# a free pair: the base moves as far as the body on it, and does not turn
cat >pair.veh <<'END'
gicgen: 1
model: pair
gravity: [0, 0, 0]
bodies:
  base: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
base: base
joints: {b: {type: prismatic, bodies: [base, b], axis: [1, 0, 0]}}
coordinates: {y: {type: translation, bodies: [base, b], axis: [1, 0, 0], range: [-1, 1]}}
forces: {rubber: {type: bushing, bodies: [base, b], point: [0, 0, 0], stiffness: [1e6, 0, 0, 0, 0, 0], damping: [100, 0, 0, 0, 0, 0]}}
outputs: {y: {type: coordinate, coordinate: y}}
END
chosen 'a free pair' 'r.x, r.y, r.z, y, v.x, v.y, v.z, y.rate' pair.veh 0.004

# a stop that is 0.1 m away as the model is drawn, of a coordinate and of points, and what hangs on a soft spring beside
cat >stop.veh <<'END'
gicgen: 1
model: stop
gravity: [0, 0, 0]
base: ground
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}, c: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {b: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}, c: {type: prismatic, bodies: [ground, c], axis: [0, 1, 0]}}
coordinates:
  x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}
  y: {type: translation, bodies: [ground, c], axis: [0, 1, 0], range: [-1, 1]}
forces:
  stop: {type: stop, coordinate: x, high: 0.1, stiffness: 1e6, damping: 1000}
  soft: {type: spring_damper, coordinate: y, stiffness: 1, damping: 0}
outputs: {x: {type: coordinate, coordinate: x}, y: {type: coordinate, coordinate: y}}
END
chosen 'a stop that does not touch' 'x, x.rate' stop.veh 0.001
sed 's/stop: .*/stop: {type: stop, bodies: [ground, b], points: [[-1, 0, 0], [0, 0, 0]], high: 1.1, stiffness: 1e6, damping: 1000}/' stop.veh >points.veh
chosen 'a stop between points that does not touch' 'x, x.rate' points.veh 0.001
# both sides of a vehicle alike, though rounding is not
for side in l r; do
    eval "$side=\$(states '$models/formula_student.veh' 0.002 | tr ',' '\n' | sed -n 's/ *\(.*\)_${side}\(\..*\)*$/\1\2/p' | sort | tr '\n' ' ')"
done
check "left: ${l:-none}, right: ${r:-none}" [ -n "$l" ] && [ "$l" = "$r" ]

# ---- nothing stiff: the backward formula with extrapolated rates alone. Of the free swing of c, w h = 0.01, with the
# first step 1 + z + z^2 / 2 and then r1 = 4/3 (1 + z) r0 - (1 + 2 z) / 3 r-1, z = 0.01 i
scene 10 0.01 'integrator: imex' 'implicit: stiff' 'initial: {coordinates: {z: 1}}' 'outputs: [z]' >free.scene
chain 1 1 1 0 | sed 's/damping: 1}/damping: 0.1}/' >soft.veh
run soft.veh free.scene -o free.csv
check 'a run tells how many states are implicit' says '0 of 6 states are implicit'
off=$(tail -n 1 free.csv | awk -F, '{ y = 0.01; a = 1; b = 0; c = 1 - y * y / 2; d = y
    for (k = 1; k < 1000; ++k) { u = 4 * (c - y * d) / 3 - (a - 2 * y * b) / 3; v = 4 * (d + y * c) / 3 - (b + 2 * y * a) / 3
        a = c; b = d; c = u; d = v }
    e = $2 - c; f = $3 + d; print sqrt(e * e + f * f) }')
check "explicit alone against its recurrence: ${off:-no run}" within "${off:-1}" 1e-12

# ---- order 2 with y alone implicit, at z = -0.8 +- 3.9i and shorter, of a swing that starts at rest on the rubber; the reference shares no formula
scene 0.4 0.004 'integrator: imex' 'implicit: stiff' 'initial: {coordinates: {x: 0.01, y: 0.000001}, rates: {x: 0}}' 'outputs: [x.value, y.value]' >half.scene
sed '/^implicit/d; s/imex/rkck/' half.scene >exact.scene
run -q --tolerance 1e-12 light.veh exact.scene -o exact.csv
for n in 1 2 4; do
    sed "s/^step: .*/step: $(awk "BEGIN { print 0.004 / $n }")/" half.scene >order.scene
    run light.veh order.scene -o order.csv
    check "2 of 6 states are implicit at 4 ms / $n" says '2 of 6 states are implicit'
    eval "off$n=\$(apart order.csv exact.csv)"
done
# shellcheck disable=SC2154  # set by eval
for n in 1 2; do
    found=$(eval "awk -v a=\${off$n:-0} -v b=\${off$((2 * n)):-0} 'BEGIN { print (b > 0 ? log(a / b) / log(2) : 0) }'")
    check "order with a part of the states implicit: $found ($off1 $off2 $off4)" within 1.7 "$found"
    check "order $found" within "$found" 2.4
done

# ---- stable where all states implicit are: a second of steps after a kick; the motion of the pair dies out
kick() { # MODEL COORDINATE STEP LEFT: what is left of 1 mm or m/s
    for method in imex ros2 ros3; do
        scene 1 "$3" "integrator: $method" 'keep_jacobian: 8' 'implicit: stiff' "initial: {coordinates: {$2: 0.001}}" "outputs: [$2.value]" >kick.scene
        run -q "$1" kick.scene -o kick.csv
        found=$(tail -n 1 kick.csv | awk -F, '{ print ($2 < 0 ? -$2 : $2) }')
        check "$1 by $method after a kick: ${found:-none}" within "${found:-1}" "$4"
    done
}
kick light.veh y 0.005 1e-6
kick equal.veh y 0.005 1e-4
kick tiny.veh y 0.005 1e-6
kick pair.veh y 0.005 1e-6
# the same with rows of velocities that are multiplied by masses
for model in light equal pair; do
    scene 1 0.005 'integrator: imex' 'implicit: stiff' 'initial: {coordinates: {y: 0.001}}' 'outputs: [y.value]' >kick.scene
    run -q --solve reduced $model.veh kick.scene -o kick.csv
    found=$(tail -n 1 kick.csv | awk -F, '{ print ($2 < 0 ? -$2 : $2) }')
    check "$model.veh, reduced, after a kick: ${found:-none}" within "${found:-1}" 1e-6
done
# into the stop with 1 m/s: as with all states implicit
for way in stiff all; do
    scene 1 0.001 'integrator: imex' "implicit: $way" 'initial: {rates: {x: 1}}' 'outputs: [x]' >hit.scene
    run -q stop.veh hit.scene -o hit_$way.csv
done
check 'a stop is hit' awk -F, 'END { exit !($3 < 0 && $3 > -1) }' hit_stiff.csv
off=$(apart hit_stiff.csv hit_all.csv)
check "against all states implicit: $off" within "$off" 1e-12

# ---- all states: the code but for its comments, and the bits of a run
mkdir all plain
"$gicgen" --implicit --stiff 1 light.veh -o all/chain.c 2>err && "$gicgen" --implicit light.veh -o plain/chain.c 2>err
# but for the number of the header, which has comments of its own
for code in all plain; do sed 's/0x[0-9a-f]*u*\|PAIR [0-9]*//g' $code/chain.c >$code.c; done
check 'all states stiff: the code of --implicit' cmp all.c plain.c
for way in stiff all; do
    scene 5 0.5 'integrator: imex' 'keep_jacobian: 4' "implicit: $way" 'initial: {coordinates: {x: 0.001, z: 0.5}}' 'outputs: [x, y, z]' >bits.scene
    run -q light.veh bits.scene -o bits_$way.csv
done
check 'all states stiff: the bits of a run' cmp -s bits_stiff.csv bits_all.csv

# ---- a vehicle: engines, lanes, shares, and parked without creep
sed '/^ratio/d; /^integrator/d; s/^step: .*/step: 0.004\nintegrator: imex\nkeep_jacobian: 8\nimplicit: stiff/; s/^duration: .*/duration: 5/; /^plot/d' "$models/scenes/tires_park.scene" >park.scene
echo 'outputs: [chassis]' >>park.scene
for way in 'tcc' 'cc' 'cc --lanes 4'; do
    # shellcheck disable=SC2086
    run -q --engine $way "$models/hmmwv_tires.veh" park.scene -o "park_$(echo "$way" | tr -d ' -').csv"
done
check 'tcc and cc' cmp -s park_tcc.csv park_cc.csv
off=$(apart park_cclanes4.csv park_cc.csv)
check "in lanes: $off" within "$off" 1e-9
sed 's/^implicit: .*/implicit: all/' park.scene >whole.scene
run -q "$models/hmmwv_tires.veh" whole.scene -o whole.csv
off=$(apart park_tcc.csv whole.csv)
# both are off by some mm/s^2 h^2 while it settles
check "parked, against all states implicit: $off" within "$off" 1e-3
sed 's/^implicit/spread_jacobian: true\nimplicit/' park.scene >shares.scene
run -q "$models/hmmwv_tires.veh" shares.scene -o shares.csv
off=$(apart shares.csv park_tcc.csv)
check "with shares: $off" within "$off" 1e-4

# ---- a program: clean with warnings, in both number types; what is explicit goes on so; a copy has the same bits
"$gicgen" --implicit --stiff 0.004 --spread-jacobian light.veh -o chain.c 2>err
check '4 states go on explicitly' [ "$(grep -c '/\* explicit: ' chain.c)" -eq 4 ]
check '2 unknowns less than 6' grep -q 'CHAIN_IMPLICIT_UNKNOWNS = 1,' chain.h
cat >snapshot.c <<'END'
#include "chain.h"
#include <stdio.h>
#include <string.h>
static chain car, copy;
int main(void)
{
    int i, status = chain_setup(&car);
    car.state[CHAIN_STATE_X] = GIC_R(0.01);
    car.implicit.keep = 3, car.implicit.spread = 1;
    for (i = 0; i < 10 && status == GIC_OK; ++i)
        status = chain_step(&car, GIC_R(STEP), GIC_IMEX);
    copy = car;
    for (i = 0; i < 10 && status == GIC_OK; ++i)
        status = chain_step(&car, GIC_R(STEP), GIC_IMEX) + chain_step(&copy, GIC_R(STEP), GIC_IMEX);
    return status != GIC_OK || memcmp(car.state, copy.state, sizeof car.state) != 0;
}
END
for flags in '-DSTEP=0.004' '-DSTEP=0.004 -DGIC_FLOAT'; do
    # shellcheck disable=SC2086
    { "${CC:-cc}" -std=c99 -O1 -Wall -Wextra -Wpedantic -Werror $flags -I. -I"$root/runtime" chain.c snapshot.c "$root/runtime/gic_runtime.c" -o snapshot -lm && ./snapshot; } >out 2>err
    verdict $? "a copy goes on with the same bits $flags"
done
"$gicgen" --implicit --stiff 0.0001 light.veh -o chain.c 2>err && { "${CC:-cc}" -std=c99 -O1 -Wall -Wextra -Wpedantic -Werror -DSTEP=0.0001 -I. -I"$root/runtime" chain.c snapshot.c "$root/runtime/gic_runtime.c" -o snapshot -lm && ./snapshot; } >out 2>err
verdict $? 'the same where no state is implicit'

# ---- a unit of FMI has the scene's choice
scene 1 0.004 'integrator: imex' 'implicit: stiff' 'outputs: [x]' >unit.scene
"$gicgen" --fmu 2 light.veh --scene unit.scene -o chain.fmu 2>err
check 'an FMU' sh -c 'python3 -m zipfile -e chain.fmu unpacked && grep -q "explicit: " unpacked/sources/*.c'

# ---- what is refused
refused() { # STATUS TEXT COMMAND...
    wanted=$1
    text=$2
    shift 2
    "$@" >out 2>err
    [ $? -eq "$wanted" ] && grep -qF -- "$text" err && [ ! -e none.c ] && [ ! -e none.csv ]
    verdict $? "refused: $text"
}
refused 2 'stiff goes with --implicit' "$gicgen" --stiff 0.001 light.veh -o none.c
for step in 0 -1 nan inf 0.001s ''; do
    refused 2 "--stiff takes the length of a step in seconds, above 0, not: $step" "$gicgen" --implicit --stiff "$step" light.veh -o none.c
done
refused 2 'whose steps treat all states alike' "$gicgen" --implicit --exponential --stiff 0.001 light.veh -o none.c
scene 1 0.001 'integrator: imex' 'implicit: some' >bad.scene
refused 1 "bad.scene:6:11: error: implicit is" "$gicrun" light.veh bad.scene -o none.csv
scene 1 0.001 'integrator: ab3' 'implicit: stiff' >bad.scene
refused 1 'ab3 has no implicit steps of this kind' "$gicrun" light.veh bad.scene -o none.csv
scene 1 0.001 'integrator: exp3' 'implicit: stiff' >bad.scene
refused 1 'exp3 treats all states alike' "$gicrun" light.veh bad.scene -o none.csv

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
