# SPDX-License-Identifier: MIT
"""gradient.py GICRUN MODELS WORK: what `gicrun --gradient` finds. A mass on a spring in closed form; a pendulum and the same
mass by the steps of AB3 and RK4 written again here in 50 digits and differentiated by differences of 1e-20, so that it is the
derivative of the very steps; whole runs of vehicles by Taylor remainders, which shrink with the square of the change; all variables at once, which is
backwards through the run, against one by one, which is forwards."""
import csv
import math
import re
import shutil
from decimal import Decimal
from pathlib import Path

from counted import check, finish, near
from gradient_tools import both_ways, difference, gic, gradient, models, steps, taylor, work

# ---- a mass on a spring -------------------------------------------------------------------------------------------------------

spring = f"{work}/spring.veh"
Path(spring).write_text("""gicgen: 1
model: spring
gravity: [0, 0, 0]
base: ground
parameters:
  k: {value: 36, unit: N/m, tunable: true}
  c: {value: 0, unit: N s/m, tunable: true}
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


def spring_scene(method, step, more=""):
    path = f"{work}/spring.scene"
    Path(path).write_text(f"gicscene: 1\nduration: 2\nstep: {step}\nintegrator: {method}\n"
                          f"initial: {{coordinates: {{x: 1}}, rates: {{x: 0.5}}}}\n{more}")
    return path


k, m, T, x0, v0 = 36.0, 4.0, 2.0, 1.0, 0.5
w = math.sqrt(k / m)


def motion(t, w):
    return x0 * math.cos(w * t) + v0 / w * math.sin(w * t)


by_w = -x0 * T * math.sin(w * T) + v0 * (T / w * math.cos(w * T) - math.sin(w * T) / w**2)
value, d = gradient("cart.x", spring, spring_scene("rk4", 0.001))
closed = {"initial/x": math.cos(w * T), "initial/x.rate": math.sin(w * T) / w, "parameter/k": by_w / (2 * w * m),
          "parameter/m": -by_w * w / (2 * m), "input/push": (1 - math.cos(w * T)) / k,
          "parameter/c": -(T * motion(T, w) - x0 * math.sin(w * T) / w) / (2 * m)}  # of c = 0, to which -x' / m responds
near("end", value, motion(T, w), 1e-11)
for name, wanted in closed.items():
    near(f"end by {name}", d[name], wanted, 1e-10)
value, d = gradient("integral(x)", spring, spring_scene("rk4", 0.001), "initial", "input/push")
near("integral", value, x0 * math.sin(w * T) / w + v0 * (1 - math.cos(w * T)) / w**2, 2e-6)
near("integral by x", d["initial/x"], math.sin(w * T) / w, 2e-6)
near("integral by push", d["input/push"], (T - math.sin(w * T) / w) / k, 2e-6)
check("no others than asked for", set(d) == {"initial/x", "initial/x.rate", "input/push"})
value, d = gradient("maximum(x)", spring, spring_scene("rk4", 0.001))
amplitude = math.hypot(x0, v0 / w)
near("maximum", value, amplitude, 1e-5)
near("maximum by x", d["initial/x"], x0 / amplitude, 1e-3)
near("maximum by rate", d["initial/x.rate"], v0 / w**2 / amplitude, 1e-3)

# ---- the very steps -------------------------------------------------------------------------------------------------------------


def sine(x):
    term = total = x
    n = 1
    while abs(term) > Decimal(10) ** -48:
        term *= -x * x / ((n + 1) * (n + 2))
        n += 2
        total += term
    return total


def cart(method, h, x=1, v=Decimal("0.5"), k=36, m=4, c=0, push=(2, -1)):
    def quintic(t):  # from 0.5 s on for 1 s
        s = min(max((t - Decimal("0.5")) / 1, Decimal(0)), Decimal(1))
        share = s**3 * (10 + s * (6 * s - 15))
        return push[0] + (push[1] - push[0]) * share

    return steps(lambda t, y: [y[1], (quintic(t) - k * y[0] - c * y[1]) / m], [Decimal(x), Decimal(v)], h, round(2 / h),
                 method)[0]


pushed = "inputs: {push: {step: {from: 2, to: -1, start: 0.5, rise: 1}}}\n"
for method, h in (("rk4", 0.1), ("ab3", 0.05)):
    value, d = gradient("cart.x", spring, spring_scene(method, h, pushed))
    near(f"{method}: the end", value, float(cart(method, h)), 1e-13)
    one = Decimal(1)
    wanted = {"initial/x": difference(lambda p: cart(method, h, x=p), one),
              "initial/x.rate": difference(lambda p: cart(method, h, v=p), one / 2),
              "parameter/k": difference(lambda p: cart(method, h, k=p), 36 * one),
              "parameter/c": difference(lambda p: cart(method, h, c=p), 0 * one),
              "parameter/m": difference(lambda p: cart(method, h, m=p), 4 * one),
              "input/push[0]": difference(lambda p: cart(method, h, push=(p, -1)), 2 * one),
              "input/push[1]": difference(lambda p: cart(method, h, push=(2, p)), -one)}
    check(f"{method}: variables {set(d) ^ set(wanted)}", set(d) == set(wanted))
    for name, number in wanted.items():
        near(f"{method}: the steps' derivative by {name}", d[name], number, 1e-13)

pendulum = f"{work}/swing.veh"
Path(pendulum).write_text("""gicgen: 1
model: swing
gravity: [0, 0, -10]
base: ground
parameters:
  l: {value: 2, unit: m, tunable: true}
  m: {value: 4, unit: kg, tunable: true}
bodies:
  bob: {mass: m, position: [0, 0, 0], com: [0, 0, "-l"], inertia: [3, 3, 3]}
joints:
  hinge: {type: revolute, bodies: [ground, bob], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, bob], axis: [0, 1, 0], range: [-3, 3]}
outputs:
  angle: {type: coordinate, coordinate: angle}
""")


def swing(method, h, angle=1, rate=0, l=2, m=4):
    return steps(lambda t, y: [y[1], -m * 10 * l * sine(y[0]) / (m * l * l + 3)], [Decimal(angle), Decimal(rate)], h,
                 round(3 / h), method)[0]


for method, h in (("rk4", 0.1), ("ab3", 0.05)):
    Path(f"{work}/swing.scene").write_text(f"gicscene: 1\nduration: 3\nstep: {h}\nintegrator: {method}\n"
                                           "initial: {coordinates: {angle: 1}}\n")
    value, d = gradient("angle", pendulum, f"{work}/swing.scene")
    near(f"pendulum, {method}: the end", value, float(swing(method, h)), 1e-12)
    one = Decimal(1)
    wanted = {"initial/angle": difference(lambda p: swing(method, h, angle=p), one),
              "initial/angle.rate": difference(lambda p: swing(method, h, rate=p), 0 * one),
              "parameter/l": difference(lambda p: swing(method, h, l=p), 2 * one),
              "parameter/m": difference(lambda p: swing(method, h, m=p), 4 * one)}
    for name, number in wanted.items():
        near(f"pendulum, {method}: by {name}", d[name], number, 1e-12 * max(1, abs(number)))

# ---- vehicles: Taylor remainders ------------------------------------------------------------------------------------------------


start = """gicscene: 1
duration: 1.5
step: 0.002
integrator: METHOD
initial:
  position: [0, 0, 0.4825]
  velocity: [VX, VY, 0]
  angular_velocity: [0, 0, YAW]
  coordinates: {spring_f_l: FRONT}
  states: {STATES}
inputs:
  drive_torque: {step: {to: TORQUE, rise: 0.5, start: 0.2}}
  rack: {step: {to: RACK, rise: 0.3, start: 0.2}}
  brake: {knots: {times: [0.8, 1.0], values: [0, BRAKE]}}
"""
states = ", ".join(f"tire_{a}_{b}.{c}: {v}" for a in "fr" for b in "lr"
                   for c, v in (("spin", "SPIN" if a + b == "fl" else 22), ("slip_x", 0.01), ("slip_y", 0.02), ("brake", 0.1)))
numbers = {"initial/x.rate": ("VX", 10.0, 1), "initial/y.rate": ("VY", 0.5, 1), "initial/yaw.rate": ("YAW", 0.1, 0.1),
           "initial/spring_f_l": ("FRONT", 0.25, 0.01), "initial/tire_f_l.spin": ("SPIN", 22.5, 1),
           "input/drive_torque[1]": ("TORQUE", 600.0, 200), "input/rack[1]": ("RACK", -0.01, 0.003),
           "input/brake[1]": ("BRAKE", 0.3, 0.1)}
for method in ("ab3", "rk4"):
    scene = start.replace("METHOD", method).replace("STATES", states)
    for formula in ("chassis.y", "integral(chassis.x * chassis.y)", "maximum(chassis_attitude.roll)"):
        if method == "rk4" and formula != "chassis.y":
            continue
        taylor(f"tires, {method}, {formula}", formula, f"{models}/hmmwv_tires.veh", scene, numbers, 0.01)
dual = start.replace("METHOD", "ab3\nratio: 5").replace("step: 0.002", "step: 0.005").replace("STATES", states)
for formula in ("chassis.y", "integral(chassis.x * chassis.y)"):
    taylor(f"tires, dual rate, {formula}", formula, f"{models}/hmmwv_tires.veh", dual, numbers, 0.01)

# tunable geometry on a road of waves; the state at time 0 is held
car = str(Path(__file__).resolve().parent.parent / "data/tuning/car.veh")
plain = f"{work}/plain.scene"
Path(plain).write_text("gicscene: 1\nduration: 0.01\nstep: 0.01\n")
rows = [r for r in csv.DictReader(gic("--gradient", "time", car, plain, "-o", "-").splitlines()) if r["variable"]]
at = {r["variable"]: float(r["value"]) for r in rows}
held = ", ".join(f"{name.split('/')[1]}: {value!r}" for name, value in at.items()
                 if re.match(r"initial/(spring_.._.|spring_._.|rack)$", name))
scene = f"""gicscene: 1
duration: 0.6
step: 0.002
initial: {{position: [0, 0, 0.49], velocity: [8, 0, 0], coordinates: {{{held}}}}}
road: {{type: sine, amplitude: 0.02, wavelength: 5, start: 1, phase_per_y: 0.3}}
parameters:
"""
chosen = {}
for i, name in enumerate(name for name in at if name.startswith("parameter/")):
    chosen[name] = (f"P{i}P", at[name], 0.02 * abs(at[name]) if at[name] else 0.001)
    scene += f"  {name.split('/')[1]}: P{i}P\n"
check("parameters that are geometric", len(chosen) >= 15)
taylor("tunable geometry", "chassis.z", car, scene, chosen, 0.02)
for e in (0, 1):  # all parameters count, those of gravity and of outputs' points too, as they do in a run
    text = scene
    for mark, value, unit in chosen.values():
        text = text.replace(mark, repr(value + e * unit))
    Path(f"{work}/all.scene").write_text(text)
    last = gic("-q", "--general", car, f"{work}/all.scene", "-o", "-").splitlines()
    names = [name.split(" [")[0] for name in last[0].split(",")]
    for output in ("chassis.z", "wheel_f_l.z"):
        value = gradient(output, car, f"{work}/all.scene", "initial/z")[0]
        near(f"tunable geometry: {output} is that of the run", value, float(last[-1].split(",")[names.index(output)]), 1e-11)
check("gravity counts", abs(gradient("chassis.z", car, f"{work}/all.scene", "parameter/g")[1]["parameter/g"]) > 1e-3)
check("a value beside a name", gradient("chassis.z", car, f"{work}/all.scene", "parameter/g=9", "initial/z")[0] !=
      gradient("chassis.z", car, f"{work}/all.scene", "parameter/g", "initial/z")[0])
for g in (9.0, 10.0):  # by a word as by the scene
    Path(f"{work}/word.scene").write_text(text.replace(f"g: {chosen['parameter/g'][1] + chosen['parameter/g'][2]!r}", f"g: {g}"))
    by_word = gradient("chassis.z", car, f"{work}/all.scene", f"parameter/g={g}", "initial/z")
    check(f"gravity {g} by a word: {by_word}", by_word == gradient("chassis.z", car, f"{work}/word.scene", "parameter/g", "initial/z"))

# ---- backwards and forwards -----------------------------------------------------------------------------------------------------


for method in ("ab3", "rk4", "ab3\nratio: 2", "ab3\nratio: 6"):
    path = f"{work}/both.scene"
    text = start.replace("METHOD", method).replace("STATES", states).replace("duration: 1.5", "duration: 0.6")
    for mark, value, unit in numbers.values():
        text = text.replace(mark, repr(value))
    Path(path).write_text(text)  # the rack has knots, and their corrections a way back
    for formula in ("chassis.y", "integral(chassis.x * chassis.y)", "maximum(chassis_attitude.roll)"):
        if method in ("ab3", "ab3\nratio: 6") or formula == "chassis.y":
            both_ways(f"tires, {method!r}, {formula}", formula, f"{models}/hmmwv_tires.veh", path)
Path(f"{work}/tuned.scene").write_text(f"""gicscene: 1
duration: 0.3
step: 0.002
initial: {{position: [0, 0, 0.49], velocity: [8, 0, 0], coordinates: {{{held}}}}}
""")
both_ways("tunable geometry", "integral(chassis.z^2)", car, f"{work}/tuned.scene")

# a body that tumbles: each Euler parameter becomes the dependent one
tumbler = f"{work}/tumbler.veh"
Path(tumbler).write_text("""gicgen: 1
model: tumbler
gravity: [0, 0, -9.81]
base: rock
bodies:
  rock: {mass: 2, com: [0.1, 0, 0.05], inertia: [1, 2, 2.5]}
outputs:
  rock: {type: position, body: rock, point: [1, 1, 1]}
""")
tumble = """gicscene: 1
duration: 3
step: 0.05
integrator: METHOD
initial: {velocity: [1, 2, 3], angular_velocity: [WX, 1, 3]}
"""
for method in ("ab3", "rk4"):
    path = f"{work}/tumble.scene"

    def end(wx):
        Path(path).write_text(tumble.replace("METHOD", method).replace("WX", repr(wx)))
        return gradient("rock.x", tumbler, path, "initial/roll.rate")

    small = 1e-5  # the state changes its dependent parameter in the same steps
    side = [end(2 + k * small)[0] for k in (-2, -1, 1, 2)]
    slope = (side[0] - side[3] + 8 * (side[2] - side[1])) / (12 * small)
    near(f"tumbling, {method}: steps that turn far, against differences", end(2.0)[1]["initial/roll.rate"], slope, 1e-8)
    both_ways(f"tumbling, {method}", "rock.x", tumbler, path)

# ---- gears that change ----------------------------------------------------------------------------------------------------------

# tables without kinks, so that remainders are of order 2; selector and pedal change within steps
for name in ("parts", "tires"):
    shutil.copytree(f"{models}/{name}", f"{work}/smooth/{name}", dirs_exist_ok=True)
for name in ("hmmwv.veh", "hmmwv_tires.veh", "hmmwv_vehicle.veh"):
    shutil.copy(f"{models}/{name}", f"{work}/smooth")
shafts = Path(f"{work}/smooth/parts/hmmwv_powertrain.veh")
shafts.write_text(shafts.read_text().replace("]}\n", "], interpolation: cubic}\n").replace("-400]\n", "-400]\n    interpolation: cubic\n")
                  .replace("\nparameters:\n", "\nparameters:\n  early: {value: 1, tunable: true}\n")
                  .replace("up: [2500 * rpm,", "up: [2500 * rpm * early,"))
smooth = f"{work}/smooth/hmmwv_vehicle.veh"
drive = """gicscene: 1
duration: 0.8
step: 0.006
integrator: METHOD
initial: {position: [0, 0, 0.4825], velocity: [VX, 0.1, 0], gear: 1, coordinates: {spring_f_l: FRONT},
          states: {engine.speed: 240, SPINS}}
parameters: {early: EARLY}
inputs:
  accelerator: {step: {from: 0.5, to: PEDAL, rise: 0.5, start: 0.01}}
  rack: {step: {to: RACK, rise: 0.8, start: 0.05}}
"""
# a speed that changes leaves spins and slips as they are only where the scene has them
drive = drive.replace("SPINS", ", ".join(f"tire_{a}_{b}.{c}: {v}" for a in "fr" for b in "lr"
                                         for c, v in (("spin", 9.4), ("slip_x", 0.01), ("slip_y", 0.02))))
knobs = {"initial/x.rate": ("VX", 4.4, 0.2), "initial/spring_f_l": ("FRONT", 0.25, 0.01),
         "parameter/early": ("EARLY", 1.0, 0.01), "input/accelerator[1]": ("PEDAL", 0.9, 0.3),
         "input/rack[1]": ("RACK", -0.01, 0.003)}
for method, step in (("ab3\nratio: 6", "0.006"), ("rk4", "0.002"), ("ab3", "0.002")):
    scene = drive.replace("METHOD", method).replace("0.006", step)
    path = f"{work}/shift.scene"
    text = scene
    for mark, value, unit in knobs.values():
        text = text.replace(mark, repr(value))
    Path(path).write_text(text)
    rows = list(csv.DictReader(gic("-q", "--general", smooth, path, "-o", "-").splitlines()))
    gears = [float(value) for row in rows for name, value in row.items() if name.startswith("drive.gear")]
    check(f"{method!r}: the gear changes", gears[0] == 1 and gears[-1] == 2)
    value, d = gradient("chassis.x", smooth, path, *knobs)
    last = [float(value) for name, value in rows[-1].items() if name.startswith("chassis.x")][0]
    near(f"{method!r}: a run with a change of gear is that of gicrun", value, last, 1e-12)
    for formula in ("chassis.x", "integral(chassis.y * drive.turbine_speed)"):
        taylor(f"a change of gear, {method!r}, {formula}", formula, smooth, scene, knobs, 0.005)
        Path(path).write_text(text)
        both_ways(f"a change of gear, {method!r}, {formula}", formula, smooth, path, list(knobs) +
                  ["initial/yaw.rate", "initial/engine.speed", "initial/tire_f_l.slip_y", "input/accelerator[0]"])

# the selector, which is let go of in a step: by an input that moves, whose values change the time
moved = drive.replace("METHOD", "rk4").replace("0.006", "0.002").replace("VX", "3").replace("FRONT", "0.25").replace(
    "EARLY", "1").replace("PEDAL", "0.5").replace("RACK", "0") + "  selector: {step: {from: FIRST, to: LAST, rise: 0.2, start: 0.1}}\n"
lever = {"input/selector[0]": ("FIRST", 1.0, 0.3), "input/selector[1]": ("LAST", -0.1, 0.3)}
taylor("the selector", "chassis.x", smooth, moved, lever, 0.01)

# the complete drive: two changes up, one down
whole = gradient("chassis.x", f"{models}/hmmwv_vehicle.veh", f"{models}/scenes/full_run.scene")[1]
for name in ("initial/y.rate", "initial/spring_r_l", "input/accelerator[1]", "input/rack[6]"):
    one = gradient("chassis.x", f"{models}/hmmwv_vehicle.veh", f"{models}/scenes/full_run.scene", name)[1][name]
    near(f"the complete drive: {name} both ways", whole[name], one, 1e-12 * max(1, abs(one)))

# ---- a run of gicrun ends there -------------------------------------------------------------------------------------------------

vehicle = f"{models}/hmmwv_vehicle.veh"
gic("--trim", "-q", vehicle, "speed=10", "lateral=2", "-o", f"{work}/circle.scene")
text = Path(f"{work}/circle.scene").read_text().replace("integrator: rkck\ntolerance: 1e-9\noutput_step: 0.01",
                                                       "step: 0.001\noutput_step: 0.01").replace("duration: 10", "duration: 1")
Path(f"{work}/circle.scene").write_text(text)
value, d = gradient("chassis.y", vehicle, f"{work}/circle.scene")
last = gic("-q", "--general", vehicle, f"{work}/circle.scene", "-o", "-").splitlines()
names = [name.split(" [")[0] for name in last[0].split(",")]
near("the value is that of the run", value, float(last[-1].split(",")[names.index("chassis.y")]), 1e-11)
roll = float(last[1].split(",")[names.index("chassis_attitude.roll")])
aside = d["initial/y"] * math.cos(roll) - d["initial/z"] * math.sin(roll)  # the axes are those of a base that leans
near("a circle moved aside", aside, 1, 1e-9)
turn = gradient("chassis.x", vehicle, f"{work}/circle.scene", "initial/yaw")[1]["initial/yaw"]
check("a circle turned moves backwards on the left", turn < 0)

hmmwv = f"{models}/hmmwv.veh"
Path(f"{work}/rest.scene").write_text("gicscene: 1\nduration: 0.5\nstep: 0.005\ninitial: {equilibrium: true, speed: 5}\n")
value = gradient("chassis.z", hmmwv, f"{work}/rest.scene", "initial/z")[0]
last = gic("-q", "--general", hmmwv, f"{work}/rest.scene", "-o", "-").splitlines()
names = [name.split(" [")[0] for name in last[0].split(",")]
near("a start in equilibrium", value, float(last[-1].split(",")[names.index("chassis.z")]), 1e-12)

finish()
