#!/bin/sh
# SPDX-License-Identifier: MIT
# test_axes.sh GICRUN: numbers along axes of --plot and of pages are different ones and not over each other, in ranges nice and
# nasty; colours of curves that colour-blind people tell apart. Small diagrams of reports: test_panel.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
axes() { /usr/bin/python3 "$root/tests/lib/axes.py" "$@" >said 2>&1; }

# picture NAME FORMULA OF X...: curves over time, one unit each, x going from 0 to 1, then the first over the others
picture() {
    name=$1
    shift
    printf 'gicgen: 1\nmodel: %s\ngravity: [0, 0, 0]\nbase: ground\nbodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\n' "$name" >"$name.veh"
    printf 'joints: {rail: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}\ncoordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0]}}\n' >>"$name.veh"
    signals=signals:
    outputs=outputs:
    plot=
    over=
    k=0
    for formula; do
        k=$((k + 1))
        signals="$signals\n  s$k: {value: \"$formula\", unit: u$k}"
        outputs="$outputs\n  s$k: {type: signal, signal: s$k}"
        plot="$plot${plot:+, }s$k"
        over="$over, {x: s$k, y: s1}"
    done
    printf '%b\n%b\n' "$signals" "$outputs" >>"$name.veh"
    echo "{gicscene: 1, duration: 1, step: 0.01, output_step: 0.02, integrator: rk4, initial: {rates: {x: 1}}, plot: [$plot$over]}" >"$name.scene"
    "$gicrun" -q "$name.veh" "$name.scene" -o "$name.csv" --plot "$name.svg" >said 2>&1 && axes numbers "$name.svg"
    verdict $? "$name: $(tail -n 1 said)"
}
picture nice x '2 * x - 1' '100 * x' '-5 * x'
picture large '1e12 * x' '1e5 * x' '-1e6 - 1e5 * x' '1e12 * (x - 0.5)'
picture small '1e-12 * x' '-3e-5 * x' '1e-4 + 1e-5 * x' '1e-9 * (x - 0.3)'
picture far '1e6 + x' '1000 + 0.1 * x' '123456.789 + 0.001 * x' '-1e5 - 2 * x'
picture noise '1e6 + 1e-6 * x' '1000 + 0 * x' '7 + 1e-9 * x' '-2 - 1e-12 * x'

axes inks "$root/runtime/host/axis.c" "$root/templates/animate_ink.js.in"
verdict $? "colours: $(tail -n 1 said)"

axes page "$root/templates/animate_ink.js.in" "$root/templates/animate_vectors.js.in" "$work/page.html"
HOME=$work chromium --headless --no-sandbox --disable-gpu --user-data-dir="$work/chromium" --dump-dom "file://$work/page.html" >page.out 2>said
grep -q 'different numbers' page.out
verdict $? "axes of pages: $(head -c 300 page.out)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
