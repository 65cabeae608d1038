# SPDX-License-Identifier: MIT
"""compliance.py GICGEN GICRUN MODELS WORK: `gicrun --kc --loads`. The steering of hmmwv.veh, whose rack is free on a spring,
against the independent kinematics of kinematics.py: the rack's stiffness by differences of the springs' generalized force
while contacts keep their heights, and virtual work of each load. A vertical kingpin in closed form. Reciprocity: what a
load a does along a load b, b does along a."""
import csv
import json
import os
import subprocess
import sys

import kinematics as k
import numpy as np

gicgen, gicrun, models, work = sys.argv[1:5]
failed = passed = 0


def check(what, mine, value, tolerance):
    global failed, passed
    if abs(mine - value) <= tolerance:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}: {mine!r}, independently {value!r}")


def given(model):
    said = subprocess.run([gicrun, "--kc", "--loads", "--axle", "front", model, "-o", "-"], capture_output=True, text=True)
    assert said.returncode == 0, said.stderr
    return {(r["load"], int(r["opposed"]), r["wheel"]):
            {n: float(r[n]) for n in r if n not in ("axle", "load", "wheel", "unit")}
            for r in csv.DictReader(said.stdout.splitlines())}


hmmwv = os.path.join(models, "hmmwv.veh")
mine = given(hmmwv)
v = k.Vehicle(json.loads(subprocess.run([gicgen, "--dump-model", hmmwv], capture_output=True, check=True).stdout), "front")
heights = [w.P(v.m.pose0)[2] for w in v.wheels]


def at(rack):
    return v.m.solve(v.m.pose0, v.wanted(heights, rack, True))


def motion(pose):
    wanted = v.wanted(heights, 0, True)
    return v.m.rates(pose, wanted, [[0] * len(v.other) + [1] + [0] * len(v.wheels)])[0]


def force(rack):
    pose = at(rack)
    d, Q = motion(pose), 0
    for f in v.m.dump["forces"]:
        g = v.element(f)
        Q -= f["stiffness"] * (g(pose) - f["free"]) * np.imag(g(v.m.moved(pose, 1e-30j * d))) / 1e-30
    return Q


pose = at(0)
d = motion(pose)
stiffness = -k.rate(force, 2e-3)
for load in ("lateral", "longitudinal", "aligning", "hub_longitudinal"):
    for opposed in (0, 1):
        power = 0
        for w in v.wheels:
            c, om = w.along(pose, d, w.c), w.omega(d)
            locked = c + np.cross(om, w.P(pose) - w.c(pose))
            one = {"lateral": locked[1], "longitudinal": locked[0], "aligning": om[2], "hub_longitudinal": c[0]}[load]
            power += one * (w.side if opposed else 1)
        rack = power / stiffness
        for w in v.wheels:
            row = mine[load, opposed, w.name]
            check(f"{load} {opposed} steer", row["steer"], rack * w.along(pose, d, w.steer), 1e-8 * abs(row["steer"]) + 1e-16)
            check(f"{load} {opposed} camber", row["camber"], rack * w.along(pose, d, w.camber), 1e-8 * abs(row["camber"]) + 1e-16)
            check(f"{load} {opposed} centre", row["centre_x"], rack * w.along(pose, d, w.c)[0], 1e-8 * abs(row["centre_x"]) + 1e-16)

# reciprocity, in phase and opposed
along = {"lateral": "contact_y", "longitudinal": "contact_x", "aligning": "steer", "hub_longitudinal": "centre_x"}


def work_of(a, opposed_a, b, opposed_b):
    return sum(mine[a, opposed_a, w.name][along[b]] * (w.side if opposed_b else 1) for w in v.wheels)


for a in along:
    for b in along:
        for oa in (0, 1):
            for ob in (0, 1):
                if "aligning" in (a, b):
                    continue  # the steer angle is not the angle of turning about z where wheels lean
                x, y = work_of(a, oa, b, ob), work_of(b, ob, a, oa)
                check(f"{a} {oa} along {b} {ob}", x, y, 1e-12 * abs(x) + 1e-18)

# a rack on a spring of 50 kN/m, levers of 0.12 m to vertical kingpins through the wheels' centres
name = os.path.join(work, "free_rack.veh")
with open(name, "w") as f:
    f.write(f"""gicgen: 1
model: free_rack
include: {models}/tutorial/6_steering.veh
coordinates:
  rack: {{type: translation, bodies: [chassis, rack], axis: [0, 1, 0], range: [-0.05, 0.05]}}
forces:
  rack: {{type: spring_damper, coordinate: rack, stiffness: 50000}}
""")
for (load, opposed, wheel), row in given(name).items():
    side = 1 if wheel.endswith("_l") else -1
    expected = 2 / (50000 * 0.12**2) if load == "aligning" and not opposed else 0
    check(f"kingpin, {load} {opposed}: steer of {wheel}", row["steer"], expected, 1e-14)
    check(f"kingpin, {load} {opposed}: toe of {wheel}", row["toe"], -side * expected, 1e-14)
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0 or passed < 90)
