#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep_metrics.sh GICSWEEP GICRUN: metrics of sweeps are what numpy computes by their definitions from gicrun's table of
# the same run; in lanes and by each engine; of runs that fail; closed solutions; units; parts; mistakes.
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

# ---- runs that fail between output times: the rows that count are those of gicrun's table, the last good state among them;
# a step of AB3 may lead to one without outputs. Some runs of the sweep fail, others go on

cat >"$work/driven.veh" <<'YYY'
gicgen: 1
model: driven
base: ground
gravity: [0, 0, 0]
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-5, 5]}
parameters:
  k: {value: 1, unit: N/m, tunable: true}
  c: {value: 0, unit: N s/m, tunable: true}
forces:
  spring: {type: force, coordinate: x, value: "-k * x - c * rate(x)"}
outputs:
  x: {type: coordinate, coordinate: x}
YYY
cat >"$work/rows.py" <<'YYY'
import sys
import numpy
sweep = numpy.genfromtxt(sys.argv[1], delimiter=",", names=True, deletechars="")
row = {name.split("_[")[0]: sweep[name][int(sys.argv[3])] for name in sweep.dtype.names}
run = numpy.genfromtxt(sys.argv[2], delimiter=",", skip_header=1)
t, x = run[:, 0], run[:, 1]
def integral(x):
    return float(numpy.sum((x[1:] + x[:-1]) / 2 * (t[1:] - t[:-1])))
way = (x - x[0]) / (x[-1] - x[0]) if x[-1] != x[0] else numpy.array([numpy.nan])
weight = integral(t - 1)
square = integral((t - 1) * x**2)
want = {"time": t[-1], "x.value.end": x[-1], "x.value.min": x.min(), "x.value.max": x.max(), "x.rate.end": run[-1, 2], "e": x[-1],
        "integral": integral(x), "mean": integral(x) / (t[-1] - t[0]) if t[-1] > 0 else x[0],
        "rms": numpy.sqrt(integral(x**2) / t[-1]) if t[-1] > 0 else abs(x[0]), "over": way.max() - 1, "at": t[x.argmax()],
        "weighted": numpy.sqrt(square / weight) if weight > 0 and square >= 0 else numpy.nan}
for name, value in want.items():
    assert numpy.isclose(row[name], value, rtol=1e-11, atol=1e-13, equal_nan=True), (name, row[name], value)
assert (row["status"] != 0) == (sys.argv[4] == "1"), row["status"]
print(bool(row["status"] != 0 and t[-1] % 2 > 0.01))
YYY
set -- --metric 'e=end(x)' --metric 'integral=integral(x)' --metric 'mean=mean(x)' --metric 'rms=rms(x)' --metric 'over=overshoot(x)' \
    --metric 'at=time_of_max(x)' --metric 'weighted=rms(x, time - 1)'
for way in 'integrator: ab3, step: 0.1' 'integrator: rk4, step: 0.1'; do
    between=0
    scene="gicscene: 1, duration: 20, output_step: 2, $way, initial: {coordinates: {x: 1}, rates: {x: 300}}"
    echo "{$scene}" >"$work/f.scene"
    "$gicsweep" -q "$work/driven.veh" "$work/f.scene" --vary k=0:4:3 --vary c=-1:1:3 "$@" -o "$work/f.csv" 2>"$work/err"
    check "$way" [ $? -eq 0 ]
    run=-1
    for values in 'k: 0, c: -1' 'k: 0, c: 0' 'k: 0, c: 1' 'k: 2, c: -1' 'k: 2, c: 0' 'k: 2, c: 1' 'k: 4, c: -1' 'k: 4, c: 0' 'k: 4, c: 1'; do
        run=$((run + 1))
        echo "{$scene, parameters: {$values}}" >"$work/f.scene"
        "$gicrun" -q "$work/driven.veh" "$work/f.scene" -o "$work/run.csv" 2>"$work/err"
        /usr/bin/python3 "$work/rows.py" "$work/f.csv" "$work/run.csv" $run $? >"$work/out" 2>&1
        verdict $? "$way: run $run has the rows of gicrun"
        grep -q True "$work/out" && between=$((between + 1))
    done
    check "$way: some fail between output times" [ $between -gt 0 ]
done
# without duration: an integral of a weight is not above 0. The first step leaves all bounds
echo '{gicscene: 1, duration: 2, integrator: rk4, step: 1, initial: {coordinates: {x: 1}, rates: {x: 1e6}}}' >"$work/f.scene"
"$gicsweep" -q "$work/driven.veh" "$work/f.scene" --vary k=1:1:1 -o "$work/f.csv" --metric 'a=rms(x)' --metric 'b=rms(x, 1)' --metric 'd=rms(x, time)' \
    --metric 'f=mean(x)' --metric 'g=integral(x)' 2>"$work/err"
check "a run without duration" [ "$(sed -n 2p "$work/f.csv" | rev | cut -d, -f1-5 | rev)" = "1,nan,nan,1,0" ]

# ---- ISO 2631-1: SciPy's filters from the standard's formulas, for an input that is linear between output times

cat >"$work/ride.py" <<'YYY'
import sys
import numpy
from scipy import signal
def corner(f):
    return 2 * numpy.pi * f
def second(f, q):
    return numpy.array([1 / corner(f)**2, 1 / (q * corner(f)), 1])
def filters(turn, step):
    top = numpy.polymul([1 / corner(0.4)**2, 0, 0], [1 / corner(turn), 1])
    below = numpy.polymul(numpy.polymul(second(0.4, 0.5**0.5), second(100, 0.5**0.5)), second(turn, 0.63))
    if step:
        top = numpy.polymul(top, second(2.37, 0.91)) * (2.37 / 3.35)**2
        below = numpy.polymul(below, second(3.35, 0.91))
    return signal.StateSpace(*signal.zpk2ss(*signal.tf2zpk(top, below)))
read = numpy.atleast_1d(numpy.genfromtxt(sys.argv[1], delimiter=",", names=True, deletechars=""))
sweep = {name.split("_[")[0]: read[name] for name in read.dtype.names}
run = numpy.genfromtxt(sys.argv[2], delimiter=",", skip_header=1)
t, x = run[:, 0], run[:, 1]
for name, filter in (("wk", filters(12.5, True)), ("wd", filters(2, False))):
    even = numpy.linspace(0, t[-1], len(t))
    assert numpy.allclose(even, t, atol=1e-12)
    y = signal.lsim(filter, x - x[0], even)[1]
    want = numpy.sqrt(numpy.sum((y[1:]**2 + y[:-1]**2) / 2) / (len(t) - 1))
    have = float(sweep[name][0])
    print(name, have, want, have / want - 1)
    assert abs(have / want - 1) < 1e-8
# a sine in the steady state has the filter's size
for hertz, name in ((1, "one"), (5, "five")):
    for end, filter in (("k", filters(12.5, True)), ("d", filters(2, False))):
        size = abs(signal.freqresp(filter, [corner(hertz)])[1][0]) / 2**0.5
        have = float(sweep[name + end][0])
        print(name, have, size)
        assert abs(have / size - 1) < 2e-2
YYY
echo '{gicscene: 1, duration: 40, step: 0.001, output_step: 0.002, initial: {coordinates: {x: 1}}, parameters: {k: 900, c: 0.5}}' >"$work/f.scene"
"$gicrun" -q "$work/driven.veh" "$work/f.scene" -o "$work/run.csv" 2>"$work/err"
"$gicsweep" -q "$work/driven.veh" "$work/f.scene" --vary k=900:900:1 -o "$work/f.csv" --metric 'wk=rms_wk(x)' --metric 'wd=rms_wd(x)' \
    --metric 'onek=rms_wk(sin(2*pi*time))' --metric 'oned=rms_wd(sin(2*pi*time))' --metric 'fivek=rms_wk(sin(10*pi*time))' \
    --metric 'fived=rms_wd(sin(10*pi*time))' --metric 'still=rms_wk(9.81)' --metric 'none=rms_wd(0*time)' 2>"$work/err"
/usr/bin/python3 "$work/ride.py" "$work/f.csv" "$work/run.csv" >"$work/out" 2>&1
verdict $? "ISO 2631-1"
check "what does not change is not felt" [ "$(sed -n 2p "$work/f.csv" | rev | cut -d, -f1,2 | rev)" = "0,0" ]

# ---- blanks, and names

"$gicsweep" -q "$work/driven.veh" "$work/f.scene" --vary k=1:1:1 -o "$work/f.csv" --metric ' a  [mm] = end( x.value ) ' --metric 'b=end( x.value)' \
    --metric 'c = crossing( x , 1 )' 2>"$work/err"
check "blanks" [ "$(head -n 1 "$work/f.csv" | cut -d, -f14-)" = "a [mm],b [m],c [s]" ]
taken() {
    "$gicsweep" -q "$work/driven.veh" "$work/f.scene" --vary k=1:1:1 -o "$work/e.csv" --metric 'good=end(x)' --metric "$1=end(x)" >"$work/out" 2>"$work/err"
    [ $? -eq 2 ] && grep -q "the table has a column '$1' without the metric of this name" "$work/err"
}
for name in run k status time x.value.end x.rate.max; do check "a name that is taken: $name" taken $name; done

# ---- mistakes

check "no function" refuses "knows end, min" 2 --metric 'a=median(chassis.z)'
check "no formula" refuses "knows end, min" 2 --metric 'a=chassis.z'
check "no name" refuses "takes NAME=FUNCTION" 2 --metric '=end(chassis.z)'
check "an unknown signal" refuses "--metric a:1:1.*chassis.q" 1 --metric 'a=end(chassis.q)'
check "two arguments of a filter" refuses "only rms takes a weight" 2 --metric 'a=rms_wk(chassis.z, 1)'
check "a comma too many" refuses "only rms takes a weight" 2 --metric 'a=end(chassis.z, 1)'
check "an open formula" refuses "--metric a:1:3" 1 --metric 'a=end(2*)'
check "two of a name" refuses "two metrics 'a'" 2 --metric 'a=end(time)' --metric 'a=max(time)'
check "a comma in a name" refuses "has no commas" 2 --metric 'a,b=end(time)'
check "a quote in a name" refuses "has no commas" 2 --metric 'a"=end(time)'
check "a comma in a unit" refuses "has no commas" 2 --metric 'a [m,s]=end(time)'
check "a name of blanks" refuses "takes NAME=FUNCTION" 2 --metric ' =end(time)'
check "two of a name, but for blanks" refuses "two metrics 'a'" 2 --metric 'a=end(time)' --metric 'a =max(time)'
check "no table" [ ! -e "$work/e.csv" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
