# SPDX-License-Identifier: MIT
# let_go.py GICRUN: a mass between damped stops, under variable steps. Thrown back, it leaves the damper behind far
# outside, is held again for a part of a millisecond where the damper fades out, and then flies so evenly that one step
# suffices for all of this. Against an integration from event to event whose steps are a fiftieth of the time in which
# the mass would leave the stop, so that it can't miss the hold. Its number of contacts must be met, too.
import csv
import itertools
import math
import re
import subprocess
import sys

gicrun = sys.argv[1]
G, HIGH, STIFFNESS = 10.0, 1.25, 1e4  # of 1 kg
bad = total = 0

MODEL = """gicgen: 1
model: let_go
base: ground
gravity: [0, 0, -10]
bodies:
  a: {{mass: 1, com: [0, 1, 0], inertia: [1, 1, 1]}}
joints:
  j: {{type: prismatic, bodies: [ground, a], axis: [0, 0, 1]}}
coordinates:
  z: {{type: translation, bodies: [ground, a], axis: [0, 0, 1], range: [-1, 10]}}
forces:
  s: {{type: stop, coordinate: z, low: 0, high: 1.25, stiffness: 10000, damping: {damping!r}, fade: {fade!r}}}
outputs:
  z: {{type: coordinate, coordinate: z}}
"""


def exact(z, v, duration, rows, damping, fade):
    """Rows of place and speed, and how many contacts were made or lost."""

    def numbers(z, v):
        depth, rate = (z - HIGH, v) if z > HIGH / 2 else (-z, -v)
        s = min(max(depth / fade, 0), 1)
        return depth, STIFFNESS * depth + damping * s * s * (3 - 2 * s) * rate, fade - depth

    def pieces(z, v):
        depth, push, left = numbers(z, v)
        return depth > 0, depth > 0 and push > 0, left > 0

    def pull(z, v, kind):
        push = numbers(z, v)[1] if kind[1] else 0.0
        return -G - push if z > HIGH / 2 else -G + push

    def step(z, v, h, kind):
        a = pull(z, v, kind)
        z2, v2 = z + h / 2 * v, v + h / 2 * a
        b = pull(z2, v2, kind)
        z3, v3 = z + h / 2 * v2, v + h / 2 * b
        c = pull(z3, v3, kind)
        z4, v4 = z + h * v3, v + h * c
        d = pull(z4, v4, kind)
        return z + h / 6 * (v + 2 * v2 + 2 * v3 + v4), v + h / 6 * (a + 2 * b + 2 * c + d)

    t, found, contacts = 0.0, [(z, v)], 0
    while len(found) <= rows:
        end = len(found) * duration / rows
        kind, depth = pieces(z, v), numbers(z, v)[0]
        # no step from the air goes into a stop and out again: 1e-4 s of 10 m/s^2 are 5e-8 m
        h = min(2e-5, max(0.02 * depth / (abs(v) + 1e-9), 1e-9)) if kind[0] else 1e-4
        h = min(h, end - t)
        there = step(z, v, h, kind)
        if pieces(*there) != kind:
            low, high = 0.0, h
            while high - low > 1e-17:
                middle = (low + high) / 2
                if not low < middle < high:
                    break
                if pieces(*step(z, v, middle, kind)) == kind:
                    low = middle
                else:
                    high = middle
            h, there = high, step(z, v, high, kind)
            contacts += pieces(*there)[1] != kind[1]
        (z, v), t = there, t + h
        if t >= end - 1e-15:
            t = end
            found.append((z, v))
    return found, contacts


def run(engine, integrator, tolerance, z, v, duration, rows):
    with open("now.scene", "w") as file:
        file.write(f"gicscene: 1\nduration: {duration!r}\nintegrator: {integrator}\ntolerance: {tolerance!r}\n"
                   f"output_step: {duration / rows!r}\ninitial: {{coordinates: {{z: {z!r}}}, rates: {{z: {v!r}}}}}\n")
    done = subprocess.run([gicrun, "--engine", engine, "let_go.veh", "now.scene", "-o", "now.csv"], capture_output=True,
                          text=True)
    said = re.search(r"contacts located +(\d+)", done.stdout + done.stderr)
    if done.returncode:
        print(done.stdout + done.stderr)
        return [], -1
    with open("now.csv") as file:
        return [[float(x) for x in row[1:3]] for row in list(csv.reader(file))[1:]], int(said[1]) if said else 0


def judge(name, right, text):
    global bad, total
    total += 1
    if not right:
        bad += 1
        print(f"{name}: {text}")


# damping, fade, place and speed at the start, duration, rows
throws = [(100.0, 0.001, 1.0, 10.0, 0.75, 3), (100.0, 0.001, 1.0, 0.0, 0.75, 1), (100.0, 0.001, 1.25, -5.0, 0.5, 2),
          (50.0, 0.001, 0.5, 5.0, 0.5, 1), (100.0, 0.01, 1.0, 5.0, 0.5, 1), (25.0, 0.001, 1.0, 10.0, 0.5, 1)]
tolerances = [3e-8, 1e-8, 3e-9, 1e-9, 3e-10, 1e-10, 3e-11, 1e-11, 3e-12, 1e-12]
for throw in throws:
    damping, fade, z, v, duration, rows = throw
    with open("let_go.veh", "w") as file:
        file.write(MODEL.format(damping=damping, fade=fade))
    due, contacts = exact(z, v, duration, rows, damping, fade)
    fastest = max(abs(v), math.sqrt(v * v + 2 * G * z))
    for engine, (integrator, share) in itertools.product(("tape", "gic"), (("rkck", 30), ("adams", 150))):
        for tolerance in tolerances:
            name = f"{engine} {integrator} {tolerance}: damping {damping}, fade {fade}, from {z} at {v}"
            got, met = run(engine, integrator, tolerance, z, v, duration, rows)
            off = max((abs(a - b) for p, q in zip(got, due) for a, b in zip(p, q)), default=math.inf)
            limit = share * tolerance * (1 + fastest) + 1e-9
            judge(name, len(got) == len(due) and off <= limit, f"{off:.3g}, not below {limit:.3g}")
            judge(name, met == contacts, f"{met} contacts, not {contacts}")
print(f"{total} numbers, {bad} bad")
sys.exit(bad > 0)
