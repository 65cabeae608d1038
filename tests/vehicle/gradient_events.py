# SPDX-License-Identifier: MIT
"""gradient_events.py GICRUN MODELS WORK: gradients of runs that `until` ends, in which `when` changes inputs, and whose contacts are located.
A ball that is thrown, carts, and a mass that bounces in closed form, forwards and backwards; vehicles by Taylor remainders, and both ways against each other."""
import math
from pathlib import Path

from counted import check, finish, near
from gradient_tools import both_ways, gic, gradient, models, taylor, work

# ---- a ball: time of flight and range -----------------------------------------------------------------------------------------

ball = f"{work}/ball.veh"
Path(ball).write_text("""gicgen: 1
model: ball
gravity: [0, 0, "-g"]
base: ground
parameters:
  g: {value: 10, unit: m/s^2, tunable: true}
  m: {value: 2, unit: kg, tunable: true}
  level: {value: 0, unit: m, tunable: true}
inputs:
  push: {unit: N}
bodies:
  slide: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  ball: {mass: m, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, slide], axis: [1, 0, 0]}
  mast: {type: prismatic, bodies: [slide, ball], axis: [0, 0, 1]}
coordinates:
  x: {type: translation, bodies: [ground, slide], axis: [1, 0, 0], range: [-1000, 1000]}
  z: {type: translation, bodies: [slide, ball], axis: [0, 0, 1], range: [-1000, 1000]}
forces:
  wind: {type: force, coordinate: x, value: "push"}
outputs:
  ball: {type: position, body: ball}
""")
names = ["initial/x", "initial/z", "initial/x.rate", "initial/z.rate", "parameter/g", "parameter/m", "parameter/level", "input/push"]


def thrown(step, method, x, z, vx, vz, until="ball.z < level"):
    path = f"{work}/ball.scene"
    Path(path).write_text(f"gicscene: 1\nduration: 60\nstep: {step}\nintegrator: {method}\n"
                          f"initial: {{coordinates: {{x: {x!r}, z: {z!r}}}, rates: {{x: {vx!r}, z: {vz!r}}}}}\nuntil: \"{until}\"\n")
    return path


for method, step, x, z, vx, vz in (("rk4", 0.03, 0, 0.5, 3, 4), ("ab3", 0.01, 0, 0, 5, 5), ("rk4", 0.1, 1, 0, 1, 4), ("rk4", 0.1, 0, 0, 1, 0.01),
                                   ("ab3", 0.25, 0, 1, 1, 0), ("rk4", 0.5, 0, 8, 3, 2), ("rk4", 0.1, 0, 5, 0, 0), ("ab3", 0.2, 0, 0, 1, 1),
                                   ("rk4", 0.05, 0, 0, 10, 1e-3)):
    root = math.sqrt(vz * vz + 20 * z)  # of g = 10; acceleration along x is 0, changed by push / (m + 1)
    T = (vz + root) / 10
    by = {"initial/x": 0, "initial/z": 1 / root, "initial/x.rate": 0, "initial/z.rate": T / root, "parameter/g": -T * T / 2 / root, "parameter/m": 0,
          "parameter/level": -1 / root, "input/push": 0}
    path = thrown(step, method, x, z, vx, vz)
    what = f"a ball, {method}, {step}, {x, z, vx, vz}"
    for chosen in ([], *([n] for n in names[:1] + names[3:5])):
        value, d = gradient("time", ball, path, *chosen)
        near(f"{what}: time of flight", value, T, 1e-12)
        for name in d:
            near(f"{what}: time by {name}", d[name], by[name], 2e-11 * max(1, abs(by[name])))
        value, d = gradient("ball.x", ball, path, *chosen)
        near(f"{what}: range", value, x + vx * T, 1e-11 * max(1, abs(vx * T)))
        for name in d:
            wanted = vx * by[name] + {"initial/x": 1, "initial/x.rate": T, "input/push": T * T / 2 / 3}.get(name, 0)
            near(f"{what}: range by {name}", d[name], wanted, 2e-11 * max(1, abs(wanted)))
        value, d = gradient("integral(ball.x)", ball, path, *chosen)  # x is linear in time, so the trapezium is exact
        near(f"{what}: integral", value, x * T + vx * T * T / 2, 1e-11 * max(1, abs(vx * T * T)))
        for name in d:
            wanted = (x + vx * T) * by[name] + {"initial/x": T, "initial/x.rate": T * T / 2}.get(name, 0)
            if name != "input/push":
                near(f"{what}: integral by {name}", d[name], wanted, 2e-11 * max(1, abs(wanted)))
v = 10.0  # the range v^2 / g sin(2 a) by speed and angle: at 45 degrees the angle is the best
for angle in (30, 45, 60):
    a = math.radians(angle)
    value, d = gradient("ball.x", ball, thrown(0.05, "rk4", 0, 0, v * math.cos(a), v * math.sin(a)))
    near(f"{angle} degrees: range", value, v * v / 10 * math.sin(2 * a), 1e-11)
    by_speed = d["initial/x.rate"] * math.cos(a) + d["initial/z.rate"] * math.sin(a)
    by_angle = v * (d["initial/z.rate"] * math.cos(a) - d["initial/x.rate"] * math.sin(a))
    near(f"{angle} degrees: range by speed", by_speed, 2 * v / 10 * math.sin(2 * a), 1e-11)
    near(f"{angle} degrees: range by angle", by_angle, 2 * v * v / 10 * math.cos(2 * a), 1e-10)
# a time that is given stays; one that comes by a parameter moves
value, d = gradient("ball.x", ball, thrown(0.1, "rk4", 0, 0, 3, 4, "time > 0.5"))
near("a given time: x", value, 1.5, 1e-11)
near("a given time: x by its rate", d["initial/x.rate"], 0.5, 1e-11)
value, d = gradient("ball.x", ball, thrown(0.1, "rk4", 0, 0, 3, 4, "time > m / 4"))
near("a time by a parameter: x", value, 1.5, 1e-11)
near("a time by a parameter: x by it", d["parameter/m"], 0.75, 1e-11)
value = gradient("time", ball, thrown(0.1, "rk4", 0, 0, 3, 4, "time > m / 4"), "parameter/m")[1]["parameter/m"]
near("a time by a parameter: the time by it", value, 0.25, 1e-11)

# ---- a push that begins, and one that ends -------------------------------------------------------------------------------------

# from x = 0 with 4 m/s; at x = 1 a force of -6 N on 3 kg begins, and it is over at x = 2 by the second one
pushed = f"{work}/pushed.scene"
text = """gicscene: 1
duration: 2
step: STEP
integrator: METHOD
initial: {coordinates: {x: X0, z: 0}, rates: {x: V0, z: 1}}
inputs: {push: PUSH}
when:
  - {if: "x > 1", inputs: {push: -6}, mark: one}
  - {if: "x > 2", inputs: {push: 0}}
"""


def slid(x0, v0, push, g=10):
    a, end = push / 3, 2
    first = (1 - x0) / v0 if a == 0 else (math.sqrt(v0 * v0 + 2 * a * (1 - x0)) - v0) / a
    v1 = v0 + a * first
    v2 = math.sqrt(v1 * v1 - 4)
    second = first + (v1 - v2) / 2
    return 2 + v2 * (end - second)


def richardson(function, h):
    def one(h):
        return (function(h) - function(-h)) / (2 * h)
    return (64 * one(h / 4) - 20 * one(h / 2) + one(h)) / 45


for method, step in (("rk4", 0.02), ("ab3", 0.01), ("rk4", 0.25), ("rk4", 0.5)):
    for x0, v0, push in ((0.0, 4.0, 0.0), (0.1, 3.7, 1.5), (0.5, 4.0, 3.0)):
        Path(pushed).write_text(text.replace("STEP", str(step)).replace("METHOD", method).replace("X0", repr(x0)).replace("V0", repr(v0))
                                .replace("PUSH", repr(push)))
        what = f"pushes, {method}, {step}, {x0, v0, push}"
        by = {"initial/x": richardson(lambda e: slid(x0 + e, v0, push), 1e-2), "initial/x.rate": richardson(lambda e: slid(x0, v0 + e, push), 1e-2),
              "input/push": richardson(lambda e: slid(x0, v0, push + e), 1e-2) if push else 0}
        if not push:  # the limit of the formula
            by["input/push"] = richardson(lambda e: slid(x0, v0, push + e), 3e-2)
        value, d = gradient("ball.x", ball, pushed)
        near(f"{what}: x", value, slid(x0, v0, push), 1e-11)
        for name, wanted in by.items():
            near(f"{what}: x by {name}", d[name], wanted, 1e-8)
            near(f"{what}: x by {name} forwards", gradient("ball.x", ball, pushed, name)[1][name], d[name], 1e-12)

# a push that moves to another value from the one that it has, and a wave that has it in the middle
moved = """gicscene: 1
duration: 1.5
step: 0.02
integrator: METHOD
initial: {coordinates: {x: X0, z: 0}, rates: {x: V0, z: 1}}
inputs: {push: {step: {from: FROM, to: 3, rise: 2}}}
when:
  - {if: "x > 0.3 + push / 20", inputs: {push: CHANGE}}
"""
knobs = {"initial/x": ("X0", 0.0, 0.1), "initial/x.rate": ("V0", 1.0, 0.3), "input/push[0]": ("FROM", 1.0, 0.5)}
for change in ("{step: {to: -6, rise: 0.4}}", "{sine: {amplitude: 5, frequency: 1}}", "{step: {from: 2, to: 0, start: 0.1, rise: 0.3}}",
               "{ramp: {to: -2, duration: 0.5}}"):
    for method in ("ab3", "rk4"):
        scene = moved.replace("CHANGE", change).replace("METHOD", method)
        taylor(f"a push changes, {change}, {method}", "ball.x", ball, scene, knobs, 0.01 if method == "rk4" else 0.002)
        path = f"{work}/moved.scene"
        Path(path).write_text(scene.replace("X0", "0.0").replace("V0", "1.0").replace("FROM", "1.0"))
        both_ways(f"a push changes, {change}, {method}", "integral(ball.x * time)", ball, path)
        last = gic("-q", "--general", ball, path, "-o", "-").splitlines()
        column = [name.split(" [")[0] for name in last[0].split(",")].index("ball.x")
        # times of conditions are found by a cubic in the run, and by steps here
        near(f"a push changes, {change}, {method}: the run's own x", gradient("ball.x", ball, path, "initial/x")[0],
             float(last[-1].split(",")[column]), 1e-7)

# ---- contacts that are located --------------------------------------------------------------------------------------------------

drop = str(Path(__file__).resolve().parent.parent / "data/contact/drop.veh")  # 1 kg on a floor of k N/m at z = 0


def fallen(z, v, k, end):
    """Place at `end`: parabolas in the air, an oscillation about -10 / k on the floor."""
    w, t = math.sqrt(k), 0.0
    while True:
        air = (v + math.sqrt(v * v + 20 * z)) / 10
        if t + air > end:
            return z + v * (end - t) - 5 * (end - t) ** 2
        t, z, v = t + air, 0.0, v - 10 * air
        floor = 2 * (math.pi - math.atan2(-v / w, 10 / k)) / w  # until it is as high again
        if t + floor > end:
            return -10 / k + 10 / k * math.cos(w * (end - t)) + v / w * math.sin(w * (end - t))
        t, v = t + floor, -v


dropped = """gicscene: 1
duration: END
step: STEP
integrator: METHOD
locate: true
initial: {coordinates: {z: Z}, rates: {z: V}}
parameters: {k: K, c: C}
"""
fall = f"{work}/drop.scene"
for method, step, wide in (("rk4", 0.001, 1e-9), ("ab3", 0.0005, 1e-6)):
    for z, v, k, end in ((1.0, 0.0, 100.0, 2.0), (0.2, -1.0, 400.0, 1.5), (1.25, 0.0, 10000.0, 2.2)):
        Path(fall).write_text(dropped.replace("END", str(end)).replace("STEP", str(step)).replace("METHOD", method).replace("Z", repr(z))
                              .replace("V", repr(v)).replace("K", repr(k)).replace("C", "0"))
        what = f"a drop, {method}, {z, v, k}"
        value, d = gradient("z.value", drop, fall)
        size = (k / 100) ** 2  # what steps leave grows with a power of their share of a period
        near(f"{what}: z", value, fallen(z, v, k, end), wide * size)
        by = {"initial/z": richardson(lambda e: fallen(z + e, v, k, end), 1e-3), "initial/z.rate": richardson(lambda e: fallen(z, v + e, k, end), 1e-3),
              "parameter/k": richardson(lambda e: fallen(z, v, k + e, end), 1e-3 * k)}
        for name, wanted in by.items():
            near(f"{what}: by {name}", d[name], wanted, 20 * wide * size * max(1, abs(wanted)))
            if step == 0.001:
                near(f"{what}: by {name} forwards", gradient("z.value", drop, fall, name)[1][name], d[name], 1e-12 * max(1, abs(wanted)))
# where steps are long it is the derivative of the steps; a damper whose force does not pull
knobs = {"initial/z": ("Z", 1.0, 0.1), "initial/z.rate": ("V", -0.43, 0.2), "parameter/k": ("K", 200.0, 10), "parameter/c": ("C", 0.3, 0.05)}
for method in ("rk4", "ab3"):
    scene = dropped.replace("END", "2").replace("STEP", "0.01").replace("METHOD", method)
    taylor(f"a damped drop, {method}", "z.value", drop, scene, knobs, 0.001)
    for mark, value, unit in knobs.values():
        scene = scene.replace(mark, repr(value))
    Path(fall).write_text(scene)
    both_ways(f"a damped drop, {method}", "integral(z.value * time)", drop, fall)
    Path(fall).write_text(scene.replace("locate: true", "locate: loads") + "until: \"time > 1 and z > 0.1\"\n")
    both_ways(f"a damped drop with loads and an end, {method}", "z.rate", drop, fall)
# a wheel on the road and a load between stops, which touch at the same time
hop = str(Path(__file__).resolve().parent.parent / "data/contact/hop.veh")
for z, s in ((0.1, 0.0), (0.2, 1.0)):
    Path(fall).write_text(f"gicscene: 1\nduration: 1\nstep: 0.004\nintegrator: rk4\nlocate: true\n"
                          f"initial: {{coordinates: {{z: {z}, s: 0}}, rates: {{s: {s}}}}}\n")
    both_ways(f"a hop, {z, s}", "z.value + s.value", hop, fall)
# a car lands
jump = """gicscene: 1
duration: 0.4
step: 0.002
integrator: METHOD
locate: true
initial: {position: [0, 0, Z], velocity: [VX, 0, 0], coordinates: {spring_f_l: FRONT}, states: {STATES}}
inputs: {rack: {step: {to: RACK, rise: 0.2}}}
""".replace("STATES", ", ".join(f"tire_{a}_{b}.spin: 22" for a in "fr" for b in "lr"))
knobs = {"initial/z": ("Z", 0.6, 0.05), "initial/x.rate": ("VX", 10.0, 0.5), "initial/spring_f_l": ("FRONT", 0.25, 0.01), "input/rack[1]": ("RACK", 0.01, 0.005)}
for method in ("rk4", "ab3\nratio: 4"):
    scene = jump.replace("METHOD", method)
    taylor(f"a car lands, {method!r}", "chassis.z", f"{models}/hmmwv_tires.veh", scene, knobs, 0.004)
    for mark, value, unit in knobs.values():
        scene = scene.replace(mark, repr(value))
    Path(fall).write_text(scene)
    value = gradient("chassis.z", f"{models}/hmmwv_tires.veh", fall, "initial/z")[0]
    last = gic("-q", "--general", f"{models}/hmmwv_tires.veh", fall, "-o", "-").splitlines()
    column = [name.split(" [")[0] for name in last[0].split(",")].index("chassis.z")
    near(f"a car lands, {method!r}: the run's own z", value, float(last[-1].split(",")[column]), 1e-10)
    both_ways(f"a car lands, {method!r}", "chassis.y + chassis.z", f"{models}/hmmwv_tires.veh", fall, list(knobs) + ["initial/roll", "initial/pitch.rate"])

# ---- vehicles ------------------------------------------------------------------------------------------------------------------

# a car that brakes as soon as it has turned, and a run that ends at a speed
brakes = """gicscene: 1
duration: 3
step: 0.004
integrator: METHOD
initial: {position: [0, 0, 0.4825], velocity: [VX, 0.5, 0], coordinates: {spring_f_l: FRONT}, states: {STATES}}
inputs:
  rack: {step: {to: RACK, rise: 0.4, start: 0.1}}
when:
  - {if: "yaw > 0.05", inputs: {brake: {step: {to: 0.5, rise: 0.3}}}}
  - {if: "abs(roll) > 0.02", mark: leans}
until: "speed < 8.5"
""".replace("STATES", ", ".join(f"tire_{a}_{b}.{c}: {v}" for a in "fr" for b in "lr"
                                for c, v in (("spin", 22), ("slip_x", 0.01), ("slip_y", 0.02), ("brake", 0.1))))
knobs = {"initial/x.rate": ("VX", 10.0, 0.2), "initial/spring_f_l": ("FRONT", 0.25, 0.01), "input/rack[1]": ("RACK", -0.012, 0.002)}
for method in ("ab3\nratio: 4", "rk4"):
    scene = brakes.replace("METHOD", method)
    taylor(f"braking, {method!r}", "chassis.y", f"{models}/hmmwv_tires.veh", scene, knobs, 0.01 if method == "rk4" else 0.002)
    path = f"{work}/brakes.scene"
    for mark, value, unit in knobs.values():
        scene = scene.replace(mark, repr(value))
    Path(path).write_text(scene)
    few = list(knobs) + ["initial/yaw", "initial/yaw.rate", "input/rack[0]"]
    for formula in ("time", "integral(chassis.x)") if method == "rk4" else ("chassis.x",):
        both_ways(f"braking, {method!r}, {formula}", formula, f"{models}/hmmwv_tires.veh", path, few)
    last = gic("-q", "--general", f"{models}/hmmwv_tires.veh", path, "-o", "-").splitlines()
    near(f"braking, {method!r}: ends when the run does", gradient("time", f"{models}/hmmwv_tires.veh", path, "initial/x")[0],
         float(last[-1].split(",")[0]), 1e-6)
check("it ends early", float(last[-1].split(",")[0]) < 2.9)


# ---- conditions whose values jump: comparisons with =, `not`, `and`, `or`, `if` -----------------------------------------------------
# a cart from x = 0 at 1 m/s with 1 m/s^2 is at hi at T = sqrt(1 + 2 hi) - 1: 1 s for 1.5 m, at the end of a step as well as within one

cart = f"{work}/cart.veh"
Path(cart).write_text("""gicgen: 1
model: cart
base: ground
parameters:
  hi: {value: 1.5, unit: m, tunable: true}
  a: {value: 1, unit: N, tunable: true}
  wall: {value: 9, unit: m, tunable: true}
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  p: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], range: [-10, 10]}
forces:
  push: {type: force, coordinate: x, value: a}
  wall: {type: stop, coordinate: x, high: wall, stiffness: 1e4}
outputs:
  x: {type: coordinate, coordinate: x}
  flag: {type: signal, signal: flag}
signals:
  flag: {value: "if(x > hi, 1, -1)"}
""")
for hi in (1.5, 1.496):
    root = math.sqrt(1 + 2 * hi)
    T = root - 1
    by = {"initial/x": -1 / root, "initial/x.rate": -T / root, "parameter/hi": 1 / root, "parameter/a": -T * T / 2 / root, "parameter/wall": 0}
    for until in ("x.value > hi", "x.value >= hi", "hi <= x.value", "not (x.value < hi)", "not (x.value <= hi)", "if(x.value > hi, x.rate, -1)",
                  "if(x.value > hi, 1, 0)", "if(x.value < hi, -1, 2)", "-if(x.value < hi, 1, -1)", "x.value >= hi and x.rate >= 0", "x.value >= hi or time > 2.5",
                  "not (x.value < hi or x.rate <= 0)", "x.value > hi and not (x.value < 0)", "if(not (x.value < hi), x.value, -x.value)"):
        path = f"{work}/cart.scene"
        Path(path).write_text(f"gicscene: 1\nduration: 3\nstep: 0.01\nintegrator: rk4\ninitial: {{rates: {{x: 1}}}}\nparameters: {{hi: {hi}}}\nuntil: \"{until}\"\n")
        for chosen in ([], ["parameter/hi"], ["initial/x.rate"]):
            value, d = gradient("time", cart, path, *chosen)
            near(f"until {until}, {hi}: time", value, T, 1e-11)
            for name in d:
                near(f"until {until}, {hi}: time by {name}", d[name], by[name], 1e-10)
# whose time stays: the same for each variable
for until in ("if(time > 1, 1, -1)", "2 * if(time >= 1, 1, -1)", "x.value > if(time > 1, 0, 9)"):
    Path(path).write_text(f"gicscene: 1\nduration: 3\nstep: 0.01\ninitial: {{rates: {{x: 1}}}}\nuntil: \"{until}\"\n")
    value, d = gradient("time", cart, path)
    near(f"until {until}: time", value, 1, 1e-6)
    check(f"until {until}: it stays", len(d) > 2 and all(number == 0 for number in d.values()))
# true from the start, at its border: never becomes true
Path(path).write_text("gicscene: 1\nduration: 0.5\nstep: 0.01\ninitial: {rates: {x: 1}}\nuntil: \"x.value >= 0\"\n")
value, d = gradient("time", cart, path)
check("a condition that holds from the start", value == 0.5 and all(number == 0 for number in d.values()))

# ---- contacts at the ends of steps ---------------------------------------------------------------------------------------------
# at 1 m/s to a wall of 1e4 N/m and back: x(1) = 2 wall - 1 + pi / 100, whenever it is met. Tolerances: what RK4 and AB3 make of 100 rad/s, 0.1 and 0.5 a step

path = f"{work}/wall.scene"
for wall, step, method, far in ((0.5, 0.001, "rk4", 2e-6), (0.25, 0.001, "rk4", 2e-6), (0.5003, 0.001, "rk4", 2e-6), (0.5, 0.001, "ab3", 2e-3), (0.4, 0.005, "rk4", 1e-3),
                                (0.5, 0.005, "rk4", 1e-3), (0.4, 0.002, "rk4", 3e-4), (0.512, 0.002, "rk4", 3e-4)):
    for locate in ("true", "loads"):
        Path(path).write_text(f"gicscene: 1\nduration: 1\nstep: {step}\nintegrator: {method}\nlocate: {locate}\ninitial: {{rates: {{x: 1}}}}\n"
                              f"parameters: {{a: 0, wall: {wall}}}\n")
        for chosen in ([], ["parameter/wall"]):
            d = gradient("x.value", cart, path, *chosen)[1]
            near(f"a wall at {wall} m, {method}, {step}, locate: {locate}, {len(chosen)}: by its place", d["parameter/wall"], 2, far)

# ---- a stop on the piston of a slider crank, whose pose is found by iteration: forwards and backwards ----------------------------------

crank = f"{work}/crank.veh"
Path(crank).write_text("""gicgen: 1
model: crank
base: ground
parameters:
  lo: {value: 0.55, unit: m, tunable: true}
  T: {value: 0, unit: N m, tunable: true}
bodies:
  crank: {mass: 1, com: [0, 0, 0.05], inertia: [0.01, 0.01, 0.01]}
  rod: {mass: 1, com: [0.1414213562373095, 0, 0.05], inertia: [0.01, 0.01, 0.01]}
  piston: {mass: 1, com: [0.28284271247461903, 0, 0], inertia: [0.01, 0.01, 0.01]}
joints:
  main: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  pin: {type: revolute, bodies: [crank, rod], point: [0, 0, 0.1], axis: [0, 1, 0]}
  wrist: {type: point_on_line, bodies: [rod, piston], point: [0.28284271247461903, 0, 0], axis: [0, 1, 0]}
  bore: {type: prismatic, bodies: [ground, piston], axis: [1, 0, 0]}
coordinates:
  phi: {type: angle, bodies: [ground, crank], axis: [0, 1, 0], range: [-100, 100]}
forces:
  stop: {type: stop, bodies: [ground, piston], points: [[0.8, 0, 0], [0.28284271247461903, 0, 0]], low: lo, stiffness: 1e4, damping: 10, fade: 0.01}
  turn: {type: force, coordinate: phi, value: T}
outputs:
  phi: {type: coordinate, coordinate: phi}
""")
path = f"{work}/crank.scene"
for method in ("rk4", "ab3"):
    for k in range(12):
        Path(path).write_text(f"gicscene: 1\nduration: 1\nstep: 0.005\nintegrator: {method}\nlocate: true\ninitial: {{rates: {{phi: 5}}}}\n"
                              f"parameters: {{lo: {0.55 + 0.0005 * k!r}}}\n")
        back = gradient("phi.value", crank, path)[1]
        for name in ("parameter/lo", "initial/phi.rate"):
            near(f"a crank's stop, {method}, {k}: {name} both ways", back[name], gradient("phi.value", crank, path, name)[1][name], 1e-9 * abs(back[name]))

# ---- a wheel that is located beside a condition that is not met, and beside changes of gear --------------------------------------------

quarter = f"{work}/quarter.veh"
Path(quarter).write_text("""gicgen: 1
model: quarter
base: ground
parameters:
  m: {value: 300, unit: kg, tunable: true}
bodies:
  body: {mass: m, com: [0, 0, 0.6], inertia: [1, 1, 1]}
  hub: {mass: 40, com: [0, 0, 0.3], inertia: [1, 1, 1]}
joints:
  a: {type: prismatic, bodies: [ground, body], axis: [0, 0, 1]}
  b: {type: prismatic, bodies: [body, hub], axis: [0, 0, 1]}
coordinates:
  z: {type: translation, bodies: [ground, body], axis: [0, 0, 1], range: [-5, 5]}
  w: {type: translation, bodies: [body, hub], axis: [0, 0, 1], range: [-0.3, 0.3]}
forces:
  spring: {type: spring_damper, coordinate: w, stiffness: 20000, damping: 0}
  stop: {type: stop, coordinate: w, high: 0.1, low: -0.1, stiffness: 1e5, damping: 100}
wheels:
  t: {body: hub, center: [0, 0, 0.3], radius: 0.3, stiffness: 200000}
outputs:
  z: {type: coordinate, coordinate: z}
""")
path = f"{work}/quarter.scene"
Path(path).write_text("gicscene: 1\nduration: 0.5\nstep: 0.002\nlocate: true\ninitial: {rates: {z: 1}}\nuntil: \"z.value > 4\"\n")
check("a condition that is not met: the end stays", all(number == 0 for number in gradient("time", quarter, path)[1].values()))
both_ways("a condition that is not met", "z.value", quarter, path)
Path(path).write_text(Path(f"{models}/scenes/full_run.scene").read_text().replace("duration: 30", "duration: 4") + "\nlocate: true\n")
check("it is short", "duration: 4" in Path(path).read_text())
both_ways("gears and contacts", "chassis.x", f"{models}/hmmwv_vehicle.veh", path, ["initial/x.rate", "initial/yaw", "input/accelerator[1]", "input/rack[1]"])

# ---- a wheel that just touches at rest: the time of the contact has no derivative, what follows has --------------------------------------

touching = f"{work}/touching.veh"
Path(touching).write_text("""gicgen: 1
model: touching
base: ground
gravity: [0, 0, -10]
parameters:
  m: {value: 1, unit: kg, tunable: true}
bodies:
  b: {mass: m, com: [0, 0, 1], inertia: [1, 1, 1]}
joints:
  j: {type: prismatic, bodies: [ground, b], axis: [0, 0, 1]}
coordinates:
  z: {type: translation, bodies: [ground, b], axis: [0, 0, 1], range: [-5, 5]}
wheels:
  w: {body: b, center: [0, 0, 1], radius: 1, stiffness: 1000}
outputs:
  z: {type: coordinate, coordinate: z}
""")
path, w = f"{work}/touching.scene", math.sqrt(1000)
for method, limit in (("rk4", 3e-3), ("ab3", 0.1)):  # of an amplitude of 1 and of w: steps of 0.3 rad
    for height in (0, -0.001):
        Path(path).write_text(f"gicscene: 1\nduration: 0.1\nstep: 0.01\nintegrator: {method}\nlocate: true\ninitial: {{coordinates: {{z: {height}}}}}\n")
        for names in (["initial"], ["initial/z"], ["initial/z", "parameter/m"]):
            near(f"touching, {method}, {height}: z by z", gradient("z.value", touching, path, *names)[1]["initial/z"], math.cos(w * 0.1), limit)
            near(f"touching, {method}, {height}: rate by z", gradient("z.rate", touching, path, *names)[1]["initial/z"], -w * math.sin(w * 0.1), limit * w)

# ---- bends of roads: by moving the road ------------------------------------------------------------------------------------------

roads = {"a ramp": "{type: table, x: [%(5)s, %(6)s, %(9.4)s, %(9.5)s, %(9.8)s], height: [0, 0.06, 0.5, 0.51, 0]}",
         "bumps": "{type: bumps, bumps: [{x: %(3)s, length: 1, height: 0.05}, {x: %(5)s, length: 0.5, height: 0.02, y: [0, 2]}]}",
         "waves": "{type: sine, amplitude: 0.02, wavelength: 2, phase_per_y: 0.5, start: %(1)s}"}
# of wheels that roll they would follow the road as it moves
spins = "{" + ", ".join(f"tire_{wheel}.spin: 30, tire_{wheel}.slip_x: 0, tire_{wheel}.slip_y: 0" for wheel in ("f_l", "f_r", "r_l", "r_r")) + "}"
for what, road in roads.items():
    def over(moved, road=road):
        path = f"{work}/road.scene"
        places = {str(x): repr(x - moved) for x in (1, 3, 5, 6, 9.4, 9.5, 9.8)}
        Path(path).write_text(f"gicscene: 1\nduration: 0.9\nstep: 0.002\nratio: 4\ninitial: {{velocity: [14, 0, 0], states: {spins}}}\nroad: {road % places}\n")
        return path
    formula, vehicle, d = "chassis.z", f"{models}/hmmwv_tires.veh", 1e-6
    difference = (gradient(formula, vehicle, over(d), "initial/z")[0] - gradient(formula, vehicle, over(-d), "initial/z")[0]) / (2 * d)
    there = gradient(formula, vehicle, over(0), "initial/x")[1]["initial/x"]
    # 2e-16 m of a place, 1e-14 after 450 steps, over 2e-6; steps that are on another side of a bend by then
    near(f"{what}: by the place of the road", there, difference, 1e-6 * abs(difference) + 1e-8)
    both_ways(what, formula, vehicle, over(0), ["initial"])

finish()
