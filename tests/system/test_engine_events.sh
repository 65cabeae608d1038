#!/bin/sh
# SPDX-License-Identifier: MIT
# test_engine_events.sh GICGEN GICRUN: the comparison engines find contacts made and lost by a way of their own
# (runtime/compare/contact_pieces.c), and generated code by another one; so each judges the other. Closed solutions;
# whole scenes with tires, by constant and variable steps, through 30 s; as many contacts by either.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1
[ -x "$gicgen" ] || exit 1
models=$root/models

# scene NAME LINE...: a scene of the repository without steps and choice of results, with these lines
scene() {
    grep -v '^locate\|^step\|^ratio\|^integrator\|^outputs' "$models/scenes/$1.scene"
    shift
    printf '%s\n' "$@"
}

# run MODEL ENGINE: now.scene into ENGINE.csv, the number of contacts into ENGINE.count
run() {
    "$gicrun" --engine "$2" "$models/$1.veh" now.scene -o "$2.csv" 2>"$2.said" || return 1
    sed -n 's/^  contacts located *\([0-9]*\).*/\1/p' "$2.said" >"$2.count"
    [ -s "$2.count" ] || echo 0 >"$2.count"
}

# agree MODEL ENGINE LIMIT CONTACTS: the chassis of both engines is never further apart, m; contacts: same, that many at
# least, by both; any: as they come
agree() {
    run "$1" tcc && run "$1" "$2" && paste -d, tcc.csv "$2.csv" | awk -F, -v limit="$3" '
        NR == 1 {for (i = 1; i <= NF / 2; ++i) if ($i ~ /^chassis\.[xyz] /) at[++n] = i; next}
        {
            square = 0
            for (k = 1; k <= n; ++k)
                square += ($at[k] - $(at[k] + NF / 2))^2
            if (!(sqrt(square) <= most))
                most = sqrt(square)
        }
        END {printf "%.3g m\n", most >"apart"; exit !(n == 3 && NR > 10 && most <= limit)}' || return 1
    [ "$4" = any ] || { cmp -s tcc.count "$2.count" && [ "$(cat tcc.count)" -ge "$4" ]; }
}

# Scenes without contacts made or lost take the same steps in either engine: what differs is rounding, and a difference
# of 1e-12 stays below 1.1e-12 in them (runtime/EVENTS.md section 2). Gears change in the first two.
for case in 'full_run hmmwv_vehicle' 'acceleration_braking hmmwv_vehicle' 'lane_change hmmwv_vehicle' \
    'tires_brake hmmwv_tires'; do
    { grep -v '^outputs' "$models/scenes/${case% *}.scene" && echo 'locate: true'; } >now.scene
    check "${case% *}, steps of the scene, gic" agree "${case#* }" gic 1e-10 0
done
{ grep -v '^outputs' "$models/scenes/full_run.scene" && echo 'locate: true'; } >now.scene
# gcp1 integrates other numbers, all of q: errors of AB3 at 6 ms are others (EVENTS.md section 5: 2.6e-4 m)
check "full_run, gcp1" agree hmmwv_vehicle gcp1 5e-4 0

# Contacts: steps, and so their errors, differ from the first one on. Errors of variable steps are some ten times the
# tolerance in m of the chassis (30 s), those of both engines add up; none is lost or found twice: counts are equal.
for case in 'rkck 1e-6' 'rkck 1e-10' 'adams 1e-9'; do
    scene tires_jump "integrator: ${case% *}" "tolerance: ${case#* }" >now.scene
    limit=$(awk "BEGIN {print 100 * ${case#* }}")
    for engine in gic gcp1; do
        check "tires_jump, $case, $engine" agree hmmwv_tires $engine "$limit" 30
    done
done
# 30 s over a ramp and a step, from which wheels lift, with changes of gear
scene full_run 'integrator: rkck' 'tolerance: 1e-9' \
    'road: {type: table, x: [200, 230, 231, 234, 234.5, 260, 262, 262.1],' \
    '       height: [0, 0, 0.06, 0.3, 0, 0, 0.15, 0]}' >now.scene
check "full_run over a ramp, rkck" agree hmmwv_vehicle gic 1e-5 50
# a road with contacts in every other step
scene tires_rough 'integrator: rkck' 'tolerance: 1e-8' | sed 's/^duration.*/duration: 1/' >now.scene
check "tires_rough, rkck" agree hmmwv_tires gic 1e-6 20
# wheels without tires, whose dampers let go before the road does and take hold again for 0.1 ms
for tolerance in 1e-7 1e-10; do
    scene tires_jump 'integrator: rkck' "tolerance: $tolerance" >now.scene
    limit=$(awk "BEGIN {print 10 * $tolerance}")
    check "wheels without tires, rkck $tolerance" agree hmmwv gic "$limit" 12
done

# Constant steps: without `locate` nothing is looked for, by neither, and results are the same but for rounding; with it
# the error against the solution above falls as that of generated code does.
scene tires_jump 'integrator: rkck' 'tolerance: 1e-11' >now.scene
run hmmwv_tires gic
mv gic.csv exact.csv
for located in false true; do
    scene tires_jump 'integrator: rk4' 'step: 0.00025' "locate: $located" >now.scene
    if [ $located = false ]; then
        check "tires_jump, contacts gone over" agree hmmwv_tires gic 1e-10 0
    else
        check "tires_jump, rk4, contacts located" agree hmmwv_tires gic 1e-3 any
    fi
    paste -d, exact.csv gic.csv | awk -F, '
        NR == 1 {for (i = 1; i <= NF / 2; ++i) if ($i ~ /^chassis\.[xyz] /) at[++n] = i; next}
        {for (k = 1; k <= n; ++k) {d = ($at[k] - $(at[k] + NF / 2))^2; if (!(d <= most)) most = d}}
        END {print sqrt(most)}' >off.$located
done
check "contacts located: $(cat off.true) m off, else $(cat off.false)" awk '
    NR == 1 {there = $1} NR == 2 {exit !(there > 3 * $1 && $1 > 0)}' off.false off.true

# Closed solutions: a wheel that hops, a load between two stops; test_contact.sh says what they are.
cp "$root/tests/data/contact/hop.veh" .
printf 'gicscene: 1\nduration: 2\noutput_step: 0.01\noutputs: [z.value, z.rate, s.value, s.rate]\n' >hop.scene
echo 'initial: {coordinates: {z: 0.05}, rates: {s: 0.8}}' >>hop.scene
for way in 'step: 0.0002,integrator: rk4,locate: true' 'step: 0.00002,integrator: ab3,locate: true' \
    'integrator: rkck,tolerance: 1e-13' 'integrator: adams,tolerance: 1e-13'; do
    { cat hop.scene && echo "$way" | tr , '\n'; } >now.scene
    # AB3 has 1e-10 at 5 us; its error grows by the cube of the step
    case $way in
    *ab3*) limit=6.4e-9 ;;
    *rk4*) limit=1e-10 ;;
    *rkck*) limit=1e-9 ;;
    *) limit=3e-9 ;;
    esac
    for engine in gic gcp1; do
        : >results
        "$gicrun" -q --engine $engine hop.veh now.scene -o results 2>err
        check "closed solutions, $way, $engine" python3 "$root/tests/data/contact/hop.py" results $limit
        cp results once
        "$gicrun" -q --engine $engine hop.veh now.scene -o results 2>err
        check "the same again, $way, $engine" cmp results once
    done
done

# A damped stop at any tolerance, hit with no output time near: 3 m/s in, 0.2203 m/s out (test_contact_variable.sh).
cp "$root/tests/data/contact/stops.veh" .
for way in 'rkck 0.01' 'rkck 1e-6' 'adams 1e-4' 'adams 1e-10'; do
    {
        printf 'gicscene: 1\nduration: 0.5\nintegrator: %s\ntolerance: %s\n' "${way% *}" "${way#* }"
        printf 'output_step: 0.5\ninitial: {rates: {x: 3}, coordinates: {z: -9}}\n'
    } >now.scene
    : >out.csv
    "$gicrun" -q --engine tcc stops.veh now.scene -o code.csv 2>err
    "$gicrun" -q --engine gic stops.veh now.scene -o out.csv 2>err
    check "a damped stop, $way" sh -c 'paste -d, out.csv code.csv | tail -n 1 | awk -F, -v t="'"${way#* }"'" "
        {d = \$9 - \$(9 + NF / 2); d = d < 0 ? -d : d; exit !(\$9 < -0.1 && \$9 > -0.3 && d <= 100 * t)}"'
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
