# SPDX-License-Identifier: MIT
"""What tests of `gicrun --gradient` share; their command lines have GICRUN MODELS WORK."""
import csv
import math
import sys
from decimal import Decimal, getcontext
from pathlib import Path

from counted import check, near, runner

gicrun, models, work = sys.argv[1:4]
gic = runner(gicrun)
getcontext().prec = 50


def gradient(formula, model, scene, *names):
    rows = list(csv.DictReader(gic("--gradient", formula, model, scene, *names, "-o", "-").splitlines()))
    return float(rows[0]["value"]), {r["variable"]: float(r["derivative"]) for r in rows[1:]}


def steps(rate, y, h, count, method):
    """y after the steps of the runtime core: RK4, or AB3 that begins with two steps of RK4."""
    h = Decimal(str(h))
    past = []
    for i in range(count):
        t = h * i
        f = rate(t, y)
        if method == "ab3" and len(past) == 2:
            y = [a + h / 12 * (23 * b - 16 * c + 5 * e) for a, b, c, e in zip(y, f, past[0], past[1])]
        else:
            total, slope = list(f), f
            for reach, weight in ((h / 2, 2), (h / 2, 2), (h, 1)):
                slope = rate(t + reach, [a + reach * b for a, b in zip(y, slope)])
                total = [a + weight * b for a, b in zip(total, slope)]
            y = [a + h / 6 * b for a, b in zip(y, total)]
        past = ([f] + past)[:2]
    return y


def difference(function, number):
    h = Decimal(10) ** -20
    return float((function(number + h) - function(number - h)) / (2 * h))


def taylor(what, formula, model, scene, variables, change):
    """variables: name to (text in the scene that is replaced, its value); change: of all at once, relative to 1."""
    def run(e):
        text = scene
        for name, (mark, value, unit) in variables.items():
            text = text.replace(mark, repr(value + e * unit))
        path = f"{work}/taylor.scene"
        Path(path).write_text(text)
        return gradient(formula, model, path, *variables)

    value, d = run(0)
    slope = sum(d[name] * unit for name, (mark, at, unit) in variables.items())
    rest = [run(e)[0] - value - e * slope for e in (change, change / 2, -change, -change / 2)]
    order = [math.log2(abs(rest[i] / rest[i + 1])) for i in (0, 2)]
    # a maximum is that of steps, which may be another one
    least = 1.5 if formula.startswith("maximum") else 1.8
    check(f"{what}: remainders {rest} of order {order}, slope {slope}", all(least < o < 2.2 for o in order))
    # what is even is no derivative: the odd part of both has to be it
    odd = (run(change / 2)[0] - run(-change / 2)[0]) / change
    near(f"{what}: slope", slope, odd, 4 * change**2 * max(1, abs(slope)))


def both_ways(what, formula, model, scene, names=()):
    value, back = gradient(formula, model, scene, *names)
    check(f"{what}: more variables than go forwards", len(back) > 2)
    sizes = {}
    for name in back:
        again, one = gradient(formula, model, scene, name)
        near(f"{what}: the value with {name}", again, value, 1e-12 * max(1, abs(value)))
        sizes[name] = one[name]
    kinds = {name: name.split("/")[0] + name.endswith(".rate") * "r" for name in back}
    for name, number in sizes.items():
        largest = max(abs(sizes[n]) for n in back if kinds[n] == kinds[name])
        near(f"{what}: {name} both ways", back[name], number, 1e-12 * abs(number) + 1e-13 * largest)
