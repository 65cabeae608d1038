# SPDX-License-Identifier: MIT
"""steered_axles.py GICRUN LINEAR WORK: a car with linear tires, steered in front, behind, and by both axles. In the bicycle model
its understeer gradient is one and the same, (1 / 10 - 1 / 12.5) / g, and the yaw rate by the steer angle V / (L + K V^2), where the
angle is that of the front axle less that of the rear one. Steering that makes no curve is told by what it does."""
import csv
import math
import pathlib
import subprocess
import sys

gicrun, linear, work = sys.argv[1], pathlib.Path(sys.argv[2]).read_text(), pathlib.Path(sys.argv[3])
g, L = 9.81, 2.6
K = (1 / 10 - 1 / 12.5) / g


def once(text, *changes):
    for old, new in changes:
        assert text.count(old) == 1, (old, text.count(old))
        text = text.replace(old, new)
    return text


rear_steerers = (
    ("  rear_l: {mass", "  back_l: {mass: 1, com: [-1.4, 0.75, 0.3], inertia: [0.1, 0.1, 0.1]}\n  rear_l: {mass"),
    ("  rear_l: {type: prismatic, bodies: [chassis, rear_l], axis: [0, 0, 1]}",
     "  pin_l: {type: revolute, bodies: [chassis, back_l], point: [-1.4, 0.75, 0.3], axis: [0, 0, 1]}\n"
     "  rear_l: {type: prismatic, bodies: [back_l, rear_l], axis: [0, 0, 1]}\n"
     "  join: {type: distance, bodies: [back_l, back_r], points: [[-1.6, 0.75, 0.3], [-1.6, -0.75, 0.3]]}"),
    ("  r_l: {type: translation, bodies: [chassis, rear_l]", "  r_l: {type: translation, bodies: [back_l, rear_l]"),
)


def both(arm):
    """A rod from the left front steerer, 0.2 m outward of its kingpin, to the rear one `arm` outward of it."""
    rod = f"  rod: {{type: distance, bodies: [steerer_l, back_l], points: [[1.2, 0.95, 0.3], [-1.4, {0.75 + arm}, 0.3]]}}\n"
    return once(linear, *rear_steerers, ("coordinates:\n", rod + "coordinates:\n"))


def only_behind():
    text = once(linear, *rear_steerers,
                ("  steer: {type: angle, bodies: [chassis, steerer_l]", "  steer: {type: angle, bodies: [chassis, back_l]"),
                ("  king_l: {type: revolute, bodies: [chassis, steerer_l], point: [1.2, 0.75, 0.3], axis: [0, 0, 1]}\n", ""),
                ("  steerer_l: {mass: 1, com: [1.2, 0.75, 0.3], inertia: [0.1, 0.1, 0.1]}\n", ""),
                ("  tie: {type: distance, bodies: [steerer_l, steerer_r], points: [[1, 0.75, 0.3], [1, -0.75, 0.3]]}\n", ""))
    return text.replace("bodies: [steerer_l, knuckle_l]", "bodies: [chassis, knuckle_l]")


def sheet(name, text, *words):
    path = work / f"{name}.veh"
    path.write_text(text)
    out = subprocess.run([gicrun, "--sheet", str(path), "-o", str(work / "sheet.csv")], capture_output=True, text=True)
    assert out.returncode == 0, out.stderr
    with open(work / "sheet.csv") as f:
        return {r["quantity"]: float(r["value"]) for r in csv.DictReader(f)}, out.stderr


gains = {}
for name, text in ("front", linear), ("behind", only_behind()), ("against", both(-0.2)), ("half", both(-0.4)), ("part", both(0.4)):
    numbers, said = sheet(name, text)
    assert "not there: cornering" not in said, said
    for v in 10, 20, 30:
        gain, under = numbers[f"at_{v}.yaw_gain"], numbers[f"at_{v}.understeer"]
        # the wheels' spin, which the bicycle model does not have, and loads that are not quite those of the drawing
        assert abs(gain / (v / (L + K * v * v)) - 1) < 1e-3, (name, v, gain, v / (L + K * v * v))
        assert abs(under - K) < 5e-3 * K, (name, v, under, K)
        gains.setdefault(v, []).append(gain)
    print(f"{name}: yaw gain at 20 m/s {numbers['at_20.yaw_gain']:.6f} 1/s")
for v, of in gains.items(): # one bicycle: nothing but the mass of the steerers differs
    assert max(of) - min(of) < 1e-4 * max(of), (v, of)

for name, text, what in (
        ("alike", both(0.2), "not there: cornering: steer steers axles front and rear alike, by which the vehicle goes aside"),
        ("opposed", once(linear, ("[[1, 0.75, 0.3], [1, -0.75, 0.3]]", "[[1, 0.75, 0.3], [1.4, -0.75, 0.3]]")),
         "not there: cornering: steer steers the wheels of axle front against each other: their mean angle does not change")):
    numbers, said = sheet(name, text)
    assert what in said and "one axle" not in said, (name, said)
    assert not any(q.endswith("yaw_gain") for q in numbers)
    out = subprocess.run([gicrun, "--manoeuvre", "step-steer", str(work / f"{name}.veh"), "ay=2"], capture_output=True, text=True)
    assert out.returncode == 1 and what.split("cornering: ")[1] in out.stderr, out.stderr
    print(f"{name}: told")

# ---- the curve of wheels that steer behind, in front, and by more than a quarter turn's worth of the inner one ------------------


def curve(r, axle, fixed):
    """Radius and error of the inner wheel from contacts and steer angles alone: the centre is where the outer wheel's axis meets the
    line x = fixed, and lies to the left where the wheels ahead of that line are turned to the left."""
    wheel = [[float(r[f"{w}.{c}"]) for c in ("steer [rad]", "contact_x [m]", "contact_y [m]")] for w in axle]

    def centre(w):
        return w[2] + (w[1] - fixed) / math.tan(w[0])  # its axis is along (-sin, cos)
    left_turn = centre(wheel[0]) > wheel[0][2]
    outer, inner = (wheel[1], wheel[0]) if left_turn else (wheel[0], wheel[1])
    to = [fixed - inner[1], centre(outer) - inner[2]]
    # the inner wheel's axis points to the centre when the wheel has turned by the angle between its axis straight ahead and `to`
    ideal = math.acos((to[1] if left_turn else -to[1]) / math.hypot(*to))
    return math.hypot(outer[1] - fixed, outer[2] - centre(outer)), abs(inner[0]) - ideal


def curves(text, axle, wheels, fixed, name):
    path = work / f"{name}.veh"
    path.write_text(text)
    subprocess.run([gicrun, "--kc", "-q", "--axle", axle, str(path), "-o", str(work / "kc.csv")], check=True)
    seen = 0
    with open(work / "kc.csv") as f:
        for r in csv.DictReader(f):
            if r["motion"] != "steer" or not r["turning_radius [m]"]:
                continue
            radius, error = curve(r, wheels, fixed)
            assert abs(float(r["turning_radius [m]"]) - radius) < 1e-9 * radius, (name, r["turning_radius [m]"], radius)
            assert abs(float(r["ackermann_error [rad]"]) - error) < 1e-9, (name, r["ackermann_error [rad]"], error)
            seen += 1
    assert seen > 10, seen
    print(f"{name}: {seen} curves")


x_of = {"front": 1.2, "rear": -1.4}
curves(linear, "front", ("f_l", "f_r"), x_of["rear"], "curve in front")
curves(only_behind(), "rear", ("r_l", "r_r"), x_of["front"], "curve behind")
curves(once(linear, ("range: [-0.5, 0.5]", "range: [-1.2, 1.2]")), "front", ("f_l", "f_r"), x_of["rear"], "curve of 1.2 rad")
