# SPDX-License-Identifier: MIT
"""least_time.py GICRUN MODELS WORK IPOPT: profiles of rack and pedals with which models/optimize/least_time.scene takes the least time,
by runtime/examples/ipopt.c. What it says is that of a run; it is the end of models/optimize/least_time_found.scene; and it is the best to
first order: with differences of runs, no small change of the numbers within their bounds that keeps the distance takes less time, by a
linear program of scipy."""
import csv
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import linprog

from counted import check, finish, near, runner

gicrun, models, work, ipopt = sys.argv[1:5]
gic = runner(gicrun)
LIMIT = 0.3
model, path = f"{models}/optimize/least_time.veh", f"{models}/optimize/least_time.scene"
TEXT = Path(path).read_text()
words = [*(f"input/{pedal}[{k}]={reach}" for k in range(4) for pedal, reach in (("accelerator", "0:1"), ("brake", "0:0.2"))),
         *(f"input/rack[{k}]=-0.06:0.06" for k in range(1, 10))]
said = subprocess.run([ipopt, model, path, "time", f"peak(aside)=0:{LIMIT}", *words], capture_output=True, text=True)
assert said.returncode == 0, said.stderr
*rows, kept = csv.DictReader(said.stdout.splitlines())  # the last is the formula within bounds
first, least = float(rows[0]["start"]), float(rows[0]["value"])
names = [r["variable"] for r in rows[1:]]
best, low, high = (np.array([float(r[key]) for r in rows[1:]]) for key in ("value", "low", "high"))
check(f"the distance is told: {kept}", kept["variable"] == "peak(aside)" and float(kept["value"]) <= 1.001 * LIMIT)
check("all numbers are told", names == [w.split("=")[0] for w in words])
check("within bounds", bool(np.all((best >= low) & (best <= high))))


def run(x):
    """Time at the end and peak of the distance, by a run with steps as output times."""
    text = TEXT.replace("output_step: 0.06", "output_step: 0.006")
    value = dict(zip(names, x))
    for name in ("accelerator", "brake"):
        text = re.sub(rf"({name}: .*values: )\[.*\]", lambda m: m[1] + str([float(value[f"input/{name}[{k}]"]) for k in range(4)]), text)
    text = re.sub(r"(\n +values: )\[.*\]", lambda m: m[1] + str([0] + [float(value[f"input/rack[{k}]"]) for k in range(1, 10)]), text)
    Path(f"{work}/least.scene").write_text(text)
    table = list(csv.reader(gic("-q", model, f"{work}/least.scene", "-o", "-").splitlines()))
    title = [word.split(" [")[0] for word in table[0]]
    t, aside = (np.array([float(row[title.index(name)]) for row in table[1:]]) for name in ("time", "aside"))
    return t[-1], (np.trapezoid if hasattr(np, "trapezoid") else np.trapz)(aside**16, t) ** (1 / 16) / t[-1] ** (1 / 16), abs(aside).max()


time, peak, largest = run(best)
check(f"from {first} to {least}", first > 5 and least < 4.3795)
near("the time is that of a run", time, least, 1e-5)
check(f"the peak {peak} is within its bound, the largest distance {largest}", peak < LIMIT * 1.0005 and largest < 0.36)

# the scene that OPTIMIZE.md shows
table = list(csv.reader(gic("-q", model, f"{models}/optimize/least_time_found.scene", "-o", "-").splitlines()))
near("the scene with what was found", float(table[-1][0]), least, 1e-3)

# first order: steps of 1e-4 of the bounds' distance, changes of up to 1e-3 of it
step = 1e-4 * (high - low)
slope = []
for k in range(len(best)):
    down, up = best.copy(), best.copy()
    down[k] = max(low[k], best[k] - step[k])
    up[k] = min(high[k], best[k] + step[k])
    a, b = run(down), run(up)
    slope.append([(b[i] - a[i]) / (up[k] - down[k]) for i in (0, 1)])
by_time, by_peak = np.array(slope).T
reach = 1e-3 * (high - low)
bounds = list(zip(np.maximum(low - best, -reach), np.minimum(high - best, reach)))
program = linprog(by_time, A_ub=[by_peak], b_ub=[max(0, LIMIT - peak)], bounds=bounds)
alone = linprog(by_time, bounds=bounds)
check(f"no change gains more than {program.fun} s, without the distance's bound {alone.fun} s", program.fun > -1e-4 and alone.fun < 10 * program.fun)
finish()
