#!/bin/sh
# SPDX-License-Identifier: MIT
# test_contact.sh GICGEN GICRUN: contacts within steps (`locate: true`) against closed solutions, to 1e-10; a run again and
# one from a snapshot to the last bit.
#
# A wheel of 40 kg hops on a spring, its tire, of 16 kN/m; without dampers it leaves as fast as it lands. A load of 2 kg
# slides at 0.8 m/s from one stop to the other; each turns it round in half a period of 20 rad/s.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

cp "$root/tests/data/contact/hop.veh" .
# scene STEP WAY...
scene() {
    printf 'gicscene: 1\nduration: 2\nstep: %s\noutput_step: 0.01\noutputs: [z.value, z.rate, s.value, s.rate]\n' "$1"
    echo 'initial: {coordinates: {z: 0.05}, rates: {s: 0.8}}'
    shift
    printf '%s\n' "$@"
}

# follows FILE LIMIT: the largest distance of positions, m, and speeds, m/s, from what is due
follows() {
    awk -F, -v limit="$2" '
        function off(x, exact) {
            x -= exact
            if (x < 0)
                x = -x
            if (x > most)
                most = x
        }
        BEGIN {w = 20; g = 10; pi = atan2(0, -1); v = sqrt(2 * g * 0.05)}
        NR > 1 {
            # the first landing, then contacts and flights of always the same length
            t = $1 - v / g
            contact = 2 * (pi - atan2(v * w, g)) / w
            if (t > 0)
                t -= int(t / (contact + 2 * v / g)) * (contact + 2 * v / g)
            if (t <= 0) {
                z = 0.05 - g * $1 * $1 / 2
                r = -g * $1
            } else if (t < contact) {
                z = -g / w^2 * (1 - cos(w * t)) - v / w * sin(w * t)
                r = -g / w * sin(w * t) - v * cos(w * t)
            } else {
                t -= contact
                z = v * t - g * t * t / 2
                r = v - g * t
            }
            off($2, z)
            off($3, r)
            # from 0 to the upper stop, then stop, way, stop, way
            u = 0.8
            way = 0.25 / u
            t = $1 - 0.15 / u
            if (t > 0)
                t -= int(t / (2 * (pi / w + way))) * 2 * (pi / w + way)
            if (t <= 0) {
                s = u * $1
                r = u
            } else if (t < pi / w) {
                s = 0.15 + u / w * sin(w * t)
                r = u * cos(w * t)
            } else if (t < pi / w + way) {
                s = 0.15 - u * (t - pi / w)
                r = -u
            } else if (t < 2 * pi / w + way) {
                s = -0.1 - u / w * sin(w * (t - way - pi / w))
                r = -u * cos(w * (t - way - pi / w))
            } else {
                s = -0.1 + u * (t - 2 * pi / w - way)
                r = u
            }
            off($4, s)
            off($5, r)
        }
        END {printf "%.3g\n", most >"said"; exit !(NR == 202 && most < limit)}' "$1"
}

for way in 'rk4 0.0002' 'ab3 0.000005'; do
    step=${way#* } way=${way% *}
    scene "$step" "integrator: $way" 'locate: true' >now.scene
    for engine in tcc tape; do
        : >results
        "$gicrun" -q --engine $engine hop.veh now.scene -o results 2>err
        check "$way, $engine" follows results 1e-10
        mv results "$way.$engine"
    done
    check "$way: the same digits" cmp "$way.tcc" "$way.tape"
    "$gicrun" -q --engine tcc hop.veh now.scene -o results 2>err
    check "$way: the same again" cmp "$way.tcc" results
done

# The same on a tire that does not turn, at one rate and at two
sed 's/^wheels:/tires:\
  easy: {type: tmeasy, radius: 0.3, stiffness: 16000, damping: 0, load: 400, dfx0: [10000, 16000], fxm: [400, 700],\
         fxs: [300, 550], dfy0: [8000, 12000], fym: [380, 650], fys: [310, 520], sxm: [0.12, 0.14], sxs: [0.4, 0.4],\
         sym: [0.18, 0.22], sys: [0.5, 0.55], trail: [0.15, 0.14], sq0: [0.2, 0.24], sqe: [0.4, 0.5]}\
wheels:/; s/radius: 0.3, stiffness: 16000, damping: 0}$/tire: easy, spin_inertia: 0.5}/' hop.veh >tire.veh
for way in 'rk4 0.0002 1' 'ab3 0.000005 1' 'ab3 0.000005 4'; do
    # shellcheck disable=SC2086  # words
    set -- $way
    scene "$2" "integrator: $1" 'locate: true' >now.scene
    [ "$3" = 1 ] || echo "ratio: $3" >>now.scene
    : >results
    "$gicrun" -q --engine tcc tire.veh now.scene -o results 2>err
    check "a tire, $way" follows results 1e-10
done

# Order, at steps in which contacts are anywhere: at least 2.8 from a step to its quarter; RK4 is much better than without.
for way in ab3 rk4; do
    for located in true false; do
        for step in 0.002 0.0005; do
            scene $step "integrator: $way" "locate: $located" >now.scene
            "$gicrun" -q --engine tcc hop.veh now.scene -o results 2>err
            follows results 1 && cat said
        done >$located
    done
    cat true false >said
    check "order of $way" awk 'NR == 1 {first = $1} NR == 2 {exit !(first > 2^5.6 * $1)}' true
done
check "RK4 without it" awk 'FNR == 2 {if (NR == 2) fine = $1; else exit !($1 > 1000 * fine)}' true false

# Variable steps end at contacts always.
for way in adams rkck; do
    scene 0.001 "integrator: $way" 'tolerance: 1e-13' >now.scene
    for engine in tcc tape; do
        "$gicrun" -q --engine $engine hop.veh now.scene -o results 2>err
        check "$way, $engine" follows results 1e-9
    done
    for model in hop tire; do
        sed 's/^output_step.*/output_step: 2/' now.scene >long.scene
        "$gicrun" -q --engine tcc $model.veh now.scene -o results 2>err
        "$gicrun" -q --engine tcc $model.veh long.scene -o long 2>err
        tail -n 1 results >end
        tail -n 1 long >>end
        check "$way, $model: with one output time" awk -F, '
            NR == 1 {split($0, first)}
            NR == 2 {
                for (i = 1; i <= 5; ++i)
                    if (($i - first[i])^2 > 1e-18)
                        exit 1
                exit !(NF == 5)
            }' end
    done
done

# A roof that the hopper just reaches, for less than a step, against the closed solution: up, along the roof, down.
sed 's/^forces:/forces:\
  roof: {type: stop, coordinate: z, high: 0.05, stiffness: 16000}/' hop.veh >roof.veh
cat >skim.awk <<'AWK'
BEGIN {
    FS = ","; w = 20; g = 10
    v0 = sqrt(v * v + 2 * g * (0.05 - z0)); reach = (v0 - v) / g; stay = 2 * atan2(v * w, g) / w
}
NR > 1 && $1 < reach + stay + v0 / g {
    t = $1 - reach
    z = t <= 0 ? v * t - g * t * t / 2 : g / w^2 * (cos(w * t) - 1) + v / w * sin(w * t)
    if (t > stay)
        z = -v * (t - stay) - g * (t - stay)^2 / 2
    d = ($2 - 0.05 - z)^2
    if (d > most)
        most = d
    ++rows
}
END {printf "%.3g\n", sqrt(most) >"said"; exit !(rows > 5 && sqrt(most) < limit)}
AWK
for speed in 0.005 0.004 0.0025; do
    for low in 0.02 0.025 0.03; do
        for way in rk4 ab3; do
            rate=$(awk -v v=$speed -v z=$low 'BEGIN {printf "%.17g", sqrt(v * v + 20 * (0.05 - z))}')
            printf 'gicscene: 1\nduration: 0.15\nstep: 0.0025\nlocate: true\nintegrator: %s\n' $way >now.scene
            echo 'outputs: [z.value]' >>now.scene
            printf 'initial: {coordinates: {z: %s}, rates: {z: %s}}\n' $low "$rate" >>now.scene
            "$gicrun" -q --engine tcc roof.veh now.scene -o results 2>err
            check "a roof reached at $speed m/s, $way" awk -v v=$speed -v z0=$low -v limit=1e-10 -f skim.awk results
        done
    done
done
sed 's/^locate.*/locate: false/; s/ab3/rk4/' now.scene >blind.scene
"$gicrun" -q --engine tcc roof.veh blind.scene -o results 2>err
awk -v v=0.0025 -v z0=0.03 -v limit=1e-9 -f skim.awk results
verdict $((! $?)) "blindly it is missed"
# Loads that steps don't resolve: a mass on its tire is carried over kerbs, whose curvature jumps at the points of the
# road's table, against an integration of its own from point to point and from contact to contact. In parts in which
# loads bend little (`locate: loads`) a step leaves less than a sixteenth of what it leaves otherwise.
cp "$root/tests/data/contact/ramp.veh" .
# carried WAY...: by how much (m) is it elsewhere?
carried() {
    printf 'gicscene: 1\nduration: 1.2\nstep: %s\nintegrator: %s\nlocate: %s\n' "$1" "$2" "$3" >now.scene
    printf 'output_step: 0.01\noutputs: [z.value]\ninitial: {coordinates: {z: -0.0025}, rates: {x: 14}}\n' >>now.scene
    printf 'road: {type: table, x: [%s], height: [%s]}\n' "$x" "$h" >>now.scene
    "$gicrun" -q --engine "${4:-tcc}" ramp.veh now.scene -o results 2>err
    printf '%s\n%s\n' "$x" "$h" | python3 "$root/tests/data/contact/ramp.py" results
}
for road in '1, 1.02, 1.1, 1.13/0, 0.02, 0.02, 0' '1, 1.04, 1.08, 3, 3.05, 3.1/0, 0.02, 0, 0, -0.02, 0'; do
    x=${road%/*} h=${road#*/}
    carried 0.00002 rk4 true >said
    check "both integrations agree, $road" awk '{exit !($1 < 2e-6)}' said
    for way in ab3 rk4; do
        carried 0.002 $way true >said
        carried 0.002 $way loads >>said
        mv results first
        check "loads, $way, $road" awk 'NR == 1 {plain = $1} NR == 2 {exit !($1 < plain / 16)}' said
        carried 0.002 $way loads tape >said
        check "loads, $way, the same digits of the tape" cmp first results
    done
done
scene 0.002 'locate: load' >now.scene
run hop.veh now.scene -o none.csv
check "locate: load is refused" exits 1
check "with place and remedy" says 'now.scene:7:9: error: locate must be true, false or loads'

# Bounded work: no step beyond it, said in the summary; bounds that can't be held are refused with place and remedy.
scene 0.01 'integrator: rk4' 'locate: true' 'most_work: 40' >now.scene
"$gicrun" --engine tcc hop.veh now.scene -o results 2>err
check "work of a step" awk '/work of a step/ {found = $7} END {exit !(found > 8 && found <= 40)}' err
scene 0.01 'integrator: rk4' 'locate: true' 'most_work: 12' >now.scene
"$gicrun" --engine tcc hop.veh now.scene -o results 2>err
check "what it went over" grep -q '^  events gone over     [1-9]' err
# The same of implicit and exponential steps, each of whose parts has one Jacobian at most; what finds all contacts is
# no further off than without a bound, but for a fifth that looks may take.
for way in ros2 ros3 imex exp3; do
    for bound in none 40 12; do
        scene 0.01 "integrator: $way" 'locate: true' "most_work: $bound" | sed '/none/d' >now.scene
        "$gicrun" --engine tcc hop.veh now.scene -o results 2>err
        follows results 1
        echo "$(awk '/work of a step/ {work = $7} /right-hand sides  / {rates = $3} /Jacobians/ {made = $2} /gone over/ {over = $4}
            END {print work, rates, made, over + 0}' err) $(cat said)"
    done >bounded
    check "bounds are kept, $way" awk 'NR == 2 && $1 > 40 || NR == 3 && $1 > 12 {exit 1} {++rows} END {exit rows != 3}' bounded
    check "and two right-hand sides a Jacobian, $way" awk '$3 < 1 || 2 * $3 > $2 && w != "imex" {exit 1}' w=$way bounded
    check "all contacts, $way" awk 'NR == 1 {free = $5} NR == 2 {exit !($4 == 0 && $5 < 1.2 * free)}' bounded
    check "what it went over, $way" awk 'NR == 3 {exit !($4 > 0)}' bounded
done
for bound in 7 9.5 -1 2000000; do
    scene 0.01 'integrator: rk4' "most_work: $bound" >now.scene
    run hop.veh now.scene -o none.csv
    check "most_work: $bound is refused" exits 1
    check "with place and remedy, $bound" says 'now.scene:8:12: error: most_work must be a whole number from 8 to 1e+06'
done
scene 0.01 'integrator: rkck' 'most_work: 100' >now.scene
run hop.veh now.scene -o none.csv
check "most_work with variable steps is refused" says 'variable steps take as much work as they need'
check "without results" [ ! -e none.csv ]

# Snapshots before, in and after contacts: a copy of the instance goes on to the same last bit, in either precision.
cp "$root"/runtime/gic_runtime.[ch] .
cat >snapshot.c <<'END'
#include "hop.h"
#include <stdio.h>
#include <string.h>

static hop first, copy;

int main(void)
{
    int bad = 0;
    for (int method = 0; method < 2; ++method)
        for (int taken = 0; taken < 400; taken += 7) {
            memset(&first, 0, sizeof first);
            bad += hop_setup(&first) != GIC_OK;
            first.head.locate = 1 + taken % 2;
            first.state[HOP_STATE_Z] = GIC_R(0.05);
            first.state[HOP_STATE_S_RATE] = GIC_R(0.8);
            const gic_real step = GIC_R(0.005) * (taken % 2 ? GIC_R(2.5) : GIC_R(1.0)); /* loads bend */
            for (int k = 0; k < 420; ++k) {
                if (k == taken)
                    memcpy(&copy, &first, sizeof first);
                bad += gic_step(&hop_model, &first, step, method) != GIC_OK;
                if (k >= taken) {
                    bad += gic_step(&hop_model, &copy, step, method) != GIC_OK;
                    bad += memcmp(&first, &copy, sizeof first) != 0;
                }
            }
            bad += first.head.contact_count < 10;
        }
    printf("%d bad, %ld contacts\n", bad, (long)first.head.contact_count);
    return bad != 0;
}
END
"$gicgen" hop.veh -o hop.c >out 2>err
for real in '' -DGIC_FLOAT; do
    # shellcheck disable=SC2086  # nothing or one word
    cc -std=c99 -Wall -Wextra -Werror -O1 $real snapshot.c hop.c gic_runtime.c -lm -o snapshot >out 2>err && ./snapshot >said
    verdict $? "snapshots $real"
done

# ---- both ends of one stop, met exactly at the end of a step: 0.11 m at 1 m/s, then half a period of 20 rad/s outside, and so on.
# Errors of RK4 in that half period, at most (20 h)^4 / 120 rad, are those of the place at 1 m/s
for ends in 'low: 0, high: 0.21' 'high: 0.21' 'low: 0'; do
    cat >both.veh <<END
gicgen: 1
model: both
base: ground
gravity: [0, 0, 0]
bodies: {a: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {a: {type: prismatic, bodies: [ground, a], axis: [1, 0, 0]}}
coordinates: {a: {type: translation, bodies: [ground, a], axis: [1, 0, 0], range: [-5, 5]}}
forces: {a: {type: stop, coordinate: a, $ends, stiffness: 800}}
END
    for integrator in rk4 ab3; do
        for step in 0.001 0.002 0.005 0.01; do
            for rate in 1 -1; do
                start=0.1
                [ $rate = 1 ] || start=0.11 # both take 0.11 s to the end
                printf 'gicscene: 1\nduration: 0.2\nstep: %s\noutput_step: 0.01\nintegrator: %s\nlocate: true\n' $step $integrator >both.scene
                printf 'initial: {coordinates: {a: %s}, rates: {a: %s}}\n' $start $rate >>both.scene
                for engine in auto tape; do
                    run -q --engine $engine both.veh both.scene -o both.csv
                    check "$ends, $integrator at $step s by $engine from $start" awk -F, -v v=$rate -v x0=$start -v h=$step -v ends="$ends" -v ab3="$([ $integrator = rk4 ] || echo 1)" 'NR > 1 {
                        meets = (v > 0 ? ends ~ /high/ : ends ~ /low/) && $1 > 0.11
                        x = meets ? (v > 0 ? 0.21 : 0) + v * sin(20 * ($1 - 0.11)) / 20 : x0 + v * $1
                        d = $2 - x; if (d < 0) d = -d; bad += !(d <= 1e-9 + (ab3 ? 0.1 * (20 * h) ^ 3 : (20 * h) ^ 4 / 120))} END {exit bad || NR < 20}' both.csv
                done
            done
        done
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
