#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep_hdf5.sh GICSWEEP GICRUN: what h5py reads is the table of CSV to the last bit, and series are the tables of
# gicrun; units, descriptions, provenance; the same bytes by one process, in parts, after kills, with damaged series; runs that
# fail; no half a file; no plug-in; full disks; mistakes.
gicsweep=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
GICGEN_CACHE=$work/kept
OMP_NUM_THREADS=2
export GICGEN_CACHE OMP_NUM_THREADS
mounted=
trap '[ -z "$mounted" ] || umount "$mounted"; rm -rf "$work"' EXIT

# says TEXT STATUS COMMAND...: it ends with the status and the text in its message
says() {
    text=$1
    status=$2
    shift 2
    "$@" >"$work/out" 2>"$work/err"
    [ $? -eq "$status" ] && grep -q -- "$text" "$work/err"
}

# a mass on a spring; some runs leave the range of x and fail
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
  k: {value: 1, unit: N/m, tunable: true}
  c: {value: 0, unit: N s/m, tunable: true}
forces:
  spring: {type: force, coordinate: x, value: "-k * x - c * rate(x)"}
outputs:
  x: {type: coordinate, coordinate: x}
YYY
scene() { echo "{gicscene: 1, duration: 2, step: 0.01, output_step: 0.05, initial: {coordinates: {x: 1}}$1}" >"$work/$2.scene"; }
scene '' m
sweep() {
    "$gicsweep" "$work/m.veh" "$work/${scene:-m}.scene" --vary k=1:5:5 --vary state/x=0:4:4 --metric 'way [m]=max(x)' \
        --metric 'a/b=mean(k*x)' "$@" 2>"$work/err"
}

cat >"$work/compare.py" <<'YYY'
import sys
import h5py
import numpy
csv, path = sys.argv[1:3]
lines = open(csv).read().split("\n")
names, units = [], []
for cell in lines[0].split(","):
    name, _, unit = cell.partition(" [")
    names.append(name)
    units.append(unit.rstrip("]"))
want = numpy.array([[float(x) for x in line.split(",")] for line in lines[1:] if line])
f = h5py.File(path, "r")
seen = {}
for group in ("runs", "parameters", "outputs") + (("metrics",) if "metrics" in f else ()):
    for key, data in f[group].items():
        assert "/" not in key and data.attrs["description"] and data.compression == "gzip" and data.chunks
        assert key == data.attrs["name"].replace("/", ".")
        seen[data.attrs["name"]] = data
assert sorted(seen) == sorted(names), (seen, names)
for i, name in enumerate(names):
    assert numpy.array_equal(seen[name][:].astype(float).view(numpy.int64), want[:, i].view(numpy.int64)) or \
        numpy.array_equal(seen[name][:], want[:, i], equal_nan=True), name
    assert seen[name].attrs.get("unit", "") == units[i], name
assert seen["run"].dtype == numpy.int64 and seen["status"].dtype == numpy.int32
assert "0: ok" in seen["status"].attrs["description"]
assert list(f["parameters"]) == ["k", "state.x"] or len(sys.argv) > 3
for fact in ("format", "gicgen", "program_hash", "model", "model_hash", "scene_hash", "engine", "options", "compiler"):
    assert f.attrs[fact], fact
print(len(names), want.shape)
YYY
compare() { /usr/bin/python3 "$work/compare.py" "$@" >"$work/out" 2>&1 || { cat "$work/out" >&2; return 1; }; }

check "CSV" sweep -q -o "$work/a.csv"
check "HDF5" sweep -q -o "$work/a.h5"
check "h5py reads the numbers of the CSV" compare "$work/a.csv" "$work/a.h5"
check "no journal is left" [ ! -e "$work/a.h5.journal" -a ! -e "$work/a.h5.series" ]
check "what it says of itself" /usr/bin/python3 -c "
import h5py
f = h5py.File('$work/a.h5', 'r')
assert f.attrs['model'] == 'mass' and f.attrs['lanes'] in ('yes', 'no')
assert f.attrs['gicgen'] in open('generator/base/version.h').read()
assert f.attrs['options'] == \"--vary k=1:5:5 --vary state/x=0:4:4 --metric 'way [m]=max(x)' --metric 'a/b=mean(k*x)'\"
assert f['metrics/way'].attrs['description'] == 'max(x)' and f['metrics/way'].attrs['unit'] == 'm'
assert f['metrics/a.b'].attrs['name'] == 'a/b' and 'unit' not in f['metrics/a.b'].attrs
assert f['parameters/k'].attrs['unit'] == 'N/m' and f['parameters/k'].attrs['description'] == 'from 1 to 5'
assert 'series' not in f"

# ---- series

check "with series" sweep -q --series -o "$work/s.h5"
check "the table is the same" compare "$work/a.csv" "$work/s.h5"
sleep 1.1 # of what has the time in it
check "again" sweep -q --series -o "$work/again.h5"
check "the same bytes, at another time and place" cmp "$work/s.h5" "$work/again.h5"
check "in one process" eval 'OMP_NUM_THREADS=1 sweep -q --series -o "$work/again.h5" && cmp "$work/s.h5" "$work/again.h5"'
cat >"$work/series.py" <<'YYY'
import sys
import h5py
import numpy
f = h5py.File(sys.argv[1], "r")
run = numpy.genfromtxt(sys.argv[2], delimiter=",", skip_header=1)
row = int(sys.argv[3])
n = int(f["runs/status"][row] == 0) + 0
time = f["series/time"][:]
assert f["series/time"].attrs["unit"] == "s" and f["series/x.value"].attrs["unit"] == "m"
assert f["series/x.value"].shape == (len(f["runs/run"]), len(time)) and f["series/x.value"].compression == "gzip"
x, rate = f["series/x.value"][row], f["series/x.rate"][row]
good = numpy.isfinite(x)
assert numpy.all(good[:good.sum()])
rows = run[:good.sum()]
assert numpy.allclose(time[good], rows[:, 0], rtol=1e-13, atol=1e-13)
assert numpy.array_equal(x[good], rows[:, 1]) and numpy.array_equal(rate[good], rows[:, 2])
if f["runs/status"][row] == 0:
    assert good.all() and len(run) == len(time)
else:
    assert not good.all() and len(run) - good.sum() in (0, 1), (len(run), good.sum())
    assert f["outputs/x.value.end"][row] == run[-1, 1] and f["runs/time"][row] == run[-1, 0]
YYY
series() { /usr/bin/python3 "$work/series.py" "$@" >"$work/out" 2>&1 || { cat "$work/out" >&2; return 1; }; }
# run 4 i + j: k = 1 + i, x = 4/3 j
scene ', parameters: {k: 3}' r
sed -i 's/{x: 1}/{x: 4}/' "$work/r.scene"
"$gicrun" -q "$work/m.veh" "$work/r.scene" -o "$work/run.csv" 2>"$work/err"
check "series of a run are gicrun's table" series "$work/s.h5" "$work/run.csv" 11
check "by the engine gic" eval 'sweep -q --series --engine gic -o "$work/g.h5" && "$gicrun" -q --engine gic "$work/m.veh" "$work/r.scene" -o "$work/run.csv" &&
    series "$work/g.h5" "$work/run.csv" 11'

# runs that fail: the mass leaves its range; series have their output times, the table the last good state
fast() { sed 's/^{/{integrator: rk4, /; s/duration: 2/duration: 20/; s/output_step: 0.05/output_step: 2/; s/step: 0.01/step: 0.1/; s/x: 1}/x: 1}, rates: {x: 300}/; s/}$/, parameters: {c: -1}}/' "$work/m.scene"; }
fast >"$work/f.scene"
check "runs that fail" eval 'scene=f sweep -q --series -o "$work/f.h5" && scene=f sweep -q -o "$work/f.csv" && compare "$work/f.csv" "$work/f.h5"'
ended=$(/usr/bin/python3 -c "import h5py; print((h5py.File('$work/f.h5')['runs/status'][:] != 0).sum())")
check "some do" [ "$ended" -gt 0 ]
fast | sed 's/{c: -1}/{c: -1, k: 2}/; s/{x: 1}/{x: 4}/' >"$work/r.scene"
"$gicrun" -q "$work/m.veh" "$work/r.scene" -o "$work/run.csv" 2>"$work/err"
check "what they have up to there" series "$work/f.h5" "$work/run.csv" 7

# ---- parts, kills, damage

for i in 3 1 2; do sweep -q --series --shard $i/3 -o "$work/parts"; done
check "parts" "$gicsweep" -q --merge "$work/parts" -o "$work/merged.h5"
check "have the bytes of one process" cmp "$work/s.h5" "$work/merged.h5"
check "as CSV, too" eval '"$gicsweep" -q --merge "$work/parts" -o "$work/merged.csv" && cmp "$work/a.csv" "$work/merged.csv"'
printf x | dd of="$work/parts/part_2.series" bs=1 seek=100 conv=notrunc 2>/dev/null
check "damaged series are a run that is missing" says "1 of 20 runs in .* are missing, in part 2 of 3" 1 "$gicsweep" --merge "$work/parts" -o "$work/merged2.h5"
check "and no file" [ ! -e "$work/merged2.h5" ]
check "which is made again" eval 'sweep -q --series --shard 2/3 -o "$work/parts" && "$gicsweep" -q --merge "$work/parts" -o "$work/merged2.h5" &&
    cmp "$work/s.h5" "$work/merged2.h5"'
rm "$work/parts/part_1.series"
check "series that are gone" says "6 of 20 runs in .* are missing, in part 1 of 3" 1 "$gicsweep" --merge "$work/parts" -o "$work/merged3.h5"
check "are made again" eval 'sweep -q --series --shard 1/3 -o "$work/parts" && "$gicsweep" -q --merge "$work/parts" -o "$work/merged3.h5" &&
    cmp "$work/s.h5" "$work/merged3.h5"'
check "a plan with series is another one than without" says "is of another sweep" 1 "$gicsweep" "$work/m.veh" "$work/m.scene" --vary k=1:5:5 \
    --vary state/x=0:4:4 --metric 'way [m]=max(x)' --metric 'a/b=mean(k*x)' --shard 1/3 -o "$work/parts"
check "by a script of jobs" eval 'sweep -q --series --slurm "$work/jobs" --parts 2 && for i in 1 2; do SLURM_ARRAY_TASK_ID=$i sh "$work/jobs/job.sh" || break; done >"$work/out" 2>&1 &&
    "$gicsweep" -q --merge "$work/jobs" -o "$work/merged4.h5" && cmp "$work/s.h5" "$work/merged4.h5"'

# killed on its way at random, three times, then to its end
long() {
    exec "$gicsweep" "$work/m.veh" "$work/l.scene" --latin 3000 --vary k=1:5 --vary state/x=0:4 --engine tape --series "$@"
}
sed 's/duration: 2/duration: 20/' "$work/m.scene" >"$work/l.scene"
(long -q -o "$work/whole.h5") 2>"$work/err"
check "a longer one" [ $? -eq 0 ]
for some in 100 700 1500; do
    (long -q -o "$work/killed.h5") 2>"$work/err" &
    child=$!
    while kill -0 $child 2>/dev/null && [ "$(cat "$work/killed.h5.journal" 2>/dev/null | wc -l)" -lt $some ]; do sleep 0.01; done
    kill -KILL $child 2>/dev/null
    wait $child 2>/dev/null
    check "no file while it is not whole" [ ! -e "$work/killed.h5" ]
done
check "no run is made twice" [ -z "$(sed 1d "$work/killed.h5.journal" | cut -d' ' -f2 | sort | uniq -d)" ]
(long -o "$work/killed.h5") 2>"$work/err"
check "goes on" grep -q "3000 runs in .*killed.h5, [1-9][0-9]* of them from an earlier start" "$work/err"
check "and has the same bytes" cmp "$work/whole.h5" "$work/killed.h5"
# more runs than a block has
many() { "$gicsweep" -q "$work/m.veh" "$work/m.scene" --latin 9001 --vary k=1:5 --engine tape "$@" 2>"$work/err"; }
check "several blocks" eval 'many -o "$work/many.h5" && many -o "$work/many.csv" && compare "$work/many.csv" "$work/many.h5" other'

# ---- what goes wrong

if mkdir "$work/small" && mount -t tmpfs -o size=512k tmpfs "$work/small" 2>/dev/null; then
    mounted=$work/small
    check "a full disk, series" says "can't write .*No space left on device" 1 eval '(long -q -o "$work/small/l.h5")'
    rm -f "$work/small/"*
    (long -q --shard 1/1 -o "$work/one") 2>"$work/err"
    check "a full disk, the file" says "can't write .*No space left on device" 1 "$gicsweep" -q --merge "$work/one" -o "$work/small/l.h5"
    check "nothing is left" [ -z "$(ls "$work/small")" ]
fi
refused() { says "$@" && [ ! -e "$work/e.h5" ] && [ ! -e "$work/e.csv" ]; }
one() { "$gicsweep" -q "$work/m.veh" "$work/m.scene" --vary k=1:2:2 "$@"; }
check "series need HDF5" refused "--series needs HDF5: -o FILE.h5, not '.*e.csv'" 2 one --series -o "$work/e.csv"
check "two metrics of one name in HDF5" refused "'a/b' and 'a.b' have one name" 2 one --metric 'a/b=end(x)' --metric 'a.b=end(x)' -o "$work/e.h5"
check "in CSV they have two" eval "one --metric 'a/b=end(x)' --metric 'a.b=end(x)' -o '$work/two.csv' 2>'$work/err'"
check "a name that is none there" refused "nothing can be called '.' in HDF5" 2 one --metric '.=end(x)' -o "$work/e.h5"
check "a folder that is not there" says "can't .* No such file" 1 one -o "$work/no/e.h5"
mkfifo "$work/pipe.h5"
check "a pipe" says "results go into a file" 2 one -o "$work/pipe.h5"
check "a pipe for --merge" says "HDF5 can't go to .*pipe.h5" 1 "$gicsweep" -q --merge "$work/parts" -o "$work/pipe.h5"
mkdir "$work/bin"
cp "$gicsweep" "$work/bin/gicsweep"
alone() { "$work/bin/gicsweep" -q "$work/m.veh" "$work/m.scene" --vary k=1:2:2 "$@"; }
check "without its plug-in" eval 'refused "results in HDF5 need its library: it was not there" 1 alone -o "$work/e.h5" && grep -q "remedy: .*libhdf5-dev" "$work/err"'
check "before a run is made" [ ! -e "$work/e.h5.journal" ]
check "CSV needs none" alone -o "$work/alone.csv"
check "the program links none" sh -c "! ldd '$gicsweep' | grep -i hdf5"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
