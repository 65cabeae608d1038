# SPDX-License-Identifier: MIT
"""exact.py RESULTS.csv SETTINGS...: the model of tests/controllers/loop.veh.in from event to event, in closed form, against
a table of results; prints the largest deviation, relative to 1 and the size. Written from models/FORMAT.md section 7.4:
times of samples and effects are rational numbers, sorted; between them the force is constant, so that the mass moves on a
parabola, or with a spring on a sine."""
import csv
import math
import sys
from fractions import Fraction

SETTINGS = dict(period="0.1", offset="0", delay="0", quantum="0", mean="0.1", mean_offset="0", spring="0", start="0")
SETTINGS.update(a.split("=") for a in sys.argv[2:])
number = {k: Fraction(v) for k, v in SETTINGS.items()}
MASS, WISH = 2.0, 1.0
SAME = Fraction(1, 10**10)  # s: 1e-9 of a period of 0.1 s
SPRING = float(number["spring"])


class Loop:
    def __init__(self):
        self.t = Fraction(0)
        self.x, self.v = float(number["start"]), 0.0
        self.held = dict(sum=0.0, force=0.0, mean=0.0)
        self.waiting = []  # (time of effect, force)

    def acceleration(self):
        return (self.held["force"] - SPRING * self.x) / MASS

    def move(self, to):
        h, a = float(to - self.t), self.acceleration()
        if SPRING:
            w, rest = math.sqrt(SPRING / MASS), self.held["force"] / SPRING
            c, s, d = math.cos(w * h), math.sin(w * h), self.x - rest
            self.x, self.v = rest + d * c + self.v / w * s, self.v * c - d * w * s
        else:
            self.x, self.v = self.x + h * self.v + h * h / 2 * a, self.v + h * a
        self.t = to

    def sample(self, servo, mean):
        """Both controllers read what was held before."""
        now, error = dict(self.held), WISH - self.x
        if servo:
            now["sum"] = self.held["sum"] + 0.1 * error
            force = 8 * error - 6 * self.v + now["sum"] - 0.25 * self.acceleration() + 0.125 * self.held["mean"]
            q = float(number["quantum"])
            if q:
                force = math.copysign(math.floor(abs(force) / q + 0.5) * q, force)
            self.waiting.append((self.t + number["delay"], force))
        if mean:
            now["mean"] = 0.5 * (self.held["mean"] + self.held["force"])
        self.held = now

    def effects(self):
        while self.waiting and self.waiting[0][0] <= self.t + SAME:
            self.held["force"] = self.waiting.pop(0)[1]


def instants(until):
    """(time, [servo sampled, mean sampled]) and effects, in order; those at the same time are one."""
    all_of_them = []
    for which, (period, offset) in enumerate([("period", "offset"), ("mean", "mean_offset")]):
        for k in range(math.ceil((until - number[offset]) / number[period])):
            t = number[offset] + k * number[period]
            all_of_them.append((t, which))
            if which == 0:
                all_of_them.append((t + number["delay"], None))
    merged = []
    for t, which in sorted(all_of_them, key=lambda instant: instant[0]):
        if not merged or t - merged[-1][0] > SAME:
            merged.append((t, [False, False]))
        if which is not None:
            merged[-1][1][which] = True
    return merged


rows = list(csv.reader(open(sys.argv[1])))
names = [name.split(" ")[0] for name in rows[0]]
table = [[float(cell) for cell in row] for row in rows[1:]]
step = Fraction(rows[2][0])  # of output
loop, events, next_one, worst = Loop(), instants(step * (len(table) - 1)), 0, 0.0
for i, row in enumerate(table):
    time = i * step
    while next_one < len(events) and events[next_one][0] < time - SAME:  # what happens at a row's time comes after it
        t, (servo, mean) = events[next_one]
        next_one += 1
        loop.move(t)
        loop.effects()
        loop.sample(servo, mean)
        loop.effects()  # those without delay
    loop.move(time)
    right = {"x.value": loop.x, "x.rate": loop.v, "x.acceleration": loop.acceleration(), **loop.held}
    for name, given in zip(names[1:], row[1:]):
        worst = max(worst, abs(given - right[name]) / (1 + abs(right[name])))
print(worst if len(table) > 3 else math.inf)
