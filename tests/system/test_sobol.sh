#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sobol.sh GICSWEEP: Sobol' indices of sweeps: Ishigami's function and the g-function of Sobol' in closed form, numpy from
# the table's rows, a metric that does not vary, runs that fail, parts, mistakes.
gicsweep=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
GICGEN_CACHE=$work/kept
OMP_NUM_THREADS=2
export GICGEN_CACHE OMP_NUM_THREADS

cat >"$work/m.veh" <<'YYY'
gicgen: 1
model: mass
base: ground
gravity: [0, 0, 0]
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-5, 5]}
parameters:
  p1: {value: 1, tunable: true}
  p2: {value: 1, tunable: true}
  p3: {value: 1, tunable: true}
  p4: {value: 1, tunable: true}
  p5: {value: 1, tunable: true}
  p6: {value: 1, tunable: true}
forces:
  spring: {type: force, coordinate: x, value: "-x"}
outputs:
  x: {type: coordinate, coordinate: x}
YYY
echo '{gicscene: 1, duration: 0.02, step: 0.01, output_step: 0.01}' >"$work/m.scene"
sobol() { "$gicsweep" -q "$work/m.veh" "$work/m.scene" "$@" 2>"$work/err"; }

cat >"$work/indices.py" <<'YYY'
"""indices.py FUNCTION TABLE INDICES: estimates and intervals against closed forms, and from the rows of the table"""
import csv
import sys
import numpy
rows = list(csv.DictReader(open(sys.argv[3])))
have = {(r["metric"], r["number"]): {k: float(v) for k, v in r.items() if k not in ("metric", "number")} for r in rows}
read = numpy.genfromtxt(sys.argv[2], delimiter=",", names=True, deletechars="")
table = {name.split("_[")[0]: read[name] for name in read.dtype.names}
if sys.argv[1] == "ishigami":
    a, b, pi = 7, 0.1, numpy.pi
    names = ["p1", "p2", "p3"]
    v1, v2, v13 = (1 + b * pi**4 / 5)**2 / 2, a**2 / 8, 8 * b**2 * pi**8 / 225
    v = v1 + v2 + v13
    first, total = [v1 / v, v2 / v, 0], [(v1 + v13) / v, v2 / v, v13 / v]
    low, high = -pi, pi
else:
    names = ["p1", "p2", "p3", "p4", "p5", "p6"]
    part = 1 / (3 * (1 + numpy.array([0, 1, 4.5, 9, 99, 99]))**2)
    v = numpy.prod(1 + part) - 1
    first, total = part / v, part * numpy.prod(1 + part) / (1 + part) / v
    low, high = 0, 1
d = len(names)
point = numpy.stack([table[n] for n in names], axis=1).reshape(-1, d + 2, d)
f = table["f"].reshape(-1, d + 2)
n = len(f)
# the layout: A, B, and A with one number of B
for i in range(d):
    mixed = point[:, 0].copy()
    mixed[:, i] = point[:, 1, i]
    assert numpy.array_equal(mixed, point[:, 2 + i])
# the sequence of Sobol': the first 2^k - 1 points have each multiple of 2^-k in each number
for c in range(2):
    for i in range(d):
        cells = numpy.sort((point[:n - 1, c, i] - low) / (high - low)) * n
        assert numpy.allclose(cells, numpy.arange(1, n), atol=1e-6), (c, i)
both = numpy.concatenate([f[:, 0], f[:, 1]])
for i, name in enumerate(names):
    h = have["f", name]
    s = numpy.mean((f[:, 1] - both.mean()) * (f[:, 2 + i] - f[:, 0])) / both.var()
    t = numpy.mean((f[:, 2 + i] - f[:, 0])**2) / 2 / both.var()
    assert abs(h["first"] - s) < 1e-5 and abs(h["total"] - t) < 1e-5, (name, h, s, t)
    print(name, h, first[i], total[i])
    assert abs(h["first"] - first[i]) < 0.02 and abs(h["total"] - total[i]) < 0.02, name
    assert h["first.low"] - 1e-6 <= first[i] <= h["first.high"] + 1e-6 and h["total.low"] - 1e-6 <= total[i] <= h["total.high"] + 1e-6, name
    # the width of an interval by the normal distribution
    g = (f[:, 2 + i] - f[:, 0])**2 / 2 / both.var()
    if t > 0.01:
        wide = 2 * 1.96 * g.std() / n**0.5
        assert 0.5 < (h["total.high"] - h["total.low"]) / wide < 2, (name, wide)
    assert h["points"] == n
assert numpy.all(numpy.isnan([have["c", names[0]][k] for k in ("first", "total", "first.low", "total.high")]))
YYY
indices() { /usr/bin/python3 "$work/indices.py" "$@" >"$work/out" 2>&1 ; }

pi=3.141592653589793
ishigami() {
    sobol --vary p1=-$pi:$pi --vary p2=-$pi:$pi --vary p3=-$pi:$pi --metric 'f=end(sin(p1) + 7*sin(p2)^2 + 0.1*p3^4*sin(p1))' --metric 'c=end(2)' "$@"
}
check "Ishigami's function" eval 'ishigami --sobol 2048 -o "$work/i.csv" >"$work/i.txt"'
check "has the indices of its closed form" indices ishigami "$work/i.csv" "$work/i.txt"
check "the same table again, from other processes" eval 'OMP_NUM_THREADS=1 ishigami --sobol 2048 -o "$work/j.csv" >"$work/j.txt" && cmp "$work/i.csv" "$work/j.csv" &&
    cmp "$work/i.txt" "$work/j.txt"'
for i in 2 3 1; do ishigami --sobol 2048 --shard $i/3 -o "$work/parts" >"$work/said"; done
check "no indices of a part" [ ! -s "$work/said" ]
check "in parts" eval '"$gicsweep" -q --merge "$work/parts" -o "$work/j.csv" >"$work/j.txt" && cmp "$work/i.csv" "$work/j.csv" && cmp "$work/i.txt" "$work/j.txt"'
check "by a script of jobs, as HDF5" eval 'ishigami --sobol 64 --slurm "$work/jobs" --parts 2 && for i in 1 2; do SLURM_ARRAY_TASK_ID=$i sh "$work/jobs/job.sh"; done 2>"$work/said" &&
    "$gicsweep" -q --merge "$work/jobs" -o "$work/j.h5" >"$work/j.txt" && ishigami --sobol 64 -o "$work/k.csv" >"$work/k.txt" && cmp "$work/j.txt" "$work/k.txt"'

# what h5py reads: the same numbers as in the table of text, which has six digits, and to numpy's rounding from the rows in
# the file; by one process and in parts the same bytes
cat >"$work/hdf5.py" <<'YYY'
import csv
import sys
import h5py
import numpy
f = h5py.File(sys.argv[1], "r")
sobol, kinds = f["sobol"], ("first", "first.low", "first.high", "total", "total.low", "total.high")
metrics, numbers = sobol.attrs["metrics"].split("\n"), sobol.attrs["numbers"].split("\n")
assert sorted(sobol) == sorted((*kinds, "points")) and all(sobol[k].attrs["description"] for k in sobol)
assert sobol["points"].dtype == numpy.int64 and sobol["points"].shape == (len(metrics),)
rows = list(csv.DictReader(open(sys.argv[2])))
assert [(r["metric"], r["number"]) for r in rows] == [(m, n) for m in metrics for n in numbers]
for r in rows:
    m, n = metrics.index(r["metric"]), numbers.index(r["number"])
    for k in kinds:
        assert sobol[k].shape == (len(metrics), len(numbers)) and "%.6g" % sobol[k][m, n] == r[k], (k, r)
    assert sobol["points"][m] == int(r["points"])
seen = 0
for m, name in enumerate(metrics):
    each = f["metrics"][name][:].reshape(-1, len(numbers) + 2)
    both = each[:, :2].ravel()
    if not numpy.isfinite(each).all() or both.var() == 0:
        assert numpy.isnan(sobol["first"][m]).all()
        continue
    for i in range(len(numbers)):
        way = each[:, 2 + i] - each[:, 0]
        first, total = numpy.mean((each[:, 1] - both.mean()) * way) / both.var(), numpy.mean(way**2) / 2 / both.var()
        assert abs(sobol["first"][m, i] - first) < 1e-12 and abs(sobol["total"][m, i] - total) < 1e-12
        assert sobol["first.low"][m, i] <= first <= sobol["first.high"][m, i]
        seen += 1
assert seen == int(sys.argv[3]), seen
YYY
check "in HDF5" eval 'ishigami --sobol 256 -o "$work/i.h5" >"$work/i.txt"'
check "h5py reads the indices" /usr/bin/python3 "$work/hdf5.py" "$work/i.h5" "$work/i.txt" 3
for i in 2 1; do ishigami --sobol 256 --shard $i/2 -o "$work/two" >"$work/said"; done
check "the same file of two parts" eval '"$gicsweep" -q --merge "$work/two" -o "$work/j.h5" >"$work/j.txt" && cmp "$work/i.h5" "$work/j.h5" && cmp "$work/i.txt" "$work/j.txt"'
check "none without --sobol" eval '"$gicsweep" -q "$work/m.veh" "$work/m.scene" --vary p1=0:1:3 --metric "f=end(p1)" -o "$work/k.h5" 2>"$work/err" &&
    /usr/bin/python3 -c "import h5py; assert \"sobol\" not in h5py.File(\"$work/k.h5\")"'

one() { echo "(abs(4*p$1 - 2) + $2)/(1 + $2)"; }
product() {
    sobol --vary p1=0:1 --vary p2=0:1 --vary p3=0:1 --vary p4=0:1 --vary p5=0:1 --vary p6=0:1 \
        --metric "f=end($(one 1 0)*$(one 2 1)*$(one 3 4.5)*$(one 4 9)*$(one 5 99)*$(one 6 99))" --metric 'c=end(0)' "$@"
}
check "the g-function" eval 'product --sobol 2048 -o "$work/g.csv" >"$work/g.txt"'
check "has the indices of its closed form" indices g "$work/g.csv" "$work/g.txt"

# constants that are no sums of powers of 2: rounding of their mean is no variance
sobol --sobol 16 --vary p1=0:1 --vary p2=0:1 --metric 'a=end(0.1)' --metric 'b=end(7.3)' --metric 'c=end(1e10)' --metric 'd=end(p1)' -o "$work/c.csv" >"$work/c.txt"
check "what does not vary has no indices" /usr/bin/python3 -c "
import csv
rows = list(csv.DictReader(open('$work/c.txt')))
assert len(rows) == 8 and all((r['first'] == 'nan') == (r['total.low'] == 'nan') == (r['metric'] != 'd') for r in rows), rows"
sobol --sobol 16 --seed 2 --vary p1=0:1 --metric 'a=end(p1)' -o "$work/no.csv"
check "no seed" [ $? -eq 2 ]
check "says why" grep -q 'seed goes with --latin' "$work/err"
: >"$work/old.csv.AbCdEf.tmp"; : >"$work/old.csv.AbCdEfg.tmp"
sobol --sobol 16 --vary p1=0:1 --metric 'a=end(p1)' -o "$work/old.csv" >"$work/said"
check "what a killed one has left is taken away" eval '[ -e "$work/old.csv" ] && [ ! -e "$work/old.csv.AbCdEf.tmp" ] && [ -e "$work/old.csv.AbCdEfg.tmp" ]'

# a point of which a run has no number is left out: sqrt(-1)
sobol --sobol 256 --vary p1=-0.2:1 --vary p2=0:1 --metric 'f=end(sqrt(p1) + p2)' --metric 'none=crossing(time + 1)' -o "$work/n.csv" >"$work/n.txt"
check "points that have no number are left out" /usr/bin/python3 -c "
import csv, numpy
rows = list(csv.DictReader(open('$work/n.txt')))
f = numpy.genfromtxt('$work/n.csv', delimiter=',', names=True)['f'].reshape(-1, 4)
good = int(numpy.isfinite(f).all(axis=1).sum())
assert 0 < good < 256, good
for r in rows:
    assert int(r['points']) == (good if r['metric'] == 'f' else 0), r
    assert (r['first'] == 'nan') == (r['metric'] == 'none') and (r['total.high'] == 'nan') == (r['metric'] == 'none')"

sobol --sobol 64 --vary p1=-0.2:1 --vary p2=0:1 --metric 'f=end(sqrt(p1) + p2)' --metric 'none/of=crossing(time + 1)' -o "$work/n.h5" >"$work/n.txt"
check "in HDF5, too" /usr/bin/python3 -c "
import csv, h5py, numpy
f = h5py.File('$work/n.h5')['sobol']
good = int(next(csv.DictReader(open('$work/n.txt')))['points'])
assert f.attrs['metrics'] == 'f\nnone/of' and list(f['points']) == [good, 0] and 16 < good < 64
assert numpy.isfinite(f['total.high'][0]).all() and numpy.isnan(f['total'][1]).all()"

# ---- mistakes

refuses() {
    text=$1
    status=$2
    shift 2
    "$gicsweep" -q "$work/m.veh" "$work/m.scene" -o "$work/e.csv" "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -q -- "$text" "$work/err" && [ ! -e "$work/e.csv" ] && [ ! -s "$work/out" ]
}
check "without a metric" refuses "--sobol needs metrics" 2 --sobol 64 --vary p1=0:1
check "with a count" refuses "with --sobol a range has no count of its own" 2 --sobol 64 --vary p1=0:1:3 --metric 'f=end(p1)'
check "with --latin" refuses "--latin or --sobol, not both" 2 --sobol 64 --latin 64 --vary p1=0:1 --metric 'f=end(p1)'
check "too few points" refuses "--sobol takes 16 to" 2 --sobol 4 --vary p1=0:1 --metric 'f=end(p1)'
check "too many runs" refuses "more than ten million runs" 2 --sobol 9000000 --vary p1=0:1 --metric 'f=end(p1)'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
