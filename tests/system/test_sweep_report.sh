#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep_report.sh GICSWEEP: the page of a sweep. Fronts against every pair of runs; surfaces against numpy's least squares,
# with one fit more for each run that is left out; quadratics; designs that determine no surface; runs that fail; mistakes.
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
  m: {mass: p0, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-5, 5]}
parameters:
  p0: {value: 1, tunable: true}
  p1: {value: 1, tunable: true}
  p2: {value: 1, tunable: true}
  p3: {value: 1, tunable: true}
forces:
  spring: {type: force, coordinate: x, value: "-x"}
outputs:
  x: {type: coordinate, coordinate: x}
YYY
echo '{gicscene: 1, duration: 0.02, step: 0.01, output_step: 0.01}' >"$work/m.scene"
sweep() { "$gicsweep" --engine tape "$work/m.veh" "$work/m.scene" -o "$work/r.csv" --report "$work/r.html" "$@" >"$work/out" 2>"$work/err"; }

cat >"$work/page.py" <<'YYY'
"""page.py TABLE PAGE KIND:NUMBERS...: what the page says against the rows of the table. KIND: fits or misses (surfaces of all
metrics, of R^2 of left-out runs above 0.9 or not), exact (a quadratic), none (no surface), front (one more, of these words)"""
import html
import itertools
import re
import sys
import numpy
read = numpy.genfromtxt(sys.argv[1], delimiter=",", names=True, deletechars="")
table = {name.split("_[")[0]: numpy.atleast_1d(read[name]) for name in read.dtype.names}
page = html.unescape(open(sys.argv[2]).read())
assert not re.search(r"https?:|src=|@import|url\(|<script", page), "something is loaded"
assert not any(re.search(r"[^a-z](nan|inf)[^a-z]", svg) for svg in re.findall("<svg.*?</svg>", page, re.DOTALL)), "no number in a picture"
names = list(table)
status = names.index("status")
number = names[1:status]
metric = [n for n in names[status + 2:] if n.rpartition(".")[2] not in ("end", "min", "max")]
bad = table["status"] != 0
assert f"{len(bad)} runs; {bad.sum()} failed" in page
x = numpy.stack([table[n] for n in number], axis=1)
value = {m: numpy.where(bad, numpy.nan, table[m]) for m in metric}

def data(part):
    return [float(v or "nan") for v, _ in re.findall(r'<td class="n">(?:<data value="([^"]*)">|(nan)<)', part)]

def design(x, middle, half):
    u = (x - middle) / half
    d = u.shape[1]
    return numpy.stack([numpy.ones(len(u))] + [u[:, i] for i in range(d)] + [u[:, i] * u[:, j] for i in range(d) for j in range(i, d)],
                       axis=1)

def near(a, b, size):
    assert abs(a - b) <= 1e-10 * size, (a, b, size)

def circles(svg, kind):
    return numpy.array([[float(v) for v in c] for c in re.findall(f'class="{kind}" cx="([^"]*)" cy="([^"]*)"', svg)])

def drawn(svg, p, middle, half, f):
    """runs are where they belong; each shade is that of the surface's value in its first cell"""
    left, across, top, up = 84, 284, 10, 264
    u = (p - middle) / half
    assert numpy.abs(circles(svg, "run") - numpy.stack([left + across * (u[:, 0] + 1) / 2, top + up * (1 - u[:, 1]) / 2], axis=1)).max() < 0.06
    scale = [float(v) for v in re.findall(r'<text x="396" y="[^"]*">([^<]*)<', svg)]
    count = len(scale) - 1
    step = (scale[-1] - scale[0]) / count
    assert 3 <= count <= 12 and numpy.abs(numpy.diff(scale) - step).max() < 1e-6 * step + 1e-9 * abs(scale[0]), scale
    rect = re.findall(r'class="shade" x="([^"]*)" y="([^"]*)" width="([^"]*)" height="([^"]*)" fill-opacity="([^"]*)"', svg)
    area = 0
    for r in rect[:-count]:
        x, y, w, h, opacity = map(float, r)
        area += w * h
        at = middle + half * numpy.array([2 * (x + across / 184 - left) / across - 1, 1 - 2 * (y + h / 2 - top) / up])
        band = (f(at) - scale[0]) / step
        k = numpy.floor(band)
        assert abs(opacity - (0.04 + 0.86 * k / (count - 1))) < 0.006 or abs(band - numpy.round(band)) < 0.1, (r, band)
    assert abs(area / (across * up) - 1) < 0.01, area

def surface(m, part, kind):
    pictures = part.count("<svg")
    if kind == "none":
        assert not pictures and f"no surface of {m}" in part, part
        return
    have = numpy.isfinite(value[m])
    p, y, run = x[have], value[m][have], numpy.flatnonzero(have)
    low, high = p.min(axis=0), p.max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2
    X = design(p, middle, half)
    size, n, mean = numpy.abs(y).max(), len(y), y.mean()
    y = y - mean
    c = numpy.linalg.lstsq(X, y, rcond=None)[0]
    errors = data(part.split('class="errors"')[1].split("</table>")[0])
    factors = data(part.split('class="factors"')[1].split("</table>")[0])
    assert len(factors) == X.shape[1] and f"{n} runs, {len(c)} factors" in part
    for k, (a, b) in enumerate(zip(factors, c)):
        near(a, b if k else b + mean, size)
    left = numpy.array([y[i] - X[i] @ numpy.linalg.lstsq(numpy.delete(X, i, 0), numpy.delete(y, i), rcond=None)[0] for i in range(n)])
    rest, all_of = y - X @ c, (y**2).sum()
    want = [1 - (rest**2).sum() / all_of, (rest**2).mean()**0.5, 1 - (left**2).sum() / all_of, (left**2).mean()**0.5]
    for a, b, s in zip(errors, want, (1, size, 1, size)):
        near(a, b, s)
    near(abs(errors[4]), numpy.abs(left).max(), size)
    worst = int(re.search(r"the largest of these, run (\d+)", part)[1])
    near(errors[4], left[list(run).index(worst)], size)
    d = len(number)
    assert pictures == (1 if d == 1 else sum(1 for _ in itertools.combinations(range(min(d, 4)), 2))), pictures
    if d == 2:
        drawn(part.split("<svg")[1].split("</svg>")[0], p, middle, half, lambda at: design(numpy.array([at]), middle, half)[0] @ factors)
    assert ("does not fit" in part) == (want[2] < 0.9) == (kind == "misses"), (m, want)
    if kind == "exact":
        assert abs(errors[0] - 1) < 1e-14 and errors[1] < 1e-13 * size and errors[3] < 1e-12 * size, errors

def front(words, part):
    columns, sign = zip(*[(value[w[4:]], -1 if w.startswith("max:") else 1) for w in words.split(",")])
    f = numpy.stack(columns, axis=1) * numpy.array(sign)
    runs = [r for r in range(len(f)) if numpy.isfinite(f[r]).all()]
    want = {r for r in runs if not any((f[q] <= f[r]).all() and (f[q] < f[r]).any() for q in runs)}
    rows = re.findall(r'<tr><td class="n">(\d+)</td>(.*?)</tr>', part)
    assert [int(r) for r, _ in rows] == sorted(want, key=lambda r: (*f[r], r)), (want, rows)
    assert not runs or f"{len(want)} of {len(runs)} runs" in part
    for r, row in rows:
        assert numpy.array_equal(data(row), [*x[int(r)], *[value[m][int(r)] for m in metric]], equal_nan=True), row
    assert part.count("<svg") == (len(f[0]) - 1 if runs else 0)
    for k, svg in enumerate(part.split("<svg")[1:], 1):  # pictures are linear in the numbers, whose runs are in order
        for kind, of in (("run", runs), ("on", [int(r) for r, _ in rows])):
            seen = circles(svg, kind)
            for axis, column in ((0, columns[0]), (1, columns[k])):
                y, low, high = column[of], column[runs].min(), column[runs].max()
                room = [84, 284] if axis == 0 else [274, -264]
                share = (y - low) / (high - low) if high > low else 0.5 + 0 * y
                share = (share + 0.04) / 1.08 if high > low else share
                if numpy.isfinite(columns[0]).sum() == len(runs) == numpy.isfinite(columns[k]).sum():
                    assert numpy.abs(seen[:, axis] - room[0] - room[1] * share).max() < 0.06, (kind, axis)
    assert bool(runs) != ("no front of" in part)

surfaces = page.split("<section>")
fronts = surfaces[0].split("<h2>Pareto front")[1:]
assert len(surfaces) == len(metric) + 1
words = [w.split(":", 1)[1] for w in sys.argv[3:] if w.startswith("front:")]
kinds = [w for w in sys.argv[3:] if not w.startswith("front:")]
assert len(fronts) == len(words) and len(kinds) in (0, len(metric)), (fronts, kinds)
for w, part in zip(words, fronts):
    front(w, part)
for m, part, kind in zip(metric, surfaces[1:], kinds):
    surface(m, part, kind)
YYY
page() { /usr/bin/python3 "$work/page.py" "$work/r.csv" "$work/r.html" "$@" >"$work/said" 2>&1; }

# ---- surfaces

quadratic='1 + 2*p1 - 3*p2 + p1^2 - 4*p1*p2 + 0.5*p2^2'
check "a quadratic, points at random" sweep --latin 40 --vary p1=-1:3 --vary p2=10:12 --metric "f=end($quadratic)" --metric 'g=end(p1^2)' --metric 'h=end(1000 + p2)'
check "has no error" page exact exact exact
check "a quadratic on a grid" sweep --vary p1=0:2:3 --vary p2=-1:1:3 --metric "f=end($quadratic)" --metric 'g=end(p1)'
check "has none, either" page exact exact
check "and nothing is noted" [ "$(grep -c note "$work/err")" -eq 0 ]
check "other functions of two" sweep --latin 60 --vary p1=-1:1 --vary p2=2:5 --metric 'f [m]=end(sin(p1)*p2 + exp(0.3*p2))' \
    --metric 'g=end(sin(20*p1))' --metric 'h=end(sqrt(p1 + 0.5) + p2)' --metric 'k=end(1e6 + 0.001*cos(p1 + p2))'
check "are fitted, or said not to be" page fits misses fits fits
check "to who called, too" grep -q 'the surface of g does not fit: R^2 of runs that are left out is' "$work/err"
check "on a grid" sweep --vary p1=-1:1:5 --vary p2=0:1:4 --metric 'f=end(exp(p1 - p2))' --metric 'g=end(abs(p1))' --metric 'h=end(p1^3)'
check "as numpy says" page fits misses misses
check "of one" sweep --vary p1=0:1:9 --metric 'f=end(exp(p1))' --metric 'g=end(p1^2 - p1)'
check "as numpy" page fits exact
check "of three" sweep --latin 50 --vary p1=0:1 --vary p2=0:1 --vary p3=-1:0 --metric 'f=end(exp(p1*p2 + p3))' --metric "g=end($quadratic - p1*p3)"
check "as numpy" page fits exact
check "of four" sweep --vary p1=0:1:3 --vary p2=0:1:3 --vary p3=-1:0:3 --vary p0=1:2:3 --metric 'f=end(exp(p1*p2 + p3)/p0)'
check "as numpy" page fits
check "one run more than factors" sweep --latin 7 --vary p1=0:1 --vary p2=0:1 --metric "f=end($quadratic)"
check "will do" page exact

# ---- designs that determine none

# none TEXT OPTION...: no surface, for this reason
none() {
    text=$1
    shift
    sweep "$@" && page none && grep -q -- "no surface of f: .*$text" "$work/r.html" && grep -q -- "^no surface of f: .*$text" "$work/err"
}
check "as many runs as factors" none "6 runs have this number; 6 factors and their error need at least 7" --latin 6 --vary p1=0:1 --vary p2=0:1 --metric 'f=end(p1)'
check "one run" none "1 runs have this number" --vary p1=0:0:1 --metric 'f=end(p1)'
check "two values" none "p2 has 2 values in the runs" --vary p1=0:1:7 --vary p2=0:1:2 --metric 'f=end(p1)'
check "one value" none "p1 has 1 value in the runs" --vary p1=3:3:9 --metric 'f=end(p2)'
check "nothing varies" none "it does not vary" --vary p1=0:1:7 --metric 'f=end(p2)'
check "but for rounding" none "it does not vary" --vary p1=0:1:7 --metric 'f=end(1e9 + 1e-5*p1)'
check "on a line" none "cannot be told apart" --vary p1=0:1:9 --vary p2=0:8:9 --metric 'f=end(p1 + sqrt(-abs(8*p1 - p2)))'
check "on a circle" none "cannot be told apart" --vary p1=-5:5:11 --vary p2=-5:5:11 --metric 'f=end(p1 + sqrt(-abs(p1^2 + p2^2 - 25)))'
check "one run alone tells a factor" none "without run 12 the others do not determine it" --vary p1=-1:1:3 --vary p2=-2:2:5 --metric 'f=end(p1 + p2 + sqrt(-max(p1, 0)*abs(p2)))'
check "no run has it" none "0 runs have this number" --vary p1=0:1:7 --metric 'f=crossing(time + 1)'

# ---- fronts

check "fronts of random runs" sweep --latin 200 --vary p1=0:1 --vary p2=0:1 --metric 'a=end(p1)' --metric 'b=end(p2 + 0.1*sin(9*p1))' --metric 'c=end((p1 - 0.5)*(p2 - 0.3))' \
    --front min:a,min:b --front max:a,min:b --front min:a,max:b --front max:a,max:b --front min:a,min:b,min:c --front max:c,min:b,max:a --front min:c,max:c2 --metric 'c2=end((p1 - 0.5)*(p2 - 0.3))'
check "against all pairs" page front:min:a,min:b front:max:a,min:b front:min:a,max:b front:max:a,max:b front:min:a,min:b,min:c front:max:c,min:b,max:a front:min:c,max:c2
check "ties and runs that are equal" sweep --vary p1=-2:2:5 --vary p2=-2:2:5 --metric 'a=end(abs(p1))' --metric 'b=end(max(p2, 0) - abs(p1))' --metric 'c=end(3)' --metric 'd=end(p1*p2)' --metric 'e=end(0*p1)' \
    --front min:a,min:b --front max:a,min:b --front min:c,max:b --front min:c,min:e --front min:a,max:d,min:b --front max:d,max:e
check "against all pairs" page front:min:a,min:b front:max:a,min:b front:min:c,max:b front:min:c,min:e front:min:a,max:d,min:b front:max:d,max:e
check "runs without a number" sweep --vary p1=-2:2:5 --vary p2=0:1:4 --metric 'a=end(sqrt(p1))' --metric 'b=end(1/(p2 + 1) - p1)' --metric 'c=crossing(time + 1)' \
    --front min:a,min:b --front max:b,max:a --front min:b,min:c
check "are on none" page front:min:a,min:b front:max:b,max:a front:min:b,min:c
check "and that is told" grep -q 'no front of least b, least c: no run has all of these numbers' "$work/err"
check "runs that fail" sweep --vary p0=-2:3:6 --vary x.rate=0:6:7 --metric 'a=end(x)' --metric 'b=end(p0 + x^2)' --front min:a,min:b --front max:a,max:b
check "are on none and in no surface" page fits fits front:min:a,min:b front:max:a,max:b
check "some fail, some do not" grep -qE '42 runs; (21|[1-9][0-9]?) failed' "$work/r.html"

# ---- the same page, and the same table

one="--latin 30 --vary p1=0:1 --vary p2=0:1 --metric a=end(p1) --metric b=end(p2-p1^2)"
# shellcheck disable=SC2086  # words
sweep $one --front min:a,min:b
cp "$work/r.html" "$work/first.html"
cp "$work/r.csv" "$work/first.csv"
check "again, in one process" eval 'OMP_NUM_THREADS=1 sweep $one --front min:a,min:b && cmp "$work/r.html" "$work/first.html" && cmp "$work/r.csv" "$work/first.csv"'
check "the table without a page" eval '"$gicsweep" -q --engine tape "$work/m.veh" "$work/m.scene" $one -o "$work/plain.csv" && cmp "$work/plain.csv" "$work/first.csv"'
# of a sweep in parts the same page, of the same bytes
sed -i 's/^model: mass/&\ndescription: A mass,\n  on \& a <spring>/' "$work/m.veh"
many="--latin 60 --vary p1=-1:1 --vary p0=-2:5"
metrics() { "$@" --metric 'f [m]=end(sin(p1)*p0)' --metric 'g=end(exp(p1))'; }
# shellcheck disable=SC2086  # words
check "with a description" metrics sweep $many --front max:f,min:g
check "which stands on it" grep -q 'A mass, on &amp; a &lt;spring&gt;' "$work/r.html"
for i in 3 1 2; do
    # shellcheck disable=SC2086  # words
    metrics "$gicsweep" -q --engine tape "$work/m.veh" "$work/m.scene" $many --shard $i/3 -o "$work/parts"
done
check "in parts" "$gicsweep" -q --merge "$work/parts" -o "$work/merged.csv" --report "$work/merged.html" --front max:f,min:g
check "the same page and table" eval 'cmp "$work/r.html" "$work/merged.html" && cmp "$work/r.csv" "$work/merged.csv"'
# merge TEXT STATUS OPTION...: ends with the status and this message, and leaves no file
merge() {
    text=$1
    status=$2
    shift 2
    rm -f "$work/merged.csv" "$work/merged.html"
    "$gicsweep" -q --merge "$work/parts" -o "$work/merged.csv" "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -q -- "$text" "$work/err" && [ ! -e "$work/merged.csv" ] && [ ! -e "$work/merged.html" ]
}
check "merged: a front without a page" merge "--front goes onto a page" 2 --front max:f,min:g
check "merged: no such metric" merge "there is no --metric 'h'" 2 --report "$work/merged.html" --front max:f,min:h
check "merged: the table's file" merge "--report is not to write over" 2 --report "$work/merged.csv"
check "merged: a folder that is not there" merge "can't" 1 --report "$work/nowhere/merged.html"
cp "$work/parts/plan" "$work/kept.plan"
check "merged: the plan" eval 'merge "--report is not to write over" 2 --report "$work/parts/plan" && cmp "$work/kept.plan" "$work/parts/plan"'
mv "$work/parts/part_2.journal" "$work/away.journal"
check "merged: runs are missing" merge "20 of 60 runs in .* are missing" 1 --report "$work/merged.html"
for i in 1 2; do "$gicsweep" -q --engine tape "$work/m.veh" "$work/m.scene" --vary p1=0:1:4 --shard $i/2 -o "$work/plain"; done
check "merged: no metrics" eval '"$gicsweep" -q --merge "$work/plain" -o "$work/merged.csv" --report "$work/merged.html" 2>"$work/err"; [ $? -eq 2 ] && grep -q "the sweep has none" "$work/err" && [ ! -e "$work/merged.csv" ]'

check "names are texts" sweep --latin 30 --vary p1=0:1 --metric 'a<b&c [<i>]=end(p1)' --metric 'b=end(p1^2)' --front 'min:a<b&c,min:b'
check "and no marks" eval '! grep -q "a<b\|<i>" "$work/r.html"'

# ---- mistakes

refuses() {
    text=$1
    status=$2
    shift 2
    rm -f "$work/e.csv" "$work/e.html"
    "$gicsweep" -q --engine tape "$work/m.veh" "$work/m.scene" --vary p1=0:1:9 -o "$work/e.csv" "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -qF -- "$text" "$work/err" && [ ! -e "$work/e.csv" ] && [ ! -e "$work/e.html" ]
}
check "without a metric" refuses "--report needs metrics" 2 --report "$work/e.html"
check "a front without a page" refuses "--front goes onto a page" 2 --metric 'f=end(p1)' --front min:f,max:f
set -- --report "$work/e.html" --metric 'f=end(p1)' --metric 'g=end(p1^2)'
check "of one metric" refuses "a front is of two metrics or more" 2 "$@" --front min:f
check "twice the same" refuses "--front has twice the metric 'f'" 2 "$@" --front min:f,max:f
check "no such metric" refuses "there is no --metric 'h'" 2 "$@" --front min:f,max:h
check "no direction" refuses "--front takes min:NAME,max:NAME,... of metrics, not 'f,g'" 2 "$@" --front f,g
check "an end too early" refuses "--front takes min:NAME,max:NAME,... of metrics, not 'min:f,'" 2 "$@" --front min:f,
check "parts" refuses "--report is of all parts: give it to --merge" 2 "$@" --shard 1/2
check "standard output" refuses "a report goes into a file" 2 --metric 'f=end(p1)' --report -
check "over the table" refuses "--report is not to write over" 2 --metric 'f=end(p1)' --report "$work/e.csv"
check "over the model" refuses "m.veh" 1 --metric 'f=end(p1)' --report "$work/m.veh"
check "no such folder" refuses "none/e.html" 1 --metric 'f=end(p1)' --report "$work/none/e.html"
check "too many runs" refuses "a report has 100000 runs and 8 numbers at most, not 180000 and 2" 2 "$@" --vary p2=0:1:20000

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
