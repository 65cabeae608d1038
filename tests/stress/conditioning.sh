#!/bin/sh
# SPDX-License-Identifier: MIT
# conditioning.sh GICGEN GICRUN STATES REFERENCE AGREE: sizes of numbers, against quad precision
#
# Mass ratios to 1e8, stiffness to 1e9 N/m, millimetres and hundreds
# of metres, 1e6 m from the origin, 1e3 rad/s: accelerations and poses against quad precision; a million turns; and
# numbers outside FORMAT.md section 14, which are refused.
#
# Errors are those of agree: accelerations relative to the largest term of their sum, places to the model's size. What
# grows is explained by the tolerance: a place has the rounding of its distance from the origin, 1.1e-16 of it, however
# small the model is, and the rest follows no further.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
cd "$(dirname "$0")/../.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
rows=8
[ "$STRESS" = short ] || rows=40

# row NAME COMMENT TRIED OK REFUSED WORST VERDICT
row() {
    case $7 in ok*) ;; *) found=1 ;; esac
    echo "conditioning | $1, $2 | $3 | $4 | $5 | $6 | $7"
}

# accurate MODEL WHAT TOLERANCE EDIT [SCALING...]: EDIT is what awk does to the states' columns c[name]
accurate() {
    model=$1 what=$2 tolerance=$3 edit=$4
    shift 4
    if python3 tests/stress/scale.py "models/$model.veh" "$@" >"$work/model.veh" &&
        "$gicgen" --dump-model "$work/model.veh" >"$work/dump" &&
        "$states" "$work/dump" --count "$rows" --seed 3 -o "$work/drawn" &&
        awk -F, -v OFS=, -v OFMT=%.17g -v CONVFMT=%.17g "NR == 1 { for (i = 1; i <= NF; ++i) c[\$i] = i; print; next }
            { $edit; print }" "$work/drawn" >"$work/states" &&
        "$reference" "$work/dump" "$work/states" -o "$work/expected" >/dev/null &&
        "$gicrun" -q --engine tcc --eval "$work/states" "$work/model.veh" -o "$work/found"; then
        if "$agree" "$work/dump" "$work/expected" "$work/found" --tolerance "$tolerance" >"$work/out"; then
            verdict=ok
        else
            verdict=$(tail -n 2 "$work/out" | tr '\n' ' ')
        fi
    else
        verdict="can't be compared"
        : >"$work/out"
    fi
    worst=$(awk '/ worst / { for (i = 1; i < NF; ++i) if ($i == "worst" && $(i + 1) + 0 >= most) { most = $(i + 1) + 0
        line = sprintf("%.1e of %s %s", most, $1, i > 2 ? $2 : "") } } END { print line }' "$work/out")
    compared=$(sed -n 's/.* \([0-9]*\) compared.*/\1/p' "$work/out")
    row "$model" "$what" "${compared:-0}" "${compared:-0}" 0 "$worst" "$verdict"
}

# shellcheck disable=SC2016  # columns of awk
fast='for (k in c) if (k ~ /^omega/) $c[k] *= 500'
# shellcheck disable=SC2016
away='$c["r.x"] += 1e6; $c["r.y"] -= 1e6'
for model in quarter_car hmmwv; do
    accurate "$model" "as it is" 1e-12 ""
    accurate "$model" "length 1 mm" 1e-10 "" length=3e-4
    accurate "$model" "length 100 m" 1e-12 "" length=30
    accurate "$model" "arms of 1e-8 their mass" 1e-12 "" "body=*a*r*m*:1e-8" "body=lca_*:1e-8"
    accurate "$model" "wheels of 1e8 their mass" 1e-12 "" "body=wheel*:1e8"
    accurate "$model" "springs of 1e9 N/m" 1e-12 "" stiffness=1e9
done
accurate hmmwv "1e6 m from the origin" 1e-9 "$away"
accurate hmmwv "turning at 1e3 rad/s" 1e-12 "$fast"
accurate hmmwv "all at once" 1e-9 "$away; $fast" "body=wheel*:1e8" stiffness=1e9

# a body that spins at 1e3 rad/s about its axis of symmetry: turns, normalization, angular velocity and energy
turns=2000
[ "$STRESS" = short ] || turns=1000000
cat >"$work/top.veh" <<END
gicgen: 1
model: top
base: top
gravity: [0, 0, 0]
bodies: {top: {mass: 3, com: [0, 0, 0], inertia: [1, 1, 2]}}
outputs:
  e: {type: orientation, body: top}
  w: {type: angular_velocity, body: top}
  energy: {type: energy}
END
cat >"$work/top.scene" <<END
gicscene: 1
duration: $(awk "BEGIN { print int($turns * 6.283185307179586) / 1000 }")
step: 0.0001
output_step: $(awk "BEGIN { print int($turns * 6.283185307179586) / 2000 }")
integrator: rk4
initial: {angular_velocity: [0, 0, 1000]}
END
engine=tcc
[ "$STRESS" = short ] || engine=cc
"$gicrun" -q --engine $engine "$work/top.veh" "$work/top.scene" -o "$work/out" 2>"$work/err"
status=$?
drift=$(awk -F, 'END { n = sqrt($2^2 + $3^2 + $4^2 + $5^2) - 1; w = $8 / 1000 - 1; e = $9 / 1e6 - 1
    if (n < 0) n = -n; if (w < 0) w = -w; if (e < 0) e = -e; printf "%.1e", n + w + e }' "$work/out")
row top "$turns turns at 1e3 rad/s" 1 1 0 "drift $drift" \
    "$([ $status -eq 0 ] && awk "BEGIN { exit !($drift < 1e-12) }" && echo ok || echo "status $status, or it drifts")"

# refused WHAT CODE SCALING...: numbers outside, by the reader, which says where
tried=0 refused=0 verdict=ok
while read -r what argument; do
    tried=$((tried + 1))
    python3 tests/stress/scale.py models/quarter_car.veh "$argument" >"$work/model.veh"
    "$gicgen" "$work/model.veh" -o "$work/model.c" 2>"$work/err"
    if [ $? -eq 1 ] && grep -q '^[^ ]*model.veh:[0-9]*:[0-9]*: error: ' "$work/err" && [ ! -e "$work/model.c" ]; then
        refused=$((refused + 1))
    else
        verdict="$what: not refused"
    fi
done <<END
mass mass=1e14
mass mass=1e-18
stiffness stiffness=2e15
stiffness stiffness=1e-16
length length=1e7
length length=1e-15
END
row quarter_car "outside of FORMAT.md" $tried $((tried - refused)) $refused "error with place" "$verdict"
exit $found
