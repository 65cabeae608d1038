# SPDX-License-Identifier: MIT
"""joints_rubber.py GICGEN GICRUN MODELS WORK: `gicrun --kc --joints` of axles on rubber.

A hub on one bushing with numbers on paper. Both axles of hatchback.veh, at set-up and with 30 mm of travel, against the static
solution of compliance_rubber.py: reactions are its multipliers, loads of bushings the gradient of their energy, and what a load
changes follows from its response and from the gradients at poses beside it. Then the loads as reported: their forces and
moments on each body, with those of springs and pads, add up to nothing, and the steering is held by virtual work."""
import csv
import os
import subprocess
import sys

import compliance_rubber as c
import numpy as np

gicgen, gicrun, models, work = sys.argv[1:5]
passed = failed = 0
worst = {}


def check(what, mine, value, tolerance, size):
    """Within the tolerance of the largest load of the case."""
    global passed, failed
    error = float(np.max(abs(np.array(mine, float) - value))) / size
    worst[tolerance] = max(worst.get(tolerance, 0), error)
    if error <= tolerance:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}: {mine!r}, independently {value!r}")


def rows_of(model, axle, mode="--joints", travel=0.03):
    options = [gicrun, "--kc", "-q", "--axle", axle, "--travel", str(travel), model, "-o", "-"] + ([mode] if mode else [])
    said = subprocess.run(options, capture_output=True, text=True)
    assert said.returncode == 0 and (mode is None or "warning" not in said.stderr), said.stderr
    return [{n.split(" [")[0]: x for n, x in r.items()} for r in csv.DictReader(said.stdout.splitlines())]


def vector(row, name):
    return np.array([float(row[f"{name}.{x}"]) for x in "xyz"])


# ---- on paper: the bushing takes the load and what the pad takes with it, at a lever of 0.5 m across and 0.5 m down

PAPER = {
    ("lateral", 1): ([0, -1, 0.5], [-0.25, 0, 0]),
    ("longitudinal", 0): ([-1, 0, 0], [0, 0.5, 0.5]),
    ("aligning", 1): ([0, 0, 0], [0, 0, -1]),
    ("vertical", 0): ([0, 0, -1], [-0.5, 0, 0]),
    ("hub_longitudinal", 0): ([-1, 0, 0], [0, 0, 0.5]),
    ("hub_lateral", 1): ([0, -1, 0], [0, 0, 0]),
    ("hub_vertical", 0): ([0, 0, 0], [0, 0, 0]),
}


def on_paper():
    name = os.path.join(work, "one_bushing_joints.veh")
    six = "\n".join(f"  {n}_l: {{type: {t}, bodies: [car, hub_l], axis: [{a}], range: [-0.1, 0.1]}}" for n, t, a in c.SIX)
    with open(name, "w") as f:
        f.write(c.HUB % six)
    rows = {(r["load"], int(r["opposed"])): r for r in rows_of(name, "1") if r["motion"] == "parallel" and float(r["travel"]) == 0}
    for case, (force, torque) in PAPER.items():
        check(f"on paper: {case}", vector(rows[case], "rubber_l.force"), force, 1e-13, 1)
        check(f"on paper: {case}: torque", vector(rows[case], "rubber_l.torque"), torque, 1e-13, 1)
        check(f"on paper: {case}: right", vector(rows[case], "rubber_r.force"), np.array(force) * [1, -1, 1], 1e-13, 1)
        check(f"on paper: {case}: right", vector(rows[case], "rubber_r.torque"), np.array(torque) * [-1, 1, -1], 1e-13, 1)


# ---- a static solution


class Loads(c.Static):
    """With what joints and bushings carry."""

    def __init__(self, dump, axle, bodies):
        super().__init__(dump, axle, bodies)
        moving = set(self.free)
        self.joints = [j for j in dump["joints"] if moving & {j["a"], j["b"]}]
        self.rubber = [f for f in dump["forces"] if f["type"] == "bushing" and moving & {f["a"], f["b"]}]
        self.springs = [e for e in self.energies if e[1].__name__ != "<lambda>" or "bushing" not in e[1].__code__.co_names]

    def raise_pads(self, heights):
        self.pads = [((w.body,), lambda p, w=w, z=z: [w.P(p)[2] - z]) for w, z in zip(self.v.wheels, heights)]

    def on(self, at, Q, pose, body, sign):
        """Force, and torque about a point, of the part of Q [6] on a body."""
        F = sign * Q[:3]
        return np.concatenate([F, sign * Q[3:] - np.cross(at - pose[body][0], F)])

    def carried(self, pose, lam):
        """{name: force and torque on the second body, about its point}."""
        kept, self.pose, out, row = self.pose, pose, {}, 0
        for j, (bodies, function) in zip(self.joints, self.constraints):
            places = self.places(bodies)
            J = self.gradient(function, bodies, np.zeros(len(places)))
            Q = np.zeros(self.n)
            Q[places] = -(lam[row : row + len(J)] @ J)
            row += len(J)
            b, sign = (j["b"], 1) if j["b"] in self.free else (j["a"], -1)
            at = self.m.at(pose, j["b"], j["point_b"] if j["point_b"] is not None else [0, 0, 0])
            i = 6 * self.free.index(b)
            out[j["name"]] = self.on(at, Q[i : i + 6], pose, b, sign)
        for f in self.rubber:
            pair = (f["a"], f["b"])
            places = self.places(pair)
            Q = np.zeros(self.n)
            Q[places] = -self.gradient(lambda p, f=f: self.bushing(p, f), pair, np.zeros(len(places)))[0]
            i = 6 * self.free.index(f["b"])
            out[f["name"]] = self.on(self.m.at(pose, f["b"], f["point_b"]), Q[i : i + 6], pose, f["b"], 1)
        self.pose = kept
        return out

    def change(self, load, opposed):
        p = sum(self.work(w, load) * (w.side if opposed else 1) for w in self.v.wheels)
        J = self.J[: -len(self.pads)] if load == "vertical" else self.J
        x = c.solve(np.block([[self.H, J.T], [J, np.zeros((len(J), len(J)))]]), np.concatenate([p, np.zeros(len(J))]))
        d, slope = x[: self.n], np.concatenate([x[self.n :], np.zeros(len(self.lam))])[: len(self.lam)]
        s = 2e-3 / np.max(abs(d))

        def along(h):
            ends = [self.carried(self.m.moved(self.pose, e * d), self.lam + e * slope) for e in (h, -h)]
            return {n: (ends[0][n] - ends[1][n]) / (2 * h) for n in ends[0]}

        far, near = along(s), along(s / 2)
        return {n: (4 * near[n] - far[n]) / 3 for n in near}


def on_each_body(what, static, row, dump):
    """Of the loads as reported: their sum on each body."""
    names = [b["name"] for b in dump["bodies"]]
    total = np.zeros(static.n)
    for one in static.joints + static.rubber:
        at = static.m.at(static.pose, one["b"], one["point_b"] if one["point_b"] is not None else [0, 0, 0])
        F, T = vector(row, one["name"] + ".force"), vector(row, one["name"] + ".torque")
        for body, sign in ((one["a"], -1), (one["b"], 1)):
            if body in static.free:
                i = 6 * static.free.index(body)
                total[i : i + 3] += sign * F
                total[i + 3 : i + 6] += sign * (T + np.cross(at - static.pose[body][0], F))
    for bodies, function in static.springs:
        places = static.places(bodies)
        total[places] -= static.gradient(function, bodies, np.zeros(len(places)))[0]
    pads = len(static.pads)
    total -= static.lam[-pads:] @ static.J[-pads:]
    for i, body in enumerate(static.free):
        check(f"{what}: on {names[body]}", total[6 * i : 6 * i + 6], np.zeros(6), 1e-10, SIZE)


SIZE = 1e3  # N, of springs at set-up


def against_statics(axle, bodies):
    model = os.path.join(models, "hatchback.veh")
    dump = c.json.loads(subprocess.run([gicgen, "--dump-model", model], capture_output=True, check=True).stdout)
    loads, places = rows_of(model, axle), rows_of(model, axle, None)
    static = Loads(dump, axle, bodies)
    for motion, travel in (("parallel", 0.0), ("parallel", 0.03), ("opposite", 0.03)):
        cases = {(r["load"], int(r["opposed"])): r for r in loads if r["motion"] == motion and abs(float(r["travel"]) - travel) < 1e-9}
        place = next(r for r in places if r["motion"] == motion and abs(float(r["travel"]) - travel) < 1e-9)
        static.pose = static.m.pose0
        for share in (0.5, 1.0):
            static.raise_pads([w.P(static.m.pose0)[2] * (1 - share) + share * float(place[w.name + ".contact_z"])
                               for w in static.v.wheels])
            static.settle()
        what = f"{axle}, {motion} {travel}"
        for name, value in static.carried(static.pose, static.lam).items():
            got = np.concatenate([vector(cases["springs", 0], name + ".force"), vector(cases["springs", 0], name + ".torque")])
            check(f"{what}: {name}", got, value, 1e-10, SIZE)
        on_each_body(what, static, cases["springs", 0], dump)
        for load in c.LOADS:
            for opposed in (0, 1):
                for name, value in static.change(load, opposed).items():
                    row = cases[load, opposed]
                    got = np.concatenate([vector(row, name + ".force"), vector(row, name + ".torque")])
                    check(f"{what}, {load} {opposed}: {name}", got, value, 1e-9, 1)
        for case, row in cases.items():
            if axle == "front":
                line = vector(cases["springs", 0], "teeth.force")  # along the rack, which rolls with the subframe
                line = line / np.linalg.norm(line) if np.linalg.norm(line) > 1e-3 else np.array([0.0, 1, 0])
                held = -0.0083 * np.copysign(1, line[1]) * (vector(row, "teeth.force") @ line)
                check(f"{what}, {case}: steering", float(row["holds"]), held, 1e-12, 1)


if __name__ == "__main__":
    on_paper()
    against_statics("rear", ["trail_l", "trail_r"])
    against_statics("front", ["subframe", "gear", "rack", *(b + s for b in ("arm", "strut", "lever") for s in ("_l", "_r"))])
    print(f"{passed} passed, {failed} failed; " + ", ".join(f"{e:.1e} of {t:g}" for t, e in sorted(worst.items())))
    sys.exit(failed > 0 or passed < 700)
