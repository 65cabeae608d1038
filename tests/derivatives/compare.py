#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""compare.py GICGEN MODEL [-n ROWS] [--states CSV] [--option=OPTION] [--wave] [--lanes W] [--npz IN OUT
[--but INPUT]] [--matrices CSV OUT]: derivatives of rates and outputs by the code of `gicgen --derivatives`, by tangents and by the
jacobian, against the very same code computed with dual numbers in C++ (dual_real.hpp), by every state, input, parameter
and number of a port, at the design and at ROWS (5) random states beside it, or at those of a file of tests/tools/states.

--lanes W: the derivatives are those of code in lanes, the dual numbers are over code without them.

--matrices CSV OUT: instead, at the states of such a file the matrices of small motions, by the jacobian, as
tests/tools/linearized prints them, for quad_linear.

--npz IN OUT: instead, at the operating point of a file IN of `gicrun --linearize`: the matrices A to F by the code, in the
small motions of models/SCENE.md section 8, which are written again here, against those of the file; those of the code
go into OUT, for linear_difference.py.

Deviations are relative to the largest of the derivative's row and column. Prints the largest; exit status 1 where it is
above the tolerance, 1e-13 or, of files, 1e-12, and where nothing was compared."""
import os
import shutil
import subprocess
import sys
import tempfile

import numpy as np

here = os.path.dirname(os.path.abspath(__file__))
runtime = os.path.join(here, "..", "..", "runtime")
words = sys.argv[1:]


def option(name, count, default):
    if name not in words:
        return default
    at = words.index(name)
    values = words[at + 1:at + 1 + count]
    del words[at:at + 1 + count]
    return values


rows = int(option("-n", 1, ["5"])[0])
npz = option("--npz", 2, None)
states_file = option("--states", 1, [None])[0]
matrices = option("--matrices", 2, None)
left_out = option("--but", 1, [])
lanes = option("--lanes", 1, [])
wave = ["0.05", "5"] if option("--wave", 0, None) is not None else []
options = [word[9:] for word in words if word.startswith("--option=")]
gicgen, model = [word for word in words if not word.startswith("--")]


def build(folder, dual):
    """The program of program.c with the code of the model."""
    subprocess.run([gicgen, *([] if dual else ["--derivatives", *(["--lanes", *lanes] if lanes else [])]),
                    *[w for o in options for w in o.split("=")], model, "-o",
                    f"{folder}/code.c"], check=True, stderr=subprocess.DEVNULL)
    with open(f"{folder}/code.h", encoding="utf-8") as file:
        header = file.read()
    name = header.split("typedef struct ", 1)[1].split()[0]
    for part in ("gic_runtime.c", "gic_road.c", "gic_road.h", "gic_lanes.h", "gic_road_lanes.h"): # each includes the header beside it
        shutil.copy(f"{runtime}/{part}", folder)
    with open(f"{runtime}/gic_runtime.h", encoding="utf-8") as file:
        text = file.read()
    with open(f"{folder}/gic_runtime.h", "w", encoding="utf-8") as file:
        file.write(text.replace("typedef double gic_real;", "typedef Differential gic_real;") if dual else text)
    how = ["g++", "-std=c++11", "-x", "c++", "-fpermissive", "-DDUAL"] if dual else ["gcc", "-std=c99"]
    if " derived[" in header:
        how.append("-DTUNED")
    subprocess.run([*how, "-O0", "-w", "-ffp-contract=off", f"-I{folder}", f"-I{here}", f"-DMODEL={name}",
                    '-DCODE="code.c"', f"{here}/program.c", "-o", f"{folder}/program", "-lm"], check=True)
    return f"{folder}/program"


def evaluate(program, numbers, *how):
    """For each row of numbers: rates and outputs, and the derivatives, a column for each number."""
    text = "\n".join(" ".join(repr(float(number)) for number in row) for row in numbers)
    said = subprocess.run([program, *(wave or ["0", "1"]), *how], input=text, capture_output=True, text=True,
                          check=True).stdout.split("\n")
    found, at = [], 0
    for _ in numbers:
        status, at = int(said[at]), at + 1
        if status:
            found.append(None)
            continue
        lines = said[at:at + 1 + columns]
        at += 1 + columns
        table = np.array([[float(word) for word in text.split()] for text in lines])
        found.append((table[0], table[1:].T))
    return found


with tempfile.TemporaryDirectory() as work:
    os.mkdir(f"{work}/tangent")
    tangent = build(f"{work}/tangent", False)
    names = [text.split() for text in subprocess.run([tangent, "names"], capture_output=True, text=True,
                                                     check=True).stdout.splitlines()]
    kind = {k: [text[1] for text in names if text[0] == k] for k in ("state", "input", "parameter", "port", "discrete",
                                                                     "output")}
    columns = sum(len(kind[k]) for k in ("state", "input", "parameter", "port"))

    def deviation(a, b):
        scale = np.maximum(np.abs(b).max(axis=1, keepdims=True), np.abs(b).max(axis=0, keepdims=True))
        return np.abs(a - b) / np.where(scale == 0, 1, scale)

    start = subprocess.run([tangent, "start"], capture_output=True, text=True, check=True).stdout.splitlines()[-1]
    order = [name for k in ("state", "input", "parameter", "port", "discrete") for name in kind[k]]
    base_row = dict(zip(order, start.split()))
    assert len(base_row) == len(order)

    def rows_of(path):
        """The numbers of each row of a file of states, others as at the start."""
        with open(path, encoding="utf-8") as file:
            lines = [text.strip().split(",") for text in file]
        numbers = []
        for cells in lines[1:]:
            row = [float({**base_row, **dict(zip(lines[0], cells))}[name]) for name in order]
            row[len(row) - len(kind["discrete"]):] = [int(x) for x in row[len(row) - len(kind["discrete"]):]]
            if "dependent_euler_parameter" in kind["discrete"]:
                e = np.abs([row[order.index(f"e{i}")] for i in range(4)])
                row[order.index("dependent_euler_parameter")] = int(e.argmax())
            numbers.append(row)
        return numbers

    if npz is None and matrices is None:
        os.mkdir(f"{work}/dual")
        dual = build(f"{work}/dual", True)
        base = np.array([float(word) for word in start.split()])
        random = np.random.default_rng(7)
        states, inputs, parameters = (len(kind[k]) for k in ("state", "input", "parameter"))
        numbers = []
        for i in range(rows + 1):
            row = base.copy()
            if i:
                row[:states] += 0.02 * random.standard_normal(states)
                row[states:states + inputs] += 0.02 * random.standard_normal(inputs)
                part = slice(states + inputs, states + inputs + parameters)
                row[part] *= 1 + 0.002 * random.standard_normal(parameters)
                ports = slice(part.stop, part.stop + len(kind["port"]))
                row[ports] = random.standard_normal(len(kind["port"]))
                speeds = [k for k, name in enumerate(kind["state"]) if name in ("v.x", "v.y", "v.z")]
                row[speeds] += 5 * random.standard_normal(len(speeds))
                if "e0" in kind["state"]:
                    e = slice(kind["state"].index("e0"), kind["state"].index("e0") + 4)
                    row[e] /= np.linalg.norm(row[e])
            numbers.append(row[:len(row)].tolist())
        for row in numbers:
            row[len(row) - len(kind["discrete"]):] = [int(x) for x in row[len(row) - len(kind["discrete"]):]]
        if states_file:
            numbers = rows_of(states_file)
        mine, theirs = evaluate(tangent, numbers), evaluate(dual, numbers)
        worst, compared = 0, 0
        for a, b in zip(mine + evaluate(tangent, numbers, "columns"), theirs + theirs):
            if a is None or b is None:
                if (a is None) != (b is None):
                    sys.exit("one of both has a status")
                continue
            assert np.allclose(a[0], b[0], rtol=1e-9, atol=1e-9)
            off = deviation(a[1], b[1])
            if not np.isfinite(off).all():
                sys.exit("a derivative is no finite number")
            i, j = np.unravel_index(off.argmax(), off.shape)
            if off[i, j] > worst:
                worst, place = off[i, j], (i, j)
            compared += 1
        print(f"{compared} states, by tangents and by columns, {columns} columns: {worst:.2e}" + (f" at {place}" if worst else ""))
        sys.exit(not (compared and worst <= 1e-13))

    # ---- small motions
    def matrix(e):
        w, x, y, z = e
        return np.array([[w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                         [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                         [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z]])

    n, slow = len(kind["state"]), {name: i for i, name in enumerate(kind["state"])}
    free = "e0" in slow
    base = 6 if free else 0

    def plain(name):
        return name.split("/")[-1]

    class Motions:
        """Small motions `names` at a state: `places` of the base and of coordinates, their rates, fast states."""

        def __init__(self, names, places, p, v, omega, rate):
            self.names, self.places, self.rate = names, places, rate
            self.change = np.zeros((n, len(names)))  # the state's by each small motion
            for j, name in enumerate(names):
                if not self.is_base(j):
                    self.change[slow[plain(name)], j] = 1
            if not free:
                return
            self.R, self.omega = matrix(p), omega
            self.u = self.R.T @ v
            r, e, v, o = slow["r.x"], slow["e0"], slow["v.x"], slow["omega.x"]
            self.change[r:r + 3, 0:3] = self.R
            for k in range(3):
                theta = np.eye(3)[k]
                turn = np.concatenate([[-p[1:] @ theta], p[0] * theta + np.cross(p[1:], theta)])
                self.change[e:e + 4, 3 + k] = turn / 2
                self.change[v:v + 3, 3 + k] = self.R @ np.cross(theta, self.u)
            self.change[v:v + 3, places:places + 3] = self.R
            self.change[o:o + 3, places + 3:places + 6] = np.eye(3)

        def is_base(self, i):
            return i < base or self.places <= i < self.places + base

        def rates(self, drate, z):
            """The change of the motions' rates along z with that of the state's rate."""
            out = np.zeros(len(self.names))
            for i, name in enumerate(self.names):
                if not self.is_base(i):
                    out[i] = drate[slow[plain(name)]]
            if free:
                places, R, v, omega = self.places, self.R, slow["v.x"], slow["omega.x"]
                rho, theta, du, domega = z[:3], z[3:6], z[places:places + 3], z[places + 3:places + 6]
                out[:3] = du + np.cross(theta, self.u) - np.cross(self.omega, rho)
                out[3:6] = domega - np.cross(self.omega, theta)
                out[places:places + 3] = (R.T @ drate[v:v + 3] - np.cross(theta, R.T @ self.rate[v:v + 3]) -
                                          np.cross(domega, self.u) - np.cross(self.omega, du))
                out[places + 3:places + 6] = drate[omega:omega + 3]
            return out

    if matrices is not None:
        coordinates = [name[:-5] for name in slow if name.endswith(".rate")]
        known = {*("r.x r.y r.z e0 e1 e2 e3 v.x v.y v.z omega.x omega.y omega.z".split() if free else ()), *coordinates,
                 *(name + ".rate" for name in coordinates), "transmission.age"}
        names = ["base"] * base + coordinates
        places = len(names)
        names += ["base"] * base + [name + ".rate" for name in coordinates]
        names += [name for name in slow if name not in known]
        numbers, done = rows_of(matrices[0]), 0
        with open(matrices[1], "w", encoding="utf-8") as file:
            print("row", *names, sep=",", file=file)
            for k, found in enumerate(evaluate(tangent, numbers, "columns")):
                if found is None:
                    continue
                at = dict(zip(order, numbers[k]))
                p, v, omega = (np.array([at.get(name, 0) for name in group.split()]) for group in
                               ("e0 e1 e2 e3", "v.x v.y v.z", "omega.x omega.y omega.z"))
                motions = Motions(names, places, p, v, omega, found[0][:n])
                total, eye = found[1][:n, :n] @ motions.change, np.eye(len(names))
                A = np.array([motions.rates(total[:, j], eye[j]) for j in range(len(names))]).T
                for line in A:
                    print(k + 1, *(f"{x:.17g}" for x in line), sep=",", file=file)
                done += 1
        sys.exit(not done)

    # ---- at the point of a file
    point = dict(np.load(npz[0]))
    states, inputs, parameters = (list(point[k]) for k in ("states", "inputs", "parameters"))
    assert free == (len(point["base"]) == 7)
    places = len([name for name in states if name.endswith(".rate")])
    held = dict(zip(point["held"], point["held0"]))
    z0, f = point["z0"], point["f"]

    value = {plain(name): z for name, z in list(zip(states, z0))[base:places] + list(zip(states, z0))[places + base:]}
    value.update(held)
    if free:
        p = point["base"][3:]
        R, u0, omega0 = matrix(p), z0[places:places + 3], z0[places + 3:places + 6]
        for group, numbers in (("r.x r.y r.z", point["base"][:3]), ("e0 e1 e2 e3", p), ("v.x v.y v.z", R @ u0),
                               ("omega.x omega.y omega.z", omega0)):
            value.update(zip(group.split(), numbers))
    else:
        p = omega0 = R = u0 = None
    u, par = dict(zip(inputs, point["u0"])), dict(zip(parameters, point["p0"]))
    row = [value[name] for name in kind["state"]] + [u[name] for name in kind["input"]]
    row += [par[name] for name in kind["parameter"]] + [u[name] for name in kind["port"]]
    row += [int(held.get(name, 0)) for name in kind["discrete"]]
    found = evaluate(tangent, [row], "columns")[0]
    if found is None:
        sys.exit("the code refuses the point")
    D = found[1]
    motion = Motions(states, places, p, R @ u0 if free else None, omega0, found[0][:n])
    change, motions = motion.change, motion.rates

    own = {}
    total = D[:, :n] @ change
    eye = np.eye(len(states))
    own["A"] = np.array([motions(total[:n, j], eye[j]) for j in range(len(states))]).T.reshape(len(states), len(states))
    own["C"] = total[n:]
    at = {(k, name): j for j, (k, name) in enumerate((k, name) for k in ("state", "input", "parameter", "port")
                                                      for name in kind[k])}
    still = np.zeros(len(states))
    for upper, lower, wanted in (("B", "D", inputs), ("E", "F", parameters)):
        cols = [at[("input", m)] if ("input", m) in at and upper == "B" else at[("port", m)] if upper == "B"
                else at[("parameter", m)] for m in wanted]
        own[upper] = np.array([motions(D[:n, c], still) for c in cols]).T.reshape(len(states), len(cols))
        own[lower] = D[n:][:, cols].reshape(len(kind["output"]), len(cols))
    keep = [kind["output"].index(name) for name in point["outputs"]]
    for name in "CDF":
        own[name] = own[name][keep]
    for name in left_out:
        for key in "BD":
            own[key][:, inputs.index(name)] = point[key][:, inputs.index(name)]
    top = np.hstack([point["A"], point["B"], point["E"]])
    bottom = np.hstack([point["C"], point["D"], point["F"]])
    off = deviation(np.vstack([np.hstack([own["A"], own["B"], own["E"]]), np.hstack([own["C"], own["D"], own["F"]])]),
                    np.vstack([top, bottom]))
    point.update(own)
    np.savez(npz[1], **point)
    i, j = np.unravel_index(off.argmax(), off.shape)
    print(f"{off.size} derivatives: {off.max():.2e} at {i}, {j}")
    sys.exit(not off.max() <= 1e-12)
