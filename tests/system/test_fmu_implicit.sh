#!/bin/sh
# SPDX-License-Identifier: MIT
# test_fmu_implicit.sh GICGEN GICRUN: Functional Mock-up Units with implicit steps (ros2, ros3, imex) and exponential ones (exp3), by the importer of
# tests/fmi: co-simulation is gicrun's bit for bit, with kept Jacobians and controllers, and after going back.
gicgen=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/fmi/lib.sh
. "$(dirname "$0")/../fmi/lib.sh"
importer -o "$work/importer" >"$work/out" 2>"$work/err"
verdict $? "the importer compiles"

# implicit MODEL.veh SCENE OUTPUT_STEP DURATION: the scene with gicrun and in an FMU of $version
implicit() {
    vehicle=$(basename "$1" .veh)
    "$gicrun" -q --general --engine tcc "$1" "$2" -o "$work/steps.csv" 2>"$work/err"
    verdict $? "$vehicle: gicrun"
    unit "$1" "$2"
    verdict $? "$vehicle: FMI $version.0"
    check "$vehicle, FMI $version.0: its description" described
    drive steps "$3" "$4" >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "$vehicle, FMI $version.0: co-simulation is gicrun's, bit for bit"
    drive rollback "$3" "$(awk "BEGIN { print 20 * $3 }")" 7 >"$work/out" 2>"$work/err"
    verdict $? "$vehicle, FMI $version.0: going back"
}

version=2
python3 "$here/scene.py" "$root/models/scenes/quarter_car.scene" 1 0.02 >"$work/drawn.scene"
as() { sed -e "s/\"integrator\": \"[a-z0-9]*\"/\"integrator\": \"$1\", \"keep_jacobian\": $2/; s/\"step\": [0-9.]*/\"step\": $3/" "$work/drawn.scene"; }
for version in 2 3; do
    as ros3 3 0.004 >"$work/quarter.scene"
    implicit "$root/models/quarter_car.veh" "$work/quarter.scene" 0.02 1
done
cp -r "$work/unit" "$work/third"
# the importer chooses another one
for word in "ros2 1 3" "imex 5 5"; do
    # shellcheck disable=SC2086  # three words
    set -- $word
    as "$1" "$2" 0.004 >"$work/other.scene"
    "$gicrun" -q --general --engine tcc "$root/models/quarter_car.veh" "$work/other.scene" -o "$work/steps.csv" 2>"$work/err" &&
        drive steps 0.02 1 "solver.method=$3" "solver.keep_jacobian=$2" >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv"
    verdict $? "quarter_car: $1 that the importer chooses"
done
says_of() { # MESSAGE NAME=VALUE
    wanted=$1
    shift
    ! drive steps 0.02 1 "$@" >"$work/out" 2>"$work/err" && says "$wanted"
}
check "no method 6" says_of "1 (AB3), 2 (RK4), 3 (ROS2), 4 (ROS3) or 5 (IMEX), not 6" solver.method=6
check "no Jacobian for 0 steps" says_of "from 1 to 1000, not 0" solver.keep_jacobian=0
for step in 0 -0.01 9e-10; do
    check "no step of $step" says_of "solver.step must be 1e-9 s or more, not $step" solver.step=$step
done
for version in 2 3; do
    as exp3 60 0.004 >"$work/exponential.scene"
    implicit "$root/models/quarter_car.veh" "$work/exponential.scene" 0.02 1
    check "FMI $version.0: no method 7" says_of "5 (IMEX) or 6 (EXP3), not 7" solver.method=7
done
rm -rf "$work/unit" && cp -r "$work/third" "$work/unit"
drive cvode 1e-9 0.02 1 >"$work/unit.csv" 2>"$work/err" &&
    "$gicrun" -q --general --engine tcc --integrator adams --tolerance 1e-11 "$root/models/quarter_car.veh" "$work/quarter.scene" -o "$work/variable.csv" 2>>"$work/err" &&
    as_run 1e-7 "$work/variable.csv" "m rad 1 m/s rad/s"
verdict $? "quarter_car: model exchange is as without"

# Jacobians by shares: of the scene, switched off by the importer, and what is refused
for version in 2 3; do
    as imex '8, "spread_jacobian": true' 0.004 >"$work/shared.scene"
    as imex 8 0.004 >"$work/whole.scene"
    implicit "$root/models/quarter_car.veh" "$work/shared.scene" 0.02 1
    cp "$work/steps.csv" "$work/shares.csv"
    "$gicrun" -q --general --engine tcc "$root/models/quarter_car.veh" "$work/whole.scene" -o "$work/steps.csv" 2>"$work/err" &&
        drive steps 0.02 1 solver.spread_jacobian=0 >"$work/unit.csv" 2>"$work/err" && as_run 0 "$work/steps.csv" && ! cmp -s "$work/steps.csv" "$work/shares.csv"
    verdict $? "FMI $version.0: whole Jacobians that the importer chooses"
    check "FMI $version.0: no half shares" says_of "solver.spread_jacobian is 0 or 1, not 2" solver.spread_jacobian=2
done
"$gicgen" --fmu 3 --solve augmented "$root/models/quarter_car.veh" --scene "$work/shared.scene" -o "$work/none.fmu" 2>"$work/err"
[ $? -ne 0 ] && says "not made by shares" && [ ! -e "$work/none.fmu" ]
verdict $? "shares of a model that has none are refused"

# without a scene: --implicit, which lets the importer choose; it begins with AB3
CC=$work/plain_cc "$gicgen" --fmu 3 --implicit "$root/models/pendulum.veh" -o "$work/choice.fmu" 2>"$work/err" &&
    rm -rf "$work/unit" && unpack "$work/choice.fmu" "$work/unit" &&
    drive steps 0.01 1 solver.method=4 solver.step=0.01 >"$work/unit.csv" 2>"$work/err" &&
    printf 'gicscene: 1\nduration: 1\nstep: 0.01\nintegrator: ros3\n' >"$work/pendulum.scene" &&
    "$gicrun" -q --general --engine tcc "$root/models/pendulum.veh" "$work/pendulum.scene" -o "$work/steps.csv" 2>"$work/err" &&
    as_run 0 "$work/steps.csv"
verdict $? "pendulum, --implicit: ros3 that the importer chooses"

# sampled controllers, in parts of steps
version=2
sed 's/@period@/0.03/; s/@offset@/0.005/; s/@delay@/0.04/; s/@quantum@//; s/@mean@/0.1/; s/@mean_offset@/0/; s/@spring@/18/; s/@start@/0.5/' \
    "$root/tests/controllers/loop.veh.in" >"$work/loop.veh"
printf 'gicscene: 1\nstep: 0.007\noutput_step: 0.07\nduration: 1.4\nintegrator: ros2\n' >"$work/loop.scene"
implicit "$work/loop.veh" "$work/loop.scene" 0.07 1.4

# any calls in any order, under sanitizers
version=3
# shellcheck disable=SC2086  # a list of words
importer $sanitize -o "$work/sanitized" 2>"$work/err" &&
    (cd "$work/third/sources" && ${CC:-cc} -std=c99 -pedantic -Wall -Wextra -Werror -O0 $sanitize -fPIC -shared ./*.c -o "$work/sources.so" -lm) 2>"$work/err"
verdict $? "sources compile for sanitizers, without warnings"
printf 'leak:xml\nleak:description\n' >"$work/kept"
for task in "attack 4 1500" "misuse" "rollback 0.004 0.2 5"; do
    # shellcheck disable=SC2086  # a list of words
    LSAN_OPTIONS=suppressions=$work/kept:print_suppressions=0 "$work/sanitized" "$work/sources.so" "$work/third/modelDescription.xml" $task >"$work/out" 2>"$work/err"
    verdict $? "sanitizers: $task"
done

# refused: the scene leaves the choice to gicrun; an FMU without implicit steps has no such method
sed 's/"ros3", "keep_jacobian": 3/"auto"/' "$work/quarter.scene" >"$work/auto.scene"
"$gicgen" --fmu 2 "$root/models/quarter_car.veh" --scene "$work/auto.scene" -o "$work/none.fmu" 2>"$work/err"
[ $? -ne 0 ] && says "an FMU does not choose an integrator" && [ ! -e "$work/none.fmu" ]
verdict $? "auto is refused"
version=2
unit "$root/models/pendulum.veh"
check "an FMU without implicit steps refuses them" says_of "1 (AB3) or 2 (RK4), not 4" solver.method=4

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
