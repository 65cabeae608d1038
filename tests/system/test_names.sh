#!/bin/sh
# SPDX-License-Identifier: MIT
# test_names.sh GICGEN GICRUN GICSWEEP: texts of models, scenes and files that HTML, scripts, SVG and gnuplot mean something
# by (descriptions, units, names of files and columns; other names are letters, digits and `_`) are texts on every page and
# picture, looked at in a real browser; and names that are none are refused.
gicgen=$1
gicrun=$2
gicsweep=$3
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
for program in gicgen gicrun gicsweep; do
    eval "case \$$program in /*) ;; *) $program=\$PWD/\$$program ;; esac"
done
cd "$work" || exit 1
evil='<img src=x onerror=boom()>'

cat >odd.veh <<'END'
gicgen: 1
model: odd
description: "</script></title><img src=x onerror=boom()>\"5 < 6\" & ' Größe \u2028 <!-- x `touch hacked`"
base: ground
parameters:
  length: {value: 0.3, tunable: true, unit: "<img src=x onerror=boom()>"}
  weight: {value: 1, tunable: true, unit: "</script><b onmouseover='boom()'>"}
inputs:
  push: {unit: "<b onmouseover='boom()'>N&\"m \\ `touch hacked` @~ {x}_2^3"}
bodies:
  bob: {mass: weight, com: [0, 0, -length], inertia: [0.01, 0.01, 0.01]}
joints:
  pivot: {type: revolute, bodies: [ground, bob], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, bob], axis: [0, 1, 0], range: [-1, 1], initial: 0.5}
forces:
  hand: {type: force, coordinate: angle, value: push}
signals:
  twice: {value: 2 * angle.value, unit: "</svg><script>boom()</script>"}
outputs:
  angle: {type: coordinate, coordinate: angle}
  twice: {type: signal, signal: twice}
END
scene="<i>&'\"ü.scene"
cat >"$scene" <<'END'
gicscene: 1
duration: 1
step: 0.005
inputs: {push: {sine: {amplitude: 0.1, frequency: 1}}}
plot: [twice, input.push, angle.value]
END
run -q odd.veh "$scene" -o results.csv
check 'a run' exits 0
# other results: a column that is called so, in a file that is called so
sed '1s/^\(.*\)$/\1,"<img src=x onerror=boom()> [<b>]"/; 2,$s/$/,1/' results.csv >"$evil.csv"

run -q odd.veh "$scene" --animate animate.html --with "$evil.csv" --plot plot.svg
check '--animate, --with and --plot' exits 0
run -q odd.veh "$scene" --plot plot.png
check '--plot, as PNG' exits 0
run -q --drive drive.html odd.veh "$scene"
check '--drive' exits 0
run -q --gradient angle odd.veh "$scene" -o gradient.html
check '--gradient' exits 0
"$gicgen" --report report.html odd.veh >out 2>err
status=$?
check 'gicgen --report' exits 0
"$gicsweep" odd.veh "$scene" --vary length=0.2:0.4:5 --vary weight=1:2:4 --metric 'size [<b onmouseover>&]=max(angle)' \
    --report sweep.html -o sweep.csv >out 2>err
status=$?
check 'gicsweep --report' exits 0
for name in one "$evil"; do
    printf 'gicgen: 1\ninclude: %s\nmodel: car\ndescription: "%s <script>boom()</script>"\n' "$root/models/hmmwv_vehicle.veh" \
        "$evil" >"$name.veh"
done
run -q --sheet one.veh --compare "$evil.veh" -o sheet.html
check '--sheet' exits 0
check 'nothing of a text was a command' [ ! -e hacked ]

timeout 300 /usr/bin/python3 -B "$root/tests/data/names/browser.py" "$work/profile" "$work/animate.html" "$work/drive.html" \
    "$work/gradient.html" "$work/report.html" "$work/sweep.html" "$work/sheet.html" "$work/plot.svg" \
    >"$work/notes" 2>"$work/err"
check 'the browser is used to the end' [ $? -eq 0 ]
while read -r how what; do
    check "$what" [ "$how" = good ]
done <"$work/notes"

# what C code, columns and JSON are made of is letters, digits and `_`
for key in bodies joints coordinates inputs parameters forces outputs signals; do
    sed "/^$key:/{n;s/^  [a-z]*:/  \"$evil\":/;}" odd.veh >named.veh
    run -q named.veh "$scene"
    check "no name among $key" exits 1
    check "no name among $key: why" says "is not a name for"
done
sed "s/^model: .*/model: \"$evil\"/" odd.veh >named.veh
run -q named.veh "$scene"
check 'no name of a model' exits 1

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
