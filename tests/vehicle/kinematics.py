# SPDX-License-Identifier: MIT
"""kinematics.py GICGEN GICRUN MODEL AXLE: the CSV of `gicrun --kc` against an independent solution.

Nothing of the program's own kinematics is used: the mechanism is taken from `gicgen --dump-model`, the equations of joints
and coordinates are written here after FORMAT.md sections 4 and 5, positions are found by Newton's method in all bodies'
six displacements at once, with the wheels' travel among the equations, and velocities from the Jacobian, whose entries
are complex steps (exact to rounding). Quantities follow models/KC.md. Wheel and roll rates are
differences of forces, Richardson's extrapolation of central ones.
"""
import csv
import json
import math
import subprocess
import sys

import numpy as np
FIRST = 1e-12  # positions, angles and first derivatives, relative to 1 m, 1 rad or their own size
SECOND = 2e-8  # rates of forces


def rotation(p):
    e0, e = p[0], np.array(p[1:])
    return (2 * e0 * e0 - 1) * np.eye(3) + 2 * (np.outer(e, e) + e0 * skew(e))


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def turned(theta):
    """Rotation by a small vector, analytic in it: Euler parameters (1, theta/2), normalized."""
    n = 1 / np.sqrt(1 + (theta[0] ** 2 + theta[1] ** 2 + theta[2] ** 2) / 4)
    e0, e = n, theta * (n / 2)
    return (2 * e0 * e0 - 1) * np.eye(3) + 2 * (np.outer(e, e) + e0 * skew(e))


def across(u):
    """Two directions perpendicular to u."""
    a = np.eye(3)[np.argmin(abs(u))]
    v = np.cross(u, a)
    v /= np.linalg.norm(v)
    return v, np.cross(u, v)


class Mechanism:
    def __init__(self, dump):
        self.dump = dump
        self.bodies = dump["bodies"]
        self.first = 1  # the base is held, or is ground
        self.pose0 = [(np.array(b["position"], float), rotation(b["euler"])) for b in self.bodies]
        self.free = list(range(self.first, len(self.bodies)))

    def pose(self, pose, i):
        return (np.zeros(3), np.eye(3)) if i < 0 else pose[i]

    def moved(self, pose, delta):
        out = list(pose)
        for k, i in enumerate(self.free):
            r, A = pose[i]
            d = delta[6 * k : 6 * k + 6]
            out[i] = (r + d[:3], turned(d[3:]) @ A)
        return out

    def at(self, pose, i, point):
        r, A = self.pose(pose, i)
        return r + A @ np.array(point, float)

    def joint(self, pose, j):
        a, b = j["a"], j["b"]
        Aa, Ab = self.pose(pose, a)[1], self.pose(pose, b)[1]
        apart = None
        if j["point_a"] is not None:
            apart = self.at(pose, b, j["point_b"]) - self.at(pose, a, j["point_a"])

        def parallel():
            v, w = across(np.array(j["axis_a"], float))
            u = Ab @ np.array(j["axis_b"], float)
            return [(Aa @ v) @ u, (Aa @ w) @ u]

        def on_line():
            v, w = across(np.array(j["axis_a"], float))
            return [(Aa @ v) @ apart, (Aa @ w) @ apart]

        def same():
            A0, B0 = self.pose(self.pose0, a)[1], self.pose(self.pose0, b)[1]
            R = Aa.T @ Ab @ (A0.T @ B0).T
            return [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]

        kind = j["type"]
        if kind == "revolute":
            return list(apart) + parallel()
        if kind == "spherical":
            return list(apart)
        if kind == "prismatic":
            return same() + on_line()
        if kind == "cylindrical":
            return parallel() + on_line()
        if kind == "universal":
            return list(apart) + [(Aa @ np.array(j["axis_a"])) @ (Ab @ np.array(j["axis_b"]))]
        if kind == "fixed":
            return list(apart) + same()
        if kind == "distance":
            return [np.sqrt(apart @ apart) - j["length"]]
        if kind == "revolute_spherical":
            return [np.sqrt(apart @ apart) - j["length"], (Aa @ np.array(j["axis_a"], float)) @ apart - j["offset"]]
        if kind == "point_on_line":
            return on_line()
        if kind == "point_in_plane":
            return [(Aa @ np.array(j["axis_a"], float)) @ apart]
        if kind == "parallel":
            return parallel()
        raise ValueError(kind)

    def coordinate(self, pose, c):
        a, b = c["a"], c["b"]
        if c["type"] == "length":
            d = self.at(pose, b, c["point_b"]) - self.at(pose, a, c["point_a"])
            return np.sqrt(d @ d)
        if c["type"] == "translation":
            u = np.array(c["axis_a"], float)
            d = [
                self.pose(p, a)[1] @ u @ (self.at(p, b, c["point_b"]) - self.at(p, a, c["point_a"]))
                for p in (pose, self.pose0)
            ]
            return d[0] - d[1] + c["design"]
        raise ValueError(c["type"])

    def pieces(self, wanted):
        """The equations: functions of the pose, and the bodies that they look at."""
        out = [((j["a"], j["b"]), lambda pose, j=j: self.joint(pose, j)) for j in self.dump["joints"]]
        return out + [(bodies, lambda pose, f=f, x=x: [f(pose) - x]) for f, x, bodies in wanted]

    def residual(self, pose, wanted):
        return np.concatenate([np.array(f(pose)) for _, f in self.pieces(wanted)])

    def jacobian(self, pose, wanted):
        rows = []
        for bodies, f in self.pieces(wanted):
            block = np.zeros((len(f(pose)), 6 * len(self.free)))
            for k, i in enumerate(self.free):
                for d in range(6) if i in bodies else ():
                    step = np.zeros(6, complex)
                    step[d] = 1e-30j
                    near = list(pose)
                    near[i] = (pose[i][0] + step[:3], turned(step[3:]) @ pose[i][1])
                    block[:, 6 * k + d] = np.imag(np.array(f(near))) / 1e-30
            rows.append(block)
        return np.concatenate(rows)

    def solve(self, pose, wanted):
        for _ in range(20):
            missing = self.residual(pose, wanted)
            if np.max(abs(missing)) < 2e-16:
                break
            step = np.linalg.solve(self.jacobian(pose, wanted), missing)
            pose = self.moved(pose, -step)
            if np.max(abs(step)) < 1e-14:
                break
        assert np.max(abs(self.residual(pose, wanted))) < 1e-14, "the independent solution did not converge"
        return pose

    def rates(self, pose, wanted, values):
        """Displacements a unit of time where the wanted functions change by these values, one set after another."""
        J = self.jacobian(pose, wanted)
        b = np.zeros((J.shape[0], len(values)))
        b[J.shape[0] - len(wanted) :] = np.array(values, float).T
        return np.linalg.solve(J, b).T


class Wheel:
    def __init__(self, m, w):
        self.m, self.name, self.body, self.centre = m, w["name"], w["body"], np.array(w["center"], float)
        r, A = m.pose0[self.body]
        if w["axis"]:
            u = np.array(w["axis"], float)
            self.axis = u if (A @ u)[1] > 0 else -u
        else:
            self.axis = A.T @ np.array([0.0, 1, 0])
        tire = w["tire"]
        self.R = m.dump["tires"][tire]["radius"] if tire is not None else w["radius"]
        self.x0 = m.at(m.pose0, self.body, self.centre)
        self.side = 1 if self.x0[1] >= 0 else -1

    def c(self, pose):
        return self.m.at(pose, self.body, self.centre)

    def s(self, pose):
        return pose[self.body][1] @ self.axis

    def P(self, pose):
        s = self.s(pose)
        n = np.array([0, 0, 1]) - s[2] * s
        return self.c(pose) - self.R * n / np.sqrt(n @ n)

    def camber(self, pose):
        return -self.side * np.arcsin(self.s(pose)[2])

    def steer(self, pose):
        s = self.s(pose)
        return np.arctan(-s[0] / s[1])

    def along(self, pose, rates, function):
        """Rate of a function of the pose."""
        return np.imag(function(self.m.moved(pose, 1e-30j * rates))) / 1e-30

    def omega(self, rates):
        k = self.m.free.index(self.body)
        return rates[6 * k + 3 : 6 * k + 6]


class Vehicle:
    def __init__(self, dump, axle):
        self.m = Mechanism(dump)
        wheels = [Wheel(self.m, w) for w in dump["wheels"]]
        xs = [w.x0[0] for w in wheels]
        self.ahead = 1 if axle != "rear" else -1
        chosen = max(xs) if axle != "rear" else min(xs)
        self.wheels = [w for w in wheels if abs(w.x0[0] - chosen) < 0.1]
        self.all = wheels
        self.coordinates = dump["coordinates"]
        ground = np.mean([w.P(self.m.pose0)[2] for w in wheels])
        mass = sum(b["mass"] for b in dump["bodies"])
        com = sum(b["mass"] * self.m.at(self.m.pose0, i, b["com"])[2] for i, b in enumerate(dump["bodies"])) / mass
        self.height = com - ground
        self.L = max(xs) - min(xs)
        # which coordinates belong to the other axle, by their point; the rack steers
        self.steer = next((c for c in self.coordinates if c["name"] == "rack"), None)
        own = {w.name[-3:] for w in self.wheels}
        self.own = [c for c in self.coordinates if c["name"][-3:] in own]
        self.other = [c for c in self.coordinates if c not in self.own and c is not self.steer]
        self.z0 = [w.x0[2] for w in self.wheels]

    def held(self, c):
        return (lambda pose: self.m.coordinate(pose, c)), c["initial"], (c["a"], c["b"])

    def wanted(self, travel, steer, contacts=False):
        """Other coordinates as they are, then steering, then the heights of the wheels' centres or contacts."""
        out = [self.held(c) for c in self.other]
        if self.steer:
            out.append((self.held(self.steer)[0], steer, (self.steer["a"], self.steer["b"])))
        for w, z, s in zip(self.wheels, self.z0, travel):
            f = (lambda pose, w=w: w.P(pose)[2]) if contacts else (lambda pose, w=w: w.c(pose)[2])
            out.append((f, s if contacts else z + s, (w.body,)))
        return out

    def element(self, f):
        if f["type"] == "coordinate":
            return lambda p: self.m.coordinate(p, self.coordinates[f["coordinate"]])
        assert f["type"] == "points"

        def length(p):
            x = self.m.at(p, f["b"], f["point_b"]) - self.m.at(p, f["a"], f["point_a"])
            return np.sqrt(x @ x)

        return length

    def forces(self, pose):
        """Vertical forces at the contacts that hold the springs, by virtual work."""
        F = np.zeros(len(self.wheels))
        for a, d in enumerate(self.by_contact(pose, np.eye(len(self.wheels)))):
            for f in self.m.dump["forces"]:
                if f["stiffness"]:
                    g = self.element(f)
                    F[a] += f["stiffness"] * (g(pose) - f["free"]) * np.imag(g(self.m.moved(pose, 1e-30j * d))) / 1e-30
        return F

    def by_contact(self, pose, ways):
        wanted = self.wanted([0] * len(self.wheels), 0, True)
        return self.m.rates(pose, wanted, [[0] * (len(wanted) - len(self.wheels)) + list(vz) for vz in ways])

    def by_centre(self, pose, ways):
        """Each of ways: the rate of steering, and of the centres' heights."""
        skip = 0 if self.steer else 1
        return self.m.rates(pose, self.wanted([0] * len(self.wheels), 0), [[0] * len(self.other) + w[skip:] for w in ways])

    def by_steer(self, pose):
        """The steering moves, and all other coordinates are held."""
        wanted = [self.held(c) for c in self.other + self.own + [self.steer]]
        return self.m.rates(pose, wanted, [[0] * (len(wanted) - 1) + [1]])[0]


def quantities(v, pose, motion):
    """Of models/KC.md: a dictionary of columns and values."""
    n = len(v.wheels)
    out = {}
    vz = [w.side if motion == "opposite" else 1 for w in v.wheels]
    travel, steered = v.by_centre(pose, [[0] + vz, [1] + [0] * n])
    along = steered if motion == "steer" else travel
    P = [w.P(pose) for w in v.wheels]
    brake = drive = 0
    for w in v.wheels:
        name = w.name + "."
        c, s, p = w.c(pose), w.s(pose), w.P(pose)
        own = 1 if motion == "steer" else w.along(pose, along, w.c)[2]
        out[name + "travel"] = c[2] - w.x0[2]
        out[name + "camber"] = w.camber(pose)
        out[name + "steer"] = w.steer(pose)
        out[name + "toe"] = -w.side * w.steer(pose)
        out[name + "camber_rate"] = w.along(pose, along, w.camber) / own
        out[name + "toe_rate"] = -w.side * w.along(pose, along, w.steer) / own
        out[name + "centre_x"], out[name + "centre_y"] = (c - w.x0)[:2]
        out[name + "contact_x"], out[name + "contact_y"], out[name + "contact_z"] = p
        dP, dc, om = w.along(pose, travel, w.P), w.along(pose, travel, w.c), w.omega(travel)
        locked = dc + np.cross(om, p - c)
        # reciprocals of lengths, which may be infinite
        out[name + "1/front_arm"] = w.side * om[0] / dP[2]
        out[name + "front_angle"] = w.side * math.atan(dP[1] / dP[2])
        out[name + "1/side_arm"] = -v.ahead * om[1] / locked[2]
        out[name + "side_angle"] = out[name + "brake_angle"] = v.ahead * math.atan(locked[0] / locked[2])
        out[name + "drive_angle"] = v.ahead * math.atan(dc[0] / dc[2])
        brake += v.ahead * locked[0] / locked[2] / n
        drive += v.ahead * dc[0] / dc[2] / n
    if len(v.all) > n:
        out["anti_brake"], out["anti_drive"] = brake * v.L / v.height, drive * v.L / v.height
    turn = v.by_steer(pose) if v.steer else None
    if v.steer and abs(v.wheels[0].omega(turn)[2]) > 1e-6:
        for w in v.wheels:
            om, dc = w.omega(turn), w.along(pose, turn, w.c)
            c, p, s = w.c(pose), w.P(pose), w.s(pose)
            u = om / np.linalg.norm(om) * np.sign(om[2])
            a = c + np.cross(om, dc) / (om @ om)
            ahead = np.cross(s, [0, 0, 1])
            ahead /= np.linalg.norm(ahead)
            left = np.cross([0, 0, 1], ahead)
            g, h = (a + u * (z - a[2]) / u[2] for z in (p[2], c[2]))
            out[w.name + ".kingpin_inclination"] = math.atan(-w.side * u[1] / u[2])
            out[w.name + ".caster"] = math.atan(-u[0] / u[2])
            out[w.name + ".scrub_radius"] = w.side * (p - g) @ left
            out[w.name + ".caster_trail"] = (g - p) @ ahead
            out[w.name + ".kingpin_offset"] = w.side * (c - h) @ left
            out[w.name + ".caster_offset"] = (h - c) @ ahead
    l, r = [next(w for w in v.wheels if w.side == side) for side in (1, -1)]
    roll = v.by_contact(pose, [[p[1] for p in P]])[0]
    vl, vr = (w.along(pose, roll, w.P) for w in (l, r))
    pl, pr = l.P(pose), r.P(pose)
    out["track"] = pl[1] - pr[1]
    out["track_rate"] = (l.along(pose, along, l.P) - r.along(pose, along, r.P))[1]
    out["roll_centre_force"] = np.mean([w.along(pose, roll, w.P)[1] for w in v.wheels])
    # the normals of both velocities meet: (x - p) . v = 0 in the plane of y and z
    y, z = np.linalg.solve([vl[1:], vr[1:]], [pl[1:] @ vl[1:], pr[1:] @ vr[1:]])
    out["roll_centre_height"], out["roll_centre_y"] = z - (pl[2] + pr[2]) / 2, y
    for i, w in enumerate(v.wheels):
        d = v.by_centre(pose, [[0] + list(np.eye(n)[i])])[0]
        for f in v.m.dump["forces"]:
            out[f"{w.name}.ratio.{f['name']}"] = np.imag(v.element(f)(v.m.moved(pose, 1e-30j * d))) / 1e-30
    force = v.forces(pose)
    for w, f in zip(v.wheels, force):
        out[w.name + ".force"] = f
    if motion == "steer":
        dl, dr = l.along(pose, along, l.steer), r.along(pose, along, r.steer)
        out["mean_steer"] = (l.steer(pose) + r.steer(pose)) / 2
        out["steering_ratio"] = 2 / (dl + dr)
        if abs(out["mean_steer"]) > 2e-3 and len(v.all) > n:
            xr = np.mean([w.P(v.m.pose0)[0] for w in v.all if w not in v.wheels])
            # steered to the left ahead of that line it turns to the left, behind it to the right
            left_turn = out["mean_steer"] * (l.P(pose)[0] - xr) > 0
            inner, outer = (l, r) if left_turn else (r, l)
            po, pi = outer.P(pose), inner.P(pose)
            # the centre: on the outer wheel's axis and on the other axle's line
            t = (xr - po[0]) / -math.sin(outer.steer(pose))
            middle = po[:2] + t * np.array([-math.sin(outer.steer(pose)), math.cos(outer.steer(pose))])
            # the angle from straight ahead (astern) to the perpendicular of the line from the inner contact to the centre
            to = middle - pi[:2]
            ideal = math.acos((to[1] if left_turn else -to[1]) / np.hypot(*to))
            di, do = abs(inner.steer(pose)), abs(outer.steer(pose))
            out["turning_radius"] = np.hypot(*(middle - po[:2]))
            out["ackermann_error"] = di - ideal
            out["ackermann"] = (di - do) / (ideal - do)
    return out


def rate(function, h):
    """Derivative at 0 by two central differences."""
    d = [(function(k) - function(-k)) / (2 * k) for k in (h, h / 2)]
    return (4 * d[1] - d[0]) / 3


def main():
    gicgen, gicrun, model, axle = sys.argv[1:5]
    dump = json.loads(subprocess.run([gicgen, "--dump-model", model], check=True, capture_output=True).stdout)
    said = subprocess.run([gicrun, "--kc", "-q", "--axle", axle, model, "-o", "-"], check=True, capture_output=True, text=True)
    rows = [{k.split(" [")[0]: x for k, x in row.items()} for row in csv.DictReader(said.stdout.splitlines())]
    v = Vehicle(dump, axle)
    worst = {}
    failed = 0
    seen = 0
    for motion in ("parallel", "opposite", "steer"):
        some = [r for r in rows if r["motion"] == motion]
        for r in some[:: max(1, len(some) // 5)]:
            at = float(r["rack"]) if motion == "steer" else float(r["travel"])
            steer = at if motion == "steer" else v.steer["initial"] if v.steer else 0
            travel = [0 if motion == "steer" else at * (w.side if motion == "opposite" else 1) for w in v.wheels]
            pose = v.m.solve(v.m.pose0, v.wanted(travel, steer))
            for name, value in quantities(v, pose, motion).items():
                mine = 1 / float(r[name.replace("1/", "")]) if "1/" in name else float(r[name])
                error = abs(mine - value) / max(1, abs(value))
                if name.startswith("ackermann"):
                    error /= 1e3  # a small difference of angles is divided by another
                worst[name] = max(worst.get(name, 0), error)
                seen += 1
                if not error <= FIRST * (10 if name.endswith("force") and "roll" not in name else 1):
                    print(f"FAIL {motion} {at:g}: {name}: {mine!r}, independently {value!r}")
                    failed += 1
            if motion == "steer" or r is some[0] or r is some[-1]:
                continue

            # rates of forces along the motion, and in roll
            def along(k):
                t = [x + k * (w.side if motion == "opposite" else 1) for x, w in zip(travel, v.wheels)]
                p = v.m.solve(pose, v.wanted(t, steer))
                return v.forces(p), np.array([w.P(p)[2] for w in v.wheels])

            df = rate(lambda k: along(k)[0], 2e-3)
            dz = rate(lambda k: along(k)[1], 2e-3)
            for w, value in zip(v.wheels, df / dz):
                error = abs(float(r[w.name + ".wheel_rate"]) / value - 1)
                worst["wheel_rate"] = max(worst.get("wheel_rate", 0), error)
                seen += 1
                if not error <= SECOND:
                    print(f"FAIL {motion} {at:g}: {w.name}.wheel_rate: {r[w.name + '.wheel_rate']}, independently {value!r}")
                    failed += 1
            P = [w.P(pose) for w in v.wheels]

            def rolled(k):
                return v.forces(v.m.solve(pose, v.wanted([p[2] + k * p[1] for p in P], steer, True)))

            value = sum(p[1] * f for p, f in zip(P, rate(rolled, 2e-3)))
            error = abs(float(r["roll_rate"]) / value - 1)
            worst["roll_rate"] = max(worst.get("roll_rate", 0), error)
            seen += 1
            if not error <= SECOND:
                print(f"FAIL {motion} {at:g}: roll_rate: {r['roll_rate']}, independently {value!r}")
                failed += 1
    first = max(x for name, x in worst.items() if not name.endswith("_rate") or name[0] == "t")
    print(f"{seen} numbers, {failed} off; largest difference {first:.1e}, of rates of forces "
          f"{max(worst['wheel_rate'], worst['roll_rate']):.1e}")
    return failed > 0 or seen < 100


if __name__ == "__main__":
    sys.exit(main())
