# SPDX-License-Identifier: MIT
"""identify.py GICRUN MODELS WORK: what `gicrun --identify` finds. 200 trials with drawn noise on a mass on a spring: intervals
of 95 % have the planted numbers in them as often as that says, and noise and deviations are those that were planted and
that the numbers scatter by; two outputs whose noises differ by a factor of 1000; without noise the planted numbers; the
suspension of a vehicle from the motion of its chassis."""
import csv
import math
import re
import sys
from pathlib import Path

import numpy as np

from counted import check, finish, runner

gicrun, models, work = sys.argv[1:4]
gic = runner(gicrun)


def columns(text):
    rows = list(csv.reader(text.splitlines()))
    return rows[0], np.array([[float(x) for x in row] for row in rows[1:]])


def identify(names, table, model, scene, *variables):
    path = f"{work}/measured.csv"
    with open(path, "w") as f:
        f.write(",".join(names) + "\n")
        for row in table:
            f.write(",".join(f"{x:.17g}" for x in row) + "\n")
    rows = csv.DictReader(gic("--identify", path, model, scene, *variables, "-o", "-").splitlines())
    return {row["variable"]: {key: float(row[key]) for key in ("start", "value", "deviation", "low", "high")} for row in rows}


# ---- a mass on a spring --------------------------------------------------------------------------------------------------------

spring = f"{work}/spring.veh"
Path(spring).write_text("""gicgen: 1
model: spring
gravity: [0, 0, 0]
base: ground
parameters:
  k: {value: 40, unit: N/m, tunable: true}
  c: {value: 2, unit: N s/m, tunable: true}
  m: {value: 10, unit: kg, tunable: true}
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
  pull: {type: force, element: spring}
""")
head = """gicscene: 1
duration: 4
step: 0.02
integrator: rk4
output_step: 0.04
initial: {coordinates: {x: START}, rates: {x: 0.5}}
inputs: {push: {step: {from: 0, to: 20, start: 1, rise: 0.5}}}
outputs: [cart.x, pull]
"""
planted = {"parameter/k": 40.0, "parameter/c": 2.0, "initial/x": 1.0}
Path(f"{work}/true.scene").write_text(head.replace("START", "1"))
Path(f"{work}/start.scene").write_text(head.replace("START", "0.8") + "parameters: {k: 30, c: 1}\n")
names, clean = columns(gic("-q", spring, f"{work}/true.scene", "-o", "-"))

found = identify(names[:2], clean[:, :2], spring, f"{work}/start.scene", *planted)
for name, value in planted.items():
    check(f"without noise: {name} {found[name]}", abs(found[name]["value"] - value) < 1e-8 * value)
check("it began elsewhere", found["parameter/k"]["start"] == 30 and found["initial/x"]["start"] == 0.8)

TRIALS, NOISE = 200, 0.02
draw = np.random.default_rng(20261126)
inside = dict.fromkeys(planted, 0)
values = {name: [] for name in planted}
deviations = {name: [] for name in planted}
for trial in range(TRIALS):
    table = clean[:, :2].copy()
    table[:, 1] += NOISE * draw.standard_normal(len(table))
    found = identify(names[:2], table, spring, f"{work}/start.scene", *planted)
    for name, value in planted.items():
        inside[name] += found[name]["low"] <= value <= found[name]["high"]
        values[name].append(found[name]["value"])
        deviations[name].append(found[name]["deviation"])
spread = math.sqrt(TRIALS * 0.95 * 0.05)
for name, value in planted.items():
    check(f"intervals of {name}: {inside[name]} of {TRIALS}", abs(inside[name] - 0.95 * TRIALS) <= 3 * spread)
    scatter, told = np.std(values[name], ddof=1), np.mean(deviations[name])
    check(f"deviation of {name}: {told} told, {scatter} seen", abs(told / scatter - 1) < 0.2)  # of 200: 5 %
    check(f"{name} on the mean: {np.mean(values[name])}", abs(np.mean(values[name]) - value) < 4 * scatter / math.sqrt(TRIALS))

# two outputs of other sizes: the noise of each is found
table = clean.copy()
table[:, 1] += 0.001 * draw.standard_normal(len(table))
table[:, 2] += 1.0 * draw.standard_normal(len(table))
path = f"{work}/both.csv"
with open(path, "w") as f:
    f.write(",".join(names) + "\n" + "".join(",".join(f"{x:.17g}" for x in row) + "\n" for row in table))
said = gic("--identify", path, spring, f"{work}/start.scene", *planted)
noise = {m.group(1): float(m.group(2)) for m in re.finditer(r"^(cart\.x|pull) +([0-9.e-]+)$", said, re.M)}
check(f"noises {noise}", abs(noise["cart.x"] / 0.001 - 1) < 0.3 and abs(noise["pull"] / 1.0 - 1) < 0.3)
both = identify(names, table, spring, f"{work}/start.scene", *planted)
one = identify(names[:2], table[:, :2], spring, f"{work}/start.scene", *planted)
# columns that nothing moves tell nothing: as without them, but for the rounding of the search (1e-6 of a deviation). Few
# measurements, where degrees of freedom of another noise would show most
idle = Path(spring).read_text() + "  side: {type: position, body: cart, point: [0, 0, 1]}\n"
Path(f"{work}/idle.veh").write_text(idle)
few = np.column_stack([table[10:90:16, :2], 0.02 * draw.standard_normal((5, 2)) + [0, 1]])
alone = identify(names[:2], few[:, :2], f"{work}/idle.veh", f"{work}/start.scene", *planted)
beside = identify([*names[:2], "side.y [m]", "side.z [m]"], few, f"{work}/idle.veh", f"{work}/start.scene", *planted)
for name in planted:
    apart = max(abs(alone[name][key] - beside[name][key]) for key in ("value", "deviation", "low", "high"))
    check(f"{name} beside columns that nothing moves: {apart}", apart < 1e-6 * alone[name]["deviation"])
still = np.column_stack([clean[:, :2], np.full(len(clean), 0.001)])
found = identify([*names[:2], "side.y [m]"], still, f"{work}/idle.veh", f"{work}/start.scene", *planted)
check("a column that stands still", all(abs(found[n]["value"] - v) < 1e-8 * v for n, v in planted.items()))

check("more measurements tell more", all(both[n]["deviation"] < 1.05 * one[n]["deviation"] for n in planted))

# ---- a vehicle -------------------------------------------------------------------------------------------------------------------

car = str(Path(__file__).resolve().parent.parent / "data/tuning/car.veh")
scene = """gicscene: 1
duration: 1.2
step: 0.004
output_step: 0.02
initial: {position: [0, 0, 0.49], velocity: [8, 0, 0]}
road: {type: sine, amplitude: 0.02, wavelength: 5, start: 1, phase_per_y: 0.3}
outputs: [chassis.z, chassis_velocity]
parameters: {PLANTED}
"""
Path(f"{work}/car.scene").write_text(scene.replace("PLANTED", "load: 2000, tire: 250000, roll: 800"))
Path(f"{work}/car_start.scene").write_text(scene.replace("{PLANTED}", "{load: 2200, tire: 300000, roll: 800}"))
Path(f"{work}/car.scene").write_text(scene.replace("{PLANTED}", "{load: 2000, tire: 250000, roll: 800}"))
names, clean = columns(gic("-q", "--general", car, f"{work}/car.scene", "-o", "-"))
found = identify(names, clean, car, f"{work}/car_start.scene", "parameter/load", "parameter/tire")
for name, value in (("parameter/load", 2000), ("parameter/tire", 250000)):
    check(f"a vehicle: {name} {found[name]}", abs(found[name]["value"] / value - 1) < 1e-6)
noisy = clean + np.array([0, 1e-4, 1e-3, 1e-3, 1e-3])[: clean.shape[1]] * draw.standard_normal(clean.shape)
found = identify(names, np.column_stack([clean[:, 0], noisy[:, 1:]]), car, f"{work}/car_start.scene", "parameter/load",
                 "parameter/tire")
for name, value in (("parameter/load", 2000), ("parameter/tire", 250000)):
    check(f"a vehicle with noise: {name} {found[name]}", abs(found[name]["value"] - value) < 4 * found[name]["deviation"])

finish()
