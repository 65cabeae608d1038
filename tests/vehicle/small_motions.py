# SPDX-License-Identifier: MIT
# small_motions.py GICRUN MODEL BASE: eigenvalues of `gicrun --modes` against those of the vehicle's own motion: CVODE's BDF on
# the nonlinear equations of the engine gic, let go from rest with each number of the state moved by a little, both ways.
# With columns y(0) and y(T) of outputs for all these motions, y(T) = F y(0), and the eigenvalues of F on what the
# outputs span are exp(lambda T). Nothing is linearized but by these differences. Prints the largest difference, over
# 1/s and the eigenvalue.
import csv
import math
import re
import subprocess
import sys

import numpy as np

gicrun, path, base = sys.argv[1:4]
EPS = 1e-5


def table(text):
    rows = list(csv.reader(text.splitlines()))
    return rows[0], np.array([[float(x) if x else math.nan for x in row] for row in rows[1:]])


def call(*words):
    done = subprocess.run([gicrun, *words], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{words}: {done.stderr}")
    return done.stdout


# the model, with outputs that tell its whole state
with open(path) as file:
    model = file.read()
names, rest = table(call("--equilibrium", path, "-o", "-"))
names = [name.split(" ")[0] for name in names]
rest = rest[0]
free = "e0" in names
half = names.index("v.x") if free else next(i for i, name in enumerate(names) if name.endswith(".rate"))
coordinates = names[7 if free else 0:half]
more = "".join(f"  all_{name}: {{type: coordinate, coordinate: {name}}}\n" for name in coordinates)
watched = [f"all_{name}.{what}" for name in coordinates for what in ("value", "rate")]
if free:
    for i, point in enumerate(("[0, 0, 0]", "[1, 0, 0]", "[0, 1, 0]")):
        for what in ("position", "velocity"):
            more += f"  {what}_{i}: {{type: {what}, body: {base}, point: {point}}}\n"
            watched += [f"{what}_{i}.{axis}" for axis in "xyz"]
with open("seen.veh", "w") as file:
    file.write(re.sub(r"^outputs:\n", "outputs:\n" + more, model, flags=re.M))

# what --modes says
head, modes = table(call("--modes", path, "-o", "-"))
told = modes[:, 0] + 1j * modes[:, 1]
told = told[np.abs(told) > 1e-3]
T = 1.5 / np.max(np.abs(told))


def turned(e, i, angle):
    """Euler parameters after a small turn about axis i of the base."""
    s, c = math.sin(angle / 2), math.cos(angle / 2)
    d = [c, 0, 0, 0]
    d[1 + i] = s
    a, b = e, d
    return [a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]]


def motion(number, by):
    """What is watched, at 0 and T, with a number of the state moved."""
    state = list(rest)
    if free and 3 <= number < 6:
        state[3:7] = turned(state[3:7], number - 3, by)
    else:
        state[number + (1 if free and number >= 6 else 0)] += by
    scene = {"gicscene": 1, "duration": T, "output_step": T, "integrator": "bdf", "tolerance": 1e-12}
    first = 7 if free else 0
    initial = {"coordinates": dict(zip(coordinates, state[first:half])),
               "rates": dict(zip(coordinates, state[half + (6 if free else 0):]))}
    if free:
        initial |= {"position": state[:3], "orientation": {"euler": state[3:7]}, "velocity": state[half:half + 3],
                    "angular_velocity": state[half + 3:half + 6]}
    scene["initial"] = initial
    scene["outputs"] = watched
    with open("motion.scene", "w") as file:
        file.write(re.sub(r"'", "", repr(scene)))
    rows = table(call("-q", "--engine", "gic", "seen.veh", "motion.scene", "-o", "-"))[1]
    return rows[:, 1:]


count = len(rest) - (1 if free else 0)
Y = np.array([(motion(k, EPS) - motion(k, -EPS)) / (2 * EPS) for k in range(count)])  # [number][time][output]
begin, end = Y[:, 0].T, Y[:, 1].T
U = np.linalg.svd(begin, full_matrices=False)[0][:, :count]
found = np.log(np.linalg.eigvals(U.T @ end @ np.linalg.inv(U.T @ begin)).astype(complex)) / T
worst = 0
for one in told:
    near = found[np.argmin(np.abs(found - one))]
    worst = max(worst, abs(near - one) / (1 + abs(one)))
print(f"{worst:.2g} over {len(told)} eigenvalues up to {np.max(np.abs(told)):.4g} 1/s")
sys.exit(not (worst < 1e-4 and len(told) > 1))
