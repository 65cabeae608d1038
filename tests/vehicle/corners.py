# SPDX-License-Identifier: MIT
"""corners.py GICRUN MODELS: front corners of the Formula Student car and of the HMMWV from their hard points alone, as a
designer draws them: two wishbones that turn about their hinges, the upright between their ball joints, a tie rod, a
pushrod with its rocker. scipy.optimize.root finds each position; rates are those of the same equations, whose derivatives
are complex steps. All rows of `gicrun --kc`, both sides, travel and steering, to 1e-12."""
import csv
import os
import subprocess
import sys

import numpy as np
import yaml
from kinematics import turned
from scipy.optimize import root

gicrun, models = sys.argv[1:]
FIRST = 1e-12
failed = seen = 0
worst = 0


def about(axis, at, angle, point):
    """A point turned about a line."""
    n = np.array(axis, float) / np.linalg.norm(axis)
    d = point - at
    return at + n * (n @ d) + np.cos(angle) * (d - n * (n @ d)) + np.sin(angle) * np.cross(n, d)


def points_of(*files):
    out = {}
    for f in files:
        with open(os.path.join(models, f)) as text:
            out |= yaml.safe_load(text)["points"]
    return {n: np.array(p, float) for n, p in out.items()}


def formula_student():
    p = points_of("formula_student.veh")
    names = {"lower_in": "f_lower_in", "lower_out": "f_lower_out", "upper_in": "f_upper_in", "upper_out": "f_upper_out",
             "rod_in": "f_rod_in", "rod_out": "f_rod_out", "hub": "f_hub", "push_out": "f_push_out", "push_in": "f_push_in",
             "rocker": "f_rocker", "spring_in": "f_spring_in", "spring_out": "f_spring_out"}
    return {n: p[f + "_l"] for n, f in names.items()} | {"lower_axis": [0.28, 0, 0.001], "upper_axis": [0.25, 0, 0.010]}


def hmmwv():
    p = points_of("parts/chassis.veh")
    names = {"lower_in": "hinge_f", "lower_out": "ball_f", "upper_in": "upper_c_f", "upper_out": "upper_u_f", "rod_in": "tierod_c_f",
             "rod_out": "tierod_u_f", "hub": "centre_f", "spring_in": "spring_c_f", "spring_out": "spring_a_f"}
    return {n: p[f + "_l"] for n, f in names.items()} | {"lower_axis": [1, 0, 0], "upper_axis": [0.2202992, -0.0317754, 0.0490626]}


class Corner:
    """The left one. Unknowns: angles of both wishbones, three of the upright, the rocker's where there is a pushrod."""

    def __init__(self, points, radius):
        self.p, self.R = points, radius
        self.n = 6 if "rocker" in points else 5

    def place(self, x):
        p = self.p
        ball = about(p["lower_axis"], p["lower_in"], x[0], p["lower_out"])
        A = turned(np.array(x[2:5]))
        return ball, A, lambda point: ball + A @ (point - p["lower_out"])

    def equations(self, x, rise, rack):
        p = self.p
        _, _, carried = self.place(x)
        inner = p["rod_in"] + np.array([0, 1, 0]) * rack
        rod = carried(p["rod_out"]) - inner
        drawn = p["rod_out"] - p["rod_in"]
        out = list(carried(p["upper_out"]) - about(p["upper_axis"], p["upper_in"], x[1], p["upper_out"]))
        out += [rod @ rod - drawn @ drawn, carried(p["hub"])[2] - p["hub"][2] - rise]
        if self.n == 6:
            d = about([1, 0, 0], p["rocker"], x[5], p["push_in"]) - about(p["lower_axis"], p["lower_in"], x[0], p["push_out"])
            d0 = p["push_in"] - p["push_out"]
            out.append(d @ d - d0 @ d0)
        return np.array(out)

    def slopes(self, function, x):
        return np.array([np.imag(function(x + 1e-30j * e)) / 1e-30 for e in np.eye(self.n)]).T

    def solve(self, rise, rack, near):
        f = lambda x: self.equations(x, rise, rack)
        found = root(f, near, jac=lambda x: self.slopes(f, x.astype(complex)), tol=1e-13).x
        for _ in range(2):  # to the last digit
            found = found - np.linalg.solve(self.slopes(f, found.astype(complex)), np.real(f(found)))
        return found

    def look(self, x):
        p = self.p
        _, A, carried = self.place(x)
        s, c = A @ np.array([0.0, 1, 0]), carried(p["hub"])
        down = np.array([0, 0, 1]) - s[2] * s
        contact = c - self.R * down / np.sqrt(down @ down)
        spring = about([1, 0, 0], p["rocker"], x[5], p["spring_out"]) if self.n == 6 else \
            about(p["lower_axis"], p["lower_in"], x[0], p["spring_out"])
        d = spring - p["spring_in"]
        return {"camber": -np.arcsin(s[2]), "steer": np.arctan(-s[0] / s[1]), "toe": np.arctan(s[0] / s[1]),
                "centre_x": c[0] - p["hub"][0], "centre_y": c[1] - p["hub"][1], "contact_x": contact[0], "contact_y": contact[1],
                "contact_z": contact[2], "spring": np.sqrt(d @ d)}

    def rate(self, x, rise, rack, way):
        """Of what look() says, along a rate of (rise, rack)."""
        f = lambda y: self.equations(y, rise, rack)
        by = np.imag(self.equations(x.astype(complex), rise + 1e-30j * way[0], rack + 1e-30j * way[1])) / 1e-30
        d = -np.linalg.solve(self.slopes(f, x.astype(complex)), by)
        return {n: np.imag(v) / 1e-30 for n, v in self.look(x + 1e-30j * d).items()}

    def kingpin(self, x):
        """The line through both ball joints, where it meets the heights of contact and centre."""
        p = self.p
        ball, A, carried = self.place(x)
        top = carried(p["upper_out"])
        u, s, c = top - ball, A @ np.array([0.0, 1, 0]), carried(p["hub"])
        look = self.look(x)
        P = np.array([look["contact_x"], look["contact_y"], look["contact_z"]])
        ahead = np.array([s[1], -s[0], 0]) / np.hypot(s[0], s[1])
        left = np.array([s[0], s[1], 0]) / np.hypot(s[0], s[1])
        g, h = (ball + u * (at[2] - ball[2]) / u[2] - at for at in (P, c))
        return {"kingpin_inclination": np.arctan2(-u[1], u[2]), "caster": np.arctan2(-u[0], u[2]), "scrub_radius": -g @ left,
                "caster_trail": g @ ahead, "kingpin_offset": -h @ left, "caster_offset": h @ ahead}


def check(what, mine, value):
    global failed, seen, worst
    error = abs(mine - value) / max(1, abs(value))
    seen += 1
    worst = max(worst, error)
    if not error <= FIRST:
        failed += 1
        print(f"FAILED: {what}: {mine!r}, by hard points {value!r}")


def compare(model, points, radius, wheel, spring, steering, ratio):
    corner = Corner(points, radius)
    said = subprocess.run([gicrun, "--kc", "-q", "--axle", "front", os.path.join(models, model), "-o", "-"],
                          capture_output=True, text=True, check=True)
    rows = [{n.split(" [")[0]: x for n, x in r.items()} for r in csv.DictReader(said.stdout.splitlines())]
    for row in rows:
        motion, at = row["motion"], float(row[steering])
        for side, sign in (("_l", 1), ("_r", -1)):
            rise = 0 if motion == "steer" else float(row["travel"]) * (sign if motion == "opposite" else 1)
            rack = sign * ratio * at  # on the right in the mirror
            x = corner.solve(rise, rack, np.zeros(corner.n))
            own = corner.look(x) | corner.kingpin(x)
            along = corner.rate(x, rise, rack, (0, sign * ratio) if motion == "steer" else (1, 0))
            own["camber_rate"], own["toe_rate"] = along["camber"], along["toe"]
            own[f"ratio.{spring}{side}"] = corner.rate(x, rise, rack, (1, 0))["spring"]
            del own["spring"]
            for name, value in own.items():
                mirrored = sign < 0 and name in ("steer", "centre_y", "contact_y")
                check(f"{model} {motion} {row['travel']} {at:g} {side}: {name}", float(row[f"{wheel}{side}.{name}"]),
                      -value if mirrored else value)


compare("formula_student.veh", formula_student(), 0.2045, "front_tire", "front_spring", "steering", -0.0095)
compare("hmmwv.veh", hmmwv(), 0.4699, "tire_f", "spring_f", "rack", 1)
print(f"to {worst:.1e}")
print(f"{seen} passed, {failed} failed")
sys.exit(failed > 0 or seen < 6000)
