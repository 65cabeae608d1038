#!/bin/sh
# SPDX-License-Identifier: MIT
# test_mode_steps.sh GICRUN: the longest steps that `gicrun --modes` tells are those with which runs just do not grow, by
# runs themselves on both sides: motions with eigenvalues in closed form, vehicles; and the limits of the methods in their
# own numbers, 6/11 and 2.785 on the real axis, 0.7236 and sqrt(8) on the imaginary one.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

# column NAME FILE: the least number in it
column() {
    awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name " [s]") c = i; next }
        $c != "" && (least == "" || $c + 0 < least) { least = $c + 0 } END { printf "%.17g", least }' "$2"
}
# near A B TOLERANCE: relative
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a / b - 1; exit !((d < 0 ? -d : d) <= t) }'; }

# oscillator MASS STIFFNESS DAMPING: a body on a spring and a damper
oscillator() {
    cat >oscillator.veh <<END
gicgen: 1
model: oscillator
gravity: [0, 0, 0]
base: ground
bodies: {b: {mass: $1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}}
forces: {f: {type: spring_damper, coordinate: x, stiffness: $2, damping: $3, free: 0}}
outputs: {x: {type: coordinate, coordinate: x}}
END
}
# grows MODEL COLUMN INTEGRATOR STEP SCENE: the amplitude over the last 200 steps of 1400 above that over 200 before
# half of them, or the run fails
grows() {
    { printf 'gicscene: 1\nintegrator: %s\nstep: %s\nduration: %s\n' "$3" "$4" "$(awk -v h="$4" 'BEGIN { printf "%.17g", 1400.5 * h }')"
        cat "$5"; } >grows.scene
    "$gicrun" -q "$1" grows.scene -o grows.csv >/dev/null 2>&1 || return 0
    awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; ++i) if (index($i, name " ") == 1) c = i; next }
        { x = $c + 0; x = x < 0 ? -x : x; k = NR - 2; if (k > 500 && k <= 700 && x > a) a = x; if (k > 1200 && x > b) b = x }
        END { exit !(b > a) }' grows.csv
}
# around MODEL COLUMN INTEGRATOR STEP SCENE PART: runs with steps that are shorter by that part do not grow, with longer
# ones they do
around() {
    ! grows "$1" "$2" "$3" "$(awk -v h="$4" -v p="$6" 'BEGIN { printf "%.17g", h * (1 - p) }')" "$5" &&
        grows "$1" "$2" "$3" "$(awk -v h="$4" -v p="$6" 'BEGIN { printf "%.17g", h * (1 + p) }')" "$5"
}

# ---- a body on a spring and a damper: mass, stiffness, damping, |lambda|, what |lambda| h may be with AB3 and RK4 where
# it is known in numbers, otherwise 0
echo 'initial: {coordinates: {x: 1e-3}, rates: {x: 1e-3}}' >pulled
while read -r mass stiffness damping size ab3 rk4 case; do
    oscillator "$mass" "$stiffness" "$damping"
    run --modes oscillator.veh -o modes.csv
    check "$case: modes" exits 0
    for method in ab3 rk4; do
        told=$(column "stable.$method" modes.csv)
        known=$([ $method = ab3 ] && echo "$ab3" || echo "$rk4")
        [ "$known" = 0 ] || check "$case: $method to $told s" near "$(awk -v h="$told" -v s="$size" 'BEGIN { printf "%.9g", h * s }')" "$known" 1e-4
        check "$case: $method is stable up to $told s" around oscillator.veh x.rate "$method" "$told" pulled 0.005
    done
done <<'END'
1 10000 0 100 0.723605 2.828427 undamped, 100 rad/s
1 1 0 1 0.723605 2.828427 undamped, 1 rad/s
4 400 40 10 0 0 damped by half
1 100 1 10 0 0 damped by a twentieth
1 10100 200 100.4987562 0 0 -100 +- 10i
1 0 1000 1000 0.545454545 2.785293563 a damper alone
2 1000000 4000 707.1067812 0 0 damped by 1.4: two real eigenvalues
END
# ---- vehicles, let go from rest with a small rate of one coordinate: runs with 2 % less and 2 % more
while read -r case method column rate; do
    model=$root/models/$case.veh
    run --modes "$model" -o modes.csv
    check "$case: modes" exits 0
    echo "initial: {equilibrium: true, $rate}" >moved
    told=$(column "stable.$method" modes.csv)
    check "$case: $method is stable up to $told s" around "$model" "$column" "$method" "$told" moved 0.02
done <<'END'
hmmwv ab3 spring_r_l.rate rates: {spring_r_l: 1e-6}
quarter_car ab3 spring.rate rates: {spring: 1e-6}
quarter_car rk4 spring.rate rates: {spring: 1e-6}
END

# ---- the table for people has the least of each
oscillator 1 10000 0
run --modes oscillator.veh
check "a row of AB3" prints '^ab3  *0.007236 s  *0.00[0-9.]* s  0 +- 100i: x 100 %$'
check "a row of imex" prints '^imex  *any  *0.001[67][0-9]* s *$'
check "a row of ros3" prints '^ros3  *any  *0.0[0-9.]* s *$'

# ---- auto: |lambda| is 1000 1/s, so AB3 is stable to 0.64 ms; which it takes, and that the run is that of its name
oscillator 1 1e6 200
# automatic STEP PATTERN INTEGRATOR OF_STEP [OPTION...]
automatic() {
    { printf 'gicscene: 1\nintegrator: auto\nstep: %s\noutput_step: 0.08\nduration: 0.8\n' "$1"; cat pulled; } >auto.scene
    sed "s/auto/$3/; s/^step: .*/step: $4/" auto.scene >named.scene
    expected=$2
    shift 4
    run "$@" oscillator.veh auto.scene -o auto.csv
    check "auto: $expected" says "integrator auto: $expected"
    run -q "$@" oscillator.veh named.scene -o named.csv
    check "auto: $expected: the run is that of its name" cmp -s auto.csv named.csv
}
automatic 0.02 'ros3, steps of 0.02 s$' ros3 0.02
automatic 0.0005 'ab3, steps of 0.0005 s$' ab3 0.0005
automatic 0.001 'ab3, steps of 0.0005 s$' ab3 0.0005
automatic 0.002 'ab3, steps of 0.0005 s$' ab3 0.0005 --engine tape
run oscillator.veh auto.scene -o auto.csv
check "auto: what limits it" says "ab3 is stable up to 0.000[67][0-9]* s, rk4 up to 0.00[23][0-9]* s: 'x', eigenvalue -100 +- 995i 1/s at t = 0 s"
# imex is offered with Jacobians that are kept, where ros3 shows no motion that it does not
cp pulled one_by_one
echo 'keep_jacobian: 8' >>pulled
automatic 0.02 'imex, steps of 0.02 s$' imex 0.02
run oscillator.veh auto.scene -o auto.csv
check "auto: what imex takes" says "for 0.02 s, about: .* ros3 6.875 imex 2.475$"
sed -i 's/^step: .*/step: 0.0007/; s/^output_step: .*/output_step: 0.07/; s/^duration: .*/duration: 0.7/' auto.scene
run oscillator.veh auto.scene -o auto.csv
check "auto: at 0.7 ms ros3 shows the vibration to 1 %, imex does not" says "for 0.0007 s, about: .* ros3 6.875$"
sed 's/^step: .*/step: 0.02/; s/^output_step: .*/output_step: 0.1/' auto.scene >tape.scene
run --engine tape oscillator.veh tape.scene -o auto.csv
check "auto: no implicit steps with the tape" says "integrator auto: [abrk34]*, "
mv one_by_one pulled
# a state a thousand million times as fast as a second: the way ahead by variable steps ends
{ cat oscillator.veh && printf 'states:\n  lag: {rate: "(time - lag) / 1e-9"}\n'; } >lag.veh
sed 's/^step: .*/step: 0.02/; s/^output_step: .*/output_step: 0.1/' auto.scene >lag.scene
timeout 60 "$gicrun" lag.veh lag.scene -o auto.csv >out 2>err
verdict $? "auto: beside a state of 1 ns"
check "auto: what limits explicit steps there" grep -q "ab3 is stable up to 5.4[0-9]*e-10 s, .*: 'lag', eigenvalue -1e+09 1/s" err
run --linearize --at 0.1 oscillator.veh auto.scene
check "auto is refused where nothing chooses" says 'does not choose an integrator (auto) yet'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
