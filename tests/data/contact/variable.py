# SPDX-License-Identifier: MIT
# variable.py GICRUN MODEL: contacts under variable steps, against closed solutions and, where there is a damper, against
# an integration of its own from event to event. MODEL is stops.veh, copied into the present folder.
import csv
import math
import subprocess
import sys

gicrun, model = sys.argv[1:3]
OMEGA, G = 20.0, 10.0  # rad/s of all undamped stops, m/s^2
bad = total = 0


def run(integrator, tolerance, duration, rows, initial, engine):
    text = f"gicscene: 1\nduration: {duration!r}\nintegrator: {integrator}\ntolerance: {tolerance!r}\n"
    text += f"output_step: {duration / rows!r}\ninitial: {initial}\n"
    with open("now.scene", "w") as file:
        file.write(text)
    done = subprocess.run([gicrun, "--engine", engine, model, "now.scene", "-o", "-"], capture_output=True, text=True)
    if done.returncode:
        print(done.stderr)
        return None
    return [[float(x) for x in row] for row in list(csv.reader(done.stdout.splitlines()))[1:]]


def between(t, s, v):
    """A mass that slides between stops at 0 and 1 m, from s at v: a way, half a period in a stop, a way..."""
    while True:
        if v > 0 and s < 1 or v < 0 and s > 0:
            way = ((1 if v > 0 else 0) - s) / v
            if t <= way:
                return s + v * t, v
            t -= way
            s = 1.0 if v > 0 else 0.0
        side, base = (1, 1.0) if s >= 1 else (-1, 0.0)
        depth, speed = side * (s - base), side * v
        if depth <= 0 and speed <= 0:
            return s, v  # at rest
        # depth cos + speed / omega sin, back at 0
        out = (math.pi if depth == 0 else math.atan2(speed, -depth * OMEGA) if speed else math.pi / 2) / OMEGA
        if depth and speed:
            out = (math.atan2(speed / OMEGA, depth) + math.pi / 2) / OMEGA
        if t <= out:
            c, w = math.cos(OMEGA * t), math.sin(OMEGA * t)
            return base + side * (depth * c + speed / OMEGA * w), side * (speed * c - depth * OMEGA * w)
        t -= out
        s, v = base, -side * math.hypot(speed, depth * OMEGA)


def thrown(t, v):
    """A mass thrown up at v from 0 under a stop at 0.05 m: it reaches it or does not."""
    square = v * v - 2 * G * 0.05
    if square <= 0:
        return v * t - G * t * t / 2, v - G * t
    u = math.sqrt(square)
    meets, stay = (v - u) / G, 2 / OMEGA * math.atan(u * OMEGA / G)
    if t <= meets:
        return v * t - G * t * t / 2, v - G * t
    t -= meets
    if t <= stay:
        c, w = math.cos(OMEGA * t), math.sin(OMEGA * t)
        return 0.05 + u / OMEGA * w - G / OMEGA**2 * (1 - c), u * c - G / OMEGA * w
    t -= stay
    return 0.05 - u * t - G * t * t / 2, -u - G * t


def damped(duration, x, v):
    """2 kg between stops at -0.1 and 0.1 m of 4 kN/m and 600 Ns/m, which fades in over 20 mm: RK4 from event to event."""

    def numbers(x, v):
        depth, rate = (x - 0.1, v) if x > 0 else (-0.1 - x, -v)
        s = min(max(depth / 0.02, 0), 1)
        return depth, 4000 * depth + 600 * s * s * (3 - 2 * s) * rate, 0.02 - depth

    def pieces(x, v):
        return tuple(number > 0 for number in numbers(x, v))

    def force(x, v, kind):
        depth, push, _ = numbers(x, v)
        return 0.0 if not (kind[0] and kind[1]) else (-push / 2 if x > 0 else push / 2)

    def step(x, v, h, kind):
        a = force(x, v, kind)
        x2, v2 = x + h / 2 * v, v + h / 2 * a
        b = force(x2, v2, kind)
        x3, v3 = x + h / 2 * v2, v + h / 2 * b
        c = force(x3, v3, kind)
        x4, v4 = x + h * v3, v + h * c
        d = force(x4, v4, kind)
        return x + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a + 2 * b + 2 * c + d)

    t = 0.0
    while t < duration:
        kind = pieces(x, v)
        h = min(2e-5 if kind[0] else 1e-4, duration - t)
        there = step(x, v, h, kind)
        if pieces(*there) != kind and h > 1e-15:
            low, high = 0.0, h
            while high - low > 1e-17:
                middle = (low + high) / 2
                if not low < middle < high:
                    break
                if pieces(*step(x, v, middle, kind)) == kind:
                    low = middle
                else:
                    high = middle
            h, there = high, step(x, v, high, kind)
        (x, v), t = there, t + h
    return x, v


def judge(name, got, exact, limit):
    global bad, total
    total += 1
    off = max(abs(a - b) for a, b in zip(got, exact)) if got else math.inf
    if not off <= limit:
        bad += 1
        print(f"{name}: {off:.3g}, not below {limit:.3g}; {got} and {exact}")


edge = math.sqrt(2 * G * 0.05)  # just reaches the stop
starts = [(0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (1.0, -1.0), (1.0, 0.0), (0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.25, -4.0),
          (1.125, 0.0), (-0.5, 0.0), (1.5, 0.5), (-0.25, -2.0), (0.75, 1e-3)]
throws = [edge, 1.0, 0.0, math.sqrt(1 + 2e-5), math.sqrt(1 + 2e-8), math.sqrt(1 - 2e-8), 1.25, 2.0, -1.0, 5.0]
hits = [3.0, -3.0, 0.0, 1.0, -1.0, 0.125, 8.0]
exact_damped = {v: damped(0.5, 0.0, v) for v in hits}
# the damper's mass alone, in one step as long as may be, at any tolerance
for integrator in "rkck", "adams", "bdf":
    for tolerance in 0.01, 1e-4, 1e-6, 1e-9, 1e-12:
        for v in hits:
            rows = run(integrator, tolerance, 0.5, 1, f"{{rates: {{x: {v!r}}}, coordinates: {{z: -9}}}}", "tape")
            # errors of steps, some hundred in the contact, whose rates are a hundred times the numbers
            judge(f"{integrator} {tolerance}: damped from {v}", rows and rows[-1][7:9], exact_damped[v],
                  max(30 * tolerance, 1e-9))
# bdf has order 5 and takes tens of thousands of steps at this tolerance
most = {"rkck": 1e-10, "adams": 1e-9, "bdf": 1e-8}
# closed solutions: nice numbers, starts on stops and in them, the stop just reached or just not, rows at contacts
for integrator in "rkck", "adams", "bdf":
    for i, (s, v) in enumerate(starts):
        up = throws[i % len(throws)]
        for rows_wanted in (1, 8) if i % 2 else (2, 16):
            engine = "tcc" if rows_wanted < 3 else "tape"
            rows = run(integrator, 1e-13, 2.0, rows_wanted, f"{{coordinates: {{s: {s!r}}}, rates: {{s: {v!r}, z: {up!r}}}}}",
                       engine)
            for row in rows or [[2.0] + 9 * [math.inf]]:
                judge(f"{integrator}: slides from {s} at {v}, t = {row[0]}", row[1:3], between(row[0], s, v), most[integrator])
                judge(f"{integrator}: thrown at {up}, t = {row[0]}", row[4:6], thrown(row[0], up), 1e-9)
print(f"{total} numbers, {bad} bad")
sys.exit(bad > 0)
