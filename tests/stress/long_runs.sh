#!/bin/sh
# SPDX-License-Identifier: MIT
# long_runs.sh GICRUN: an hour of vehicle time
#
# (Short: three minutes.) Constraint residuals, normalization, energy and
# memory at its end are what they were at its beginning.
gicrun=$(realpath "$1")
cd "$(dirname "$0")/../.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
seconds=3600
[ "$STRESS" = short ] && seconds=180

# Peak memory of a command, kB, on the last line of what it prints on standard error.
cat >"$work/peak.py" <<'END'
import resource
import subprocess
import sys

status = subprocess.call(sys.argv[1:])
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
sys.exit(status)
END

# drive NAME MODEL SECONDS: $work/scene for so long, with as many rows whatever the time
drive() {
    awk -v t="$3" '/^duration:/ { print "duration: " t; next } /^output_step:/ { print "output_step: " t / 60; next } { print }' \
        "$work/scene" >"$work/timed.scene"
    python3 "$work/peak.py" "$gicrun" --engine tcc -o "$work/$1.csv" "$2" "$work/timed.scene" 2>"$work/$1.err"
}

# hour MODEL WHAT TOLERANCE [ROW]: $work/scene; energy and normalization of rows from ROW on (default the first) within
# TOLERANCE of those of that row
hour() {
    model=$1 what=$2 tolerance=$3 from=${4:-1}
    drive short "$model" 36 && drive long "$model" "$seconds"
    status=$?
    residual=$(sed -n 's/.*constraint residual *\([0-9.e+-]*\) .*/\1/p' "$work/long.err")
    growth=$(($(tail -n 1 "$work/long.err") - $(tail -n 1 "$work/short.err")))
    drift=$(awk -F, -v from="$from" '
        NR == 1 { for (i = 1; i <= NF; ++i) { if ($i ~ /kinetic|potential/) energy[i] = 1; if ($i ~ /chassis_orientation/) e[i] = 1 } next }
        {
            sum = norm = size = 0
            for (i in energy) { sum += $i; size += $i < 0 ? -$i : $i }
            for (i in e) norm += $i * $i
            if (NR - 1 < from) next
            if (NR - 1 == from) first = sum
            d = sum - first; if (d < 0) d = -d; if (d > most) most = d
            if (size > largest) largest = size
            d = norm ? norm - 1 : 0; if (d < 0) d = -d; if (d > 1e-12) far = 1
        }
        END { printf "%.1e", NR == 62 && !far ? most / largest : 1 }' "$work/long.csv")
    verdict=ok
    awk "BEGIN { exit !($drift <= $tolerance) }" || verdict="energy or normalization drifts"
    awk "BEGIN { exit !(${residual:-1} <= 1e-12) }" || verdict="residual grows"
    # pages that the C library keeps
    [ "$growth" -lt 2000 ] || verdict="memory grows by $growth kB"
    [ $status -eq 0 ] || verdict="it ends: $(sed -n 's/.*error: //p' "$work/short.err" "$work/long.err")"
    [ "$verdict" = ok ] || found=1
    echo "long runs | $(basename "$model" .veh), $what, $seconds s | 1 | 1 | 0 | energy $drift, residual ${residual:-?}, memory $growth kB | $verdict"
}

cat >"$work/scene" <<END
gicscene: 1
duration: 1
step: 0.001
output_step: 1
integrator: rk4
END
# a swing without damping: RK4 takes (step times frequency)^6 / 72 of the energy a step, 5e-11 in an hour
hour models/pendulum.veh "swinging" 1e-9

cat >"$work/scene" <<END
gicscene: 1
duration: 1
step: 0.005
output_step: 1
initial: {velocity: [5, 0, 0], equilibrium: true, orientation: {yaw: 0.4}}
END
hour models/hmmwv.veh "rolling straight on" 1e-9

sed '/^output_step/d; /^plot/,$d' models/scenes/steady_circle.scene >"$work/scene"
grep -q '^output_step' "$work/scene" || echo 'output_step: 1' >>"$work/scene"
# the driver keeps the speed to what its gains and the shape of its path leave
[ "$STRESS" = short ] || hour models/hmmwv_vehicle.veh "on a circle" 1e-5 10
exit $found
