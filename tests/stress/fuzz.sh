#!/bin/sh
# SPDX-License-Identifier: MIT
# fuzz.sh GICGEN RANDOM_VEHICLE: readers of models, formulas, tires, scenes and roads under clang's libFuzzer with
# sanitizers (tests/fuzz/fuzz.c, which `make fuzz` builds), for SECONDS_EACH (60, short: 10) each, from seeds:
# tests/fuzz/seeds, the project's own files, sound and broken, and random vehicles, of which 40 reach as many branches
# as some ten minutes of fuzzing without them. What it made of them is gone afterwards but for findings, which stay in
# $BUILD/stress/fuzz.
gicgen=$1
build=$(dirname "$gicgen")
fuzz=$build/fuzz/check/fuzz
random_vehicle=$(realpath "$2")
cd "$(dirname "$0")/../.." || exit 1
[ "$STRESS" = short ] && seconds=${SECONDS_EACH:-10} || seconds=${SECONDS_EACH:-60}
found=$build/stress/fuzz
mkdir -p "$found" || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# words of the formats, so that whole ones come in
"$gicgen" --list-keys | grep -oE '[a-z_]{2,}' | sort -u | sed 's/.*/"&"/' >"$work/words"

# seeds READER: files to begin with
seeds() {
    case $1 in
    veh)
        ls models/*.veh models/parts/*.veh tests/data/mistakes/*.veh tests/data/laws/*.veh tests/data/elements/*.veh
        ls "$work"/random/*.veh
        ;;
    tir) ls models/tires/*.tir tests/data/tires/*.tir ;;
    scene) ls models/scenes/*.scene ;;
    esac
    ls -d tests/fuzz/seeds/"$1"/*
}

# random vehicles in one file; they have no other to read a tire from
mkdir "$work/random"
for seed in $(seq 40); do
    "$random_vehicle" --seed "$seed" --rich "$work" --tire models/tires/hmmwv_pac2002.tir || exit 1
    other=$(sed -n 's/^  \(tmeasy_[0-9]*\): .*/\1/p' "$work/$seed.plain.veh")
    sed "/^  pacejka_/d; s/tire: pacejka_[0-9]*/tire: $other/" "$work/$seed.plain.veh" >"$work/random/$seed.veh"
done

for reader in veh formula tir scene road; do
    mkdir "$work/$reader"
    for file in $(seeds $reader); do
        cp "$file" "$work/$reader/$(echo "${file#"$work/"}" | tr / _)"
    done
    rm -f "$found/$reader"-*
    # what gicgen reads in 0.6 s takes half a minute with sanitizers, coverage and -O1, more without, or beside other work;
    # it ends by a signal or a status that is not 0 at the first finding; leaks are blocks that libyaml keeps until exit
    READER=$reader ASAN_OPTIONS=detect_leaks=0 "$fuzz" -detect_leaks=0 -dict="$work/words" -timeout=180 \
        -rss_limit_mb=3000 -max_total_time="$seconds" -print_final_stats=1 -close_fd_mask=2 \
        -artifact_prefix="$found/$reader-" "$work/$reader" >"$work/log" 2>&1
    status=$?
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/log")
    branches=$(sed -n 's/.* cov: \([0-9]*\).*/\1/p' "$work/log" | tail -n 1)
    verdict=ok
    if [ $status -ne 0 ]; then
        verdict=$(grep -m 1 'runtime error\|ERROR: \|finding: ' "$work/log" || echo "exit status $status")
        verdict="$verdict: $found"
        cat "$work/log" >&2
    fi
    # what it accepts and what it refuses is one to a fuzzer: neither may fall
    echo "fuzz | $reader | ${runs:-0} | ${runs:-0} | 0 | ${branches:-0} branches reached | $verdict"
done
