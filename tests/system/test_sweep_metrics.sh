#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep_metrics.sh GICSWEEP GICRUN: metrics of sweeps are what numpy computes by their definitions from gicrun's table of
# the same run; in lanes and by each engine; closed solutions; units; parts; mistakes.
gicsweep=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
GICGEN_CACHE=$work/kept
export GICGEN_CACHE

# refuses TEXT STATUS ARGUMENT...: gicsweep ends with the status and the text in its message
refuses() {
    text=$1
    status=$2
    shift 2
    "$gicsweep" -q models/hmmwv.veh "$work/s.scene" --vary speed=5:6:2 -o "$work/e.csv" "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -q -- "$text" "$work/err"
}

# metrics: of formulas of z = chassis.z and w = wheel_f_l.z
set -- --metric 'last=end(chassis.z)' --metric 'low=min(chassis.z - 2*wheel_f_l.z)' --metric 'high=max(chassis.z*wheel_f_l.z)' \
    --metric 'middle=mean(chassis.z)' --metric 'root [m]=rms(chassis.z - wheel_f_l.z)' \
    --metric 'weighted=rms(chassis.z, abs(wheel_f_l.z) + time)' --metric 'sum=integral(max(chassis.z, wheel_f_l.z))' \
    --metric 'when_low=time_of_min(chassis.z)' --metric 'when_high=time_of_max(wheel_f_l.z)' \
    --metric 'through=crossing(chassis.z, 0.49)' --metric 'over=overshoot(wheel_f_l.z)' --metric 'never=crossing(chassis.z + 1000)'

# compare SWEEP RUN ROW: the sweep's row, of which gicrun made RUN
cat >"$work/compare.py" <<'YYY'
import sys
import numpy
sweep = numpy.genfromtxt(sys.argv[1], delimiter=",", names=True, deletechars="")
row = {name.split("_[")[0]: sweep[name][int(sys.argv[3])] for name in sweep.dtype.names}
run = numpy.genfromtxt(sys.argv[2], delimiter=",", skip_header=1)
t, z, w = run[:, 0], run[:, 1], run[:, 2]
def integral(x):
    return float(numpy.sum((x[1:] + x[:-1]) / 2 * (t[1:] - t[:-1])))
def crossing(x):
    for i in range(len(x)):
        if x[i] == 0:
            return t[i]
        if i + 1 < len(x) and x[i] * x[i + 1] < 0:
            return t[i] + (t[i + 1] - t[i]) * x[i] / (x[i] - x[i + 1])
    return numpy.nan
def overshoot(x):
    y = (x - x[0]) / (x[-1] - x[0])
    return y.max() - 1
weight = numpy.abs(w) + t
want = {"last": z[-1], "low": (z - 2 * w).min(), "high": (z * w).max(), "middle": integral(z) / (t[-1] - t[0]),
        "root": numpy.sqrt(integral((z - w) ** 2) / (t[-1] - t[0])),
        "weighted": numpy.sqrt(integral(weight * z**2) / integral(weight)), "sum": integral(numpy.maximum(z, w)),
        "when_low": t[z.argmin()], "when_high": t[w.argmax()], "through": crossing(z - 0.49), "over": overshoot(w),
        "never": numpy.nan}
for name, value in want.items():
    assert numpy.isclose(row[name], value, rtol=1e-11, atol=1e-13, equal_nan=True), (name, row[name], value)
    print(name, row[name])
assert not numpy.isnan(want["through"]) and want["over"] > 0
YYY

for model in hmmwv hmmwv_tires; do
    speed=5
    [ $model = hmmwv ] && step=0.005 || step=0.002
    cat >"$work/s.scene" <<YYY
gicscene: 1
duration: 1
step: $step
output_step: 0.01
initial: {speed: 5}
road: {type: bumps, bumps: [{x: 2, length: 2, height: 0.06, tracks: left}]}
outputs: [chassis.z, wheel_f_l.z]
YYY
    "$gicrun" -q models/$model.veh "$work/s.scene" -o "$work/run.csv" 2>"$work/err"
    for engine in '' '--engine tape' '--engine gic'; do
        [ "$model $engine" != "hmmwv_tires --engine gic" ] || continue
        # shellcheck disable=SC2086  # words
        "$gicsweep" -q $engine models/$model.veh "$work/s.scene" --vary speed=$speed:6:2 "$@" -o "$work/sweep.csv" 2>"$work/err"
        check "$model $engine" [ $? -eq 0 ]
        if [ -n "$engine" ]; then
            # shellcheck disable=SC2086  # words
            "$gicrun" -q $engine models/$model.veh "$work/s.scene" -o "$work/run.csv" 2>"$work/err"
        fi
        /usr/bin/python3 "$work/compare.py" "$work/sweep.csv" "$work/run.csv" 0 >"$work/out" 2>&1
        verdict $? "$model $engine: numpy's numbers"
    done
done
check "units" [ "$(head -n 1 "$work/sweep.csv" | cut -d, -f11-)" = \
    "last [m],low,high,middle [m],root [m],weighted [m],sum,when_low [s],when_high [s],through [s],over [1],never [s]" ]
"$gicsweep" -q models/hmmwv_tires.veh "$work/s.scene" --vary speed=5:6:2 -o "$work/plain.csv" 2>"$work/err"
"$gicsweep" -q models/hmmwv_tires.veh "$work/s.scene" --vary speed=5:6:2 "$@" -o "$work/sweep.csv" 2>"$work/err"
check "other columns keep their digits" eval 'cut -d, -f1-10 "$work/sweep.csv" | cmp -s - "$work/plain.csv"'
for i in 1 2; do
    "$gicsweep" -q models/hmmwv_tires.veh "$work/s.scene" --vary speed=5:6:2 "$@" --shard $i/2 -o "$work/parts" 2>"$work/err"
done
"$gicsweep" -q --merge "$work/parts" -o "$work/merged.csv" 2>>"$work/err"
check "in parts" cmp -s "$work/sweep.csv" "$work/merged.csv"
"$gicsweep" -q models/hmmwv_tires.veh "$work/s.scene" --vary speed=5:6:2 "$@" --slurm "$work/jobs" --parts 2 2>"$work/err"
for i in 1 2; do SLURM_ARRAY_TASK_ID=$i sh "$work/jobs/job.sh" 2>>"$work/err"; done
"$gicsweep" -q --merge "$work/jobs" -o "$work/again.csv" 2>>"$work/err"
check "by a script of jobs" cmp -s "$work/sweep.csv" "$work/again.csv"

# ---- closed solutions, with nice numbers: formulas of time alone

sed -i 's/^duration: .*/duration: 2/; s/^output_step: .*/output_step: 0.25/' "$work/s.scene"
"$gicsweep" -q models/hmmwv_tires.veh "$work/s.scene" --vary speed=0:5:2 -o "$work/closed.csv" --metric 'a=mean(time)' --metric 'b=integral(2)' \
    --metric 'c=crossing(time, 1)' --metric 'd=crossing(time - 1.1)' --metric 'e=crossing(0*time)' --metric 'f=overshoot(time)' \
    --metric 'g=overshoot(1 + 0*time)' --metric 'h=rms(3)' --metric 'i=rms(time, 0)' --metric 'j=overshoot(time*(3 - time))' \
    --metric 'k=overshoot(time*(time - 3))' --metric 'l=time_of_max(time*(2 - time))' --metric 'm=rms(time, 1 - time)' --metric 'n=crossing(time, 2)' \
    --metric 'o=mean(-5)' 2>"$work/err"
for row in 2 3; do
    check "closed solutions" [ "$(sed -n "${row}p" "$work/closed.csv" | cut -d, -f11-)" = "1,4,1,1.1,0,0,nan,3,nan,0.125,0.125,1,nan,2,-5" ]
done
"$gicsweep" -q models/hmmwv_tires.veh "$work/s.scene" --vary speed=4:4e9:2 -o "$work/fail.csv" --metric 'a=mean(time)' 2>"$work/err"
check "a run that fails at its start has none" [ "$(sed -n 3p "$work/fail.csv" | sed 's/.*,//')" = nan ]

# ---- mistakes

check "no function" refuses "knows end, min" 2 --metric 'a=median(chassis.z)'
check "no formula" refuses "knows end, min" 2 --metric 'a=chassis.z'
check "no name" refuses "takes NAME=FUNCTION" 2 --metric '=end(chassis.z)'
check "an unknown signal" refuses "--metric:1:.*chassis.q" 1 --metric 'a=end(chassis.q)'
check "a comma too many" refuses "only rms takes a weight" 2 --metric 'a=end(chassis.z, 1)'
check "an open formula" refuses "--metric:1:" 1 --metric 'a=end(2*)'
check "two of a name" refuses "two metrics 'a'" 2 --metric 'a=end(time)' --metric 'a=max(time)'
check "no table" [ ! -e "$work/e.csv" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
