#!/bin/sh
# SPDX-License-Identifier: MIT
# mechanisms.sh RANDOM_VEHICLE GICGEN GICRUN STATES REFERENCE AGREE REFERENCE_LONG GICSWEEP SINGLE: random mechanisms of
# a few bodies with numbers such as people write (random_vehicle --mechanism), of the seeds FIRST to LAST (1 to 20), at
# ROWS (4) states each, quarter, half and many turns among them, against quad precision: accelerations and places to what
# FORMAT.md section 14 promises, with nothing refused that is regular; and short runs, which must keep their energy where
# nothing takes any, and agree between code for the scene and the engine gic. All by the engine `tape` and by one of the
# other ways of generating, in turn; of the former, nine in ten in extended precision alone where nothing is wrong. One
# in COMPILED (50) goes through a C compiler, as numbers one by one, in lanes, side by side in a sweep, and for warnings.
# Prints a line for each thing found wrong,
#
#     CLASS SEED WAY: what was seen
#
# and, last, a line of counts, each as NAME NUMBER: of mechanisms, of those that gicgen refuses, of comparisons and rows
# compared, of refusals without cause, of runs, of failures, the largest deviation. REFUSALS=ignore: refusals without
# cause are counted and are no failures. KEEP=folder: the files are left there.
random_vehicle=$1
gicgen=$2
gicrun=$3
states=$4
reference=$5
agree=$6
reference_long=$7
gicsweep=$8
single=$9
tests=$(dirname "$0")/..
rows=${ROWS:-4}
compiled=${COMPILED:-50}
if [ -n "$KEEP" ]; then
    work=$KEEP
    mkdir -p "$work" || exit 1
else
    work=$(mktemp -d) || exit 1
    trap 'rm -rf "$work"' EXIT
fi
GICGEN_CACHE=
export GICGEN_CACHE
# the last of two levels of optimization counts
echo "exec ${CC:-cc} \"\$@\" -O0" >"$work/cc"
: >"$work/worst"
mechanisms=0
refused=0
comparisons=0
runs=0
failures=0
rows_compared=0
baseless=0
reactions=

# wrong CLASS SEED WAY TEXT
wrong() {
    failures=$((failures + 1))
    echo "$1 $2 $3: $4"
}

# solve SEED PROGRAM: poses and accelerations at the states
solve() {
    timeout 100 "$2" "$work/$1.dump" "$work/$1.states" --brisk -o "$work/$1.accelerations" 2>"$work/said" ||
        wrong reference "$1" "$2" "$(tail -n 1 "$work/said")"
}

# judge SEED WAY TOLERANCE: sets $verdict, the counts of rows compared and $without cause refused, the largest deviation
# $most, and $what there is to say. agree wants half of the rows to count; here many are singular, and none may do.
judge() {
    "$agree" "$work/$1.dump" "$work/$1.accelerations" "$work/$1.results" --tolerance "$3" --condition 30 --regular 100 --floor 0.1 \
        $reactions >"$work/agreed" 2>&1
    # shellcheck disable=SC2046  # words
    set -- $(awk '
        / passed, [0-9]* failed$/ { passed = $1; ended = 1 }
        / refused without cause$/ { baseless = $1 }
        /^row .* refused / { sub(/.*: /, ""); refusal = $0 }
        / worst / { x = $0; sub(/.* worst /, "", x); sub(/ in row.*/, "", x)
                    if (!(x + 0 <= most + 0)) { most = x; where = $0 } }
        /  FAILED$/ { failed = 1 }
        END {
            verdict = failed ? "numbers" : !ended ? "compare" : baseless ? "refusal" : "ok"
            print passed + 0, baseless + 0, most + 0, verdict, failed ? where : !ended ? $0 : refusal
        }' "$work/agreed")
    count=$1
    without=$2
    most=$3
    verdict=$4
    shift 4
    what=$*
}

# compare SEED WAY TOLERANCE: rows evaluated in a way against the reference; fails where the model is refused
compare() {
    # shellcheck disable=SC2086  # an engine with its options
    timeout 100 "$gicrun" --engine $2 --cc "sh $work/cc" --eval "$work/$1.states" "$work/$1.variant.veh" \
        -o "$work/$1.results" 2>"$work/said"
    status=$?
    if [ $status -eq 1 ] && [ "$2" = tape ]; then
        return 1
    elif [ $status -ne 0 ]; then
        wrong engine "$1" "$2" "status $status: $(grep -m 1 error: "$work/said")"
        return
    fi
    comparisons=$((comparisons + 1))
    judge "$1" "$2" "$3"
    if [ "$verdict" != ok ] && [ -n "$extended" ]; then
        extended=
        solve "$1" "$reference"
        judge "$1" "$2" "$3"
    fi
    rows_compared=$((rows_compared + count))
    baseless=$((baseless + without))
    # engines that share no code with generated code have no part in what is promised for that
    case $2 in g*) ;; *) echo "$most" >>"$work/worst" ;; esac
    case $verdict in
    ok) ;;
    refusal)
        # engines for comparison go by their own ways, and may lose one
        case $2$REFUSALS in g* | *ignore) ;; *) wrong refusal "$1" "$2" "$without rows: $what" ;; esac
        ;;
    *) wrong "$verdict" "$1" "$2" "$what" ;;
    esac
    return 0
}

# energies RESULTS: how far kinetic and potential energy change together, and the larger of them, J
energies() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /kinetic/) k = i
                       next }
        { e = $k + $(k + 1)
          if (NR == 2) first = e
          d = e - first; if (d < 0) d = -d; if (d > most) most = d
          if ($k > size) size = $k
          p = $(k + 1); if (p < 0) p = -p; if (p > size) size = p }
        END { printf "%.6g %.6g\n", most, size + 1e-3 }' "$1"
}

# scene SEED STEP: nice rates from the design; of a mechanism with two sides the same on both
scene() {
    awk -v seed="$1" -v step="$2" -v base="$(grep '^base: ' "$work/$1.veh")" -v halves="$(grep -c "_l: " "$work/$1.veh")" '
        function rate() { seed = (seed * 1103515245 + 12345) % 2147483648; return int(seed / 65536) % 4 - 1 }
        BEGIN {
            rate(); rate()
            printf "gicscene: 1\nduration: %s\nstep: %s\noutput_step: 0.01\nintegrator: rk4\ninitial:\n", halves ? 1.2 : 0.2, step
            if (base ~ /^base: base.*/ && halves)
                printf "  velocity: [%d, 0, %d]\n  angular_velocity: [0, %d, 0]\n", rate(), rate(), rate()
            else if (base != "base: ground")
                printf "  velocity: [%d, %d, 0]\n  angular_velocity: [%d, %d, %d]\n", rate(), rate(), rate(), rate(), rate()
            printf "  rates: {"
        }
        /^[a-z]+:/ { inside = /^coordinates:/; next }
        inside && !/driven/ {
            name = $1; sub(/:.*/, "", name); side = name; sub(/_[lr]$/, "", side)
            if (!(side in known)) known[side] = rate()
            printf "%s%s: %d", n++ ? ", " : "", name, known[side] }
        END { print "}" }' "$work/$1.veh" >"$work/$1.$2.scene"
}

# go SEED STEP ENGINE OUT: exit status of a run
go() {
    # shellcheck disable=SC2086  # an engine with its options
    timeout 100 "$gicrun" -q --engine $3 --cc "sh $work/cc" "$work/$1.veh" "$work/$1.$2.scene" -o "$4" 2>"$work/said"
}

# regular SEED: are all states of the run by gic far from singular configurations, in quad precision? A light mechanism
# goes to a dead centre and back within a hundredth of a second, so that states are taken every millisecond. Where the
# base is, does not matter.
regular() {
    sed -i 's/^output_step:.*/output_step: 0.001/' "$work/$1.0.000125.scene"
    go "$1" 0.000125 gic "$work/$1.closely.csv" || return 1
    awk -F, '
        FNR == 1 { ++file }
        file == 1 && /^ *out_[0-9]*: / {
            name = $1; sub(/^ */, "", name); sub(/:.*/, "", name)
            sub(/.*coordinate: /, ""); sub(/}.*/, ""); of[name] = $0
        }
        file == 1 { next }
        FNR == 1 {
            if (free) printf "r.x,r.y,r.z,e0,e1,e2,e3,v.x,v.y,v.z,omega.x,omega.y,omega.z,"
            for (i = 1; i <= NF; ++i) {
                name = $i; sub(/ .*/, "", name); kind = name; sub(/.*[.]/, "", kind); sub(/[.][a-z]*$/, "", name)
                if (!(name in of)) continue
                if (kind == "value") column[++columns] = i
                if (kind == "value") printf "%s%s,%s.rate", (columns > 1 ? "," : ""), of[name], of[name]
            }
            print ""
            next
        }
        {
            if (free) printf "0,0,0,1,0,0,0,0,0,0,0,0,0,"
            for (i = 1; i <= columns; ++i) printf "%s%s,%s", (i > 1 ? "," : ""), $column[i], $(column[i] + 1)
            print ""
        }' free="$(grep -c "^base: base" "$work/$1.veh")" "$work/$1.veh" "$work/$1.closely.csv" >"$work/$1.way.states"
    timeout 100 "$reference_long" "$work/$1.dump" "$work/$1.way.states" --brisk -o "$work/$1.way" 2>"$work/said" &&
        awk -F, 'NR > 1 && !($NF == 0 && $(NF - 2) < 100 && $(NF - 1) > 0.05) { exit 1 }' "$work/$1.way"
}

# apart TABLE TABLE: the largest difference of two runs, relative to 1 + the number
apart() {
    paste -d, "$1" "$2" | awk -F, '
            NR == 1 { for (i = 1; i <= NF / 2; ++i) either[i] = $i ~ /[.]e[0-3] /; next }
            { for (i = 1; i <= NF / 2; ++i) {
                # Euler parameters have a sign of their own where e0 is rounding
                if (either[i]) { if ($i < 0) $i = -$i; if ($(i + NF / 2) < 0) $(i + NF / 2) = -$(i + NF / 2) }
                d = $i - $(i + NF / 2); s = $i + $(i + NF / 2); if (d < 0) d = -d; if (s < 0) s = -s
            d /= 1 + s; if (d > most || d != d) most = d } } END { printf "%.6g", most }'
}

# runs_well SEED WAY: a run by that way against one by gic, and its energy
runs_well() {
    scene "$1" 0.002
    runs=$((runs + 1))
    go "$1" 0.002 gic "$work/$1.gic.csv"
    other=$?
    go "$1" 0.002 "$2" "$work/$1.run.csv"
    status=$?
    if [ $status -gt 1 ]; then
        wrong crash "$1" "$2" "status $status: $(head -n 1 "$work/said")"
    elif [ $status -ne 0 ] && [ $other -eq 0 ]; then
        said=$(grep -m 1 error: "$work/said")
        # what a long step would pass is judged by a bound; a shorter one gets nearer (FORMAT.md section 14)
        scene "$1" 0.000125
        if ! go "$1" 0.000125 "$2" "$work/$1.fine.csv" && regular "$1"; then
            [ "$REFUSALS" = ignore ] || wrong stops "$1" "$2" "$said"
        fi
    elif [ $status -eq 0 ] && [ $other -eq 0 ]; then
        off=$(apart "$work/$1.run.csv" "$work/$1.gic.csv")
        # shellcheck disable=SC2046
        set -- "$1" "$2" "$off" $(energies "$work/$1.run.csv")
        # A shortcut of code for the scene is none of code for all scenes, whose right-hand sides the rows have judged.
        # Where that is as far off, the motion has amplified roundings.
        if ! awk "BEGIN { exit !($3 < 1e-8) }"; then
            go "$1" 0.002 "$2 --general" "$work/$1.general.csv"
            awk "BEGIN { exit !($(apart "$work/$1.general.csv" "$work/$1.gic.csv") > 1e-2 * $3) }" ||
                wrong run "$1" "$2" "off by $3 from gic"
        fi
        grep -q "damping\|type: force\|type: aero\|force: \|torque: \|driven" "$work/$1.veh" || awk "BEGIN { exit !($4 > 1e-6 * $5) }" || return 0
        grep -q "damping\|type: force\|type: aero\|force: \|torque: \|driven" "$work/$1.veh" && return 0
        # an integrator's error shrinks with its step
        scene "$1" 0.000125
        go "$1" 0.000125 "$2" "$work/$1.fine.csv" || return 0
        # shellcheck disable=SC2046
        set -- "$1" "$2" "$4" "$5" $(energies "$work/$1.fine.csv")
        awk "BEGIN { exit !($5 > 0.05 * $3 && $5 > 1e-9 * $4) }" && wrong energy "$1" "$2" "drifts by $3 J of $4, with a sixteenth of the step by $5"
    fi
}

# in_single SEED: single precision, where nothing is near singular. What tcc links does not say that it needs no
# executable stack, and glibc from 2.41 on loads that only where a tunable allows it.
in_single() {
    comparisons=$((comparisons + 1))
    mkdir "$work/single"
    "$gicgen" "$work/$1.veh" -o "$work/single/model.c" 2>"$work/said" &&
        tcc -shared -DGIC_FLOAT -I"$tests/../runtime" "$work/single/model.c" "$tests/../runtime/gic_runtime.c" \
            -o "$work/single/model.so" >"$work/said" 2>&1 &&
        "$single" --round "$work/$1.states" -o "$work/single/states" &&
        GLIBC_TUNABLES=glibc.rtld.execstack=2 "$single" "$work/single/model.so" "random_$1" "$work/single/states" -o "$work/single/results" &&
        "$reference_long" "$work/$1.dump" "$work/single/states" --brisk -o "$work/single/accelerations" 2>"$work/said"
    status=$?
    "$agree" "$work/$1.dump" "$work/single/accelerations" "$work/single/results" --tolerance 1e-3 --condition 100 \
        --refusals --floor 0.1 >"$work/agreed" 2>&1 || status=1
    rm -rf "$work/single"
    [ $status -eq 0 ] || wrong single "$1" float "$(head -n 1 "$work/said") $(grep -m 1 '  FAILED$' "$work/agreed")"
}

# side_by_side SEED: a sweep in the lanes of vectors against one by the engine gic
side_by_side() {
    name=$(awk '/^[a-z]+:/ { inside = /^coordinates:/; next }
                inside && !/driven/ { sub(/:.*/, ""); sub(/^ */, ""); print; exit }' "$work/$1.veh")
    scene "$1" 0.002
    comparisons=$((comparisons + 1))
    for engine in "" gic; do
        "$gicsweep" -q "$work/$1.veh" "$work/$1.0.002.scene" --vary "state/$name.rate=-1:1:5" --cc "sh $work/cc" \
            ${engine:+--engine $engine} -o "$work/$1.sweep$engine" 2>"$work/said" || {
            wrong sweep "$1" "${engine:-lanes}" "$(grep -m 1 error: "$work/said")"
            return
        }
    done
    paste -d, "$work/$1.sweep" "$work/$1.sweepgic" | awk -F, '
        NR == 1 { for (i = 1; i <= NF / 2; ++i) either[i] = $i ~ /[.]e[0-3][. ]/; next }
        # a run that ends in lanes only may be near singular
        $4 != 0 || $(4 + NF / 2) != 0 { next }
        { for (i = 1; i <= NF / 2; ++i) {
              d = $i - $(i + NF / 2); s = $i + $(i + NF / 2)
              if (d < 0) d = -d
              if (s < 0) s = -s
              if (!either[i] && !(d <= 1e-8 * (1 + s))) bad = i ":" $i " and " $(i + NF / 2) } }
        END { print bad; exit bad != "" }' >"$work/agreed" || wrong sweep "$1" lanes "$(cat "$work/agreed")"
}

# compiles SEED: without warnings
compiles() {
    comparisons=$((comparisons + 1))
    # shellcheck disable=SC2015  # either may fail
    "$gicgen" "$work/$1.veh" -o "$work/model.c" 2>"$work/said" &&
        ${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O1 -I"$tests/../runtime" \
            -c "$work/model.c" -o "$work/model.o" 2>"$work/said" || wrong warnings "$1" cc "$(grep -m 1 error: "$work/said")"
}

way() {
    case $(($1 % 10)) in
    0) echo "gic" ;;
    1) echo "gcp1" ;;
    2) echo "tape --solve augmented --recovery newton" ;;
    3) echo "tape --recovery closed" ;;
    4) echo "tcc" ;;
    5) echo "tape --recovery newton" ;;
    6) echo "gcp2" ;;
    7) echo "tcc --solve augmented --recovery closed" ;;
    8) echo "tape --solve augmented" ;;
    9) echo "gic --recovery newton" ;;
    esac
}

mechanism() {
    mechanisms=$((mechanisms + 1))
    "$random_vehicle" --seed "$1" --mechanism >"$work/$1.veh" || wrong crash "$1" random_vehicle ""
    "$gicgen" --dump-model "$work/$1.veh" >"$work/$1.dump" 2>"$work/said"
    status=$?
    if [ $status -ne 0 ]; then
        refused=$((refused + 1))
        [ $status -eq 1 ] || wrong crash "$1" gicgen "status $status"
        return
    fi
    "$states" "$work/$1.dump" --count "$rows" --seed "$1" --nice -o "$work/$1.states"
    extended=
    [ $(($1 % 10)) -eq 0 ] || extended=yes
    solve "$1" "$([ -n "$extended" ] && echo "$reference_long" || echo "$reference")"
    reactions=
    if [ $(($1 % 3)) -eq 0 ]; then
        reactions=--reactions
        sh "$tests/lib/reactions.sh" "$work/$1.dump" "$1.veh" >"$work/$1.variant.veh"
    else
        cp "$work/$1.veh" "$work/$1.variant.veh"
    fi
    # reactions are not promised as much
    tolerance=$([ -n "$reactions" ] && echo 1e-11 || echo 2e-12)
    if ! compare "$1" tape "$tolerance"; then
        refused=$((refused + 1))
        # columns way.condition, way.determinant, status
        good=$(awk -F, 'NR > 1 && $NF == 0 && $(NF - 2) < 100 && $(NF - 1) > 0.05 { ++n } END { print n + 0 }' \
            "$work/$1.accelerations")
        [ "$good" -eq 0 ] || [ "$REFUSALS" = ignore ] ||
            wrong generation "$1" tape "$good regular states, and $(grep -m 1 error: "$work/said" | sed 's/^[^ ]* //')"
        return
    fi
    way=$(way "$1")
    case $way in g*) compare "$1" "$way" 1e-9 ;; *) compare "$1" "$way" "$tolerance" ;; esac
    case $(($1 % compiled)) in
    0) compare "$1" "cc" "$tolerance" ;;
    1) compare "$1" "cc --lanes 4" "$tolerance" ;;
    2) compare "$1" "cc --lanes 2 --solve augmented" "$tolerance" ;;
    3) side_by_side "$1" ;;
    4) compiles "$1" ;;
    esac
    [ $(($1 % 5)) -ne 3 ] || in_single "$1"
    if grep -q "_l: " "$work/$1.veh" || [ $(($1 % 4)) -eq 0 ]; then
        runs_well "$1" tcc
    fi
    [ $(($1 % 40)) -ne 1 ] || runs_well "$1" "tcc --general"
    [ -n "$KEEP" ] || rm -f "$work/$1".*
}

seed=${FIRST:-1}
while [ "$seed" -le "${LAST:-20}" ]; do
    mechanism "$seed"
    seed=$((seed + 1))
done
echo "mechanisms $mechanisms refused $refused comparisons $comparisons rows $rows_compared" \
    "baseless $baseless runs $runs failures $failures worst $(sort -g "$work/worst" | tail -n 1)"
