#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sweep_rest.sh GICSWEEP GICRUN: runs that begin in static equilibrium begin in that of their own mass, stiffness, force
# and speed: against the closed form of a mass on a spring, and to the bit against gicrun of scenes with these numbers; a run
# that has none fails alone; by one process, two, in lanes and in parts the same bytes.
gicsweep=$1
gicrun=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
GICGEN_CACHE=$work/kept
OMP_NUM_THREADS=2
export GICGEN_CACHE OMP_NUM_THREADS

cat >"$work/m.veh" <<'YYY'
gicgen: 1
model: mass
base: ground
gravity: [0, 0, -10]
bodies:
  m: {mass: p, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, m], axis: [0, 0, 1]}
coordinates:
  z: {type: translation, bodies: [ground, m], axis: [0, 0, 1], range: [-5, 5]}
parameters:
  p: {value: 1, tunable: true}
  k: {value: 100, tunable: true}
inputs:
  push: {unit: N}
forces:
  spring: {type: force, coordinate: z, value: "-k * z - 3 * rate(z) + push"}
outputs:
  z: {type: coordinate, coordinate: z}
YYY
echo '{gicscene: 1, duration: 0.5, step: 0.01, output_step: 0.1, initial: {equilibrium: true}}' >"$work/m.scene"
sweep() { "$gicsweep" -q "$work/m.veh" "$work/m.scene" "$@" >"$work/out" 2>"$work/err"; }

# the spring carries what weighs and pushes, z = (push - 10 p)/k, all along the run; rounding of the equilibrium's equations,
# which it solves to 1e-9 m/s^2: 1e-9 p/k. k = 0 carries nothing: no equilibrium, status -2
cat >"$work/rest.py" <<'YYY'
import csv
import sys
rows = list(csv.DictReader(open(sys.argv[1])))
assert len(rows) == int(sys.argv[2])
seen, none = set(), 0
for row in rows:
    r = {name.split(" ")[0]: float(x) for name, x in row.items()}
    p, k, push = r.get("p", 1), r.get("k", 100), r.get("push", 0)
    if k == 0:
        assert r["status"] == -2 and r["time"] == 0 and r["z.value.end"] != r["z.value.end"], r
        none += 1
        continue
    assert r["status"] == 0 and r["time"] == 0.5, r
    z = (push - 10 * p) / k
    for at in "end", "min", "max":
        assert abs(r["z.value." + at] - z) < 1e-9 * p / k + 1e-15, (r, z)
    seen.add(round(z, 12))
assert len(seen) >= int(sys.argv[3]) and none == int(sys.argv[4]), (seen, none)
YYY
rest() { /usr/bin/python3 "$work/rest.py" "$@" >"$work/said" 2>&1; }
check "masses and forces" sweep --engine tape --vary p=1:4:4 --vary push=-10:10:3 -o "$work/r.csv"
check "stand where their springs carry them" rest "$work/r.csv" 12 6 0
check "springs, one of which carries nothing" sweep --engine tape --vary k=0:100:3 --vary p=1:2:2 -o "$work/k.csv"
check "fail alone" rest "$work/k.csv" 6 3 2
"$gicsweep" --engine tape "$work/m.veh" "$work/m.scene" --vary k=0:100:3 -o "$work/n.csv" >"$work/out" 2>"$work/err"
check "and it is said why" grep -q "1 failed, the first is run 0: .*equilibrium" "$work/err"
check "from one process the same bytes" eval 'OMP_NUM_THREADS=1 sweep --engine tape --vary p=1:4:4 --vary push=-10:10:3 -o "$work/s.csv" && cmp "$work/r.csv" "$work/s.csv"'
for i in 2 1; do sweep --engine tape --vary p=1:4:4 --vary push=-10:10:3 --shard $i/2 -o "$work/parts"; done
check "of parts, too" eval '"$gicsweep" -q --merge "$work/parts" -o "$work/s.csv" && cmp "$work/r.csv" "$work/s.csv"'
check "in lanes" sweep --vary p=1:4:4 --vary k=0:100:3 -o "$work/l.csv"
check "where they stand, too" rest "$work/l.csv" 12 6 4

# gicrun of a scene that has these numbers
sed 's/initial/parameters: {p: 3}, inputs: {push: -10}, &/' "$work/m.scene" >"$work/one.scene"
"$gicrun" -q --engine tape "$work/m.veh" "$work/one.scene" -o "$work/one.csv" 2>"$work/err"
check "to the bit those of gicrun" /usr/bin/python3 -c "
import csv
one = [float(r['z.value [m]']) for r in csv.DictReader(open('$work/one.csv'))]
row = [r for r in csv.DictReader(open('$work/r.csv')) if float(r['p [1]']) == 3 and float(r['push [N]']) == -10]
assert len(row) == 1 and len(one) == 6
assert (float(row[0]['z.value.end [m]']), float(row[0]['z.value.min [m]']), float(row[0]['z.value.max [m]'])) == (one[-1], min(one), max(one))"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
