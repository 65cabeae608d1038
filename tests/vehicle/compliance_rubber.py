# SPDX-License-Identifier: MIT
"""compliance_rubber.py GICGEN GICRUN MODELS WORK: `gicrun --kc --loads` of axles on bushings.

A hub on one bushing with numbers on paper. Both axles of hatchback.veh against a static solution of its own: displacements
of all bodies, multipliers of all joints, energies written here after FORMAT.md 7.5, Newton's method, then the response to
each load from the same matrix; first derivatives by complex steps, second ones by differences of these. Reciprocity, and
virtual work: what heights do for vertical forces, vertical forces do for held heights; wheel and roll rates."""
import csv
import json
import math
import os
import subprocess
import sys

import kinematics as k
import numpy as np
from scipy.linalg import lu_factor, lu_solve

gicgen, gicrun, models, work = sys.argv[1:5]
failed = passed = 0
LOADS = ("lateral", "longitudinal", "aligning", "vertical", "hub_longitudinal", "hub_lateral", "hub_vertical")
ALONG = {"lateral": "contact_y", "longitudinal": "contact_x", "aligning": "turn", "vertical": "contact_z",
         "hub_longitudinal": "centre_x", "hub_lateral": "centre_y", "hub_vertical": "centre_z"}
FLOATING = ("vertical", "hub_vertical")


def check(what, mine, value, tolerance):
    global failed, passed
    if abs(mine - value) <= tolerance:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}: {mine!r}, independently {value!r}")


def given(model, axle):
    said = subprocess.run([gicrun, "--kc", "--loads", "--axle", axle, model, "-o", "-"], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    return {(r["load"], int(r["opposed"]), r["wheel"]):
            {n: float(r[n]) for n in r if n not in ("axle", "load", "wheel", "unit", "opposed")}
            for r in csv.DictReader(said.stdout.splitlines())}


# ---- a hub on one bushing: compliance of a place r from it is that of six springs

HUB = """gicgen: 1
model: hub
base: car
bodies:
  car: {mass: 1000, com: [0, 0, 0.5], inertia: [300, 900, 1000]}
  hub_l: {mass: 20, com: [0, 0.5, 0.5], inertia: [1, 1, 1], position: [0, 0.5, 0.5]}
coordinates:
%s
forces:
  rubber_l: {type: bushing, bodies: [car, hub_l], point: [0, 0.5, 0.5], stiffness: [2e5, 2e5, 1e5, 25000, 50000, 12500]}
wheels:
  tire_l: {body: hub_l, center: [0, 1, 0.5], radius: 0.5, stiffness: 200000}
"""
SIX = [("x", "translation", "1, 0, 0"), ("y", "translation", "0, 1, 0"), ("z", "translation", "0, 0, 1"),
       ("roll", "angle", "1, 0, 0"), ("pitch", "angle", "0, 1, 0"), ("yaw", "angle", "0, 0, 1")]
# of the left wheel, R = e = 0.5, of loads that the mirror exchanges; the pads' force N makes up for the height e R / 25000
# that a lateral force gives: N = -0.5
PAPER = {
    ("lateral", 1): {"contact_y": 1e-5, "camber": -1e-5, "force": -0.5, "steer": 0, "contact_x": 0, "centre_y": 5e-6},
    ("longitudinal", 0): {"contact_x": 3e-5, "steer": -4e-5, "toe": 4e-5, "centre_x": 2.5e-5, "camber": 0, "force": 0},
    ("aligning", 1): {"steer": 8e-5, "toe": -8e-5, "turn": 8e-5, "contact_x": -4e-5, "centre_x": -4e-5, "force": 0},
    ("hub_longitudinal", 0): {"contact_x": 2.5e-5, "centre_x": 2.5e-5, "steer": -4e-5, "force": 0},
    ("hub_lateral", 1): {"contact_y": 5e-6, "centre_y": 5e-6, "camber": 0, "force": 0},
    ("vertical", 0): {"contact_z": 2e-5, "centre_z": 2e-5, "camber": -2e-5, "contact_y": 1e-5, "force": 1},
    ("hub_vertical", 0): {"contact_z": 2e-5, "centre_z": 2e-5, "camber": -2e-5, "contact_y": 1e-5, "force": 0},
}


def on_paper():
    name = os.path.join(work, "one_bushing.veh")
    with open(name, "w") as f:
        f.write(HUB % "\n".join(f"  {n}_l: {{type: {t}, bodies: [car, hub_l], axis: [{u}], range: [-0.2, 0.2]}}" for n, t, u in SIX))
    mine = given(name, "1")
    for (load, opposed), row in PAPER.items():
        for column, value in row.items():
            check(f"on paper: {load} {opposed}: {column}", mine[load, opposed, "tire_l"][column], value, 1e-15 + 1e-12 * abs(value))
            mirrored = column in ("contact_y", "centre_y", "steer", "turn")
            check(f"on paper: {load} {opposed}: {column} on the right", mine[load, opposed, "tire_r"][column],
                  -value if mirrored else value, 1e-15 + 1e-12 * abs(value))


# ---- a static solution

ARCSIN = [math.factorial(2 * i) / (4**i * math.factorial(i) ** 2 * (2 * i + 1)) for i in range(26)]


def rotation_vector(C):
    s = np.array([C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]]) / 2
    square = s @ s
    return s * sum(c * square**i for i, c in enumerate(ARCSIN))


class Static:
    """The wheels of one axle; `bodies` move, all others stay."""

    def __init__(self, dump, axle, bodies):
        self.v = k.Vehicle(dump, axle)
        self.m = self.v.m
        names = [b["name"] for b in dump["bodies"]]
        self.free = self.m.free = [names.index(b) for b in bodies]
        self.energies, self.constraints = [], []
        moving = set(self.free)
        for f in dump["forces"]:
            pair = (f["a"], f["b"])
            c = dump["coordinates"][f["coordinate"]] if f["coordinate"] >= 0 else None
            if c:
                pair = (c["a"], c["b"])
            if not moving & set(pair):
                continue
            if f["type"] == "bushing":
                self.energies.append((pair, lambda p, f=f: self.bushing(p, f)))
            elif f["stiffness"] is not None and f["low"] is None:  # stops are not reached
                value = self.value(f, c)
                self.energies.append((pair, lambda p, f=f, g=value: f["stiffness"] * (g(p) - f["free"]) ** 2 / 2))
        for j in dump["joints"]:
            if moving & {j["a"], j["b"]}:
                self.constraints.append(((j["a"], j["b"]), lambda p, j=j: self.joint(p, j)))
        self.pads = [((w.body,), lambda p, w=w, z=w.P(self.m.pose0)[2]: [w.P(p)[2] - z]) for w in self.v.wheels]
        self.pose = self.m.pose0
        self.n = 6 * len(self.free)

    def joint(self, pose, j):
        if j["type"] == "coupler":  # the steering wheel is held straight ahead
            apart = self.m.at(pose, j["b"], j["point_b"]) - self.m.at(pose, j["a"], j["point_a"])
            return [(pose[j["a"]][1] @ np.array(j["axis_a"], float)) @ apart]
        return self.m.joint(pose, j)

    def angle(self, pose, f):
        A, B = self.m.pose(pose, f["a"])[1], self.m.pose(pose, f["b"])[1]
        u, v = A @ np.array(f["reference_a"], float), B @ np.array(f["reference_b"], float)
        return np.arctan((A @ np.array(f["axis_a"], float)) @ np.cross(u, v) / (u @ v))

    def value(self, f, c):
        if c:
            return (lambda p: self.angle(p, c)) if c["type"] == "angle" else (lambda p: self.m.coordinate(p, c))
        return (lambda p: self.angle(p, f)) if f["type"] == "axis" else self.v.element(f)

    def bushing(self, pose, f):
        A = [self.m.pose(pose, f[e])[1] @ np.reshape(f["frame_" + e], (3, 3)) for e in "ab"]
        d = A[0].T @ (self.m.at(pose, f["b"], f["point_b"]) - self.m.at(pose, f["a"], f["point_a"]))
        q = np.concatenate([d, rotation_vector(A[0].T @ A[1])])
        return q @ np.reshape(f["stiffness_matrix"], (6, 6)) @ q / 2

    def places(self, bodies):
        return [6 * self.free.index(b) + i for b in sorted(set(bodies)) if b in self.free for i in range(6)]

    def gradient(self, function, bodies, at):
        """Rows of derivatives by the displacements of these bodies, at a displacement `at` of theirs."""
        columns = []
        for i in range(len(at)):
            step = np.array(at, complex)
            step[i] += 1e-30j
            columns.append(np.imag(np.atleast_1d(function(self.displaced(bodies, step)))) / 1e-30)
        return np.array(columns).T

    def displaced(self, bodies, step):
        """Along a rotation vector and a displacement from the present pose."""
        out = list(self.pose)
        for i, b in enumerate(x for x in sorted(set(bodies)) if x in self.free):
            r, A = self.pose[b]
            d = step[6 * i : 6 * i + 6]
            out[b] = (r + d[:3], k.turned(d[3:]) @ A)
        return out

    def curvature(self, function, bodies, weights):
        n, h = len(self.places(bodies)), 7e-4
        H = np.zeros((n, n))
        for i in range(n):
            e = np.eye(n)[i]
            at = lambda x: weights @ self.gradient(function, bodies, x * e)
            slopes = [(at(s) - at(-s)) / (2 * s) for s in (h, h / 2)]
            H[i] = (4 * slopes[1] - slopes[0]) / 3
        return (H + H.T) / 2

    def assemble(self, multipliers):
        n = self.n
        held = self.constraints + self.pads
        g = np.zeros(n)
        H = np.zeros((n, n))
        rows, missing, at = [], [], 0
        for bodies, function in self.energies:
            p = self.places(bodies)
            g[p] += self.gradient(function, bodies, np.zeros(len(p)))[0]
            H[np.ix_(p, p)] += self.curvature(function, bodies, np.ones(1))
        for bodies, function in held:
            p = self.places(bodies)
            J = self.gradient(function, bodies, np.zeros(len(p)))
            count = len(J)
            block = np.zeros((count, n))
            block[:, p] = J
            rows.append(block)
            missing.append(np.atleast_1d(function(self.pose)))
            own = multipliers[at : at + count] if multipliers is not None else np.zeros(count)
            if own.any():
                H[np.ix_(p, p)] += self.curvature(function, bodies, own)
            at += count
        return g, H, np.concatenate(rows), np.concatenate(missing)

    def settle(self):
        lam = None
        for step in range(12):
            g, H, J, missing = self.assemble(lam)
            n, m = self.n, len(J)
            if lam is not None and np.max(abs(g + J.T @ lam)) < 1e-8 and np.max(abs(missing)) < 1e-13:
                break
            K = np.block([[H, J.T], [J, np.zeros((m, m))]])
            x = solve(K, -np.concatenate([g, missing]))
            self.pose = self.m.moved(self.pose, x[:n])
            lam = x[n:]
        else:
            raise AssertionError("the static solution did not converge")
        self.H, self.J, self.lam = H, J, lam

    def place(self, w, load):
        """Where it acts, in the carrier's frame."""
        r, A = self.pose[w.body]
        return w.centre if load.startswith("hub") else A.T @ (w.P(self.pose) - r)

    def work(self, w, load):
        p = np.zeros(self.n)
        first = 6 * self.free.index(w.body)
        if load == "aligning":
            p[first + 5] = 1
            return p
        point = self.place(w, load)
        axis = ("longitudinal", "lateral", "vertical").index(load.replace("hub_", ""))
        own = self.gradient(lambda q: self.m.at(q, w.body, point)[axis], (w.body,), np.zeros(6))[0]
        p[first : first + 6] = own
        return p

    def response(self, load, opposed):
        p = sum(self.work(w, load) * (w.side if opposed else 1) for w in self.v.wheels)
        J = self.J[: -len(self.pads)] if load in FLOATING else self.J
        K = np.block([[self.H, J.T], [J, np.zeros((len(J), len(J)))]])
        x = solve(K, np.concatenate([p, np.zeros(len(J))]))
        d, out = x[: self.n], {}
        for i, w in enumerate(self.v.wheels):
            row = {"steer": w.along(self.pose, d, w.steer), "camber": w.along(self.pose, d, w.camber),
                   "turn": w.omega(d)[2]}
            row["toe"] = -w.side * row["steer"]
            for name, what in (("contact", "lateral"), ("centre", "hub_lateral")):
                v = w.along(self.pose, d, lambda q: self.m.at(q, w.body, self.place(w, what)))
                row |= {f"{name}_{axis}": x for axis, x in zip("xyz", v)}
            row["force"] = (w.side if opposed else 1) * (load == "vertical") if load in FLOATING else -x[len(x) - len(self.pads) + i]
            out[w.name] = row
        return out


def solve(K, b):
    """With rows and columns in proportion, and one refinement."""
    s = 1 / np.sqrt(np.max(abs(K), axis=0))
    scaled = lu_factor(K * s * s[:, None])
    x = s * lu_solve(scaled, s * b)
    return x + s * lu_solve(scaled, s * (b - K @ x))


def against_statics(model, axle, bodies):
    mine = given(model, axle)
    dump = json.loads(subprocess.run([gicgen, "--dump-model", model], capture_output=True, check=True).stdout)
    static = Static(dump, axle, bodies)
    static.settle()
    worst = 0
    for load in LOADS:
        for opposed in (0, 1):
            other = static.response(load, opposed)
            size = {}
            for row in other.values():
                for n, x in row.items():
                    kind = "force" if n == "force" else "length" if n[-2] == "_" else "angle"
                    size[kind] = max(size.get(kind, 0), abs(x))
            for wheel, row in other.items():
                for n, x in row.items():
                    most = size["force" if n == "force" else "length" if n[-2] == "_" else "angle"]
                    apart = abs(mine[load, opposed, wheel][n] - x)
                    worst = max(worst, apart / most if most > 1e-12 else 0)
                    check(f"{axle}, {load} {opposed} {wheel}: {n}", mine[load, opposed, wheel][n], x, 1e-10 * most + 1e-16)
    print(f"{axle}: statics to {worst:.1e}")
    return mine, static.v.wheels


def reciprocal(what, mine, wheels):
    def work_of(a, oa, b, ob):
        return sum(mine[a, oa, w.name][ALONG[b]] * (w.side if ob else 1) for w in wheels)

    most = {a: max(work_of(a, o, a, o) for o in (0, 1)) for a in LOADS}
    for a in LOADS:
        for b in LOADS:
            if (a in FLOATING) != (b in FLOATING):
                continue
            for oa in (0, 1):
                for ob in (0, 1):
                    x, y = work_of(a, oa, b, ob), work_of(b, ob, a, oa)
                    check(f"{what}: {a} {oa} along {b} {ob}", x, y, 1e-11 * math.sqrt(most[a] * most[b]))
    # forces that hold the heights for a load L: with the heights Z and what goes along L for unit vertical forces, -Y / Z
    Z = np.array([[sum(mine["vertical", o, w.name]["contact_z"] * (w.side if p else 1) for w in wheels) for o in (0, 1)] for p in (0, 1)])
    for a in LOADS:
        for oa in (0, 1):
            if a in FLOATING:
                continue
            along = [sum(mine["vertical", o, w.name][ALONG[a]] * (w.side if oa else 1) for w in wheels) for o in (0, 1)]
            modes = np.linalg.solve(Z, -np.array(along))
            for w in wheels:
                x = mine[a, oa, w.name]["force"]
                check(f"{what}: {a} {oa}: force by virtual work", x, modes[0] + w.side * modes[1], 1e-9 * max(1, abs(x)))


def rates(model, axle):
    """Without rubber, vertical compliance is what wheel and roll rates say."""
    mine = given(model, axle)
    said = subprocess.run([gicrun, "--kc", "-q", "--axle", axle, model, "-o", "-"], capture_output=True, text=True, check=True)
    row = next(r for r in csv.DictReader(said.stdout.splitlines()) if r["motion"] == "parallel" and abs(float(r["travel [m]"])) < 1e-12)
    row = {n.split(" [")[0]: x for n, x in row.items()}
    for (load, opposed, wheel), give in mine.items():
        if load == "vertical":
            rate = 2 * float(row["roll_rate"]) / float(row["track"]) ** 2 if opposed else float(row[wheel + ".wheel_rate"])
            check(f"{axle}: rate of {wheel}, {opposed}", abs(give["contact_z"]) * rate, 1, 1e-9)


if __name__ == "__main__":
    on_paper()
    hatchback = os.path.join(models, "hatchback.veh")
    front = [b + s for b in ("arm", "strut", "lever") for s in ("_l", "_r")]
    for axle, bodies in (("front", ["subframe", "gear", "rack", *front]), ("rear", ["trail_l", "trail_r"])):
        mine, wheels = against_statics(hatchback, axle, bodies)
        reciprocal(axle, mine, wheels)
    for axle in ("front", "rear"):
        rates(os.path.join(models, "hmmwv_vehicle.veh"), axle)
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed > 0 or passed < 700)
