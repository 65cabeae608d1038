# SPDX-License-Identifier: MIT
"""rubber_and_units.py GICRUN WORK: `gicrun --kc` of trailing arms on bushings, six coordinates each: stiff bushings move as
the hinge through both does, and numbers do not follow where the arms' frames stand, which is what their coordinates
mean. And of a car with a trailer on single wheels: numbers of the car are those that it has without the trailer."""
import csv
import os
import subprocess
import sys

gicrun, work = sys.argv[1:]
failed = passed = 0

CAR = """gicgen: 1
model: arms
base: car
bodies:
  car: {mass: 1000, com: [0, 0, 0.5], inertia: [300, 900, 1000]}
  arm_l: {mass: 20, com: [-1.3, 0.6, 0.3], inertia: [1, 1, 1]%(frame)s}
  front_l: {mass: 20, com: [1.2, 0.7, 0.3], inertia: [1, 1, 1], position: [1.2, 0.7, 0.3]}
%(bodies)s
points:
  inner_l: [-1, 0.3, 0.3]
  outer_l: [-0.9, 0.6, 0.35]
joints:
  slide_l: {type: cylindrical, bodies: [car, front_l], point: [1.2, 0.7, 0.3], axis: [0, 0, 1]}
  rack: {type: prismatic, bodies: [car, rack], point: [1.1, 0, 0.3], axis: [0, 1, 0]}
  tie_l: {type: distance, bodies: [rack, front_l], points: [[1.1, 0.4, 0.3], [1.1, 0.68, 0.3]]}
%(joints)s
coordinates:
  up_l: {type: translation, bodies: [car, front_l], axis: [0, 0, 1], range: [-0.1, 0.1]}
  rack: {type: translation, bodies: [car, rack], axis: [0, 1, 0], range: [-0.05, 0.05], driven: true}
%(coordinates)s
forces:
  front_l: {type: spring_damper, coordinate: up_l, stiffness: 20000}
  spring_l: {type: spring_damper, bodies: [car, arm_l], points: [[-1.2, 0.6, 0.7], [-1.25, 0.6, 0.3]], stiffness: 30000, free: 0.45}
%(forces)s
wheels:
  front_l: {body: front_l, center: [1.2, 0.7, 0.3], radius: 0.3, stiffness: 200000}
  rear_l: {body: arm_l, center: [-1.3, 0.7, 0.3], radius: 0.3, stiffness: 200000}
%(wheels)s
"""
RACK = "  rack: {mass: 5, com: [1.1, 0, 0.3], inertia: [0.1, 0.1, 0.1]}\n"
HINGE = {"joints": "  hinge_l: {type: revolute, bodies: [car, arm_l], point: inner_l, axis: [0.1, 0.3, 0.05]}",
         "coordinates": "  arm_l: {type: angle, bodies: [car, arm_l], axis: [0.1, 0.3, 0.05], range: [-0.4, 0.4]}"}
TRAILER = {"bodies": RACK + """  trailer: {mass: 500, com: [-3.5, 0, 0.5], inertia: [200, 400, 400]}
  beam: {mass: 40, com: [-4, 0, 0.3], inertia: [10, 1, 10], position: [-4, 0, 0.3]}""",
           "joints": HINGE["joints"] + """
  hitch: {type: revolute, bodies: [car, trailer], point: [-2, 0, 0.5], axis: [0, 0, 1]}
  pillar: {type: prismatic, bodies: [trailer, mount], point: [-4, 0, 0.3], axis: [0, 0, 1]}
  roll: {type: revolute, bodies: [mount, beam], point: [-4, 0, 0.3], axis: [1, 0, 0]}""",
           "coordinates": HINGE["coordinates"] + """
  tow: {type: angle, bodies: [car, trailer], axis: [0, 0, 1], range: [-1, 1]}
  heave: {type: translation, bodies: [trailer, mount], axis: [0, 0, 1], range: [-0.1, 0.1]}
  lean: {type: angle, bodies: [mount, beam], axis: [1, 0, 0], range: [-0.2, 0.2]}""",
           "forces": """  heave: {type: spring_damper, coordinate: heave, stiffness: 40000}
  lean: {type: spring_damper, coordinate: lean, stiffness: 20000}""",
           "wheels": "  trailer_l: {body: beam, center: [-4, 0.7, 0.3], radius: 0.3, stiffness: 200000}"}
TRAILER["bodies"] += "\n  mount: {mass: 5, com: [-4, 0, 0.3], inertia: [1, 1, 1]}"


def on_rubber(stiffness, turning, ends=("inner", "outer")):
    kinds = [("translation", "x", "1, 0, 0", 0.1), ("translation", "y", "0, 1, 0", 0.1), ("translation", "z", "0, 0, 1", 0.2),
             ("angle", "roll", "1, 0, 0", 0.4), ("angle", "pitch", "0, 1, 0", 0.6), ("angle", "yaw", "0, 0, 1", 0.4)]
    return {"coordinates": "\n".join(f"  {name}_l: {{type: {kind}, bodies: [car, arm_l], axis: [{axis}], range: [-{end}, {end}]}}"
                                     for kind, name, axis, end in kinds),
            "forces": "\n".join(f"  {end}_l: {{type: bushing, bodies: [car, arm_l], point: {end}_l, stiffness: "
                                f"[{stiffness}, {2 * stiffness}, {3 * stiffness}, {turning}, {turning}, {turning}]}}" for end in ends)}


def check(what, is_right, found=""):
    global failed, passed
    passed += bool(is_right)
    failed += not is_right
    if not is_right:
        print(f"FAILED: {what}: {found}")


def write(name, parts):
    path = os.path.join(work, name + ".veh")
    with open(path, "w") as f:
        f.write(CAR % {"frame": "", "bodies": RACK, "joints": "", "coordinates": "", "forces": "", "wheels": "", **parts})
    return path


def said(name, parts, *more):
    return subprocess.run([gicrun, "--kc", *more, write(name, parts)], capture_output=True, text=True)


def study(name, parts, *more):
    done = said(name, parts, "-q", *more, "-o", "-")
    assert done.returncode == 0, done.stderr
    return [{k.split(" [")[0]: x for k, x in r.items()} for r in csv.DictReader(done.stdout.splitlines())]


def worst(a, b, near=1):
    """The largest difference of rows that both have, over 1 or the number, and where."""
    most = (0, ())
    rows = {(r["axle"], r["motion"], r["travel"], r.get("rack")): r for r in b}
    for r in a:
        other = rows[r["axle"], r["motion"], r["travel"], r.get("rack")]
        for k, x in r.items():
            if k in ("axle", "motion") or not x or x == other.get(k) or k not in other or "arm" in k.split(".")[-1]:
                continue
            apart = abs(float(x) - float(other[k])) / max(near, abs(float(x)))
            most = max(most, (apart if apart == apart else 9, (k, r["motion"], r["travel"], x, other[k])))
    return most


rear = ("--axle", "rear", "--travel", "0.04")
hinged = study("hinged", HINGE, *rear)
check("41 rows of each motion", len(hinged) == 82, len(hinged))
stiff = study("stiff", on_rubber(1e11, 0), *rear)
most = worst(hinged, stiff)
check("stiff bushings are a hinge", most[0] < 1e-5, most)
soft = study("soft", on_rubber(3e5, 200), *rear)
most = worst(hinged, soft)
check("soft ones are not", most[0] > 1e-3, most)
for place in "inner_l", "[-1.3, 0.7, 0.3]", "[-0.5, 0.2, 0.6]":
    most = worst(soft, study("moved", {**on_rubber(3e5, 200), "frame": f", position: {place}"}, *rear))
    check(f"frames of the arms at {place}", most[0] < 1e-7, most)
turned = {**on_rubber(3e5, 200), "frame": ", position: [-1.3, 0.7, 0.3], orientation: {axis: [0, 0, 1], angle: 0.5}"}
most = worst(soft, study("turned", turned, *rear))
check("frames that are turned", most[0] < 1e-7, most)

# Rates of forces: what `force` does from row to row, by five of them; the error of that is of the fourth order in steps
# of 0.1 mm, some 1e-11, and rounding of `force` over these, some 1e-10. At the drawing alone: there the rubber bears
# nothing, whose forces would turn.
fine = study("fine", on_rubber(3e5, 200), "--axle", "rear", "--travel", "0.002")
for motion in "parallel", "opposite":
    row = [r for r in fine if r["motion"] == motion]
    zero = next(i for i, r in enumerate(row) if float(r["travel"]) == 0)
    for wheel in "rear_l", "rear_r":
        slope = {k: sum(c * float(row[zero + i][f"{wheel}.{k}"]) for c, i in ((1, -2), (-8, -1), (8, 1), (-1, 2)))
                 for k in ("force", "contact_z")}
        rate, seen = float(row[zero][f"{wheel}.wheel_rate"]), slope["force"] / slope["contact_z"]
        check(f"wheel rate of {wheel}, {motion}", abs(rate - seen) < 1e-8 * abs(seen) and seen > 1000, (rate, seen))
done = said("loose", on_rubber(3e5, 0, ("inner",)), "--axle", "rear")
check("one ball does not hold an arm", done.returncode == 1 and "does not hold all of" in done.stderr, done.stderr + done.stdout)
formula = on_rubber(3e5, 200)
formula["forces"] = formula["forces"].replace("inner_l: {type: bushing,", 'inner_l: {type: bushing, force: ["-1e5 * dx^3", 0, 0],')
done = said("formula", formula, "--axle", "rear")
check("a bushing with a formula", done.returncode == 1 and "has a formula" in done.stderr, done.stderr + done.stdout)

# a trailer: its axle does not steer by the hitch, and takes no part in the numbers of the car
alone, whole = study("alone", HINGE), study("whole", TRAILER)
check("three axles", sorted({r["axle"] for r in whole}) == ["axle_2", "front", "rear"])
check("the trailer is not steered by its hitch", not any(r["axle"] == "rear" and r["motion"] == "steer" for r in whole))
check("its axle is there", sum(r["axle"] == "rear" for r in whole) == 82)
for r in whole:
    r["axle"] = {"axle_2": "rear", "rear": "trailer"}.get(r["axle"], r["axle"])
car = [r for r in whole if r["axle"] != "trailer"]
check("all rows of the car", len(car) == len(alone), (len(car), len(alone)))
check("turning radius of the car", sum(bool(r["turning_radius"]) for r in car) > 30)
for r in car:
    check("no anti-dive with a trailer", not r["anti_brake"] and not r["anti_drive"])
most = worst(alone, [{k: x if k == "rack" else x or "nan" for k, x in r.items() if not k.startswith("anti")} for r in car])
check("numbers of the car", most[0] < 1e-12, most)
done = said("whole", TRAILER)
check("the trailer is told once", done.stdout.count("axle rear belongs to a unit that turns by 'tow'") == 1, done.stdout[-600:])
short = {**TRAILER, "coordinates": TRAILER["coordinates"].replace("[-1, 1]", "[-0.1, 0.1]")}
check("what turns by 0.2 rad is rubber", "belongs to a unit" not in said("short", short).stdout)
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0 or passed < 20)
