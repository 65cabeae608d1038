#!/bin/sh
# SPDX-License-Identifier: MIT
# test_andrews.sh GICRUN: Andrews' squeezing mechanism (models/andrews.veh) at 0.03 s against published values.
#
# Two sets of values. CONVERGED: the limit on which two integrations by other programs agree (an eighth-order
# Runge-Kutta pair in double, RK4 in long double), to 13 digits. PUBLISHED: the Test Set for IVP Solvers; its digits
# belong to a time 1e-12 s off, so that at speeds of 1140 and 1424 rad/s angles differ by 1.5e-9, velocities by 5e-7.
#
# What is compared. q = (beta, Theta, gamma, Phi, delta, Omega, epsilon) and q'. Yaw and yaw rate of the bodies' frames
# are (see andrews.veh)
#     K2: beta + Theta   K3: gamma   K4: Phi + delta   K5: delta   K6: Omega + epsilon   K7: epsilon
# and beta is the dual coordinate. beta is unwrapped and compared as it is; the others are angles in (-pi, pi] and
# compared modulo 2 pi. All errors are absolute, in rad and rad/s, though velocities reach 1424 rad/s.
gicrun=$1
models=$(dirname "$0")/../../models
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

cat >"$work/converged" <<'END'
15.8107711951537 1139.9203022591
-15.7563710584118 -1424.3792951775
.0408222401197 11.0329119106
-.5347301163421 19.2933741050
.5244099658800 .5735699148
.5347301163421 -19.2933741050
1.0480807410419 .3231791493
END
cat >"$work/published" <<'END'
15.81077119629904 1139.920302151208
-15.75637105984298 -1424.379294994111
0.04082224013073101 11.03291221937134
-0.5347301163226948 19.29337464421385
0.5244099658805304 0.5735699284790808
0.5347301163226948 -19.29337464421385
1.048080741042263 0.3231791658026955
END

# simulate STEP: $work/q holds seven lines of angle and velocity at 0.03 s
simulate() {
    printf '%s\n' "gicscene: 1" "duration: 0.03" "step: $1" "integrator: rk4" "output_step: 0.03" >"$work/scene"
    "$gicrun" --quiet "$models/andrews.veh" "$work/scene" -o "$work/csv"
    verdict $? "no run at step $1"
    awk -F, -v OFMT=%.17g '
        NR == 1 { for (i = 1; i <= NF; ++i) { split($i, word, " "); column[word[1]] = i } }
        { for (name in column) value[name] = $column[name] }
        END {
            split("K2 K3 K4 K5 K6 K7", body, " ")
            for (i = 1; i <= 6; ++i) {
                angle[i] = value[body[i] ".yaw"]
                rate[i] = value["spin_" body[i] ".z"]
            }
            print value["beta.value"], value["beta.rate"]
            print angle[1] - value["beta.value"], rate[1] - value["beta.rate"]
            print angle[2], rate[2]
            print angle[3] - angle[4], rate[3] - rate[4]
            print angle[4], rate[4]
            print angle[5] - angle[6], rate[5] - rate[6]
            print angle[6], rate[6]
        }' "$work/csv" >"$work/q"
}

# errors EXPECTED: largest errors of $work/q in angles and in velocities
errors() {
    paste -d ' ' "$work/q" "$work/$1" | awk '
        function size(x) { return x < 0 ? -x : x }
        BEGIN { turn = 8 * atan2(1, 1) }
        NF != 4 { print "nan nan"; exit }
        {
            angle = $1
            if (NR > 1)
                angle -= turn * sprintf("%.0f", ($1 - $3) / turn)
            a = size(angle - $3)
            v = size($2 - $4)
            worst_a = a > worst_a ? a : worst_a
            worst_v = v > worst_v ? v : worst_v
        }
        END { if (NR == 7) printf "%.3g %.3g\n", worst_a, worst_v; else print "nan nan" }'
}

# within "ANGLES VELOCITIES" TOLERANCE TOLERANCE LABEL
within() {
    echo "$1" | awk -v a="$2" -v v="$3" '{ exit !($1 ~ /^[0-9]/ && $2 ~ /^[0-9]/ && $1 <= a && $2 <= v) }'
    verdict $? "$4: errors of angles and velocities $1"
}

# fourth order: half the step, a sixteenth of the error (somewhat less, for these steps still show the next order); the
# error stays well above the last digit of the values
simulate 1e-5
coarse=$(errors converged)
simulate 5e-6
fine=$(errors converged)
echo "$coarse $fine" | awk '{ a = log($1 / $3) / log(2); v = log($2 / $4) / log(2)
                              exit !(a > 3.6 && a < 4.4 && v > 3.6 && v < 4.4) }'
verdict $? "errors $coarse fall to $fine with half the step: not fourth order"

for step in 1e-6 5e-7; do
    simulate $step
    within "$(errors converged)" 1e-10 1e-10 "converged values, step $step"
    within "$(errors published)" 3e-9 1e-6 "published values, step $step"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
