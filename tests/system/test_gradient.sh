#!/bin/sh
# SPDX-License-Identifier: MIT
# test_gradient.sh GICRUN: gradients of runs, `gicrun --gradient` (tests/vehicle/gradient.py, gradient_loops.py); what it says and refuses.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
/usr/bin/python3 -B "$root/tests/vehicle/gradient.py" "$gicrun" "$models" "$work" >"$work/said" 2>&1
verdict $? "gradients"
tail -n 1 "$work/said"
/usr/bin/python3 -B "$root/tests/vehicle/gradient_loops.py" "$gicrun" "$models" "$work" >"$work/said" 2>&1
verdict $? "gradients of closed loops"
tail -n 1 "$work/said"

car=$models/hmmwv.veh
printf 'gicscene: 1\nduration: 0.1\nstep: 0.005\ninitial: {speed: 5}\n' >"$work/short.scene"
run --gradient 'chassis.x' "$car" "$work/short.scene"
check 'a table' prints '^initial/x.rate .* m/s '
check 'the value' prints '^hmmwv: chassis.x = 0.[45]'
run --gradient 'chassis.x' "$car" "$work/short.scene" -o "$work/a.csv"
run --gradient 'chassis.x' "$car" "$work/short.scene" -o "$work/b.csv"
check 'the same bytes again' cmp "$work/a.csv" "$work/b.csv"
check 'columns' grep -qx 'variable,value,unit,derivative' "$work/a.csv"

run --gradient 'chassis.x' "$car" "$work/short.scene" -o "$work/a.html"
check 'a page' prints '^initial/x.rate .* m/s '
bars() { # a row and a bar a variable, changes from the largest to the smallest, the largest bar half the width
    [ "$(grep -c '<tr><td>' "$work/a.html")" -eq "$(($(wc -l <"$work/a.csv") - 2))" ] && ! grep -q 'nan\|inf' "$work/a.html" &&
        sed -n 's/.*<td class="n">\([-+.e0-9]*\)<\/td><td><svg.*width="\([0-9.]*\)" height="14" fill.*/\1 \2/p' "$work/a.html" |
        awk '{ c = $1 < 0 ? -$1 : $1; if (NR == 1) most = c; bad += NR > 1 && c > last; bad += ($2 - 200 * c / most) ^ 2 > 0.01; last = c }
            END { exit !(NR > 10 && !bad) }'
}
check 'bars, the largest first' bars

# ---- what is refused
rm -f "$work"/no.*
ends() { exits "$1" && says "$2" && [ ! -e "$work/no.csv" ]; }
mistake() { # STATUS TEXT WORD...: said, and no file is left
    wanted=$1
    text=$2
    shift 2
    run "$@" -o "$work/no.csv"
    check "$text" ends "$wanted" "$text"
}
scene() { # LINES
    printf 'gicscene: 1\nduration: 1\n%b\n' "$1" >"$work/bad.scene"
}
tires=$models/hmmwv_tires.veh
scene 'integrator: rkck\noutput_step: 0.1'
mistake 1 'a run in which steps vary' --gradient chassis.x "$car" "$work/bad.scene"
scene 'step: 0.005\nratio: 5\nsteady: 1e-6'
mistake 1 'fast states take longer steps where they are steady' --gradient chassis.x "$tires" "$work/bad.scene"
scene 'step: 0.005\nsleep: {}'
mistake 1 'the vehicle may sleep' --gradient chassis.x "$car" "$work/bad.scene"
scene 'step: 0.001\ninitial: {speed: 10, gear: 1}'
cp -r "$models/parts" "$models/tires" "$models"/hmmwv*.veh "$work"
sed -i 's/latency: 1$/latency: 0.0004/; s/duration: 0.3/duration: 0.0004/' "$work/parts/hmmwv_powertrain.veh"
mistake 1 'two changes of gear in the step to t = 0.001 s' --gradient chassis.x "$work/hmmwv_vehicle.veh" "$work/bad.scene"
mistake 1 "chassis.w" --gradient 'chassis.w' "$car" "$work/short.scene"
mistake 1 'gradient' --gradient 'chassis.x +' "$car" "$work/short.scene"
mistake 2 "there is no 'parameter/none'" --gradient chassis.x "$car" "$work/short.scene" parameter/none
mistake 2 "'parameter/g=x' has no number behind the name" --gradient chassis.z "$root/tests/data/tuning/car.veh" "$work/short.scene" parameter/g=x
mistake 2 "does not find 'initial/x'" --gradient chassis.x "$car" "$work/short.scene" initial/x=1
mistake 2 'no scene given' --gradient chassis.x "$car"
mistake 2 'does not go with --engine' --engine cc --gradient chassis.x "$car" "$work/short.scene"
mistake 2 'one of --eval' --modes --gradient chassis.x "$car" "$work/short.scene"
mistake 1 "1:1: error: signal 'gradient' has no finite derivative at t = 0 s" --gradient 'integral(sqrt(abs(rate(rack))))' "$car" "$work/short.scene"

# ---- formulas past the end of a root or power, also at states of the validation
spring=$work/spring.veh # which gradient.py left
scene 'step: 0.01\ninitial: {coordinates: {x: 0.5}, rates: {x: 1}}'
for formula in 'sqrt(x + 1)' '(x + 1)^0.5' '(x + 1)^1.5' 'log(x + 1)'; do
    run --gradient "$formula" "$spring" "$work/bad.scene" initial/x -o "$work/root.csv"
    check "$formula has a value in this run" exits 0
    mistake 1 "1:1: error: signal 'gradient' has no finite value at t = 0" --gradient "integral($(echo "$formula" | sed 's/+ 1/- 0.25/'))" "$spring" "$work/bad.scene" initial/x
done
for law in 'sqrt(x)' 'x^0.5' '(x - 0.1)^1.5'; do
    sed "s/\"-k \* x .*/\"-k * $law - c * rate(x) + push\"}/" "$spring" >"$work/root.veh"
    mistake 1 "root.veh:18:3: error: force 'spring' has no finite value at t = 0." --gradient cart.x "$work/root.veh" "$work/bad.scene"
    printf 'time [s],cart.x [m]\n0.2,0.4\n0.5,0.1\n1,0\n' >"$work/m.csv"
    mistake 1 "root.veh:18:3: error: force 'spring' has no finite value at t = 0." --identify "$work/m.csv" "$work/root.veh" "$work/bad.scene" parameter/k
done
sed 's/"-k \* x .*/"-k * x * abs(rate(x) - 1)^0.5"}/' "$spring" >"$work/root.veh"
mistake 1 "root.veh:18:3: error: force 'spring' has no finite derivative at t = " --gradient cart.x "$work/root.veh" "$work/bad.scene"
sed 's/^outputs:/signals:\n  inner: "sqrt(x)"\n  outer: "2 * inner"\noutputs:\n  outer: {type: signal, signal: outer}/' "$spring" >"$work/root.veh"
run -q "$work/root.veh" "$work/bad.scene" -o "$work/root.csv"
check 'an output that is a root ends the run, not the validation' says 'a result is not a finite number'
printf 'time [s],outer [1]\n0.2,0.4\n1,0\n' >"$work/m.csv"
mistake 1 "root.veh:20:3: error: signal 'inner' has no finite value at t = " --identify "$work/m.csv" "$work/root.veh" "$work/bad.scene" parameter/k

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
