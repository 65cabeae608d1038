#!/bin/sh
# SPDX-License-Identifier: MIT
# test_elements.sh GICGEN GICRUN: torsional elements, stops and springs by tables: accelerations against values of the
# laws in FORMAT.md section 7, worked out here; stops that hold, keep energy or take it away; the energy balance.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

rig=$root/tests/data/elements/rig.veh

# ---- laws: all coordinates at the same value and rate, across every end and corner, angles beyond half a turn -----

awk 'BEGIN {
    n = split("torsion formula rest bumper spring strap", name, " ")
    for (i = 1; i <= n; ++i) printf("%s%s,%s.rate", i > 1 ? "," : "", name[i], name[i])
    print ""
    for (k = -32; k <= 32; ++k)
        for (rate = -3; rate <= 3; rate += 1.5) {
            for (i = 1; i <= n; ++i) printf("%s%.17g,%.17g", i > 1 ? "," : "", (i < 3 ? 0.2 : 0.01) * k, rate)
            print ""
        }
}' >states
"$gicrun" --eval states "$rig" -o results
verdict $? "the rig does not run"
paste -d , states results | awk -F, '
    function max(a, b) { return a > b ? a : b }
    function wrapped(x) { return x - 2 * pi * (x > pi) + 2 * pi * (x < -pi) }
    # a table of straight lines
    function rubber(d) { return d < 0.05 ? 2000 * d : 100 + 8000 * (d - 0.05) }
    function coil(e) { return e < -0.2 ? -60 : e < 0 ? 300 * e : e < 0.1 ? 900 * e : 90 }
    function fade(s) { s = s > 1 ? 1 : s; return s * s * (3 - 2 * s) }
    function push(d, rate, elastic, damping, width) {
        return d > 0 ? max(0, elastic + damping * fade(d / width) * rate) : 0
    }
    function near(label, got, want) {
        # 1e-12: rounding; forces are of the order of 1000
        if (!(got ~ /^-?[0-9]/ && (got - want)^2 <= 1e-24 * (1 + want^2))) {
            print label " at " x ", " v ": " got " instead of " want
            bad = 1
        }
    }
    NR == 1 { pi = atan2(0, -1); next }
    {
        x = wrapped($1); v = $2; y = wrapped(-$3)
        near("torsion", $13, -(3 * (x - 0.2) + 0.5 * v) / 2)
        near("formula", $14, (4 * y + y^2 - 0.5 * v) / 2) # the angle of the ground against the body
        x = $5
        low = -0.1 - x
        high = x - 0.2
        near("rest", $15, (push(low, -v, 100 * low, 7, 0.05) - push(high, v, 100 * high, 7, 0.05)) / 2)
        high = x - 0.1
        near("bumper", $16, (push(low, -v, rubber(low), 900, 0.01) - push(high, v, rubber(high), 900, 0.01)) / 2)
        near("spring", $17, -(coil(x - 0.05) + 4 * v) / 2)
        near("strap", $18, -1000 * max(0, x - 0.1) / 2)
        ++rows
        held += x > 0.1 && $16 == 0
    }
    END {
        if (rows != 65 * 5) { print rows " rows"; bad = 1 }
        if (!held) { print "damping never wanted to pull: nothing tried that"; bad = 1 }
        exit bad
    }' >said
verdict $? "$(head -n 5 said)"

# ---- a slider against a strap: energy goes into it and comes back --------------------------------------------

sed '/^forces:/,/^outputs:/{/^[a-z]/b;/^  strap:/!d}' "$rig" >strap.veh
cat >bounce.scene <<'END'
gicscene: 1
duration: 0.4
step: 0.0001
integrator: rk4
output_step: 0.001
initial:
  rates: {strap: 3}
END
"$gicrun" --quiet strap.veh bounce.scene -o bounce.csv
verdict $? "the slider does not run"
# 0.1 m to the strap, 0.1342 m into it: 2 kg and 1000 N/m, 9 J; potential at its deepest is all of that
awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) { split($i, word, " "); column[word[1]] = i }; next }
    {
        total = $column["energy.kinetic"] + $column["energy.potential"]
        if ((total - 9)^2 > 1e-12) bad = bad " " total " J at " $1
        if ($column["strap"] < 0) bad = bad " pulls at " $1
        if ($column["energy.potential"] > most) most = $column["energy.potential"]
        if ($column["place.value"] > deepest) deepest = $column["place.value"]
        last = $column["place.rate"]
    }
    END {
        if (most < 8.99) bad = bad " potential " most
        if ((deepest - 0.1 - 3 * sqrt(2 / 1000))^2 > 1e-8) bad = bad " deepest " deepest
        if ((last + 3)^2 > 1e-10) bad = bad " comes back with " last
        if (bad) { print bad; exit 1 }
    }' bounce.csv >said
verdict $? "$(head -c 300 said)"

# ---- all kinds of elements on a free base: the energy balance of the generated self-test -----------------------

"$gicgen" "$root/tests/data/laws/cart.veh" -o cart.c &&
    cc -std=c99 -O1 -ffp-contract=off -I. -I"$root/runtime" "$root/tests/data/elements/balance.c" cart.c \
        "$root/runtime/gic_runtime.c" -lm -o balance && ./balance >said
verdict $? "energy balance: $(cat said)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
