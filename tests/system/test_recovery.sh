#!/bin/sh
# SPDX-License-Identifier: MIT
# test_recovery.sh GICGEN GICRUN STATES REFERENCE AGREE: which subsets have a closed form, and that it leads to where
# Newton's iteration and the independent reference in quad precision are. The latter within 5e-13, as in
# test_accelerations.sh. That GIC_RECOVERY_ERROR is kept: residuals of the constraints, relative to a subset's size, stay
# below it along a path, and the larger ones are made use of.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# same LABEL EXPECTED FOUND
same() {
    [ "$2" = "$3" ]
    verdict $? "$1: expected '$2', found '$3'"
}

# classes MODEL WAY: those whose poses have a closed form
classes() {
    "$gicgen" --recovery "$2" "$1" -o "$work/code.c" &&
        sed -n "s/^ \*   subset '\([^']*\)' ([0-9]* times, closed form).*/\1/p" "$work/code.c" | tr '\n' ' '
}

models=$root/models
same hmmwv "rack lca_f_l wheel_f_l wheel_r_l " "$(classes "$models/hmmwv.veh" auto)"
same hmmwv14 "rack lca_f_l uca_f_l_wheel_f_l uca_r_l_wheel_r_l " "$(classes "$models/hmmwv14.veh" auto)"
same "five links" "rack lca_f_l wheel_f_l " "$(classes "$models/five_link.veh" closed)"
same "quarter car" "carriage arm wheel " "$(classes "$models/quarter_car.veh" auto)"
same "Newton's iteration alone" "" "$(classes "$models/hmmwv.veh" newton)"
# names mean nothing: the same with others
sed 's/\<arm\>/pen/g; s/\<carriage\>/lca/g' "$models/quarter_car.veh" >"$work/renamed.veh"
same "other names" "lca pen wheel " "$(classes "$work/renamed.veh" auto)"

for name in hmmwv14 five_link trailing_arm; do
    "$gicgen" --dump-model "$models/$name.veh" >"$work/dump" &&
        "$states" "$work/dump" --count 40 --seed 7 -o "$work/states" &&
        "$reference" "$work/dump" "$work/states" -o "$work/accelerations"
    for way in newton closed; do
        "$gicrun" --recovery $way --engine tape --eval "$work/states" "$models/$name.veh" -o "$work/$way" &&
            "$agree" "$work/dump" "$work/accelerations" "$work/$way" --tolerance 5e-13 >"$work/log"
        same "$name $way" 0 $?
    done
    # two ways, or the option would do nothing
    cmp -s "$work/newton" "$work/closed"
    same "$name: two ways" 1 $?
done

# The same poses thousands of turns away: 1e-12 m, or of an Euler parameter. 4907 turns are to 7e-14 the number that is
# added, and angles that are cut short before take it without a rounding.
for angles in pendulum:angle trailing_arm:bar_f_l,bar_f_r,bar_r_l,bar_r_r andrews:beta; do
    name=${angles%:*}
    "$gicgen" --dump-model "$models/$name.veh" >"$work/dump" && "$states" "$work/dump" --count 10 --seed 5 -o "$work/drawn"
    for turned in 0 1 -1; do
        awk -F, -v OFS=, -v OFMT=%.17g -v CONVFMT=%.17g -v turned=$turned -v angles="${angles#*:}" '
            NR == 1 { n = split(angles, name, ","); for (i = 1; i <= NF; ++i) column[$i] = i; print; next }
            { for (i = 1; i <= n; ++i) { k = column[name[i]]; $k = $k + 4e4 - 4e4 + turned * 30831.59030233023 }; print }' \
            "$work/drawn" >"$work/states$turned"
    done
    for engine in tape tcc gic; do
        for way in newton closed; do
            for turned in 0 1 -1; do
                "$gicrun" -q --recovery $way --engine $engine --eval "$work/states$turned" "$models/$name.veh" \
                    -o "$work/poses$turned"
            done
            same "$name $engine $way: poses thousands of turns away" "20 rows" "$(awk -F, '
                FNR == 1 { ++file; for (i = 1; i <= NF; ++i) { place[i] = $i ~ /^[A-Za-z_0-9]*[.](x|y|z|e[0-3])( |$)/ && $i !~ /^a/
                    status = $i == "status" ? i : status }; next }
                file == 1 { for (i = 1; i <= NF; ++i) known[FNR, i] = $i; good[FNR] = $status == 0; next }
                $status == 0 && good[FNR] { ++rows; for (i = 1; i <= NF; ++i) if (place[i]) {
                    d = $i - known[FNR, i]; if (d < 0) d = -d; if (!(d <= 1e-12)) off = off " " FNR ":" i ":" d; ++compared } }
                END { print (compared < 7 * rows || off ? off : rows " rows") }' \
                "$work/poses0" "$work/poses1" "$work/poses-1")"
        done
    done
done

# One recovery after the other along a path through the ranges: the largest sum of the residuals of a subset's constraints,
# which may be eight times what each pose may be off (FORMAT.md section 14).
"$gicgen" --recovery newton "$models/five_link.veh" -o "$work/five_link.c"
cat >"$work/path.c" <<'END'
#include "five_link.c"

#include <stdio.h>

int main(void)
{
    static five_link car;
    gic_real state[FIVE_LINK_STATES], rate[FIVE_LINK_STATES], worst = 0, one[2];
    int status = five_link_setup(&car);
    for (int k = 0; k < 400 && status == GIC_OK; ++k) {
        memcpy(state, car.state, sizeof state);
        for (int i = FIVE_LINK_STATE_SPRING_F_L; i <= FIVE_LINK_STATE_RACK; ++i)
            state[i] += 0.02 * sin(0.1 * k + i);
        status = five_link_rhs(&car, 0, state, rate);
        five_link_residual(&car, one);
        worst = one[0] > worst ? one[0] : worst;
    }
    printf("%.3g\n", status == GIC_OK ? worst : 1.0);
    return 0;
}
END

# residual ERROR: with poses that may be off by it, relative to the size of a subset
residual() {
    "${CC:-cc}" -std=c99 -I"$work" -I"$root/runtime" -DGIC_RECOVERY_ERROR="$1" "$work/path.c" \
        "$root/runtime/gic_runtime.c" -lm -o "$work/path" && "$work/path"
}

# A wheel may turn all the way round, whichever of a hinge's two bodies it is: within some roundings of 2.2e-16 of quad
# precision, and refused nowhere.
# turning FIRST SECOND TYPE [JOINT]
turning() {
    cat <<END
gicgen: 1
model: turning
base: ground
bodies:
  arm: {mass: 3, com: [0.5, 0, 0], inertia: {xx: 0.1, yy: 0.2, zz: 0.2}}
  wheel: {mass: 2, com: [1, 0.1, 0], inertia: {xx: 0.1, yy: 0.2, zz: 0.15}}
joints:
  pivot: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, -1, 0]}
  hinge: {type: $3, bodies: [$1, $2], point: [1, 0, 0], axis: [0.3, 1, 0.2]}
 $4
coordinates:
  angle: {type: angle, bodies: [ground, arm], axis: [0, -1, 0], range: [-1, 1]}
  spin: {type: angle, bodies: [$1, $2], axis: [0.3, 1, 0.2], range: [-3, 3]}
END
}
# round STEP: all the way round in such steps
round() {
    awk -v step="$1" 'BEGIN {
        print "angle,angle.rate,spin,spin.rate"
        for (x = -3.15; x < 3.15; x += step) printf "0.3,0.5,%.9g,1\n", x
    }'
}
round 0.05 >"$work/states"
round 1e-3 >"$work/closely"
stop='stop: {type: point_in_plane, bodies: [arm, wheel], point: [1, 0, 0], axis: [0.3, 1, 0.2]}'
for bodies in "arm wheel" "wheel arm"; do
    for joints in revolute "cylindrical $stop"; do
        kind=${joints%% *}
        # shellcheck disable=SC2086  # two words
        turning $bodies "$kind" "${joints#"$kind"}" >"$work/turning.veh"
        "$gicgen" --dump-model "$work/turning.veh" >"$work/dump" &&
            "$reference" "$work/dump" "$work/states" -o "$work/accelerations" 2>"$work/said"
        for options in "--recovery auto" "--recovery newton" "--solve augmented"; do
            # shellcheck disable=SC2086
            "$gicrun" --engine tape $options --eval "$work/states" "$work/turning.veh" -o "$work/results" &&
                "$agree" "$work/dump" "$work/accelerations" "$work/results" --tolerance 2e-15 >"$work/said"
            same "a wheel turns, $kind of $bodies, $options" 0 $?
        done
        same "turned all the way, $kind of $bodies" "" \
            "$("$gicrun" --engine tape --eval "$work/closely" "$work/turning.veh" -o "$work/results" 2>&1)"
    done
done

# points that are as far from each other as a unit vector, and along one of a frame's axes, are no directions
# pendulum PLACE BODIES: an arm and a rod, hinged at PLACE
pendulum() {
    cat <<XXX
gicgen: 1
model: double_pendulum
base: ground
bodies:
  arm: {mass: 2, com: [0.5, 0, 0], inertia: [0.1, 0.2, 0.3]}
  rod: {mass: 1, com: [1, 0, -0.5], inertia: [0.1, 0.2, 0.3]}
joints:
  h: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}
  k: {type: revolute, bodies: [$2], point: $1, axis: [0, 1, 0]}
coordinates:
  w: {type: angle, bodies: [ground, arm], axis: [0, 1, 0]}
  x: {type: angle, bodies: [arm, rod], axis: [0, 1, 0]}
outputs:
  h: {type: reaction, joint: h}
  k: {type: reaction, joint: k}
XXX
}
printf 'w,x,w.rate,x.rate\n0.1,0.2,0.3,0.1\n-0.3,0.1,1,-2\n' >"$work/states"
for place in '[1, 0, 0]' '[-1, 0, 0]' '[0, 0, 1]' '[0, 0, -1]' '[0, 1, 0]' '[0.6, 0, 0.8]'; do
    for bodies in "arm, rod" "rod, arm"; do
        pendulum "$place" "$bodies" >"$work/double.veh"
        "$gicgen" --dump-model "$work/double.veh" >"$work/dump" &&
            "$reference" "$work/dump" "$work/states" -o "$work/accelerations" 2>"$work/said"
        for options in "--recovery auto" "--recovery newton" "--solve augmented"; do
            # shellcheck disable=SC2086
            "$gicrun" --engine tape $options --eval "$work/states" "$work/double.veh" -o "$work/results" &&
                "$agree" "$work/dump" "$work/accelerations" "$work/results" --tolerance 1e-13 --reactions >"$work/said"
            same "hinged at $place, $bodies, $options" 0 $?
        done
    done
done

nearest=$(residual 0.0)
for error in 1e-14 1e-9 1e-6 1e-3; do
    worst=$(residual $error)
    same "poses within $error" yes "$(awk -v x="$worst" -v e=$error 'BEGIN { print (x != "" && x <= 8 * e ? "yes" : x) }')"
done
same "poses off by more than rounding" yes \
    "$(awk -v x="$worst" -v y="$nearest" 'BEGIN { print (x > 1000 * y ? "yes" : x " " y) }')"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
