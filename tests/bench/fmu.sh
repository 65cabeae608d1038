#!/bin/sh
# SPDX-License-Identifier: MIT
# fmu.sh GICGEN [MODEL.veh SCENE ...]: sizes of FMUs (2.0), time that `cc -O2` takes for their sources, and what a
# communication step costs beyond the same step called directly (fmu_step.c); a row of a table each. Without models: those of
# models/FMI.md.
set -eu
gicgen=$1
shift
here=$(cd "$(dirname "$0")" && pwd)
root=$here/../..
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# what an FMU can have of a scene
flat() { python3 "$root/tests/fmi/scene.py" "$root/models/scenes/$1.scene" 12 0.06 >"$work/$1.scene"; }
if [ $# -eq 0 ]; then
    for pair in pendulum:pendulum quarter_car:quarter_car hmmwv:paper_run hmmwv_tires:tires_brake hmmwv_vehicle:full_run; do
        flat "${pair#*:}"
        set -- "$@" "$root/models/${pair%:*}.veh" "$work/${pair#*:}.scene"
    done
fi
size() { wc -c <"$1"; }
echo "| model | FMU, MB | binary for this machine, MB | \`cc -O2\`, s | plain step, us | FMU's, us | more, ns | more, % |"
echo "|---|---|---|---|---|---|---|---|"
while [ $# -gt 1 ]; do
    name=$(basename "$1" .veh)
    "$gicgen" --fmu 2 "$1" --scene "$2" -o "$work/one.fmu" 2>"$work/said" || { cat "$work/said"; exit 1; }
    shift 2
    rm -rf "$work/one"
    mkdir "$work/one"
    python3 -m zipfile -e "$work/one.fmu" "$work/one"
    token=$(sed -n 's/.* guid="\([^"]*\)".*/\1/p' "$work/one/modelDescription.xml")
    library=$work/one/binaries/linux64/$name.so
    cd "$work/one/sources"
    start=$(date +%s.%N)
    ${CC:-cc} -std=c99 -O2 -fPIC -shared -fvisibility=hidden ./*.c -o "$work/one.so" -lm
    taken=$(echo "$(date +%s.%N) $start" | awk '{ printf "%.1f", $1 - $2 }')
    ${CC:-cc} -std=c11 -O2 -I. -o "$work/fmu_step" "$here/fmu_step.c" "$name.c" gic_runtime.c -ldl -lm
    cd "$work"
    times=$("$work/fmu_step" "$library" "$token")
    echo "$times" | awk -v name="$name" -v all="$(size "$work/one.fmu")" -v one="$(size "$library")" \
        -v taken="$taken" '{ printf "| %s | %.2f | %.2f | %s | %.3f | %.3f | %.0f | %.1f |\n", name, all / 1e6, one / 1e6,
            taken, $1, $2, 1000 * ($2 - $1), 100 * ($2 - $1) / $1 }'
done
