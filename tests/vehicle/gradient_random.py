# SPDX-License-Identifier: MIT
"""gradient_random.py GICRUN MODELS WORK RANDOM_VEHICLE FIRST COUNT: Taylor remainders of order 2 of whole runs of random mechanisms
that a condition ends, or that go to their end."""
import math
import subprocess
import sys
from pathlib import Path

from counted import check, finish
from gradient_tools import gradient, work

random_vehicle, first, count = sys.argv[4], int(sys.argv[5]), int(sys.argv[6])


def scene(text, rates, until):
    path = f"{work}/random.scene"
    Path(path).write_text(f"gicscene: 1\nduration: 0.06\nstep: 0.001\nintegrator: {text}\noutput_step: 0.001\ninitial: {{rates: "
                          f"{{{', '.join(f'{name}: {rate!r}' for name, rate in rates.items())}}}}}\n" + until)
    return path


def column(table, name):
    title = [n.split(" [")[0] for n in table[0]]
    return [float(row[title.index(name)]) for row in table[1:]]


tried = 0
for seed in range(first, first + count):
    model = f"{work}/random_{seed}.veh"
    text = subprocess.run([random_vehicle, "--seed", str(seed), "--mechanism"], capture_output=True, text=True, check=True).stdout
    inside, names, outputs = "", [], {}
    for line in text.splitlines():
        if not line.startswith(" "):
            inside = line
        elif inside == "coordinates:" and "driven" not in line:
            names.append(line.split(":")[0].strip())
        elif inside == "outputs:" and "type: coordinate," in line:
            outputs[line.split("coordinate: ")[1].split("}")[0]] = line.split(":")[0].strip()
    name = next((n for n in names if n in outputs), None)
    if name is None:
        continue
    Path(model).write_text(text)
    rates = {n: 0.5 + 0.1 * i for i, n in enumerate(names)}
    for method in ("rk4", "ab3"):
        run = subprocess.run([sys.argv[1], "-q", "--general", model, scene(method, rates, ""), "-o", "-"], capture_output=True, text=True)
        if run.returncode:
            break # a mechanism that such rates bring to a singular configuration
        table = [row.split(",") for row in run.stdout.splitlines()]
        way = column(table, outputs[name] + ".value")
        # in the middle of a step, at 0.0405 s, where it moves on
        threshold = (way[40] + way[41]) / 2
        sign = ">" if way[41] > way[40] else "<"
        passed = [k for k in range(41) if (way[k] > threshold) == (sign == ">")]
        if way[41] == way[40] or passed:
            continue
        conditions = ("", f'until: "{name} {sign} {threshold!r}"\n')
        for until in conditions:
            for formula in ("time" if until else f"{outputs[name]}.rate", f"integral({name}^2 + rate({name}))"):
                variable = f"initial/{names[-1]}.rate"
                e, at = 5e-4, rates[names[-1]]
                def value(x):
                    return gradient(formula, model, scene(method, {**rates, names[-1]: x}, until), variable)
                still, d = value(at)
                rest = [value(at + x)[0] - still - x * d[variable] for x in (e, e / 2, -e, -e / 2)]
                size = abs(still) + abs(d[variable])
                floor = 1e-11 * size # of rounding, and of Newton's iteration
                good = all(abs(rest[i]) < floor or abs(rest[i + 1]) < floor or 1.8 < math.log2(abs(rest[i] / rest[i + 1])) < 2.2 for i in (0, 2))
                check(f"{seed}, {method}, {until.strip()}, {formula}: remainders {rest}, slope {d[variable]}", good)
                tried += 1
check(f"{tried} runs", tried >= count)
finish()
