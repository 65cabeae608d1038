# SPDX-License-Identifier: MIT
"""gradient_loops.py GICRUN MODELS WORK: `gicrun --gradient` where a loop is closed between steps. Controllers, by the steps of a
cart written again here in 50 digits; models with controllers and scenes with drivers both ways, forwards and backwards, and by
Taylor remainders, which shrink with the square of the change. WORK has spring.veh of gradient.py."""
import csv
import re
from decimal import Decimal
from pathlib import Path

from counted import check, finish, near
from gradient_tools import both_ways, difference, gic, gradient, models, taylor, work

spring = f"{work}/spring.veh"
# ---- controllers ----------------------------------------------------------------------------------------------------------------

held = f"{work}/held.veh"
HELD = Path(spring).read_text().replace("model: spring", "model: held").replace("outputs:", """controllers:
  loop:
    period: 0.03
    offset: 0.01
    rules:
      sum: "loop.sum + 0.03 * (push - cart.x)"
      force: {value: "k * (push - cart.x) + 3 * loop.sum.next - 2 * rate(x)", unit: N, delay: DELAY}
outputs:""").replace("-k * x - c * rate(x) + push", "loop.force - c * rate(x) - 0.3 * x^3")


def sampled(method, h, delay, x=1, v=Decimal("0.5"), k=8, m=4, c=1, push=(0, 1)):
    """The cart's place at 2.1 s, in parts by RK4 where samples and effects lie within steps; a held value that changes
    begins AB3 anew."""
    period, offset, h, y, t = Decimal("0.03"), Decimal("0.01"), Decimal(h), [Decimal(x), Decimal(v)], Decimal(0)
    delay = Decimal(delay)
    force = total = Decimal(0)
    past, samples, late = [], 0, delay % period
    waiting = [(offset + late + j * period, force) for j in range(int(delay // period)) if late]  # the first of all

    def wish(t):
        s = min(max((t - Decimal("0.5")) / Decimal("0.3"), Decimal(0)), Decimal(1))
        return push[0] + (push[1] - push[0]) * s**3 * (10 + s * (6 * s - 15))

    def rate(t, y):
        return [y[1], (force - c * y[1] - Decimal("0.3") * y[0]**3) / m]

    def rk4(t, y, h):
        f = rate(t, y)
        sums, slope = list(f), f
        for reach, weight in ((h / 2, 2), (h / 2, 2), (h, 1)):
            slope = rate(t + reach, [a + reach * b for a, b in zip(y, slope)])
            sums = [a + weight * b for a, b in zip(sums, slope)]
        return [a + h / 6 * b for a, b in zip(y, sums)], f

    for i in range(round(Decimal("2.1") / h)):
        end, parted = (i + 1) * h, False
        while True:
            if waiting and waiting[0][0] <= t:
                past = past if waiting[0][1] == force else []
                force = waiting.pop(0)[1]
            if offset + samples * period <= t:
                total = total + period * (wish(t) - y[0])
                new = k * (wish(t) - y[0]) + 3 * total - 2 * y[1]
                if delay:
                    waiting.append((t + delay, new))
                else:
                    force = new
                past = []  # the sum is held, too
                samples += 1
            after = min([offset + samples * period] + [w[0] for w in waiting])
            if after >= end:
                break
            y, t, parted = rk4(t, y, after - t)[0], after, True
        if parted:
            y, past = rk4(t, y, end - t)[0], []
        elif method == "ab3" and len(past) == 2:
            f = rate(t, y)
            y, past = [a + h / 12 * (23 * b - 16 * g + 5 * e) for a, b, g, e in zip(y, f, past[0], past[1])], [f, past[0]]
        else:
            y, f = rk4(t, y, h)
            past = ([f] + past)[:2]
        t = end
    return y[0]


for delay in ("0", "0.03", "0.06", "0.017", "0.05"):
    Path(held).write_text(HELD.replace("DELAY", delay))
    for method, h in (("rk4", "0.01"), ("ab3", "0.01"), ("rk4", "0.02"), ("ab3", "0.007"), ("ab3", "0.001")):
        text = (f"gicscene: 1\nduration: 2.1\nstep: {h}\nintegrator: {method}\nparameters: {{k: 8, c: 1}}\n"
                "initial: {coordinates: {x: 1}, rates: {x: 0.5}}\ninputs: {push: {step: {from: 0, to: 1, start: 0.5, rise: 0.3}}}\n")
        Path(f"{work}/held.scene").write_text(text)
        value, d = gradient("cart.x", held, f"{work}/held.scene")
        if h == "0.001":
            continue
        near(f"held, {delay}, {method}, {h}: the end", value, float(sampled(method, h, delay)), 1e-12)
        one = Decimal(1)
        wanted = {"initial/x": difference(lambda p: sampled(method, h, delay, x=p), one),
                  "initial/x.rate": difference(lambda p: sampled(method, h, delay, v=p), one / 2),
                  "parameter/k": difference(lambda p: sampled(method, h, delay, k=p), 8 * one),
                  "parameter/m": difference(lambda p: sampled(method, h, delay, m=p), 4 * one),
                  "parameter/c": difference(lambda p: sampled(method, h, delay, c=p), one),
                  "input/push[1]": difference(lambda p: sampled(method, h, delay, push=(0, p)), one)}
        for name, number in wanted.items():
            near(f"held, {delay}, {method}, {h}: the steps' derivative by {name}", d[name], number, 1e-12)
    for formula in ("cart.x", "integral(cart.x^2)", "maximum(cart.x)"):
        both_ways(f"held, {delay}, {formula}", formula, held, f"{work}/held.scene")

# at rest all that is held is 0 and stays so, but would not
Path(held).write_text(HELD.replace("DELAY", "0"))
Path(f"{work}/held.scene").write_text("gicscene: 1\nduration: 2.1\nstep: 0.01\nparameters: {k: 8, c: 1}\n"
                                      "initial: {coordinates: {x: 0}}\ninputs: {push: 0}\n")
value, d = gradient("cart.x", held, f"{work}/held.scene")
check("at rest it stays", value == 0)
small = Decimal(10) ** -20
near("held at rest: by x", d["initial/x"], float(sampled("ab3", "0.01", "0", x=small, v=0, push=(0, 0)) / small), 1e-12)
near("held at rest: by rate", d["initial/x.rate"], float(sampled("ab3", "0.01", "0", x=0, v=small, push=(0, 0)) / small), 1e-12)
both_ways("held at rest", "integral(cart.x)", held, f"{work}/held.scene")

# the models with controllers, of which some clip or round what they hold
for name in ("abs", "esc", "skyhook"):
    scene = re.sub("(?m)^until: .*\n", "", Path(f"{models}/controllers/{name}.scene").read_text())
    scene = re.sub("(?m)^duration: .*", "duration: 1", scene)
    path = f"{work}/{name}.scene"
    Path(path).write_text(scene)
    model = f"{models}/controllers/{name}.veh"
    output = "carriage.z" if name == "skyhook" else "chassis.x"
    value = gradient(output, model, path, "initial/x" if name != "skyhook" else "initial/spring")[0]
    rows = list(csv.DictReader(gic("-q", "--general", model, path, "-o", "-").splitlines()))
    last = [float(number) for column, number in rows[-1].items() if column.startswith(output)][0]
    near(f"{name}: the value is that of the run", value, last, 1e-11)
    both_ways(name, output, model, path, ["initial/spring", "initial/spring.rate", "input/push.amplitude"] if name == "skyhook" else
              ["initial/x.rate", "initial/yaw.rate", "initial/spring_f_l", "initial/tire_f_l.spin"])

# ---- drivers --------------------------------------------------------------------------------------------------------------------

driven = """gicscene: 1
duration: 2.5
step: 0.006
integrator: METHOD
initial: {position: [0, OFFSET, 0.4825], velocity: [VX, 0.1, 0], angular_velocity: [0, 0, YAW], gear: 2,
          states: {engine.speed: 200, SPINS}}
driver:
  period: 0.024
  speed: {target: 10}
  steering:
    path: PATH
    input: rack
    per_angle: -0.142
    wheelbase: 3.302
    limit: 0.07
"""
driven = driven.replace("SPINS", ", ".join(f"tire_{a}_{b}.{c}: {v}" for a in "fr" for b in "lr"
                                           for c, v in (("spin", 21), ("slip_x", 0.01), ("slip_y", 0.02))))
start = {"initial/x.rate": ("VX", 9.5, 0.5), "initial/y": ("OFFSET", 0.4, 0.3), "initial/yaw.rate": ("YAW", 0.05, 0.05)}
straight = "{points: [[-40, 0], [200, 0]]}"
for method, step in (("ab3\nratio: 6", "0.006"), ("rk4", "0.002")):
    scene = driven.replace("METHOD", method).replace("0.006", step).replace("PATH", straight)
    for formula in ("chassis.y", "integral(chassis.x * chassis.y)"):
        taylor(f"a driver, {method!r}, {formula}", formula, f"{models}/hmmwv_vehicle.veh", scene, start, 0.02)
for path_text in (straight, "{points: [[-40, 0], [0, 0], [8, 0.5], [16, 3], [24, 3.5], [60, 3.5]]}", "{circle: {center: [0, 30], radius: 30}}"):
    path = f"{work}/driven.scene"
    text = driven.replace("METHOD", "ab3\nratio: 6").replace("PATH", path_text)
    for mark, value, unit in start.values():
        text = text.replace(mark, repr(value))
    Path(path).write_text(text)
    rows = list(csv.DictReader(gic("-q", "--general", f"{models}/hmmwv_vehicle.veh", path, "-o", "-").splitlines()))
    last = [float(number) for column, number in rows[-1].items() if column.startswith("chassis.y")][0]
    near(f"a driver, {path_text}: the value is that of the run",
         gradient("chassis.y", f"{models}/hmmwv_vehicle.veh", path, "initial/y")[0], last, 1e-11)
    for formula in ("chassis.y", "integral(rack^2)", "maximum(chassis_attitude.roll)"):
        both_ways(f"a driver, {path_text}, {formula}", formula, f"{models}/hmmwv_vehicle.veh", path,
                  list(start) + ["initial/spring_f_l", "initial/engine.speed", "initial/tire_f_l.slip_y"])

finish()
