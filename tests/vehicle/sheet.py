# SPDX-License-Identifier: MIT
"""sheet.py GICGEN GICRUN MODEL WORK: numbers of `gicrun --sheet` found again: masses and inertias summed here over the bodies
of `gicgen --dump-model` at poses that `gicrun --eval` gives; loads from --equilibrium's state by --eval; eigenvalues of
--modes and the steady response of the matrices of --linearize, of a scene at the same speed."""
import csv
import json
import math
import os
import subprocess
import sys

import numpy as np

gicgen, gicrun, model, work = sys.argv[1:5]
failed = passed = 0


def run(*words):
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def check(what, mine, value, tolerance):
    global failed, passed
    if abs(mine - value) <= tolerance * max(1e-3, abs(value)):
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}: {mine!r}, found here {value!r}")


def rotation(p):
    e0, e = p[0], np.array(p[1:])
    K = np.array([[0, -e[2], e[1]], [e[2], 0, -e[0]], [-e[1], e[0], 0]])
    return (2 * e0 * e0 - 1) * np.eye(3) + 2 * (np.outer(e, e) + e0 * K)


sheet = {r["quantity"]: float(r["value"]) for r in csv.DictReader(run(gicrun, "--sheet", "-q", model, "-o", "-").splitlines())}
dump = json.loads(run(gicgen, "--dump-model", model))
tires = bool(dump["tires"])
speed = 20 if tires else 0
scene = os.path.join(work, "straight.scene")
neutral = ", gear: 0" if dump.get("powertrain") else ""  # as sheets look at motion
with open(scene, "w") as f:
    f.write(f"gicscene: 1\nduration: 1\nstep: 0.001\n" + (f"initial: {{speed: {speed}{neutral}}}\n" if tires else ""))
states = os.path.join(work, "rest.csv")
run(gicrun, "--equilibrium", "-q", model, scene, "-o", states)
at = next(csv.DictReader(run(gicrun, "--eval", states, model).splitlines()))
at = {k.split(" [")[0]: float(v) for k, v in at.items() if v and v != "ok"}


def pose(body):
    r = np.array([at[f"{body}.{c}"] for c in "xyz"])
    return r, rotation([at[f"{body}.e{i}"] for i in range(4)])


bodies = dump["bodies"]
base, base0 = pose(bodies[0]["name"]), (np.array(bodies[0]["position"]), rotation(bodies[0]["euler"]))
T = base0[1] @ base[1].T  # world to the axes of the drawing
m = np.array([b["mass"] for b in bodies])
com = np.array([base0[0] + T @ (pose(b["name"])[0] + pose(b["name"])[1] @ np.array(b["com"]) - base[0]) for b in bodies])
centre = m @ com / m.sum()
I = np.zeros((3, 3))
for b, x in zip(bodies, com):
    xx, yy, zz, xy, xz, yz = b["inertia"]
    R = T @ pose(b["name"])[1]
    d = x - centre
    I += R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T + b["mass"] * (d @ d * np.eye(3) - np.outer(d, d))
for w in dump["wheels"]:
    if w["tire"] is not None:
        s = T @ pose(bodies[w["body"]]["name"])[1] @ np.array(w["axis"], float)
        I += w["spin_inertia"] * np.outer(s, s)
check("mass", sheet["mass"], m.sum(), 1e-14)
for i, c in enumerate("xyz"):
    check("com_" + c, sheet["com_" + c], centre[i], 1e-9)
for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
    name = "inertia_" + "xyz"[i] + "xyz"[j]
    check(name, sheet[name], I[i, j], 1e-9 if i == j else 1e-6)

# loads: gravity, moments about the axles, and the sum
g = -dump["gravity"][2]
check("load", sheet["load"], m.sum() * g, 1e-9)
check("loads", sum(v for k, v in sheet.items() if k.endswith(".load") and k not in ("front.load", "rear.load")), m.sum() * g, 1e-9)
check("axles", sheet["front.load"] + sheet["rear.load"], m.sum() * g, 1e-9)
check("shares", sheet["front.share"] + sheet["rear.share"], 1, 1e-12)
check("height", sheet["com_height"], (m @ np.array([(pose(b["name"])[0] + pose(b["name"])[1] @ np.array(b["com"]))[2]
                                                     for b in bodies])) / m.sum(), 1e-9)
# contacts at the distance of the wheels' centres, to what tires and toe move them
front = [w for w in dump["wheels"] if "_f_" in w["name"]]
rear = [w for w in dump["wheels"] if "_r_" in w["name"]]
x = [np.mean([(base0[0] + T @ (pose(bodies[w["body"]]["name"])[0] + pose(bodies[w["body"]]["name"])[1] @ np.array(w["center"])
      - base[0]))[0] for w in group]) for group in (front, rear)]
check("wheelbase", sheet["wheelbase"], x[0] - x[1], 1e-6)
# the torque of an idling engine on wheels that are held moves load
check("front share by moments", sheet["front.share"], (centre[0] - x[1]) / (x[0] - x[1]), 1e-2 if tires else 1e-3)

# small motions: the same as --modes
modes = list(csv.DictReader(run(gicrun, "--modes", "-q", model, scene, "-o", "-").splitlines()))
k = 0
for r in modes:
    if not r["share.z"]:
        continue
    k += 1
    if r["frequency [Hz]"]:
        check(f"mode {k}", sheet[f"mode_{k}.frequency"], float(r["frequency [Hz]"]), 1e-6)
        check(f"damping {k}", sheet[f"mode_{k}.damping"], float(r["damping"]), 1e-6)
    else:
        check(f"eigenvalue {k}", sheet[f"mode_{k}.eigenvalue"], float(r["real [1/s]"]), 1e-6)

# the steady response, from the file of --linearize
if f"at_{speed}.understeer" in sheet:
    npz = os.path.join(work, "linear.npz")
    run(gicrun, "--linearize", "-q", model, scene, "-o", npz)
    data = np.load(npz)
    names = [str(n) for n in data["states"]]
    inputs = [str(n) for n in data["inputs"]]
    A, B = data["A"], data["B"]
    places = names.index("x.rate")
    out = {0, 1, 5, places}
    kept = [i for i in range(len(names)) if i not in out and np.any(A[i]) and np.any(A[:, i])]
    z = np.zeros(len(names))
    z[kept] = np.linalg.solve(A[np.ix_(kept, kept)], -B[kept, inputs.index("rack")])
    r = z[places + 5]
    kc = list(csv.DictReader(run(gicrun, "--kc", "-q", "--axle", "front", model, "-o", "-").splitlines()))
    delta = r / sheet[f"at_{speed}.yaw_gain"]
    # the ratio at rest, near that of set-up
    zero = next(1 / float(row["steering_ratio [m/rad]"]) for row in kc if row["motion"] == "steer" and abs(float(row["rack [m]"])) < 1e-9)
    check("steer angle by the rack", delta, zero, 5e-3)
    check("understeer", sheet[f"at_{speed}.understeer"], delta / (speed * r) - sheet["wheelbase"] / speed**2, 1e-5)
    check("roll gradient", sheet[f"at_{speed}.roll_gradient"], z[3] / (speed * r), 1e-5)
    slip = (z[places + 1] + r * (centre[0] - base0[0][0])) / speed
    check("side-slip gradient", sheet[f"at_{speed}.sideslip_gradient"], slip / (speed * r), 1e-5)
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0 or passed < 20)
