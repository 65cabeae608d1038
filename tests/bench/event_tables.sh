#!/bin/sh
# SPDX-License-Identifier: MIT
# event_tables.sh [BUILD [PART...]]: tables of models/EVENTS.md. `work`: what a bound of work, `most_work`, does to the
# error of scenes with events; `roads`: errors over roads that steps resolve more or less; `kinks`: errors with and
# without kinks in formulas of forces; `loads`: what parts of steps in which loads bend little cost and bring. An error
# is the largest distance of chassis positions, m, from those of RK4 with contacts located and a small part of the step.
set -e
build=${1:-build}
[ $# -eq 0 ] || shift
[ $# -gt 0 ] || set -- work roads kinks loads
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# scene NAME STEP LINE...: the scene with another step
scene() {
    sed '/^step:/d; /^integrator:/d; /^ratio:/d; /^locate:/d; /^output_step:/d' "models/scenes/$1.scene"
    printf 'step: %s\noutput_step: 0.024\n' "$2"
    shift 2
    printf '%s\n' "$@"
}

apart() {
    paste -d, "$work/now.csv" "$work/fine.csv" | awk -F, '
        NR == 1 {for (i = 1; i <= NF; ++i) if ($i == "chassis.x [m]") if (a) b = i; else a = i}
        NR > 1 {d = sqrt(($a - $b)^2 + ($(a + 1) - $(b + 1))^2 + ($(a + 2) - $(b + 2))^2); if (d > most) most = d}
        END {printf "%.2g", most}'
}

part_of() { awk -v s="$1" -v p="$2" 'BEGIN {printf "%.12g", s / p}'; }

# A number of the summary; 0: it is not there.
said() { sed -n "s/^  $1  *\(at most \)\{0,1\}\([0-9]*\).*/\2/p" "$work/said" | grep . || echo 0; }

# bounds MODEL SCENE STEP RATIO PARTS BOUND...
bounds() {
    model=$1 name=$2 step=$3 ratio=$4
    scene "$name" "$(part_of "$step" "$5")" 'integrator: rk4' 'locate: true' >"$work/fine.scene"
    "$build/gicrun" -q "models/$model.veh" "$work/fine.scene" -o "$work/fine.csv"
    shift 5
    for bound; do
        scene "$name" "$step" "ratio: $ratio" 'locate: true' >"$work/now.scene"
        [ "$bound" = none ] || echo "most_work: $bound" >>"$work/now.scene"
        "$build/gicrun" "models/$model.veh" "$work/now.scene" -o "$work/now.csv" 2>"$work/said"
        echo "| \`$name\`, $step s, ratio $ratio | $bound | $(said 'work of a step') | $(said 'contacts located') |" \
            "$(said 'events gone over') | $(said 'right-hand sides') | $(apart) |"
    done
}

# loads MODEL SCENE STEP PARTS RATIO [TOLERANCE]: errors and right-hand sides of a step, its half and its quarter, and
# of variable steps
loads() {
    scene "$2" "$(part_of "$3" "$4")" 'integrator: rk4' 'locate: true' >"$work/fine.scene"
    "$build/gicrun" -q "models/$1.veh" "$work/fine.scene" -o "$work/fine.csv"
    for way in "ratio: $5" 'integrator: rk4'; do
        for located in false true loads; do
            printf '| `%s`, %s s | %s, locate: %s |' "$2" "$3" "$way" $located
            for part in 1 2 4; do
                scene "$2" "$(part_of "$3" $part)" "$way" "locate: $located" >"$work/now.scene"
                "$build/gicrun" "models/$1.veh" "$work/now.scene" -o "$work/now.csv" 2>"$work/said"
                printf ' %s | %s |' "$(apart)" "$(said 'right-hand sides')"
            done
            echo
        done
    done
    [ -n "$6" ] || return 0
    scene "$2" "$3" 'integrator: rkck' "tolerance: $6" >"$work/now.scene"
    "$build/gicrun" "models/$1.veh" "$work/now.scene" -o "$work/now.csv" 2>"$work/said"
    echo "| \`$2\` | variable steps: rkck, tolerance: $6 | $(apart) | $(said 'right-hand sides') | | | | |"
}

# errors WHAT MODEL STEP PARTS LINE...: of a step, its half and its quarter, AB3 and RK4; `one_scene STEP
# "LINE, LINE"` prints the scene
errors() {
    what=$1 model=$2 step=$3 parts=$4
    shift 4
    one_scene "$(part_of "$step" "$parts")" 'integrator: rk4, locate: true' >"$work/fine.scene"
    "$build/gicrun" -q "$model" "$work/fine.scene" -o "$work/fine.csv"
    for way; do
        printf '| %s | %s |' "$what" "$way"
        for part in 1 2 4; do
            one_scene "$(part_of "$step" "$part")" "$way" >"$work/now.scene"
            "$build/gicrun" "$model" "$work/now.scene" -o "$work/now.csv" 2>"$work/said"
            printf ' %s |' "$(apart)"
        done
        echo " $(said 'contacts located') |"
    done
}

ways='
locate: true, ratio: 4
locate: false, ratio: 4
locate: true, integrator: rk4'

# all_errors WHAT MODEL STEP PARTS
all_errors() {
    old=$IFS
    IFS='
'
    # shellcheck disable=SC2086  # lines
    errors "$@" $ways
    IFS=$old
}

# The jump of tires_jump over a ramp and a fall of smooth shape, with points 5 cm apart.
smooth_jump() {
    awk 'BEGIN {
        pi = atan2(0, -1)
        for (i = 0; i <= 120; ++i) {
            s = x = 5 + 0.05 * i
            s = x <= 9.5 ? sin(pi / 2 * (x - 5) / 4.5) : x <= 11 ? cos(pi / 2 * (x - 9.5) / 1.5) : 0
            xs = xs (i ? ", " : "") x
            hs = hs (i ? ", " : "") sprintf("%.12g", 0.51 * s * s)
        }
        print "gicscene: 1\nduration: 3\noutput_step: 0.024\ninitial: {velocity: [14, 0, 0]}"
        printf "road: {type: table, x: [%s], height: [%s]}\n", xs, hs
    }'
    printf 'step: %s\n' "$1"
    echo "$2" | sed 's/, /\n/g'
}

# with_lines SCENE STEP "LINE, LINE"
with_lines() { scene "$1" "$2" "$(echo "$3" | sed 's/, /\n/g')"; }
rough() {
    with_lines tires_rough "$@" |
        sed "s/^duration:.*/duration: 3.2/; s/^  length: .*/  length: 60\n  spacing: $spacing/"
}

for part; do
    case $part in
    work)
        echo '| scene | `most_work` | most in a step | contacts located | gone over | right-hand sides | error |'
        echo '|---|---|---|---|---|---|---|'
        bounds hmmwv_tires tires_jump 0.002 4 64 none 80 60 50 40 20
        bounds hmmwv_tires tires_jump 0.001 1 32 none 60 40 30 8
        bounds hmmwv_vehicle full_run 0.006 6 16 none 60 45 33 28
        ;;
    roads)
        echo '| road | with | step | half | a quarter | contacts of the last |'
        echo '|---|---|---|---|---|---|'
        one_scene() { with_lines tires_jump "$@"; }
        all_errors '`tires_jump`, 2 ms' models/hmmwv_tires.veh 0.002 64
        one_scene() { smooth_jump "$@"; }
        all_errors 'a smooth ramp, 2 ms' models/hmmwv_tires.veh 0.002 64
        one_scene() { rough "$@"; }
        for spacing in 0.05 0.25 1; do
            all_errors "\`tires_rough\`, nodes $spacing m apart, 4 ms" models/hmmwv_tires.veh 0.004 32
        done
        ;;
    kinks)
        law='"compression_\(.\)(length) \* min(0, speed) + rebound_.(length) \* max(0, speed)"'
        sed "s/$law/\"0.5 * (compression_\\1(length) + rebound_\\1(length)) * speed\"/" \
            models/hmmwv_full.veh >"$work/even.veh"
        cp -R models/hmmwv.veh models/parts "$work"
        ways='
locate: true
locate: true, integrator: rk4'
        echo '| model | with | step | half | a quarter | contacts of the last |'
        echo '|---|---|---|---|---|---|'
        for road in paper_run rough_road; do
            one_scene() { with_lines $road "$@"; }
            all_errors "\`hmmwv_full\`, \`$road\`, 4 ms" models/hmmwv_full.veh 0.004 32
            all_errors "the same without \`min\` and \`max\`, \`$road\`, 4 ms" "$work/even.veh" 0.004 32
            all_errors "\`hmmwv\`, \`$road\`, 4 ms" models/hmmwv.veh 0.004 32
        done
        ;;
    loads)
        echo '| scene | with | step | right-hand sides | half | right-hand sides | a quarter | right-hand sides |'
        echo '|---|---|---|---|---|---|---|---|'
        loads hmmwv_tires tires_jump 0.002 64 4 1e-4
        loads hmmwv_tires tires_rough 0.004 64 4 1e-4
        loads hmmwv_full rough_road 0.004 32 1 1e-4
        loads hmmwv_tires tires_brake 0.004 32 4
        ;;
    *) echo "event_tables.sh: no part '$part': work, roads, kinks or loads" >&2; exit 1 ;;
    esac
done
