# SPDX-License-Identifier: MIT
"""gradient_start.py GICRUN MODELS WORK: how a run's start follows parameters and inputs: equilibrium in closed form, wheels that roll against differences of runs,
forwards and backwards."""
import math
import shutil
from pathlib import Path

from counted import check, finish, near
from gradient_tools import both_ways, gradient, models, work

# ---- a mass on a mass, hanging from springs ---------------------------------------------------------------------------------------

hanging = f"{work}/hanging.veh"
Path(hanging).write_text("""gicgen: 1
model: hanging
base: ground
gravity: [0, 0, "-g"]
parameters:
  g: {value: 10, unit: m/s^2, tunable: true}
  m: {value: 10, unit: kg, tunable: true}
  n: {value: 1, unit: kg, tunable: true}
  k: {value: 1000, unit: N/m, tunable: true}
  c: {value: 100, unit: N/m, tunable: true}
inputs:
  push: {unit: N}
  lift: {unit: m}
bodies:
  upper: {mass: m, com: [0, 0, 0], inertia: [1, 1, 1]}
  lower: {mass: n, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  a: {type: prismatic, bodies: [ground, upper], axis: [0, 0, 1]}
  b: {type: prismatic, bodies: [upper, lower], axis: [0, 0, 1]}
coordinates:
  z: {type: translation, bodies: [ground, upper], axis: [0, 0, 1], range: [-5, 5]}
  w: {type: translation, bodies: [upper, lower], axis: [0, 0, 1], range: [-5, 5]}
forces:
  first: {type: force, coordinate: z, value: "-k * (z - lift)"}
  second: {type: force, coordinate: w, value: "-c * w + push"}
outputs:
  lower: {type: position, body: lower}
""")
scene = f"{work}/hanging.scene"
for method, inputs, push, lift in (("rk4", "{}", 0, 0), ("ab3", "{push: {constant: 1}, lift: {constant: 0.5}}", 1, 0.5),
                                   ("rk4", "{push: {knots: {times: [0, 5], values: [2, 2]}}, lift: {knots: {times: [0, 5], values: [1, 1]}}}", 2, 1)):
    Path(scene).write_text(f"gicscene: 1\nduration: 0.4\nstep: 0.01\nintegrator: {method}\ninitial: {{equilibrium: true}}\ninputs: {inputs}\n")
    # it rests: k (z - lift) + (m + n) g = 0 and c w + n g = push; the force of `second` is between both, so z does not feel it
    z, w = lift - 11 * 10 / 1000, (push - 10) / 100
    by = {"parameter/g": -0.011 - 0.01, "parameter/m": -0.01, "parameter/n": -0.01 - 0.1, "parameter/k": 0.11 / 1000, "parameter/c": -w / 100}
    for names in (["parameter"], ["parameter/n"], ["parameter/k", "parameter/c"]):
        value, d = gradient("lower.z", hanging, scene, *names)
        near(f"hanging, {method}, {push}: where it rests", value, z + w, 1e-10)  # accelerations of 1e-9 m/s^2 over 100 1/s^2
        for name in d:
            near(f"hanging, {method}, {push}: {name}", d[name], by[name], 1e-12)
    if push == 1:
        value, d = gradient("lower.z", hanging, scene, "input")
        near("hanging: by a constant load", d["input/push"], 0.01, 1e-13)
        near("hanging: by a constant place", d["input/lift"], 1, 1e-12)
    # another value is set before the equilibrium is sought
    value, d = gradient("lower.z", hanging, scene, "parameter/k=500")
    near(f"hanging, {method}: half the stiffness", value, lift - 0.22 + w, 1e-10)
    near(f"hanging, {method}: half the stiffness, its derivative", d["parameter/k"], 0.22 / 500, 1e-12)
# let go from equilibrium 0.1 below: what is given stays, what rests follows
Path(scene).write_text("gicscene: 1\nduration: 1\nstep: 0.001\nintegrator: rk4\ninitial: {rates: {z: 0.1}, equilibrium: true}\n")
frequency = gradient("lower.z", hanging, scene, "initial/z.rate")[1]["initial/z.rate"]
check("hanging: a rate at the start is no part of the equilibrium", abs(frequency) > 1e-3)

# ---- a start that the model gives ---------------------------------------------------------------------------------------------

falling = f"{work}/falling.veh"
Path(falling).write_text("""gicgen: 1
model: falling
base: ground
gravity: [0, 0, -10]
parameters:
  z0: {value: 1, unit: m, tunable: true}
  m: {value: 1e-9, unit: kg, tunable: true}
bodies:
  ball: {mass: m, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  a: {type: prismatic, bodies: [ground, ball], axis: [0, 0, 1]}
coordinates:
  z: {type: translation, bodies: [ground, ball], axis: [0, 0, 1], range: [-50, 50], initial: 2 * z0^2}
outputs:
  z: {type: coordinate, coordinate: z}
""")
for initial, wanted in (("", 4), ("initial: {coordinates: {z: 3}}\n", 0)):
    Path(scene).write_text(f"gicscene: 1\nduration: 1\nstep: 0.1\nintegrator: rk4\n{initial}")
    for names in (["parameter"], ["parameter/z0"]):
        d = gradient("z.value", falling, scene, *names)[1]
        near(f"falling from {'what the scene gives' if initial else 'what the model gives'}", d["parameter/z0"], wanted, 1e-11)

# ---- a rig: numbers of wheels on posts, of a base that is held --------------------------------------------------------------------------

rig = f"{work}/rig.veh"
Path(rig).write_text("""gicgen: 1
model: rig
base: b
gravity: [0, 0, -10]
parameters:
  r: {value: 1, unit: m, tunable: true}
  m: {value: 1, unit: kg, tunable: true}
  q: {value: 0.5, unit: kg, tunable: true}
  k: {value: 1000, unit: N/m, tunable: true}
  s: {value: 100, unit: N/m, tunable: true}
bodies:
  b: {mass: 4, com: [0, 0, 1], inertia: [1, 1, 1]}
  a: {mass: m, com: [0, 0, 2], inertia: [1, 1, 1]}
  e: {mass: q, com: [0, 0, 3], inertia: [0.001, 0.001, 0.001]}
joints:
  j: {type: prismatic, bodies: [b, a], axis: [0, 0, 1]}
  f: {type: fixed, bodies: [a, e], point: [0, 0, 2]}
coordinates:
  z: {type: translation, bodies: [b, a], axis: [0, 0, 1], range: [-1, 1]}
wheels:
  wa: {body: b, center: [1, 1, 1], radius: r, stiffness: k, damping: 10}
  wb: {body: b, center: [1, -1, 1], radius: r, stiffness: k, damping: 10}
  wc: {body: b, center: [-1, 1, 1], radius: r, stiffness: k, damping: 10}
  wd: {body: b, center: [-1, -1, 1], radius: r, stiffness: k, damping: 10}
forces:
  f: {type: spring_damper, coordinate: z, stiffness: s, damping: 1}
outputs:
  z: {type: coordinate, coordinate: z}
  p: {type: position, body: b}
""")
# at rest z = -(m + q) g / s, and the base stands at r - (4 + m + q) g / 4 k
for what, keys, k, carried in (("free", "", 1000, 1.5), ("posts", "posts: {wa: 0}\nparameters: {k: 2000}\n", 2000, 1.5), ("held", "base: fixed\n", 1000, 1.5),
                               ("massless", "massless: {below: 0.8}\n", 1000, 1)):
    Path(scene).write_text(f"gicscene: 1\nduration: 0.1\nstep: 0.01\ninitial: {{equilibrium: true}}\n{keys}")
    light = what == "massless"
    for names in (["parameter"], ["parameter/m"], ["parameter/k", "parameter/q"]):
        value, d = gradient("z.value", rig, scene, *names)
        near(f"rig, {what}: where it rests", value, -carried / 10, 1e-10)
        for name, wanted in (("m", -0.1), ("q", 0 if light else -0.1), ("s", carried * 10 / 100**2), ("k", 0), ("r", 0)):
            near(f"rig, {what}: z by {name}", d.get(f"parameter/{name}", wanted), wanted, 1e-12)
        if what != "held":
            value, d = gradient("p.z", rig, scene, *names)
            near(f"rig, {what}: where the base rests", value, 1 - (4 + carried) * 10 / (4 * k), 1e-10)
            for name, wanted in (("m", -2.5 / k), ("q", 0 if light else -2.5 / k), ("s", 0), ("k", (4 + carried) * 2.5 / k**2), ("r", 1)):
                near(f"rig, {what}: base by {name}", d.get(f"parameter/{name}", wanted), wanted, 1e-12)

# ---- a beam on two springs, whose angle is not small -------------------------------------------------------------------------------

beam = f"{work}/beam.veh"
Path(beam).write_text("""gicgen: 1
model: beam
base: ground
gravity: [0, 0, -10]
parameters:
  m: {value: 1, unit: kg, tunable: true}
  k: {value: 10, unit: N m/rad, tunable: true}
  length: {value: 1, unit: m, tunable: true}
bodies:
  beam: {mass: m, com: [length, 0, 0], inertia: [1, 1, 1]}
joints:
  a: {type: revolute, bodies: [ground, beam], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  turn: {type: angle, bodies: [ground, beam], axis: [0, 1, 0], range: [-3, 3]}
forces:
  spring: {type: spring_damper, coordinate: turn, stiffness: k, damping: 0}
outputs:
  turn: {type: coordinate, coordinate: turn}
""")
Path(scene).write_text("gicscene: 1\nduration: 0.5\nstep: 0.01\ninitial: {equilibrium: true}\n")
angle = 0.5
for _ in range(50):  # m g length cos(turn) = k turn
    angle -= (10 * math.cos(angle) - 10 * angle) / (-10 * math.sin(angle) - 10)
slope = 10 * math.sin(angle) + 10
value, d = gradient("turn.value", beam, scene, "parameter")
near("beam: where it rests", value, angle, 1e-10)
for name, wanted in (("parameter/m", 10 * math.cos(angle) / slope), ("parameter/length", 10 * math.cos(angle) / slope), ("parameter/k", -angle / slope)):
    near(f"beam: {name}", d[name], wanted, 1e-10)  # at the angle that is found, not at the one above

# ---- wheels that roll where the scene starts, by a point that moves and by steering ------------------------------------------------------

own = f"{work}/own"
shutil.copytree(models, own, ignore=shutil.ignore_patterns("scenes", "*.md"))


def replace(name, old, new):
    path = Path(own, name)
    text = path.read_text()
    check(f"{name} has what is replaced", text.count(old) == 1)
    path.write_text(text.replace(old, new))


replace("parts/chassis.veh", "[1.648579, 0.909701, 0.447711]", "[1.648579, 0.909701, 0.447711 + lift]")
replace("hmmwv_tires.veh", "\ninputs:\n", "\nparameters:\n  lift: {value: 0, unit: m, tunable: true}\n\ninputs:\n")
vehicle, e = f"{own}/hmmwv_tires.veh", 1e-6
for what, initial, formula, name, tolerance in (
        ("rolling", "velocity: [14, 0, 0]", "chassis.x", "parameter/lift", 1e-7),
        ("rolling aside", "velocity: [14, 1, 0]", "chassis.y", "parameter/lift", 1e-7),
        ("rolling slowly aside", "velocity: [0.5, 0.1, 0]", "chassis.y", "parameter/lift", 1e-7),
        ("backwards", "velocity: [-5, 0, 0]", "chassis.z", "parameter/lift", 1e-7),
        ("steered", "velocity: [14, 0, 0]", "chassis.y", "input/rack", 1e-7),
        # tires keep the stretch that the way down has left in them, which the search finds a little otherwise
        ("rolling from equilibrium", "velocity: [14, 0, 0], equilibrium: true", "chassis.z", "parameter/lift", 3e-4)):
    path = f"{work}/rolling.scene"
    Path(path).write_text(f"gicscene: 1\nduration: 0.1\nstep: 0.002\nratio: 4\ninitial: {{{initial}}}\ninputs: {{rack: {{constant: 0.001}}}}\n")
    at = {"parameter/lift": 0, "input/rack": 0.001}[name]
    there = gradient(formula, vehicle, path, name)[1][name]
    difference = (gradient(formula, vehicle, path, f"{name}={at + e!r}")[0] - gradient(formula, vehicle, path, f"{name}={at - e!r}")[0]) / (2 * e)
    near(f"{what}: {name}", there, difference, tolerance * abs(difference) + 1e-8)  # 1e-14 m over 2e-6
    if name == "parameter/lift":
        both_ways(what, formula, vehicle, path, ["parameter", "initial/z", "initial/x.rate"])

finish()
