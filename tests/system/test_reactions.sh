#!/bin/sh
# SPDX-License-Identifier: MIT
# test_reactions.sh GICGEN GICRUN: reactions and drive forces against hand calculations, in either form of the equations
# of motion: the pendulum at rest and swinging, the quarter car standing still and moving. What no output needs is not
# emitted; what is compiles without warnings as C99, C++ and in single precision and passes its own self-test.
# Tolerance: 1e-12 of the largest force or torque that enters.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# balances FORM LABEL PROGRAM: an awk program over the rows of `results` says with same(label, is, should, scale) what
# must be equal; v["name"] is a cell of the row, 0 where there is no such column. There must be a row for each state.
balances() {
    awk -F, '
        function same(label, is, should, scale) {
            if ((is - should) ^ 2 <= (1e-12 * scale) ^ 2) return
            print "row " NR - 1 ", " label ": " is " instead of " should
            bad = 1
        }
        NR == 1 { for (i = 1; i <= NF; ++i) { sub(/ \[.*/, "", $i); name[i] = $i } next }
        { for (i = 1; i <= NF; ++i) v[name[i]] = $i }
        v["status"] != 0 { print "row " NR - 1 ": status " v["status"]; bad = 1 }
        '"$3"'
        END { exit bad || NR - 1 != rows }' rows="$(($(wc -l <states) - 1))" results
    verdict $? "$1: $2"
}

# ---- pendulum: m = 1, centre of mass at d = 0.5 from the pivot, angle'' = g cos(angle), force = m (a - g), no torque

cat >pendulum.veh <<END
gicgen: 1
include: $root/models/pendulum.veh
model: pendulum
outputs:
  pivot: {type: reaction, joint: pivot}
  rod: {type: reaction, joint: pivot, in: rod}
END
cat >states <<'END'
angle,angle.rate
0,0
1.5707963267948966,0
1.5707963267948966,2
0.7,-1.3
-0.9,6
2.8,0.4
END
for form in reduced augmented; do
    "$gicrun" --solve $form --eval states pendulum.veh -o results
    verdict $? "pendulum, $form"
    # shellcheck disable=SC2016
    balances $form "pendulum" '{
        getline state <"states"
        if (NR == 2) getline state <"states"
        split(state, s, ",")
        c = cos(s[1]); n = sin(s[1])
        along = 0.5 * s[2] ^ 2 + 9.81 * n; across = 0.5 * 9.81 * c - 9.81 * c
        size = 9.81 + s[2] ^ 2
        same("x", v["output.pivot.force.x"], along * c + across * n, size)
        same("y", v["output.pivot.force.y"], 0, size)
        same("z", v["output.pivot.force.z"], along * n - across * c, size)
        same("along the rod", v["output.rod.force.x"], along, size)
        same("across the rod", v["output.rod.force.z"], -across, size)
        for (i = 1; i <= 3; ++i) {
            k = substr("xyz", i, 1)
            same("torque " k, v["output.pivot.torque." k], 0, size)
        }
    }'
done

# ---- quarter car, held still by its two coordinates: weights, tire, drives and the guide in balance

outputs='
  guide: {type: reaction, joint: guide}
  arm: {type: reaction, joint: arm}
  ball: {type: reaction, joint: ball}
  upper: {type: reaction, joint: upper}
  tierod: {type: reaction, joint: tierod}
  arm_com: {type: position, body: arm, point: [0, 0.5468112, 0.414945]}
  wheel_com: {type: position, body: wheel, point: [-0.040386, 0.8756173, 0.447711]}
  a_arm: {type: acceleration, body: arm, point: [0, 0.5468112, 0.414945]}
  a_wheel: {type: acceleration, body: wheel, point: [-0.040386, 0.8756173, 0.447711]}'
masses='function balance(k, g) { # forces on wheel, arm and all, without drives
        f = k == "z" ? v["output.tire.fz"] : 0
        wheel = f - 90.555 * (g + v["output.a_wheel." k])
        all = wheel - 23.965 * (g + v["output.a_arm." k]) - 525.59 * (g + v["output.carriage_acceleration." k])
        same("wheel " k, v["output.ball.force." k] + v["output.upper.force." k] + v["output.tierod.force." k], -wheel, size)
        all += k == "z" ? v["output.lift"] : 0
        same("all " k, v["output.guide.force." k], -all, size)
    }'
# variant NAME: the quarter car with these outputs, after the script on standard input
variant() {
    cp "$root/models/quarter_car.veh" "$1.veh" && sed -f - "$1.veh" >still && printf '%s\n' "$outputs" |
        sed '1d' | cat still - >"$1.veh"
}
variant still <<'END'
s/^\(  bounce: {type: translation,\)/\1 driven: true,/
s/^\(  spring: {type: length,\)/\1 driven: true,/
s/^outputs:/&\n  lift: {type: drive_force, coordinate: bounce}\n  push: {type: drive_force, coordinate: spring}/
END
cat >states <<'END'
bounce,bounce.rate,bounce.acceleration,spring,spring.rate,spring.acceleration
0,0,0,0.25,0,0
-0.02,0,0,0.22,0,0
-0.1,0,0,0.28,0,0
0.1,0,0,0.23,0,0
END
for form in reduced augmented; do
    "$gicrun" --solve $form --eval states still.veh -o results
    verdict $? "standing quarter car, $form"
    balances $form "standing quarter car" '
        '"$masses"'
        {
            size = 6300 + v["output.tire.fz"]
            balance("x", 0); balance("y", 0); balance("z", 9.81)
            same("guide along its axis", v["output.guide.force.z"], 0, size)
            # vertical forces and their moments about the origin of the carriage
            point[1] = "wheel"; F[1] = v["output.tire.fz"]
            point[2] = "wheel_com"; F[2] = -90.555 * 9.81
            point[3] = "arm_com"; F[3] = -23.965 * 9.81
            x = y = 0
            for (i = 1; i <= 3; ++i) {
                x += (v["output." point[i] ".y"] - v["output.carriage.y"]) * F[i]
                y -= (v["output." point[i] ".x"] - v["output.carriage.x"]) * F[i]
            }
            same("torque x", v["output.guide.torque.x"], -x, size)
            same("torque y", v["output.guide.torque.y"], -y, size)
            same("torque z", v["output.guide.torque.z"], 0, size)
        }'
done

# ---- the same in motion: what the joints exert is what the masses need beyond weights and tire

variant moving </dev/null
cat >states <<'END'
bounce,bounce.rate,spring,spring.rate
0,0,0.25,0
-0.03,0.4,0.24,-0.5
0.05,-1,0.28,0.8
-0.1,0.2,0.21,1
END
for form in reduced augmented; do
    "$gicrun" --solve $form --eval states moving.veh -o results
    verdict $? "moving quarter car, $form"
    balances $form "moving quarter car" '
        '"$masses"'
        {
            size = 6300 + v["output.tire.fz"] + 2 * (v["output.force"] < 0 ? -v["output.force"] : v["output.force"])
            balance("x", 0); balance("y", 0); balance("z", 9.81)
            same("guide along its axis", v["output.guide.force.z"], 0, size)
        }'
    cp results "moving.$form"
done

# ---- a drive in the place of the spring, moving as the spring let it: the same force, and the same everywhere else

variant replaced <<'END'
s/^\(  spring: {type: length,\)/\1 driven: true,/
/^  spring: {type: spring_damper/d
s/^forces:.*/forces: {}/
s/^  force: .*/  force: {type: drive_force, coordinate: spring}/
END
for form in reduced augmented; do
    awk -F, 'NR == FNR { line[NR] = $0; next }
        FNR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^spring.acceleration/) column = i }
        { print line[FNR] "," (FNR == 1 ? "spring.acceleration" : $column) }' states "moving.$form" >driven
    "$gicrun" --solve $form --eval driven replaced.veh -o results
    verdict $? "drive in the place of the spring, $form"
    sed 's/ \[[^],]*\]//g' "moving.$form" >spring
    balances $form "drive in the place of the spring" '
        {
            if (NR == 2) { getline line <"spring"; names = split(line, of, ",") }
            getline line <"spring"
            split(line, cell, ",")
            size = 6300 + v["output.tire.fz"]
            for (i = 1; i <= names; ++i) if (of[i] == "output.force" || of[i] ~ /(force|torque)\.[xyz]$/) {
                size += cell[i] < 0 ? -cell[i] : cell[i]; ++compared }
            for (i = 1; i <= names; ++i) if (of[i] == "output.force" || of[i] ~ /(force|torque)\.[xyz]$/)
                same(of[i], v[of[i]], cell[i], size)
            if (compared != 31 * (NR - 1)) { print compared " numbers compared"; bad = 1 }
        }'
done

# ---- what is emitted

# asks JOINT...: hmmwv.veh asking for their reactions
asks() {
    printf '%s\n' "gicgen: 1" "include: $root/models/hmmwv.veh" "model: hmmwv" "outputs:" >hmmwv.veh
    for joint in "$@"; do echo "  $joint: {type: reaction, joint: $joint}" >>hmmwv.veh; done
    # the same reaction whatever else stands on its right side
    printf '%s\n' "  force: {type: force, element: spring_f_l}" >>hmmwv.veh
}
# solves COUNT LABEL: number of subsets whose multipliers the code solves for
solves() {
    "$gicgen" hmmwv.veh -o hmmwv.c
    verdict $? "gicgen, $2"
    count=$(grep -c '^    hmmwv_react_.*&links' hmmwv.c)
    [ "$count" -eq "$1" ]
    verdict $? "$2: multipliers of $count subsets instead of $1"
}
asks
solves 0 "no reactions"
! grep -q 'hmmwv_react' hmmwv.c
verdict $? "functions for reactions that nobody asks for"
asks upper_r_r # a leaf
solves 1 "a wheel's link"
asks arm_r_r # carries the wheel
solves 2 "an arm"
asks rack_guide # carries both tie rods
solves 3 "the rack"

# ---- the code compiles everywhere, and its self-test measures rounding

"$gicgen" --dump-model "$root/models/hmmwv.veh" >dump &&
    sh "$root/tests/lib/reactions.sh" dump "$root/models/hmmwv.veh" >hmmwv.veh
cat >drive.c <<'END'
#include "hmmwv.h"
#include <stdio.h>
int main(void)
{
    static hmmwv vehicle;
    gic_self_test test;
    int i, status = hmmwv_setup(&vehicle);
    /* off the symmetric motion, where equations hold nothing but rounding */
    vehicle.state[HMMWV_STATE_OMEGA_X] = GIC_R(0.2);
    vehicle.state[HMMWV_STATE_OMEGA_Z] = GIC_R(-0.3);
    vehicle.state[HMMWV_STATE_RACK_RATE] = GIC_R(0.1);
    for (i = 0; i < 200 && status == GIC_OK; ++i)
        status = hmmwv_step(&vehicle, GIC_R(0.005), GIC_RK4);
    if (status == GIC_OK)
        status = hmmwv_self_test(&vehicle, &test);
    if (status == GIC_OK)
        status = hmmwv_outputs(&vehicle);
    printf("%d %g %g %g %g %g\n", status, (double)test.constraint, (double)test.symmetry, (double)test.balance,
           (double)test.energy, (double)test.smallest_pivot);
    return status;
}
END
flags="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -I$root/runtime -I."
for form in reduced augmented; do
    "$gicgen" --solve $form hmmwv.veh -o hmmwv.c
    verdict $? "gicgen --solve $form"
    grep -q "^ \* Equations of motion in the $form form" hmmwv.c
    verdict $? "$form: the head of the code does not say so"
    # shellcheck disable=SC2086
    ${CC:-cc} -std=c99 -O0 $flags -o drive drive.c hmmwv.c "$root/runtime/gic_runtime.c" -lm
    verdict $? "$form: compiled as C99"
    # the balance is that of the reduced form's equations: in the other form the accelerations' rounding shows in it
    ./drive >said && awk '{ exit !(NF == 6 && $1 == 0 && $2 <= 1e-13 && $3 <= 1e-13 && $4 <= 1e-11 && $5 <= 1e-12 &&
        $6 > 0) }' said
    verdict $? "$form: self-test: $(cat said)"
    # shellcheck disable=SC2086
    ${CC:-cc} -std=c99 -O0 $flags -Wdouble-promotion -Wfloat-conversion -DGIC_FLOAT -c -o single.o hmmwv.c
    verdict $? "$form: single precision"
    # shellcheck disable=SC2086
    ${CXX:-c++} -x c++ -O0 $flags -c -o cxx.o hmmwv.c
    verdict $? "$form: compiled as C++"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
