#!/bin/sh
# SPDX-License-Identifier: MIT
# test_controllers.sh GICGEN GICRUN: sampled controllers (FORMAT.md section 7.4). A mass under discrete control against its
# motion in closed form from event to event (tests/controllers/exact.py): periods equal to the step, twice, half of it and
# no multiple, longer than the run, offsets, delays of none, part of a period, one, several, rounding, two controllers at
# one instant or not; all integrators, engines, one rate and two; with a spring, orders of RK4 and AB3 across samples.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
within() { awk "BEGIN { exit !($1 <= $2) }"; }

# loop SETTING=VALUE...: loop.veh with these; the others as exact.py has them
loop() {
    period=0.1 offset=0 delay=0 quantum='' mean=0.1 mean_offset=0 spring=0 start=0
    for setting; do
        eval "${setting%%=*}=${setting#*=}"
    done
    [ -z "$quantum" ] || quantum=", quantum: $quantum"
    sed "s/@period@/$period/; s/@offset@/$offset/; s/@delay@/$delay/; s/@quantum@/$quantum/; s/@mean@/$mean/
        s/@mean_offset@/$mean_offset/; s/@spring@/$spring/; s/@start@/$start/" "$root/tests/controllers/loop.veh.in" >loop.veh
}
# scene STEP OUTPUT_STEP DURATION LINE...
scene() {
    printf 'gicscene: 1\nstep: %s\noutput_step: %s\nduration: %s\n' "$1" "$2" "$3" >a.scene
    shift 3
    printf '%s\n' "$@" >>a.scene
}
# off SETTING=VALUE...: largest deviation of out.csv
off() { /usr/bin/python3 -B "$root/tests/controllers/exact.py" out.csv "$@"; }
# run LIMIT NAME OPTIONS -- SETTING=VALUE...: the scene with these
run() {
    limit=$1 name=$2 options=$3
    shift 4
    loop "$@"
    rm -f out.csv
    # shellcheck disable=SC2086  # options
    "$gicrun" -q $options loop.veh a.scene -o out.csv 2>err
    found=$(off "$@" 2>&1)
    check "$name, $options $*: ${found:-no run}" within "${found:-1}" "$limit"
}

# ---- the closed form, at any step: RK4, AB3 and two rates are exact on parabolas
for method in 'integrator: rk4' 'integrator: ab3' 'ratio: 4'; do
    scene 0.1 0.1 2 "$method"
    run 1e-12 "period = step, $method" '' --
    run 1e-12 "period of two steps, $method" '' -- period=0.2
    run 1e-12 "period of half a step, $method" '' -- period=0.05 mean=0.025
    run 1e-12 "period longer than the run, $method" '' -- period=3 mean=100
    scene 0.006 0.06 2.4 "$method"
    run 1e-12 "period 1/7 s, $method" '' -- period=0.14285714285714285
    run 1e-12 "both, apart, $method" '' -- period=0.14285714285714285 mean=0.0909090909 offset=0.05 mean_offset=0.003
    run 1e-12 "delay of part of a period, $method" '' -- period=0.09 delay=0.02
    run 1e-12 "delay of a period, $method" '' -- period=0.09 delay=0.09
    run 1e-12 "delay of 2.5 periods, $method" '' -- period=0.0625 delay=0.15625
    run 1e-12 "delay of 3 periods, $method" '' -- period=0.1 delay=0.3
    run 1e-12 "rounded, $method" '' -- period=0.03 quantum=0.5
    run 1e-12 "rounded and delayed, $method" '' -- period=0.07 quantum=0.25 delay=0.1
done
scene 0.1 0.1 2
# adams begins at first order after each change, so that the errors of many steps add up
for tolerance in 1e-6 1e-9; do
    for method in adams rkck; do
        scene 0.1 0.1 2 "integrator: $method" "tolerance: $tolerance"
        most=${tolerance#*-}
        [ $method = rkck ] || most=$((most - 3))
        run 1e-"$most" "variable steps, $method, $tolerance" '' -- period=0.14285714285714285 delay=0.05 mean=0.1
    done
done
scene 0.01 0.1 2 'integrator: ab3' 'ratio: 2'
for way in --general '--engine cc' '--engine tape' '--engine gic' '--engine gcp1' '--engine gcp2' '--solve augmented'; do
    run 1e-11 'engines' "$way" -- period=0.07 delay=0.1 mean=0.1
done

# ---- the summary names a controller with instants within steps, and a step that fits
# told NAME STEP TEXT SETTING=VALUE...: the line says TEXT; without TEXT there is none
told() {
    name=$1 text=$3
    scene "$2" 0.1 1 'integrator: ab3'
    shift 3
    loop "$@"
    "$gicrun" loop.veh a.scene -o out.csv 2>err
    found=$(sed -n 's/^  steps in parts  *//p' err)
    verdict "$([ "$found" = "$text" ]; echo $?)" "$name: $found"
}
told 'a period of no multiple' 0.002 \
    "the period of controller 'servo', 0.0025 s, is no multiple of the step, 0.002 s; 0.00125 s fits" period=0.0025
told 'the step that fits' 0.00125 '' period=0.0025
told 'an offset' 0.002 \
    "the offset of controller 'servo', 0.001 s, is no multiple of the step, 0.002 s; 0.001 s fits" period=0.004 offset=0.001
told 'a delay' 0.01 \
    "the delay of controller 'servo', 0.005 s, is no multiple of the step, 0.01 s; 0.005 s fits" period=0.02 delay=0.005
told 'the second controller' 0.01 \
    "the period of controller 'mean', 0.025 s, is no multiple of the step, 0.01 s; 0.00625 s fits" mean=0.025
told 'no step' 0.01 "the period of controller 'servo', 0.01001 s, is no multiple of the step, 0.01 s, and no step near \
it fits all controllers" period=0.01001
told 'a third of a tenth' 0.03333333333333333 '' period=0.1
told 'ten steps, rounded' 0.01 '' period=0.1 offset=0.3 delay=0.07

# ---- 10^5 samples: k * period, no sum. In 1000 s a sum of 0.01 is off by some 1e-9 s
scene 0.005 100 1000 'integrator: ab3'
run 1e-10 'long' '' -- period=0.01 mean=0.1 delay=0.0125

# ---- rounding of exact halves: 0.5, 1.5, -0.5, -1.5 and what is no half
halves() {
    cat >halves.veh <<END
gicgen: 1
model: halves
base: ground
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-10, 10]}}
tables: {u: {x: [0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2], y: [$2]}}
controllers: {round: {period: 0.25, rules: {u: {value: u(time), quantum: $1}}}}
signals: {rounded: round.u}
outputs: {rounded: {type: signal, signal: rounded}}
END
    printf 'gicscene: 1\nstep: 0.25\noutput_step: 0.25\nduration: 2\n' >halves.scene
    "$gicrun" -q halves.veh halves.scene -o halves.csv 2>err
    found=$(awk -F, 'NR > 2 { printf "%s ", $2 + 0 }' halves.csv)
    verdict "$([ "$found" = "$3 " ]; echo $?)" "multiples of $1: $found"
}
halves 1 '0.5, 1.5, -0.5, -1.5, 0.25, -0.75, 2, 0, 0' '1 2 -1 -2 0 -1 2 0'
halves 0.5 '0.25, 0.75, -0.25, -0.75, 0.125, -0.5, 1, 0.24, 0' '0.5 1 -0.5 -1 0 -0.5 1 0'

# ---- conditions on what is held become true when it changes: at a sample, at a step's end or within it, or after a delay
for way in '0.25 ab3 0' '0.1 ab3 0' '0.1 rk4 0.05' '0.07 ab3 0.1' '0.25 rk4 0.1' '0.25 rkck 0' '0.07 adams 0.1'; do
    # shellcheck disable=SC2086  # words
    set -- $way
    cat >clock.veh <<END
gicgen: 1
model: clock
base: ground
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-10, 10]}}
controllers: {clock: {period: 0.25, rules: {t: {value: time, unit: s, delay: $3}}}}
signals: {seen: {value: clock.t, unit: s}}
outputs: {seen: {type: signal, signal: seen}}
END
    printf 'gicscene: 1\nstep: %s\nintegrator: %s\nduration: 2.1\nwhen: [{if: seen > 0.6, mark: m}]\n' "$1" "$2" >clock.scene
    [ "$1" != 0.25 ] || sed -i 's/2.1/2/' clock.scene
    "$gicrun" clock.veh clock.scene -o clock.csv 2>err
    found=$(sed -n 's/.* at t = \([0-9.]*\) s.*/\1/p' err)
    verdict "$(awk -v t="${found:-0}" -v d="$3" 'BEGIN {t -= 0.75 + d; exit !(t < 1e-9 && t > -1e-9)}'; echo $?)" \
        "a condition on what is held, $way: $found"
done

# ---- orders across samples: a spring, 3 rad/s
for method in 'rk4 13' 'ab3 6.5'; do
    for step in 0.005 0.0025; do
        scene $step 0.1 2 "integrator: ${method% *}"
        settings='period=0.14285714285714285 delay=0.05 mean=0.1 spring=18 start=0.5'
        # shellcheck disable=SC2086  # settings
        loop $settings
        "$gicrun" -q loop.veh a.scene -o out.csv 2>err
        # shellcheck disable=SC2086  # settings
        off $settings
    done >errors
    awk -v most="${method#* }" 'NR == 1 { a = $1 } NR == 2 { b = $1 } END { exit !(NR == 2 && a < 1e-4 && a / b > most) }' errors
    verdict $? "order of ${method% *}: $(tr '\n' ' ' <errors)"
done

# ---- a function in C in the slot of a formula: the same model but for the formula of `force`
loop period=0.07 delay=0.1 mean=0.1
"$gicgen" loop.veh -o loop.c
# shellcheck disable=SC2016  # no expansion
sed 's/^model: .*/model: slot/; s/force: {value: "8[^"]*", /force: {/' loop.veh >slot.veh
"$gicgen" slot.veh -o slot.c
for flags in '-std=c99 -O2' '-std=c11 -O1 -fsanitize=address,undefined -fno-sanitize-recover=all'; do
    # shellcheck disable=SC2086  # flags
    ${CC:-cc} $flags -Wall -Wextra -Werror -pedantic -I. -I"$root/runtime" "$root/tests/controllers/slot.c" loop.c slot.c \
        "$root/runtime/gic_runtime.c" -o slot -lm 2>err && ./slot >said 2>&1
    verdict $? "a controller in C, $flags: $(tail -n 1 said)"
done
# what the page shows of it
sed -n '/^    static void servo/,/^    }/s/^    //p' "$root/runtime/README.md" >page
[ "$(wc -l <page)" -gt 4 ]
verdict $? 'the page has an example'
while IFS= read -r row; do
    grep -qF -- "$row" "$root/tests/controllers/slot.c"
    verdict $? "the page's example is what runs: $row"
done <page

# ---- linear models, rest and modes hold what controllers hold; derivatives; many vehicles
"$gicrun" --linearize loop.veh >out 2>err && grep -q '^held/servo.force,N,0' out && grep -q '^output/servo.force.next,N,8.1,-8.1,-6,8.1' out
verdict $? 'a linear model'
"$gicrun" --modes loop.veh >out 2>err && grep -q '2 eigenvalues that are zero: neutral in x$' out && ! grep -q servo out
verdict $? 'modes'
"$gicrun" --equilibrium loop.veh >out 2>err && grep -q 'servo.force: 0' out
verdict $? 'rest'
"$gicgen" --derivatives loop.veh -o derived.c && sed 's/"loop.h"/"derived.h"/' derived.c >d.c &&
    ${CC:-cc} -std=c99 -Wall -Wextra -Werror -pedantic -I. -I"$root/runtime" -c d.c -o d.o 2>err
verdict $? 'code with derivatives'
"$gicgen" loop.veh -o loop.c && "$gicgen" --batch 4 loop.veh -o loop_batch.c &&
    ${CC:-cc} -std=c11 -O1 -ffp-contract=off -DGIC_BATCH_LIBM -DBATCH=loop_batch_model -I. -I"$root/runtime" \
        "$root/tests/data/embed/lanes.c" loop.c loop_batch.c "$root/runtime/gic_runtime.c" -lm -o lanes 2>said &&
    [ "$(./lanes)" = '4 4 4 of 4' ]
verdict $? "many vehicles at once: $(./lanes) $(head -n 1 said)"
printf 'gicscene: 1\nstep: 0.01\nduration: 1\nsleep: {}\n' >sleep.scene
"$gicrun" -q loop.veh sleep.scene -o none.csv 2>said
[ $? -eq 1 ] && grep -q "controller 'servo' of 'loop' changes with time by itself" said
verdict $? "sleep is refused: $(head -n 1 said)"
printf 'gicscene: 1\nstep: 0.1\nduration: 0.2\noutput_step: 0.1\ninitial: {states: {servo.force: 4}}\n' >start.scene
loop period=5 offset=1
"$gicrun" -q loop.veh start.scene -o start.csv 2>err && awk -F, 'NR == 4 { exit !($2 > 0.0399999999 && $2 < 0.0400000001) }' start.csv
verdict $? 'a scene gives what is held at the start'

# ---- an engine held at a speed, gears that change meanwhile, two rates; a part with a controller, twice
cp -r "$root/models/parts" "$root/models/tires" .
cp "$root"/models/hmmwv*.veh .
sed 's/^    throttle: .*/    throttle: cruise.pedal/' parts/hmmwv_powertrain.veh >held && mv held parts/hmmwv_powertrain.veh
cat >cruise.veh <<'END'
gicgen: 1
model: cruise
include: hmmwv_vehicle.veh
controllers:
  cruise:
    period: 0.02
    rules:
      sum: {value: "min(1, max(0, cruise.sum + 0.004 * (11 - ahead.x)))", initial: 0.1}
      pedal: {value: "min(1, max(0, 0.2 * (11 - ahead.x) + cruise.sum.next))", delay: 0.03}
outputs:
  ahead: {type: velocity, body: chassis, in: chassis}
  drive: {type: powertrain}
END
sed 's/^duration: .*/duration: 3/; /^inputs/,$d' "$root/models/scenes/straight.scene" >cruise.scene
for way in general 'engine tape' 'engine gic'; do
    # shellcheck disable=SC2086  # options
    "$gicrun" -q --$way cruise.veh cruise.scene -o "${way#* }.csv" 2>said
done
cmp general.csv tape.csv >said
verdict $? 'cruise: general code and the tape'
! grep -q 'reads rule' said
verdict $? 'a rule of which formulas read what comes next is read'
found=$(paste -d, general.csv gic.csv | awk -F, 'NR > 1 { for (i = 1; i <= NF / 2; ++i) {
        d = $i - $(i + NF / 2); s = $i < 0 ? -$i : $i; if (d < 0) d = -d; d /= 1 + s; if (!(d <= most)) most = d } }
    END { print (NR > 50 ? most + 0 : 1) }')
check "cruise: general code and gic, $found" within "$found" 1e-9
{ printf 'gicgen: 1\n'; loop; sed -n '/^bodies/,/^  mean:$/p' loop.veh | sed '/^inputs/d; /^  mean:/d; s/wish/1/g; s/ + 0.125 . mean.mean//'
    printf 'forces: {f: {type: force, coordinate: x, value: servo.force}}\noutputs: {x: {type: coordinate, coordinate: x}}\n'; } >part.veh
printf 'gicgen: 1\nmodel: two\ngravity: [0, 0, 0]\nbase: ground\ninclude: [{file: part.veh, prefix: a_}, {file: part.veh, prefix: b_}]\n' >two.veh
scene 0.01 0.1 1 'integrator: rk4'
"$gicrun" -q two.veh a.scene -o two.csv 2>said && awk -F, 'NR > 1 && ($2 != $5 || $3 != $6) { wrong = 1 } END { exit !(NR == 12 && $2 > 0.5 && !wrong) }' two.csv
verdict $? 'a part with a controller twice, by prefixes'

# ---- rows at sampling times are those before the sample, whatever rounding makes of either
# counted PERIOD OFFSET OUTPUT_STEP INTEGRATOR: the number of samples so far against whole numbers
counted() {
    cat >count.veh <<END
gicgen: 1
model: count
base: ground
gravity: [0, 0, 0]
bodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {slide: {type: prismatic, bodies: [ground, car], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, car], axis: [1, 0, 0], range: [-9, 9]}}
controllers: {c: {period: $1, offset: $2, rules: {n: "c.n + 1"}}}
forces: {push: {type: force, coordinate: x, value: "0.001 * c.n"}}
signals: {n: {value: c.n, unit: "1"}}
outputs: {n: {type: signal, signal: n}}
END
    printf 'gicscene: 1\nduration: 3\nstep: 0.01\noutput_step: %s\nintegrator: %s\n' "$3" "$4" >count.scene
    "$gicrun" -q count.veh count.scene -o count.csv 2>said &&
        python3 - "$1" "$2" "$3" <<'END' >>said
import csv, math, sys
from fractions import Fraction
period, offset, step = map(Fraction, sys.argv[1:])
rows = list(csv.reader(open("count.csv")))[1:]
assert len(rows) == 3 // step + 1, len(rows)
for i, row in enumerate(rows):
    before = max(0, math.ceil((i * step - offset) / period))
    assert float(row[1]) == before, (i, row, before)
END
    verdict $? "samples before rows: period $1, offset $2, rows $3, $4"
}
for integrator in rkck adams ab3; do
    counted 0.02 0 0.1 $integrator
    counted 0.02 0 0.07 $integrator
    counted 0.01 0.1 0.07 $integrator
    counted 0.03 0 0.01 $integrator
done

# ---- mistakes
# refused PLACE MESSAGE REMEDY CONTROLLERS [MORE]: one message and no output
refused() {
    rm -f bad.c
    printf 'gicgen: 1\nmodel: m\nbase: car\nbodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\ncontrollers: %s\n%b\n' "$4" "$5" >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "bad.veh:$1: error: $2" said && grep -qF "  remedy: $3" said
    verdict $? "refused: $2"
}
refused 5:15 "controller 'c' lacks the key 'period'" 'add `period: number`' '{c: {rules: {a: 1}}}'
refused 5:15 "controller 'c' lacks the key 'rules'" 'add `rules: {name: formula}`' '{c: {period: 1}}'
refused 5:39 "controller 'c' holds nothing" 'write `rules: {name: formula}`' '{c: {period: 0.5, rules: {}}}'
refused 5:27 "controller 'c': its period is below 1e-6 s" 'write the period in seconds' '{c: {period: 1e-7, rules: {a: 1}}}'
refused 5:27 "period of controller 'c' must be greater than zero" 'write a positive number' '{c: {period: 0, rules: {a: 1}}}'
refused 5:38 "offset of controller 'c' must not be negative" 'write zero or a positive number' '{c: {period: 1, offset: -1, rules: {a: 1}}}'
refused 5:61 "rule 'c.a': its delay is longer than 100 periods" 'shorten the delay' '{c: {period: 0.1, rules: {a: {value: 1, delay: 10.1}}}}'
refused 5:61 "quantum of rule 'c.a' must be greater than zero" 'write a positive number' '{c: {period: 1, rules: {a: {value: 1, quantum: 0}}}}'
refused 5:61 "initial of rule 'c.a': states are below 2^30" 'give it a unit in which it is smaller' '{c: {period: 1, rules: {a: {value: 1, initial: 2e9}}}}'
refused 5:15 "controller 'u' has the name of an input" 'give the controller another name' '{u: {period: 1, rules: {a: 1}}}' 'inputs: {u: {}}'
refused 5:42 "value of rule 'c.a': there is no 'c.b'" "did you mean 'c.a'?" '{c: {period: 1, rules: {a: "c.b"}}}'
refused 5:41 "value of rule 'c.a': 'c.a.next' follows itself" 'read the rule without `.next`' '{c: {period: 1, rules: {a: c.a.next}}}'
refused 5:38 "rule 'c.x' has the name of a component of output 'c'" 'give the rule' '{c: {period: 1, rules: {x: 1}}}' 'outputs: {c: {type: position, body: car}}'
refused 6:14 "value of signal 's': there is no 'c.q'" "did you mean 'c.a'?" '{c: {period: 1, rules: {a: 1}}}' 'signals: {s: c.q}'
printf 'gicgen: 1\nmodel: m\nbase: car\nbodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\ncontrollers: {c: {period: 1, rules: {a: 1}}}\n' >idle.veh
"$gicgen" idle.veh -o idle.c 2>said && grep -q "warning: nothing in the model reads rule 'c.a'" said
verdict $? "a rule that nothing reads: $(head -n 1 said)"
sed 's/{a: 1}/{a: {unit: m}}/' idle.veh >program.veh
"$gicgen" program.veh -o program.c 2>said && [ ! -s said ]
verdict $? "a rule that a program supplies, and may read alone: $(head -n 1 said)"
for more in '' --derivatives --implicit; do # one body, no joints
    # shellcheck disable=SC2086  # no word or one
    "$gicgen" $more idle.veh -o idle.c 2>/dev/null && ${CC:-cc} -std=c99 -Wall -Wextra -Werror -pedantic -I. -I"$root/runtime" -c idle.c -o idle.o 2>said
    verdict $? "a body alone compiles without warnings $more: $(head -n 1 said)"
done

# a program begins at other times than 0, or moves the time: the next sample is the first one that is not before it
cat >moved.veh <<'END'
gicgen: 1
model: moved
base: car
bodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
controllers:
  c: {period: 0.1, rules: {n: {value: "c.n + 1"}}}
  d: {period: 0.07, offset: 0.03, rules: {n: {value: "d.n + 1"}}}
END
cat >moved_main.c <<'END'
#include "moved.h"
#include <math.h>
#include <stdio.h>
static moved car;
static int failed;
/* Samples in [from, to), in thousandths, where all of these are whole. */
static int due(int period, int offset, int from, int to)
{
    int count = 0;
    for (int at = offset; at < to; at += period)
        count += at >= from;
    return count;
}
/* From a time to another in steps of a thousandth: as many samples as are due. What the next step begins with, it samples. */
static void go(int from, int to)
{
    const gic_real c = car.state[MOVED_STATE_C_N], d = car.state[MOVED_STATE_D_N];
    gic_restart(&car, from / 1000.0);
    for (int k = from; k < to; ++k)
        failed += moved_step(&car, 0.001, GIC_RK4) != GIC_OK;
    const int of_c = (int)(car.state[MOVED_STATE_C_N] - c), of_d = (int)(car.state[MOVED_STATE_D_N] - d);
    if (of_c != due(100, 0, from, to) || of_d != due(70, 30, from, to))
        failed += printf("from %d to %d: %d and %d samples, not %d and %d\n", from, to, of_c, of_d, due(100, 0, from, to),
                         due(70, 30, from, to));
}
int main(void)
{
    static const int start[] = {0, 20, 30, 50, 65, 80, 99, 100, 101, 149, 151, 199, 1050, 100050};
    for (int i = 0; i < (int)(sizeof start / sizeof *start); ++i) {
        failed += moved_setup(&car) != GIC_OK;
        go(start[i], start[i] + 235);
    }
    /* back by part of a period, by one and a half, by many; ahead by as much */
    failed += moved_setup(&car) != GIC_OK;
    go(0, 365);
    go(285, 465);
    go(315, 465);
    go(15, 465);
    go(475, 685);
    go(725, 985);
    go(5025, 5165);
    return failed != 0;
}
END
"$gicgen" moved.veh -o moved.c 2>said && ${CC:-cc} -std=c99 -Wall -Wextra -Werror -I. -I"$root/runtime" moved_main.c moved.c "$root/runtime/gic_runtime.c" -o moved -lm >>said 2>&1 && ./moved >>said 2>&1
verdict $? "samples where the time is moved: $(grep -v warning said | head -n 3)"

# numbers of samples and effects follow from the time: a scene can not give them
sed 's/{a: 1}/{a: {value: 1, delay: 0.4}}/' idle.veh >late.veh
for state in c.samples c.a.effects; do
    printf 'gicscene: 1\nduration: 1\nstep: 0.1\ninitial: {states: {%s: 3}}\n' "$state" >bad.scene
    "$gicrun" -q late.veh bad.scene -o bad.csv >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.csv ] && [ "$(grep -c error: said)" -eq 1 ] &&
        grep -qF "bad.scene:4:20: error: '$state' follows from the time at which the run begins" said && grep -q '  remedy: remove it' said
    verdict $? "a scene that gives $state: $(grep error: said)"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
