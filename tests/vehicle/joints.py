# SPDX-License-Identifier: MIT
"""joints.py GICGEN GICRUN MODELS WORK: `gicrun --kc --joints`. Axles against the equilibrium of all bodies by themselves:
positions are those of the independent kinematics of kinematics.py, the equations of joints have one multiplier each, the
wheels' pads a vertical force, and the virtual work of all that acts is 0 in each body's six displacements. The front
corner of the Formula Student car by the statics of one upright from hard points. A rack with levers in nice numbers."""
import csv
import json
import os
import subprocess
import sys

import kinematics as k
import numpy as np

gicgen, gicrun, models, work = (os.path.abspath(a) for a in sys.argv[1:])
failed = seen = 0
worst = {}
LOADS = ("lateral", "longitudinal", "aligning", "hub_longitudinal", "hub_lateral", "hub_vertical")


def check(what, mine, value, tolerance, size=1.0):
    global failed, seen
    error = float(np.max(abs(np.array(mine, float) - value))) / max(1, size)
    seen += 1
    worst[tolerance] = max(worst.get(tolerance, 0), error)
    if not error <= tolerance:
        failed += 1
        print(f"FAILED: {what}: {mine!r}, independently {value!r}")


def rows_of(model, axle):
    said = subprocess.run([gicrun, "--kc", "--joints", "-q", "--axle", axle, model, "-o", "-"], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    return list(csv.DictReader(said.stdout.splitlines()))


def dump_of(model):
    return json.loads(subprocess.run([gicgen, "--dump-model", model], capture_output=True, check=True).stdout)


def vector(row, name):
    return np.array([float(row[f"{name}.{c}"]) for c in "xyz"])


def acting(load, wheel, pose, size):
    """Force and torque on the carrier at the wheel's centre."""
    way = {"lateral": [0, size, 0], "hub_lateral": [0, size, 0], "hub_vertical": [0, 0, size]}.get(load, [size, 0, 0])
    if load == "aligning":
        return np.zeros(3), np.array([0, 0, size])
    F = np.array(way, float)
    return F, np.zeros(3) if load.startswith("hub") else np.cross(wheel.P(pose) - wheel.c(pose), F)


class Statics:
    def __init__(self, v):
        self.v, self.m = v, v.m

    def on(self, body, at, F, T, pose):
        """Force at a point and torque, on the displacements of all bodies."""
        Q = np.zeros(6 * len(self.m.free))
        i = 6 * self.m.free.index(body)
        Q[i : i + 3], Q[i + 3 : i + 6] = F, T + np.cross(at - pose[body][0], F)
        return Q

    def gradient(self, f, bodies, pose):
        g = np.zeros(6 * len(self.m.free))
        for b in set(bodies) & set(self.m.free):
            for d in range(6):
                step = np.zeros(len(g), complex)
                i = 6 * self.m.free.index(b) + d
                step[i] = 1e-30j
                g[i] = np.imag(f(self.m.moved(pose, step))) / 1e-30
        return g

    def springs(self, pose):
        Q = np.zeros(6 * len(self.m.free))
        for f in self.m.dump["forces"]:
            c = self.v.coordinates[f["coordinate"]] if f["type"] == "coordinate" else None
            if c is not None and c not in self.v.own or not f["stiffness"]:
                continue  # along the steering, or of the other axle
            bodies = (c["a"], c["b"]) if c else (f["a"], f["b"])
            own = {w.name[-3:] for w in self.v.wheels}
            if c is None and f["name"][-3:] not in own:
                continue
            g = self.v.element(f)
            Q -= f["stiffness"] * (g(pose) - f["free"]) * self.gradient(g, bodies, pose)
        return Q

    def solve(self, pose, loads):
        """Reactions {joint: (force, torque)}, pads and what holds the steering, of several loads."""
        m, v = self.m, self.v
        held = [v.held(c) for c in v.other + ([v.steer] if v.steer else [])]
        J = m.jacobian(pose, held)
        pads = np.array([self.on(w.body, w.P(pose), np.array([0, 0, 1.0]), np.zeros(3), pose) for w in v.wheels])
        out = []
        for x in np.linalg.solve(np.concatenate([J, pads]).T, -np.array(loads).T).T:
            row, reactions = 0, {}
            for j in m.dump["joints"]:
                count = len(m.joint(pose, j))
                Q = x[row : row + count] @ J[row : row + count]
                row += count
                b, sign = (j["b"], 1) if j["b"] in m.free else (j["a"], -1)
                i = 6 * m.free.index(b)
                point = j["point_b"] if j["point_b"] is not None else [0, 0, 0]
                at = m.at(pose, j["b"], point)
                F = Q[i : i + 3]
                reactions[j["name"]] = sign * F, sign * (Q[i + 3 : i + 6] - np.cross(at - pose[b][0], F))
            out.append((reactions, x[-len(v.wheels) :], x[row + len(v.other)] if v.steer else 0))
        return out


def axle(model, name):
    v = k.Vehicle(dump_of(model), name)
    s = Statics(v)
    rows = rows_of(model, name)
    joints = [j for j in v.m.dump["joints"] if j["name"] + ".force.x" in rows[0]]
    assert len(joints) > 3
    positions = {}
    for r in rows:
        positions.setdefault((r["motion"], r["travel"], r["steering"]), {})[r["load"], int(r["opposed"])] = r
    some = [p for motion in ("parallel", "opposite", "steer") for p in [q for q in positions if q[0] == motion][3::9]]
    for p in some:
        cases = positions[p]
        motion, at = p[0], float(p[2] or 0) if p[0] == "steer" else float(p[1])
        steer = at if motion == "steer" else v.steer["initial"] if v.steer else 0

        def place(more=(0, 0)):
            travel = [(0 if motion == "steer" else at * (w.side if motion == "opposite" else 1)) + d for w, d in zip(v.wheels, more)]
            return v.m.solve(v.m.pose0, v.wanted(travel, steer))

        pose = place()
        loads, names = [s.springs(pose)], [("springs", 0)]
        for load in LOADS:
            for opposed in (0, 1):
                names.append((load, opposed))
                loads.append(sum(s.on(w.body, w.c(pose), *acting(load, w, pose, w.side if opposed else 1), pose) for w in v.wheels))
        for case, (reactions, pads, holds) in zip(names, s.solve(pose, loads)):
            row, size = cases[case], 1e3 if case[0] == "springs" else 1
            if row["holds"]:
                check(f"{model} {p} {case}: steering", float(row["holds"]), holds, 1e-10, size)
            for j in joints:
                F, T = reactions[j["name"]]
                check(f"{model} {p} {case}: {j['name']}", vector(row, j["name"] + ".force"), F, 1e-10, size)
                check(f"{model} {p} {case}: {j['name']} torque", vector(row, j["name"] + ".torque"), T, 1e-10, size)
                if j["type"] == "distance":
                    line = v.m.at(pose, j["a"], j["point_a"]) - v.m.at(pose, j["b"], j["point_b"])
                    check(f"{model} {p} {case}: {j['name']} tension", float(row[j["name"] + ".tension"]),
                          F @ line / np.linalg.norm(line), 1e-10, size)
        if p is some[1] or p is some[-2]:
            def springs(more):
                there = place(more)
                reactions, pads, _ = s.solve(there, [s.springs(there)])[0]
                return np.concatenate([pads] + [reactions[j["name"]][0] for j in joints])

            slopes = np.array([k.rate(lambda h, w=w: springs([h * (x is w) for x in v.wheels]), 2e-3) for w in v.wheels])
            n = len(v.wheels)
            for opposed in (0, 1):
                way = np.linalg.solve(slopes[:, :n].T, [w.side if opposed else 1 for w in v.wheels])
                for i, j in enumerate(joints):
                    check(f"{model} {p} vertical {opposed}: {j['name']}", vector(cases["vertical", opposed], j["name"] + ".force"),
                          (way @ slopes)[n + 3 * i : n + 3 * i + 3], 1e-7)


def upright():
    """One corner: the upright between ball joint, upper wishbone and tie rod, on its pad. The lower wishbone has no moment
    about its hinge; the upper one, without mass, passes a force in the plane of its hinge and of its ball joint."""
    import yaml

    with open(os.path.join(models, "formula_student.veh")) as text:
        points = {n: np.array(x, float) for n, x in yaml.safe_load(text)["points"].items()}
    row = {(r["load"], int(r["opposed"])): r for r in rows_of(os.path.join(models, "formula_student.veh"), "front")
           if r["motion"] == "steer" and float(r["steering"]) == 0}
    racks = {}
    for side, sign in (("l", 1), ("r", -1)):
        at = {n[2:-2]: x * [1, sign, 1] for n, x in points.items() if n.startswith("f_")}
        contact = at["hub"] - [0, 0, 0.2045]
        ball, top, rod = at["lower_out"], at["upper_out"], at["rod_out"]
        arm = top - at["upper_in"]
        arm /= np.linalg.norm(arm)
        hinge = np.array([0.25, 0, 0.010]) / np.hypot(0.25, 0.010)
        line = (at["rod_in"] - rod) / np.linalg.norm(at["rod_in"] - rod)
        below = np.array([0.28, 0, 0.001])
        for load in LOADS:
            for opposed in (0, 1):
                size = sign if opposed else 1
                F = np.array({"lateral": [0, 1, 0], "hub_lateral": [0, 1, 0], "hub_vertical": [0, 0, 1], "aligning": [0, 0, 0]}
                             .get(load, [1, 0, 0]), float) * size
                T = np.array([0, 0, size if load == "aligning" else 0.0])
                where = at["hub"] if load.startswith("hub") else contact
                # of unit forces at the ball joint, of the upper wishbone, of the tie rod's tension, of the pad
                units = [(e, ball) for e in np.eye(3)] + [(arm, top), (hinge, top), (line, rod), (np.array([0, 0, 1.0]), contact)]
                A = np.array([np.concatenate([f, np.cross(x, f)]) for f, x in units]).T
                moment = [below @ np.cross(ball - at["lower_in"], f) if i < 3 else 0 for i, (f, _) in enumerate(units)]
                x = np.linalg.solve(np.vstack([A, moment]), np.concatenate([-F, -T - np.cross(where, F), [0]]))
                said = row[load, opposed]
                check(f"upright {side} {load} {opposed}: ball", vector(said, f"front_ball_{side}.force"), x[:3], 1e-11)
                check(f"upright {side} {load} {opposed}: upper", vector(said, f"front_upper_{side}.force"), x[3] * arm + x[4] * hinge, 1e-11)
                check(f"upright {side} {load} {opposed}: rod", float(said[f"front_link_{side}.tension"]), x[5], 1e-11)
                racks[load, opposed] = racks.get((load, opposed), 0) - x[5] * line[1]
    for case, rack in racks.items():  # the rack moves -9.5 mm a radian; the steering wheel holds it
        check(f"rack {case}", float(row[case]["holds"]), -rack * -0.0095, 1e-12)
        teeth = vector(row[case], "teeth.force")  # on the steering wheel
        check(f"teeth {case}", teeth, [0, rack, 0], 1e-11)


def nice():
    """Vertical kingpins through the wheels' centres, levers of 0.12 m behind them: 1 N m on each wheel is 2 / 0.12 N."""
    rows = {(r["load"], int(r["opposed"])): r for r in rows_of(os.path.join(models, "tutorial", "6_steering.veh"), "front")
            if r["motion"] == "steer" and float(r["steering"]) == 0}
    for (load, opposed), row in rows.items():
        value = 2 / 0.12 if load == "aligning" and not opposed else 0
        check(f"levers {load} {opposed}", abs(float(row["holds"])), value, 1e-10)


one_sided = os.path.join(work, "one_sided_joints.veh")
with open(one_sided, "w") as f:
    f.write(f"gicgen: 1\nmodel: one_sided\ninclude: {models}/hmmwv.veh\npoints:\n  tierod_u_f_r: [1.42, -0.7, 0.51]\n"
            "  upper_u_f_r: [1.60, -0.73, 0.69]\n")
for file, name in (("hmmwv", "front"), ("hmmwv14", "rear"), ("five_link", "rear"), ("solid_axle", "rear")):
    axle(os.path.join(models, file + ".veh"), name)
axle(one_sided, "front")
upright()
nice()
print(f"{seen} numbers, {failed} off; " + ", ".join(f"{e:.1e} of {t:g}" for t, e in sorted(worst.items())))
sys.exit(failed > 0 or seen < 3000)
