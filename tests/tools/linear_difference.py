#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""linear_difference.py GICRUN MODEL NPZ [SCENE]: the matrices of `gicrun --linearize -o NPZ` against differences of what
the engine gic, which shares no formula with the expression graph, finds at states, inputs and parameters beside the
operating point (`gicrun --eval`; SCENE gives the road). Small motions as models/SCENE.md section 8 defines them, written
again here. Differences are central and of fourth order, with steps h of 1e-4 or less in units in which rates are smooth;
what is compared is the change over a step, relative to the largest one of the row: there rounding (1e-14 of sums whose
terms cancel, times 1 / h) and the fifth derivative (h^4) leave 2e-7 at most in our models; a wrong or missing term of
any size that matters shows. Columns of ports are not compared, for --eval has no ports. Prints the largest deviation of
each matrix; exit status 1 where one is above 1e-6 or nothing was compared."""
import csv
import subprocess
import sys

import numpy as np

gicrun, model, path = sys.argv[1:4]
road = sys.argv[4:5]
point = np.load(path)
states, inputs, outputs, parameters = (list(point[k]) for k in ("states", "inputs", "outputs", "parameters"))
free = len(point["base"]) == 7
base = 6 if free else 0
rates = [name for name in states if name.endswith(".rate")]
places = len(rates)
z0, f = point["z0"], point["f"]


def cross(a, b):
    return np.cross(a, b)


def matrix(e):
    w, x, y, z = e / np.linalg.norm(e)
    return np.array([[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]])


def product(p, q):
    return np.concatenate([[p[0] * q[0] - p[1:] @ q[1:]], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])])


def turned(e, theta):
    angle = np.linalg.norm(theta)
    half = theta / 2 if angle == 0 else theta * np.sin(angle / 2) / angle
    return product(e, np.concatenate([[np.cos(angle / 2)], half]))


def plain(name):
    return name.split("/")[-1]


class Row:
    """The numbers of a row of --eval, moved by z, u, p."""

    def __init__(self, z, u, p):
        self.cell = dict(zip(point["held"], point["held0"]))
        z = z0 + z
        if free:
            self.r = point["base"][:3] + matrix(point["base"][3:]) @ z[:3]
            self.e = turned(point["base"][3:], z[3:6])
            self.u, self.omega = z[places:places + 3], z[places + 3:places + 6]
            self.v = matrix(self.e) @ self.u
            for name, numbers in (("r.x r.y r.z", self.r), ("e0 e1 e2 e3", self.e), ("v.x v.y v.z", self.v),
                                  ("omega.x omega.y omega.z", self.omega)):
                self.cell.update(zip(name.split(), numbers))
        for i, name in enumerate(states):
            if i >= places + base or base <= i < places:
                self.cell[plain(name)] = z[i]
        self.z = z
        for name, value in zip(inputs, point["u0"] + u):
            self.cell[f"input/{name}"] = value
        for name, value in zip(parameters, point["p0"] + p):
            self.cell[f"parameter/{name}"] = value


def changes(row, found):
    """Rates of the motions, seen from the base as the operating point has it moving on, and outputs."""
    acceleration = [float(found[f"{plain(name)[:-5]}.acceleration"]) for name in states[places + base:2 * places]]
    fast = [float(found[f"{name}.rate"]) for name in states[2 * places:]]
    rate = np.concatenate([row.z[places:2 * places], np.zeros(base), acceleration, fast])
    if free:
        R0 = matrix(point["base"][3:])
        u0, omega0 = z0[places:places + 3], z0[places + 3:places + 6]
        rate[:3] = R0.T @ row.v - u0 - cross(omega0, R0.T @ (row.r - point["base"][:3]))
        relative = R0.T @ matrix(row.e)
        rate[3:6] = row.omega - relative.T @ omega0
        a = np.array([float(found[f"a.{k}"]) for k in "xyz"])
        rate[places:places + 3] = matrix(row.e).T @ a - cross(row.omega, row.u)
        rate[places + 3:places + 6] = [float(found[f"alpha.{k}"]) for k in "xyz"]
    return np.concatenate([rate, [float(found[f"output.{name}"]) for name in outputs]])


def step_of(name, unit, value):
    """A change over which rates are smooth. A brake that slips stands where its windup turns from one parabola to
    another one, so that differences are of first order only."""
    if name.split(".")[-1] == "brake":
        return 1e-8
    if name.split(".")[-1] in ("slip_x", "slip_y") or unit in ("m", "rad"):
        return 1e-5
    if unit in ("m/s", "rad/s", "m/s^2", "rad/s^2"):
        return 1e-4
    return 1e-4 * (abs(value) if value else 1)


ports = [i for i, name in enumerate(inputs) if ".force." in name or ".torque." in name]
columns = [(kind, j, step_of(name, unit, value))
           for kind, names, units, values in (("z", states, "state_units", z0), ("u", inputs, "input_units", point["u0"]),
                                              ("p", parameters, "parameter_units", point["p0"]))
           for j, (name, unit, value) in enumerate(zip(names, point[units], values)) if kind != "u" or j not in ports]
rows = []
for kind, j, h in columns:
    for share in (-2, -1, 1, 2):
        change = {"z": np.zeros(len(states)), "u": np.zeros(len(inputs)), "p": np.zeros(len(parameters))}
        change[kind][j] = share * h
        rows.append(Row(change["z"], change["u"], change["p"]))
names = [name for name in rows[0].cell if name[6:] not in [inputs[i] for i in ports]]
text = "\n".join([",".join(names)] + [",".join(repr(float(row.cell[name])) for name in names) for row in rows]) + "\n"
said = subprocess.run([gicrun, "--engine", "gic", "--eval", "-", model, *road], input=text, capture_output=True, text=True,
                      check=True).stdout
table = list(csv.DictReader(said.splitlines()))
bad = [row["message"] for row in table if row["status"] != "0"]
if bad:
    sys.exit(f"{len(bad)} states have no result: {bad[0]}")
table = [{name.split(" ")[0]: value for name, value in row.items()} for row in table]
found = [changes(row, result) for row, result in zip(rows, table)]
n = len(states)
exact = {"z": np.vstack([point["A"], point["C"]]), "u": np.vstack([point["B"], point["D"]]),
         "p": np.vstack([point["E"], point["F"]])}
steps = np.array([h for _, _, h in columns])
mine = np.array([exact[kind][:, j] for kind, j, _ in columns]).T * steps
theirs = np.array([(found[4 * k] - found[4 * k + 3] + 8 * (found[4 * k + 2] - found[4 * k + 1])) / 12
                   for k in range(len(columns))]).T
largest = np.abs(theirs).max(axis=1, keepdims=True)
# a row whose changes are rounding of its value: nothing moves it
value = np.concatenate([np.abs(f), np.abs(point["y0"])])[:, None]
still = largest[:, 0] <= 1e-11 * (1 + value[:, 0])
deviation = np.abs(mine - theirs) / np.where(still[:, None], 1e-5 * (1 + value), largest)
worst = 0
for name, rows_, kind in (("A", slice(0, n), "z"), ("B", slice(0, n), "u"), ("C", slice(n, None), "z"),
                          ("D", slice(n, None), "u"), ("E", slice(0, n), "p"), ("F", slice(n, None), "p")):
    part = deviation[rows_, [k for k, c in enumerate(columns) if c[0] == kind]]
    if part.size:
        i, k = np.unravel_index(part.argmax(), part.shape)
        print(f"{name}: {part.max():.2e} at row {i}, column {k}")
        worst = max(worst, part.max())
sys.exit(not (worst <= 1e-6 and deviation.size))
