#!/bin/sh
# SPDX-License-Identifier: MIT
# test_powertrain.sh GICRUN: the complete HMMWV launches, shifts, idles and goes backwards; what its powertrain tells
# obeys balances of power and momentum and formulas of POWERTRAIN.md worked out here.
gicrun=$1
models=$(cd "$(dirname "$0")/../../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# within LOW VALUE HIGH
within() {
    awk "BEGIN {exit !(\"$2\" != \"\" && $1 <= $2 && $2 <= $3)}" || ! echo "    $2 is not within $1 and $3"
}

# run NAME MODEL ENGINE: the scene on standard input; results in $work/NAME.csv
run() {
    cat >"$work/$1.scene"
    "$gicrun" -q --general --engine "$3" "$2" "$work/$1.scene" -o "$work/$1.csv"
}

spins=$(for wheel in f_l f_r r_l r_r; do printf 'slip_%s.spin, slip_%s.spin_rate, slip_%s.drive, ' $wheel $wheel $wheel; done)

# figure NAME PROGRAM END: largest |x| that an awk program makes of the rows of results, or what END prints instead. In a
# row e is the engine's speed, T its torque, g the gear, i the ratio, w and Tt the turbine, Tp the pump, v the velocity;
# W the power of the half shafts, M the sum of its magnitudes; f, r, d speeds of the differentials, fd, rd, dd rates.
figure() {
    awk -F, "NR > 1 {
        t = \$1; e = \$2; T = \$3; g = \$5; i = \$6; w = \$7; Tt = \$8; Tp = \$9; v = \$22; W = M = 0
        for (k = 10; k <= 19; k += 3) { p = \$k * \$(k + 2); W += p; M += p < 0 ? -p : p }
        f = 2.5 * (\$10 + \$13); fd = 2.5 * (\$11 + \$14); r = 2.5 * (\$16 + \$19); rd = 2.5 * (\$17 + \$20)
        d = (f + r) / 2; dd = (fd + rd) / 2
        $2
        if (x < 0) x = -x
        if (!(x <= most)) most = x
    }
    END {${3:-printf \"%.3e\\n\", most}}" "$work/$1.csv"
}

# ---- launch at full throttle, with the inertias of the driveline and without ----------------------------------------

launch="gicscene: 1
duration: 12
step: 0.001
inputs:
  accelerator: {knots: {times: [0, 0.5, 1, 20], values: [0, 0, 1, 1]}}
outputs: [drive, $spins chassis_velocity.x]"
echo "$launch" | run launch "$models/hmmwv_vehicle.veh" tape
echo "$launch" | run compiled "$models/hmmwv_vehicle.veh" tcc
check "compiled code shifts with the same bits" cmp "$work/launch.csv" "$work/compiled.csv"

mkdir "$work/light"
cp -R "$models/parts" "$models/tires" "$models/hmmwv.veh" "$models/hmmwv_vehicle.veh" "$work/light"
sed -i '/^ *engine:/,/torque:/!s/inertia: 0\.[35]/inertia: 0/' "$work/light/parts/hmmwv_powertrain.veh"
check "three differentials and the turbine lost their inertia" \
    [ "$(grep -c 'inertia: 0\b[^.]*$' "$work/light/parts/hmmwv_powertrain.veh")" -eq 4 ]
echo "$launch" | run light "$work/light/hmmwv_vehicle.veh" tape

# without inertias what the turbine gives is what the half shafts pass on, while gears change too; rounding of sums
most=$(figure light "x = (W - Tt * w) / (1 + M)")
check "power of turbine and half shafts without inertias" within 0 "$most" 1e-11
# with them the rest turns the shafts; while gears change the turbine's is another (its ratio moves)
most=$(figure launch "if (i != before) { before = i; next }
    x = (Tt * w - W - 0.5 * (f * fd + r * rd + d * dd) - 0.3 * i * i * d * dd) / (1 + M)")
check "power of turbine, half shafts and inertias" within 0 "$most" 1e-11
# engine: its momentum is the sum of torques; the trapezoidal rule at 1 ms errs by h^2 / 12 of their second derivative
most=$(figure launch "if (n++) { x = 1.6 * (e - e0) - 0.0005 * (T - Tp + Q); sum += x } e0 = e; Q = T - Tp; x = sum")
check "momentum of the engine" within 0 "$most" 1e-2
most=$(figure launch "x = w - i * d")
check "speed of the turbine by those of the wheels" within 0 "$most" 1e-11
most=$(figure launch "x = e > w ? Tt / Tp - (Tp ? 1 : 0) : Tt - Tp; bad += x < -1e-12 || x > 1 + 1e-12" 'print bad + 0')
check "torque ratio from 2 to 1" [ "$most" -eq 0 ]

# gears 1, 2, 3, up at 2500 rpm of the turbine, not less than 1 s apart
gears=$(figure launch "if (g != last) printf \"%s%d\", last == \"\" ? \"\" : \" \", g; last = g" 'print ""')
check "gears one after the other" [ "$gears" = "1 2 3" ]
most=$(figure launch "if (NR > 2 && g != last) { x = w - 2500 * 3.14159265358979 / 30; if (!(x > 0 && x < 0.5 && t - at > 1)) ++bad; at = t } last = g" 'print bad + 0')
check "shifts where the turbine exceeds 2500 rpm" [ "$most" -eq 0 ]
# the ratio follows the smooth step over 0.3 s from the time of the change, which is in the step before its row: the first
# ratio tells it, 3 s^2 - 2 s^3 = change
most=$(figure launch "if (NR > 2 && g != last) {
        from = was; ratio = g == 2 ? 2.5 : 1.25; low = 0; high = 1
        for (k = 0; k < 60; ++k) { s = (low + high) / 2; if (s * s * (3 - 2 * s) < (i - from) / (ratio - from)) low = s; else high = s }
        at = t - 0.3 * s; if (at < before - 1e-6 || at > t + 1e-6) ++bad } last = g; was = i; before = t
    s = (t - at) / 0.3; if (s > 1) s = 1
    ratio = g == 1 ? 5 : g == 2 ? 2.5 : 1.25; x = at ? i - from - (ratio - from) * s * s * (3 - 2 * s) : i - 5" \
    'printf "%.3e\n", bad ? 9 : most')
check "ratio during shifts" within 0 "$most" 1e-10
speed=$(figure launch '' 'print v')
check "speed after 12 s, m/s" within 17 "$speed" 19.5

# ---- idling, and backwards ------------------------------------------------------------------------------------------

run idle "$models/hmmwv_vehicle.veh" tape <<END
gicscene: 1
duration: 12
step: 0.001
output_step: 0.1
inputs: {selector: 0}
outputs: [drive, $spins chassis_velocity.x]
END
# neutral: governor against losses; from the maps between 700 and 800 rpm by bisection
wanted=$(awk 'BEGIN {
    rpm = 3.14159265358979323846 / 30; idle = 800 * rpm; low = 700 * rpm; high = idle
    for (k = 0; k < 60; ++k) {
        e = (low + high) / 2; n = e / rpm
        torque = (idle - e) / (0.2 * idle) * (300 + 82 * (n + 100) / 900) - 30 - 20 * (n - 50) / 950
        if (torque > 0) low = e; else high = e
    }
    printf "%.12g", e
}')
most=$(figure idle "x = t < 11 ? 0 : e - $wanted")
check "idle speed in neutral" within 0 "$most" 1e-8
gears=$(figure idle '' 'print g, i, Tt, Tp')
check "nothing is engaged in neutral" [ "$gears" = "0 0 0 0" ]

run back "$models/hmmwv_vehicle.veh" tape <<END
gicscene: 1
duration: 5
step: 0.001
output_step: 0.1
inputs: {selector: -1, accelerator: 0.3}
outputs: [drive, $spins chassis_velocity.x]
END
gears=$(figure back '' 'print g, i')
check "reverse" [ "$gears" = "-1 -10" ]
speed=$(figure back '' 'print v')
check "backwards, m/s" within -8 "$speed" -2

# ---- order of integration --------------------------------------------------------------------------------------------

# The selector engages gear 1 in the step that ends at 0.504 s, whatever its size; it slips in over 0.3 s, which no
# step sees as a jump: errors of AB3 still fall with the third power of the step.
for step in 0.002 0.001 0.0005 0.000125; do
    run order_$step "$models/hmmwv_vehicle.veh" tape <<END
gicscene: 1
duration: 1.5
step: $step
output_step: 1.5
initial: {gear: 0, speed: 2}
inputs:
  selector: {knots: {times: [0, 0.5039, 0.50399, 2], values: [0, 0, 1, 1]}}
outputs: [drive, $spins chassis_velocity.x]
END
done
# gap A B: largest difference of the last rows, relative to 1 + their size
gap() {
    { tail -n 1 "$work/order_$1.csv"; tail -n 1 "$work/order_$2.csv"; } | awk -F, '{
        for (k = 1; k <= NF; ++k)
            if (NR == 1)
                a[k] = $k
            else {
                x = ($k - a[k]) / (1 + ($k < 0 ? -$k : $k)); if (x < 0) x = -x; if (!(x <= most)) most = x
            }
    } END {printf "%.3e\n", most}'
}
coarse=$(gap 0.002 0.000125)
fine=$(gap 0.001 0.000125)
finest=$(gap 0.0005 0.000125)
check "order across a shift ($coarse, $fine, $finest)" within 5.5 "$(awk "BEGIN {print $coarse / $fine}")" 11
check "order across a shift, finer" within 5.5 "$(awk "BEGIN {print $fine / $finest}")" 11

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
