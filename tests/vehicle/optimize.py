# SPDX-License-Identifier: MIT
"""optimize.py GICRUN MODELS WORK: what `gicrun --optimize` finds. Where the motion is linear in what is looked for (knots of a
force on a mass, whose columns are differences of runs): bounded least squares and linear programs by scipy. Stiffness and
damping, and bump steer of the corner of a Formula Student car, by scipy's own search with runs of gicrun; the corner's hard
points found again by `--identify` from its curves of toe and camber, with noise too."""
import csv
import math
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares, linprog, lsq_linear

from counted import check, finish, near, runner

gicrun, models, work = sys.argv[1:4]
gic = runner(gicrun)


def optimize(formula, model, scene, *ranges):
    """start and end of the size; {variable: value}"""
    rows = list(csv.DictReader(gic("--optimize", formula, model, scene, *ranges, "-o", "-").splitlines()))
    return float(rows[0]["start"]), float(rows[0]["value"]), {r["variable"]: float(r["value"]) for r in rows[1:]}


def columns(model, scene, *names):
    rows = list(csv.reader(gic("-q", "--general", model, scene, "-o", "-").splitlines()))
    title = [name.split(" [")[0] for name in rows[0]]
    table = np.array([[float(x) for x in row] for row in rows[1:]])
    return table[:, [title.index(name) for name in names]]


# ---- a mass that a force with knots moves ----------------------------------------------------------------------------------------

spring = f"{work}/spring.veh"
Path(spring).write_text("""gicgen: 1
model: spring
gravity: [0, 0, 0]
base: ground
parameters:
  k: {value: 36, unit: N/m, tunable: true}
  c: {value: 2, unit: N s/m, tunable: true}
  m: {value: 4, unit: kg, tunable: true}
inputs:
  push: {unit: N}
bodies:
  cart: {mass: m, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-10, 10]}
forces:
  spring: {type: force, coordinate: x, value: "-k * x - c * rate(x) + push"}
outputs:
  cart: {type: position, body: cart}
""")
KNOTS = 6


def pushed(values):
    path = f"{work}/push.scene"
    Path(path).write_text("gicscene: 1\nduration: 3\nstep: 0.02\nintegrator: ab3\noutput_step: 0.06\n"
                          "initial: {coordinates: {x: 0.3}, rates: {x: -0.5}}\ninputs: {push: {knots: {times: "
                          f"{[0.5 * k for k in range(KNOTS)]}, values: {[float(v) for v in values]}}}}}}}\n")
    return path


rest = columns(spring, pushed([0] * KNOTS), "cart.x")[:, 0]
slope = np.column_stack([columns(spring, pushed([1.0 * (i == k) for i in range(KNOTS)]), "cart.x")[:, 0] - rest
                         for k in range(KNOTS)])
times = np.arange(len(rest)) * 0.06
goal = 0.1 * np.sin(2 * times)
formula = "cart.x - 0.1 * sin(2 * time)"
for reach in (1000, 3, 1):  # free, some bounds, nearly all of them
    ranges = [f"input/push[{k}]={-reach}:{reach}" for k in range(KNOTS)]
    start, end, found = optimize(formula, spring, pushed([0.5] * KNOTS), *ranges)
    want = lsq_linear(slope, goal - rest, (-reach, reach), tol=1e-14)
    size = math.sqrt(2 * want.cost / len(rest))
    held = sum(abs(x) > reach * (1 - 1e-9) for x in found.values())
    check(f"least squares within {reach}: some stand at a bound, {held}", (held > 0) == (reach < 1000))
    near(f"least squares within {reach}: the size", end, size, 1e-9)
    for k in range(KNOTS):
        near(f"least squares within {reach}: knot {k}", found[f"input/push[{k}]"], want.x[k], 1e-4)
    # the least largest magnitude is a linear program
    start, end, found = optimize(f"maximum({formula})", spring, pushed([0.5] * KNOTS), *ranges)
    one = np.ones((len(rest), 1))
    program = linprog([0] * KNOTS + [1], np.block([[slope, -one], [-slope, -one]]), np.concatenate([goal - rest, rest - goal]),
                      bounds=[(-reach, reach)] * KNOTS + [(0, None)])
    least = program.fun
    check(f"largest magnitude within {reach}: {end}, at least {least}", least * (1 - 1e-9) <= end < 1.07 * least)
    size = np.abs(rest + slope @ [found[f"input/push[{k}]"] for k in range(KNOTS)] - goal).max()
    near(f"largest magnitude within {reach}: that of a run", end, size, 1e-9)
two = optimize(f"{formula}; 0.05 * rate(x)", spring, pushed([0.5] * KNOTS), *[f"input/push[{k}]=-3:3" for k in range(KNOTS)])
check(f"two formulas count together: {two[:2]}", two[1] < two[0])

# ---- a parameter, by scipy with runs of gicrun --------------------------------------------------------------------------------------


def ringing(k, c):
    path = f"{work}/ring.scene"
    Path(path).write_text("gicscene: 1\nduration: 3\nstep: 0.02\nintegrator: rk4\noutput_step: 0.06\n"
                          f"initial: {{coordinates: {{x: 1}}}}\nparameters: {{k: {k!r}, c: {c!r}}}\n")
    return path


wish = "cart.x - exp(-time)"
start, end, found = optimize(wish, spring, ringing(36.0, 2.0), "parameter/k=1:100", "parameter/c=0:40")
other = least_squares(lambda p: columns(spring, ringing(*map(float, p)), "cart.x")[:, 0] - np.exp(-times), [20, 10], jac="3-point",
                      bounds=([1, 0], [100, 40]), xtol=1e-12, ftol=1e-12, gtol=1e-12)
near("stiffness", found["parameter/k"], other.x[0], 1e-3 * other.x[0])
near("damping", found["parameter/c"], other.x[1], 1e-3 * other.x[1])
near("what is left", end, math.sqrt(2 * other.cost / len(times)), 1e-6)

# ---- the same where a condition, whose time follows the numbers, starts a push of another size; `--identify` finds planted ones


def pushed_later(k, c):
    path = ringing(k, c)
    with open(path, "a") as f:
        f.write('inputs: {push: 0.5}\nwhen: [{if: "cart.x < 0.2", inputs: {push: {step: {to: 30, rise: 0.4}}}}]\n')
    return path


start, end, found = optimize(wish, spring, pushed_later(36.0, 2.0), "parameter/k=1:100", "parameter/c=0:40")
other = least_squares(lambda p: columns(spring, pushed_later(*map(float, p)), "cart.x")[:, 0] - np.exp(-times), [36, 2],
                      jac="3-point", bounds=([1, 0], [100, 40]), xtol=1e-12, ftol=1e-12, gtol=1e-12)
near("when: stiffness", found["parameter/k"], other.x[0], 1e-3 * other.x[0])
near("when: damping", found["parameter/c"], other.x[1], 1e-3 * other.x[1])
near("when: what is left", end, math.sqrt(2 * other.cost / len(times)), 1e-6)
near("when: the start", start, math.sqrt(np.mean((columns(spring, pushed_later(36.0, 2.0), "cart.x")[:, 0] - np.exp(-times))**2)),
     1e-9)
with open(f"{work}/later.csv", "w") as f:
    f.write("time [s],cart.x [m]\n")
    for t, x in columns(spring, pushed_later(45.0, 5.0), "time", "cart.x"):
        f.write(f"{float(t)!r},{float(x)!r}\n")
for row in csv.DictReader(gic("--identify", f"{work}/later.csv", spring, pushed_later(36.0, 2.0), "parameter/k", "parameter/c",
                              "-o", "-").splitlines()):
    near(f"when: {row['variable']} found again", float(row["value"]), {"k": 45, "c": 5}[row["variable"][-1]], 1e-7)
# beside a controller, whose outputs come after those of the conditions
sampled = f"{work}/sampled.veh"
Path(sampled).write_text(Path(spring).read_text().replace("- c * rate(x)", "- damper.drag") + "controllers:\n"
                         "  damper: {period: 0.02, rules: {drag: {value: c * rate(x), unit: N}}}\n")
with open(f"{work}/later.csv", "w") as f:
    f.write("time [s],cart.x [m]\n")
    for t, x in columns(sampled, pushed_later(45.0, 5.0), "time", "cart.x"):
        f.write(f"{float(t)!r},{float(x)!r}\n")
for row in csv.DictReader(gic("--identify", f"{work}/later.csv", sampled, pushed_later(36.0, 2.0), "parameter/k", "parameter/c",
                              "-o", "-").splitlines()):
    near(f"when, sampled: {row['variable']} found again", float(row["value"]), {"k": 45, "c": 5}[row["variable"][-1]], 1e-7)

# ---- the corner of a Formula Student car --------------------------------------------------------------------------------------------

corner, travel = f"{models}/optimize/corner.veh", f"{models}/optimize/corner.scene"
points = ("link_in_y", "link_in_z", "upper_in_y", "upper_in_z")
planted = {"link_in_y": 0.2154, "link_in_z": 0.1361, "upper_in_y": 0.2391, "upper_in_z": 0.2552}
text = Path(travel).read_text()
Path(f"{work}/planted.scene").write_text(text + f"parameters: {planted}\n".replace("'", ""))
curve = columns(corner, f"{work}/planted.scene", "wheel.roll", "wheel.yaw")
clock = columns(corner, f"{work}/planted.scene", "time")[:, 0]
draw = np.random.default_rng(29)
for noise in (0, 2e-5):
    with open(f"{work}/curve.csv", "w") as f:
        f.write("time [s],wheel.roll [rad],wheel.yaw [rad]\n")
        for t, row in zip(clock, curve + noise * draw.standard_normal(curve.shape)):
            f.write(f"{t!r},{row[0]!r},{row[1]!r}\n".replace("np.float64(", "").replace(")", ""))
    rows = csv.DictReader(gic("--identify", f"{work}/curve.csv", corner, travel, *[f"parameter/{p}" for p in points], "-o",
                              "-").splitlines())
    for row in rows:
        name = row["variable"].split("/")[1]
        off, deviation = float(row["value"]) - planted[name], float(row["deviation"])
        check(f"noise {noise}: {name} is off by {off}, deviation {deviation}", abs(off) < (4 * deviation if noise else 1e-9))
        check(f"noise {noise}: {name} within {deviation}", deviation < 3e-4)

ranges = ("parameter/link_in_y=0.2:0.24", "parameter/link_in_z=0.12:0.15")
start, end, found = optimize("wheel.yaw", corner, travel, *ranges)
near("bump steer at first", start, math.sqrt(np.mean(columns(corner, travel, "wheel.yaw")**2)), 1e-12)
check(f"bump steer falls from {start} to {end}", end < start / 50)


def toe(p):
    Path(f"{work}/toe.scene").write_text(text + f"parameters: {{link_in_y: {float(p[0])!r}, link_in_z: {float(p[1])!r}}}\n")
    return columns(corner, f"{work}/toe.scene", "wheel.yaw")[:, 0]


other = least_squares(toe, [0.22, 0.1345], jac="3-point", x_scale=[0.01, 0.001], xtol=1e-13, ftol=1e-13, gtol=1e-15)
for name, value in zip(("link_in_y", "link_in_z"), other.x):
    near(f"bump steer: {name}", found[f"parameter/{name}"], value, 1e-6)
near("bump steer that is left", end, math.sqrt(np.mean(toe(other.x)**2)), 1e-9)

# ---- the rack through a double lane change ---------------------------------------------------------------------------------------

lanes = f"{models}/optimize/lane_change"
first, least, racks = optimize("aside^2", lanes + ".veh", lanes + ".scene", *(f"input/rack[{k}]=-0.05:0.05" for k in range(1, 8)))
TEXT = Path(lanes + ".scene").read_text()
VALUES = "values: [0, -0.02, 0.006, 0.018, 0.006, 0.012, -0.006, -0.016, 0]"
check("the scene's profile", VALUES in TEXT)


def squares(x):
    """aside^2 at the scene's output times, by a run alone."""
    path = f"{work}/lanes.scene"
    Path(path).write_text(TEXT.replace(VALUES, f"values: {[0, *map(float, x), 0]}"))
    return columns(lanes + ".veh", path, "aside")[:, 0] ** 2


def size(x):
    return math.sqrt(np.mean(squares(x) ** 2))


rough = np.array([-0.02, 0.006, 0.018, 0.006, 0.012, -0.006, -0.016])
best = np.array([racks[f"input/rack[{k}]"] for k in range(1, 8)])
near("lanes: the start", size(rough), first, 1e-9)
near("lanes: what was found", size(best), least, 1e-9)
check(f"lanes: from {first} to {least}", first > 1 and least < 0.005)
check("lanes: the largest distance", math.sqrt(max(squares(best))) < 0.15)
# scipy by differences of runs, from half way: it finds nothing that is better by 1 %
other = least_squares(squares, (rough + best) / 2, bounds=(-0.05, 0.05), x_scale=0.01, diff_step=1e-5, max_nfev=15)
check(f"lanes: scipy finds {size(other.x)}, --optimize {least}", size(other.x) > 0.99 * least)
# nor does any value by itself
for k in range(7):
    for change in (-1e-4, 1e-4):
        moved = best.copy()
        moved[k] += change
        check(f"lanes: value {k + 1} moved by {change}", size(moved) > least * (1 - 1e-6))

finish()
