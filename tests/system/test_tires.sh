#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tires.sh GICRUN: forces and moments of tires on a rig against the published formulas (tests/data/tires), over loads,
# slips and cambers up to and beyond the edges of their data, on both sides of a vehicle, on roads of other friction;
# and what needs no formulas: signs, peaks, symmetry, numbers where a wheel lies flat.
gicrun=$(realpath "$1")
here=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
cp "$here/data/tires/rig.veh" "$here/data/tires/car.tir" .
cp "$here/../models/tires/hmmwv_pac2002.tir" truck.tir
for mode in 0 1 2 3; do
    sed "s/^USE_MODE = 4/USE_MODE = $mode/" car.tir >car_$mode.tir
done
passed=0
failed=0

# count: ok and FAIL lines of what came in
count() {
    while read -r line; do
        case $line in
        ok*) passed=$((passed + 1)) ;;
        *)
            failed=$((failed + 1))
            echo "$line"
            ;;
        esac
    done <"$1"
}

# road FRICTION: a scene with it
road() {
    printf 'gicscene: 1\nduration: 1\nstep: 0.1\nroad: {type: flat, friction: {value: %s}}\n' "$1" >road.scene
}

# against RADIUS FRICTION ENGINE WHEEL...: those wheels, whose tires are of that radius; ENGINE perhaps with options
against() {
    radius=$1 friction=$2 engine=$3
    shift 3
    road "$friction"
    # shellcheck disable=SC2086  # a list of words
    python3 "$here/data/tires/compare.py" states "$radius" >states.csv &&
        "$gicrun" --engine $engine --eval states.csv rig.veh road.scene -o results.csv &&
        python3 "$here/data/tires/compare.py" check . "$friction" "$@" <results.csv >said || echo "no comparison" >said
    count said
}

against 0.4699 1 cc truck truck_right easy
against 0.317 1 cc car car_right car_0 car_1 car_2 car_3
against 0.31 1 cc plain
for engine in tape gic 'cc --lanes 2'; do
    against 0.4699 0.35 "$engine" truck truck_right easy
    against 0.317 0.35 "$engine" car car_right car_0 car_1 car_2 car_3
    against 0.31 0.35 "$engine" plain
done

road 1
python3 "$here/data/tires/limits.py" states >states.csv &&
    "$gicrun" --engine tape --eval states.csv rig.veh road.scene -o results.csv &&
    python3 "$here/data/tires/limits.py" check <results.csv >said || echo "no limits" >said
count said

# a rolling resistance that does not depend on the speed needs no speed to be relative to
mkdir bare && cp rig.veh ./*.tir bare && sed -i '/^LONGVL/d' bare/truck.tir
for engine in gic tape; do
    "$gicrun" -q --engine $engine --eval states.csv rig.veh road.scene -o all.csv &&
        "$gicrun" -q --engine $engine --eval states.csv bare/rig.veh road.scene -o bare.csv && cmp all.csv bare.csv >&2 &&
        echo ok >said || echo "FAIL: a tire without LONGVL by $engine" >said
    count said
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 40 ]
