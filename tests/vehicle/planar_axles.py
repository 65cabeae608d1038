# SPDX-License-Identifier: MIT
"""planar_axles.py GICRUN WORK: axles of planar double wishbones, hinged about x, against constructions with lines and
circles: poles where the lines of the arms meet, roll centres where the lines from contacts through poles meet; trailing arms and
kingpins by their hinges. Nice
numbers among them: equal, parallel, level arms, one a quarter of a turn down, upright kingpins."""
import csv
import math
import os
import subprocess
import sys

R = 0.3

WISHBONES = """gicgen: 1
model: wishbones
base: chassis
%(parameters)s
bodies:
  chassis: {mass: 800, com: [0, 0, 0.5], inertia: [200, 800, 800]}
  arm_l: {mass: 5, com: [0, 0.5, 0.2], inertia: [0.1, 0.1, 0.1]}
  hub_l: {mass: 20, com: [0, 0.7, 0.3], inertia: [1, 1, 1]}
points:
  lower_c_l: [0, %(lcy)s, %(lcz)s]
  lower_u_l: [0, %(luy)s, %(luz)s]
  upper_c_l: [0, %(ucy)s, %(ucz)s]
  upper_u_l: [0, %(uuy)s, %(uuz)s]
joints:
  hinge_l: {type: revolute, bodies: [chassis, arm_l], point: lower_c_l, axis: [1, 0, 0]}
  knee_l: {type: revolute, bodies: [arm_l, hub_l], point: lower_u_l, axis: [1, 0, 0]}
  upper_l: {type: distance, bodies: [chassis, hub_l], points: [upper_c_l, upper_u_l]}
coordinates:
  turn_l: {type: angle, bodies: [chassis, arm_l], axis: [1, 0, 0], range: [-0.4, 0.4]}
forces:
  spring_l: {type: spring_damper, coordinate: turn_l, stiffness: 8000}
wheels:
  tire_l: {body: hub_l, center: [0, 0.75, 0.3], radius: 0.3, stiffness: 200000}
"""

failed = passed = 0


def check(what, is_right):
    global failed, passed
    if is_right:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}")


def near(a, b, tolerance=1e-12):
    return a == b or abs(a - b) <= tolerance * max(1, abs(b))


def study(gicrun, work, name, text, *more, scene=None):
    path = os.path.join(work, name + ".veh")
    with open(path, "w") as f:
        f.write(text)
    said = subprocess.run([gicrun, "--kc", "-q", *more, path, *([scene] if scene else []), "-o", "-"],
                          capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    assert "nan" not in said.stdout
    return [{k.split(" [")[0]: x for k, x in r.items()} for r in csv.DictReader(said.stdout.splitlines())]


def meet(p, u, q, v):
    """Where lines p + t u and q + t v meet; None: parallel."""
    det = u[0] * -v[1] + v[0] * u[1]
    if abs(det) < 1e-13:
        return None
    t = ((q[0] - p[0]) * -v[1] + v[0] * (q[1] - p[1])) / det
    return p[0] + t * u[0], p[1] + t * u[1]


def circles(c, r, d, s, towards):
    """Where circles meet, at the point nearer to `towards`."""
    dx, dy = d[0] - c[0], d[1] - c[1]
    e = math.hypot(dx, dy)
    a = (r * r - s * s + e * e) / (2 * e)
    h = math.sqrt(r * r - a * a)
    found = [(c[0] + (a * dx - w * h * dy) / e, c[1] + (a * dy + w * h * dx) / e) for w in (1, -1)]
    return min(found, key=lambda p: math.dist(p, towards))


class Corner:
    """The left one, at an angle of its lower arm; all of it in y and z."""

    def __init__(self, p, angle):
        lc, lu, uc, uu = ((p[k + "y"], p[k + "z"]) for k in ("lc", "lu", "uc", "uu"))
        c, s = math.cos(angle), math.sin(angle)
        d = (lu[0] - lc[0], lu[1] - lc[1])
        self.lc, self.uc = lc, uc
        self.lu = (lc[0] + c * d[0] - s * d[1], lc[1] + s * d[0] + c * d[1])
        self.uu = circles(uc, math.dist(uc, uu), self.lu, math.dist(lu, uu), (uu[0], uu[1] + self.lu[1] - lu[1]))
        before = math.atan2(uu[1] - lu[1], uu[0] - lu[0])
        self.lean = math.atan2(self.uu[1] - self.lu[1], self.uu[0] - self.lu[0]) - before
        c, s = math.cos(self.lean), math.sin(self.lean)
        d = (0.75 - lu[0], 0.3 - lu[1])
        self.centre = (self.lu[0] + c * d[0] - s * d[1], self.lu[1] + s * d[0] + c * d[1])
        # the lowest point of a disc that leans: its radius along the wheel plane
        self.contact = (self.centre[0] + R * math.sin(self.lean), self.centre[1] - R * math.cos(self.lean))
        along = (self.lu[0] - lc[0], self.lu[1] - lc[1])
        self.pole = meet(lc, along, uc, (self.uu[0] - uc[0], self.uu[1] - uc[1]))
        # the line from the contact through the pole, or parallel to the arms
        self.line = (self.pole[0] - self.contact[0], self.pole[1] - self.contact[1]) if self.pole else along


def angle_for(p, travel):
    low, high = -0.39, 0.39
    for _ in range(200):
        middle = (low + high) / 2
        if Corner(p, middle).centre[1] - 0.3 < travel:
            low = middle
        else:
            high = middle
    return (low + high) / 2


def mirrored(point):
    return -point[0], point[1]


def compare(gicrun, work, name, p):
    rows = study(gicrun, work, name, WISHBONES % {**p, "parameters": ""}, "--travel", "0.05")
    for row in rows:
        travel = float(row["travel"])
        if row["motion"] not in ("parallel", "opposite") or abs(travel) not in (0, 0.025, 0.05):
            continue
        left = Corner(p, angle_for(p, travel))
        right = Corner(p, angle_for(p, -travel if row["motion"] == "opposite" else travel))
        where = f"{name}, {row['motion']} {travel:g}"
        check(f"{where}: camber", near(float(row["tire_l.camber"]), left.lean * -1, 1e-11)
              and near(float(row["tire_r.camber"]), right.lean * -1, 1e-11))
        arm = float(row["tire_l.front_arm"])
        # the pole inboard of the contact is positive
        check(f"{where}: swing arm {arm!r}",
              near(1 / arm, 1 / (left.contact[0] - left.pole[0]) if left.pole else 0, 1e-10))
        slope = left.line[1] / left.line[0]
        check(f"{where}: its angle", near(math.tan(float(row["tire_l.front_angle"])), -slope, 1e-10))
        centre = meet(left.contact, left.line, mirrored(right.contact), mirrored(right.line))
        ground = (left.contact[1] + right.contact[1]) / 2
        height, side = float(row["roll_centre_height"]), float(row["roll_centre_y"])
        if centre:
            check(f"{where}: roll centre {height!r} {side!r}, not {centre[1] - ground!r} {centre[0]!r}",
                  near(height, centre[1] - ground, 1e-9) and near(side, centre[0], 1e-9))
        elif travel == 0 or row["motion"] == "parallel":
            check(f"{where}: roll centre on the ground", near(height, 0) and near(side, 0))
        else:
            check(f"{where}: roll centre at infinity", math.isinf(height) and math.isinf(side))
        tangents = [-c.line[1] / c.line[0] * c.contact[0] for c in (left, right)]
        check(f"{where}: roll centre by forces", near(float(row["roll_centre_force"]), sum(tangents) / 2, 1e-9))


TRAILING = """gicgen: 1
model: trailing
base: chassis
bodies:
  chassis: {mass: 800, com: [0, 0, 0.5], inertia: [200, 800, 800]}
  hub_l: {mass: 20, com: [0, 0.7, 0.3], inertia: [1, 1, 1]}
  back_l: {mass: 20, com: [-2, 0.7, 0.3], inertia: [1, 1, 1]}
joints:
  hinge_l: {type: revolute, bodies: [chassis, hub_l], point: [%(x)s, 0.75, %(z)s], axis: [%(u)s, %(v)s, 0]}
  back_l: {type: prismatic, bodies: [chassis, back_l], axis: [0, 0, 1]}
coordinates:
  turn_l: {type: angle, bodies: [chassis, hub_l], axis: [%(u)s, %(v)s, 0], range: [-0.4, 0.4]}
  back_l: {type: translation, bodies: [chassis, back_l], axis: [0, 0, 1], range: [-0.1, 0.1]}
forces:
  spring_l: {type: spring_damper, coordinate: turn_l, stiffness: 8000}
  back_l: {type: spring_damper, coordinate: back_l, stiffness: 20000, free: -0.1}
wheels:
  tire_l: {body: hub_l, center: [0, 0.75, 0.3], radius: 0.3, stiffness: 200000}
  back_l: {body: back_l, center: [-2, 0.75, 0.3], radius: 0.3, stiffness: 200000}
"""


def at_zero(rows, axle, motion="parallel"):
    return next(r for r in rows if r["axle"] == axle and r["motion"] == motion
                and abs(float(r["travel"])) < 1e-15 and abs(float(r.get("steer") or 0)) < 1e-15)


def trailing_arms(gicrun, work):
    """One hinge a wheel, 0.5 m ahead of it at its height or lower, across the vehicle, or at 45 degrees to it."""
    inf = math.inf
    # poles: across, in the side view at the hinge; at 45 degrees also in the front view, where the axis leaves the plane of
    # the wheel, 0.5 m inward or outward of it
    for name, x, z, u, v, arm, front in (("level", 0.5, 0.3, 0, 1, 0.5, inf), ("lower", 0.5, 0.1, 0, 1, 0.5, inf),
                                         ("semi", 0.5, 0.3, 1, 1, 0.5, 0.5), ("semi out", 0.5, 0.3, 1, -1, 0.5, -0.5),
                                         ("leading", -0.5, 0.3, 0, 1, -0.5, inf)):
        rows = study(gicrun, work, "trailing", TRAILING % {"x": x, "z": z, "u": u, "v": v})
        r, back = at_zero(rows, "front"), at_zero(rows, "rear")
        n = {k[7:]: float(y) for k, y in r.items() if k.startswith("tire_l.") and y}
        other = {k[7:]: float(y) for k, y in r.items() if k.startswith("tire_r.") and y}
        for what, x_, y_ in (("side arm", n["side_arm"], -arm), ("its angle", math.tan(n["side_angle"]), -z / arm),
                             ("angle of driving", math.tan(n["drive_angle"]), (0.3 - z) / arm),
                             ("front arm", 1 / n["front_arm"], 1 / front), ("camber", n["camber"], 0),
                             # about the pole at 45 degrees, the contact moves as the hinge's point in that view does
                             ("front angle", math.tan(n["front_angle"]), 0 if math.isinf(front) else 0.3 / front),
                             ("camber by travel", n["camber_rate"], -1 / front),
                             ("toe by travel", n["toe_rate"], 0),
                             ("roll centre", float(r["roll_centre_height"]), 0.75 * math.tan(n["front_angle"])),
                             ("by forces", float(r["roll_centre_force"]), 0.75 * math.tan(n["front_angle"])),
                             ("track by travel", float(r["track_rate"]), 2 * math.tan(n["front_angle"]) + 0),
                             ("wheel rate", n["wheel_rate"], float("nan"))):
            if not math.isnan(y_):
                check(f"trailing arm {name}: {what} {x_!r}, not {y_!r}", near(x_, y_, 1e-11))
        # 8000 N m/rad on a lever of 0.5 m, or of 0.5 / sqrt(2) m to an axis at 45 degrees
        check(f"trailing arm {name}: rate", near(n["wheel_rate"], 8000 / (0.25 if math.isinf(front) else 0.125), 1e-9))
        check(f"trailing arm {name}: left and right", all(near(abs(n[k]), abs(other[k]), 1e-11) for k in n if "ratio" not in k))
        check("a pillar: parallel, on the road", all(math.isinf(float(back[f"back_l.{k}"])) for k in ("front_arm", "side_arm"))
              and all(float(back[f"back_l.{k}"]) == 0 for k in ("front_angle", "side_angle", "drive_angle", "camber", "toe"))
              and float(back["roll_centre_height"]) == 0 == float(back["roll_centre_y"]) and float(back["track_rate"]) == 0)
    path = os.path.join(work, "trailing.veh")
    said = subprocess.run([gicrun, "--kc", path], capture_output=True, text=True).stdout
    check("parallel in tables", said.count(" parallel") >= 6 and "inf" not in said and "-0.0000" not in said)


def kingpins(gicrun, work):
    """A kingpin upright over the contact: all its numbers are 0; the same 0.1 m inward and 0.05 m ahead; leaning 1 in 10."""
    pins = TRAILING % {"x": 0.5, "z": 0.3, "u": 0, "v": 1}
    for dx, dy, lean, back in ((0, 0, 0, 0), (0.05, 0.1, 0, 0), (0, 0, 0.1, 0), (0, 0, 0, 0.1), (0.02, 0.05, 0.2, 0.1)):
        text = pins.replace("  back_l: {mass", "  pin_l: {mass: 2, com: [0, 0.7, 0.3], inertia: [1, 1, 1]}\n  back_l: {mass", 1)
        # the axis goes through the point (dx, 0.75 - dy) of the road and leans inward and backward
        text = text.replace("hinge_l: {type: revolute, bodies: [chassis, hub_l]", "slide_l: {type: prismatic, bodies: [chassis, pin_l]")
        text = text.replace(", point: [0.5, 0.75, 0.3], axis: [0, 1, 0]}\n", ", axis: [0, 0, 1]}\n"
                            f"  king_l: {{type: revolute, bodies: [pin_l, hub_l], point: [{dx}, {0.75 - dy}, 0], axis: [{-back}, {-lean}, 1]}}\n"
                            "  tie: {type: distance, bodies: [hub_l, hub_r], points: [[-0.2, 0.75, 0.3], [-0.2, -0.75, 0.3]]}\n", 1)
        text = text.replace("  turn_l: {type: angle, bodies: [chassis, hub_l], axis: [0, 1, 0], range: [-0.4, 0.4]}",
                            "  turn_l: {type: translation, bodies: [chassis, pin_l], axis: [0, 0, 1], range: [-0.1, 0.1]}\n"
                            f"  steer: {{type: angle, bodies: [pin_l, hub_l], axis: [{-back}, {-lean}, 1], range: [-0.3, 0.3], driven: true}}")
        r = at_zero(study(gicrun, work, "pins", text), "front")
        for k, y in (("kingpin_inclination", math.atan(lean)), ("caster", math.atan(back)), ("scrub_radius", dy),
                     ("caster_trail", dx), ("kingpin_offset", dy + 0.3 * lean), ("caster_offset", dx - 0.3 * back),
                     ("steer", 0), ("toe", 0), ("camber", 0)):
            for side in "tire_l.", "tire_r.":
                x = float(r[side + k])
                check(f"kingpin {dx, dy, lean, back}: {side}{k} {x!r}, not {y!r}", near(x, y) and (y or abs(x) < 1e-15))


def main():
    gicrun, work = sys.argv[1:]
    level = dict(lcy=0.25, lcz=0.2, luy=0.65, luz=0.2, ucy=0.25, ucz=0.4, uuy=0.65, uuz=0.4)
    compare(gicrun, work, "level", level)
    compare(gicrun, work, "inclined", {**level, "lcz": 0.15, "ucz": 0.35})
    compare(gicrun, work, "converging", {**level, "ucz": 0.35, "ucy": 0.35})
    compare(gicrun, work, "diverging", {**level, "ucz": 0.45, "lcz": 0.1})

    # the lower arm is a quarter of a turn down, the upper one level, so that their lines meet at right angles
    compare(gicrun, work, "quarter", {**level, "lcy": 0.65, "lcz": 0.45, "ucy": 0.25, "ucz": 0.4})
    trailing_arms(gicrun, work)
    kingpins(gicrun, work)

    # hard points by a scene are those of a file that has them
    tuned = "parameters: {height: {value: 0.4, tunable: true}}"
    scene = os.path.join(work, "tuned.scene")
    with open(scene, "w") as f:
        f.write("gicscene: 1\nduration: 1\nstep: 0.01\nparameters: {height: 0.35}\n")
    a = study(gicrun, work, "tuned", WISHBONES % {**level, "ucz": "height", "parameters": tuned}, scene=scene)
    b = study(gicrun, work, "written", WISHBONES % {**level, "ucz": 0.35, "parameters": ""})
    check("tuned hard points", len(a) == len(b) and all(near(float(x[k] or 0), float(y[k] or 0), 1e-9)
                                                        for x, y in zip(a, b) for k in x if k[0] not in "am"))

    # dual wheels are one wheel in the middle of them
    twins = WISHBONES.replace("center: [0, 0.75, 0.3]", "center: [0, 0.6, 0.3]")
    twins += "  twin_l: {body: hub_l, center: [0, 0.9, 0.3], radius: 0.3, stiffness: 200000}\n"
    a = study(gicrun, work, "single", WISHBONES % {**level, "ucz": 0.35, "parameters": ""})
    b = study(gicrun, work, "twins", twins % {**level, "ucz": 0.35, "parameters": ""})
    for x, y in zip(a, b):
        check("dual wheels", len(x) == len(y) and all(near(float(x[k]), float(y[k.replace("tire_l", "tire_l+twin_l").replace("tire_r", "tire_r+twin_r")]))
                                                      for k in x if x[k] and k not in ("axle", "motion")))
    check("rows of dual wheels", len(a) == len(b) > 80)

    # a sliding pillar: travel is the coordinate, and stops where its range ends
    pillar = WISHBONES[: WISHBONES.index("points:")] % {"parameters": ""}
    pillar = "\n".join(x for x in pillar.splitlines() if "arm_l" not in x) + """
joints:
  slide_l: {type: prismatic, bodies: [chassis, hub_l], axis: [0, 0, 1]}
coordinates:
  rise_l: {type: translation, bodies: [chassis, hub_l], axis: [0, 0, 1], range: [-0.03, 0.05]}
forces:
  spring_l: {type: spring_damper, coordinate: rise_l, stiffness: 20000, free: -0.1}
  bar_l: {type: force, coordinate: rise_l, value: "-5000 * (rise_l - rise_r)"}
  bar_r: {type: force, coordinate: rise_r, value: "-5000 * (rise_r - rise_l)"}
wheels:
  tire_l: {body: hub_l, center: [0, 0.75, 0.3], radius: 0.3, stiffness: 200000}
"""
    rows = study(gicrun, work, "pillar", pillar)
    parallel = [r for r in rows if r["motion"] == "parallel"]
    opposite = [r for r in rows if r["motion"] == "opposite"]
    ends = [[float(way[i]["travel"]) for i in (0, -1)] for way in (parallel, opposite)]
    check(f"ends of travel {ends}", all(near(x, y, 1e-9) for x, y in zip(ends[0] + ends[1], (-0.03, 0.05, -0.03, 0.03))))
    for r in parallel + opposite:
        one = float(r["travel"])
        other = one if r["motion"] == "parallel" else -one
        check("pillar: ratio and rates",
              near(float(r["tire_l.ratio.spring_l"]), 1) and float(r["tire_r.ratio.spring_l"]) == 0
              and near(float(r["tire_l.force"]), 20000 * (one + 0.1) + 5000 * (one - other), 1e-10)
              and near(float(r["tire_l.wheel_rate"]), 20000 if r["motion"] == "parallel" else 30000, 1e-10)
              and near(float(r["roll_rate"]), 2 * 30000 * 0.75 * 0.75, 1e-10)
              and math.isinf(float(r["tire_l.front_arm"])) and math.isinf(float(r["tire_l.side_arm"])))
    print(f"{passed} passed, {failed} failed")
    return failed > 0 or passed < 500


if __name__ == "__main__":
    sys.exit(main())
