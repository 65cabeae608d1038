# SPDX-License-Identifier: MIT
"""limits.py states > states.csv; limits.py check < results.csv: what any tire does, whatever its formulas: signs, peaks
and slopes that its data name, combined slip that takes from either force, sides that mirror each other."""
import csv
import sys
from math import isfinite, pi

import yaml

HEIGHT_OF = {"truck": 0.4699 - 0.02, "car": 0.317 - 0.02, "easy": 0.4699 - 8562.827 / 411120.9}
SLIPS = [k / 200 for k in range(-200, 201)]

rig = yaml.safe_load(open(sys.path[0] + "/rig.veh", encoding="ascii"))


def plan():
    """(what, tire whose height is set, kappa, tan alpha, camber, speed, spin)"""
    for tire in HEIGHT_OF:
        for slip in SLIPS:
            yield "x", tire, slip, 0.0, 0.0, 20.0, 40.0
            yield "y", tire, 0.0, slip, 0.0, 20.0, 40.0
            yield "both", tire, slip, 0.15, 0.0, 20.0, 40.0
        for camber in (-0.1, 0.1):
            for slip in SLIPS[::20]:
                yield "mirror", tire, 0.03, slip, camber, 20.0, 40.0
        yield "back", tire, 0.0, 0.0, 0.0, -20.0, -40.0
        for camber in (-pi / 2, -1.56, 1.5, pi / 2):
            yield "flat", tire, 0.1, -0.1, camber, 20.0, 40.0


def states():
    slips = [f"{wheel}.{state}" for wheel in rig["wheels"] for state in ("spin", "slip_x", "slip_y")]
    out = csv.writer(sys.stdout)
    out.writerow(["along", "height", "camber", "along.rate", "height.rate", "camber.rate"] + slips)
    for _, tire, kappa, tangent, camber, speed, spin in plan():
        out.writerow([repr(x) for x in [0.0, HEIGHT_OF[tire], camber, speed, 0.0, 0.0]
                      + [spin, kappa, tangent] * len(rig["wheels"])])


def report(name, good, *numbers):
    print("ok" if good else "FAIL", name, *numbers)


def check():
    table = {}
    for row, (what, tire, kappa, tangent, camber, _, _) in zip(csv.DictReader(sys.stdin), plan(), strict=True):
        row = {key.split(" [")[0].replace("output.", ""): value for key, value in row.items()}

        def force(name, component, of=row):
            return float(of[f"{name}.{component}"])
        table.setdefault((what, tire), []).append((kappa, tangent, camber, row, force))
    for tire in HEIGHT_OF:
        load = table["x", tire][0][4]("load_" + tire, "fz")
        x = [(kappa, force(tire, "fx") / load) for kappa, _, _, _, force in table["x", tire]]
        y = [(t, force(tire, "fy") / load, force(tire, "mz") / load) for _, t, _, _, force in table["y", tire]]
        report(f"{tire}: braking (kappa < 0) pulls back, driving forwards",
               all(f * k > 0 for k, f in x if abs(k) > 0.05))
        report(f"{tire}: side force against the slip", all(f * t < 0 for t, f, _ in y if abs(t) > 0.05))
        report(f"{tire}: aligning at small slip", all(m * t > 0 for t, _, m in y if 0.03 < abs(t) < 0.1))
        both = [(kappa, f(tire, "fx"), g(tire, "fx"))
                for (kappa, _, _, _, f), (_, _, _, _, g) in zip(table["both", tire], table["x", tire])]
        report(f"{tire}: combined slip takes from fx",
               all(abs(fx) < abs(alone) for kappa, fx, alone in both if 0.02 < abs(kappa) < 0.12))
        side = [abs(force(tire, "fy")) for _, _, _, _, force in table["both", tire]]
        middle = side[len(side) // 2]
        report(f"{tire}: and from fy", max(side[0], side[-1]) < 0.6 * middle, side[0], middle, side[-1])
        report(f"{tire}: a wheel that lies flat has finite forces",
               all(row["status"] == "0" and all(isfinite(float(row[f"{tire}.f{axis}"])) for axis in "xy")
                   for _, _, _, row, _ in table["flat", tire]))
        report(f"{tire}: rolling resistance brakes in both directions",
               table["x", tire][0][4](tire, "my") < 0 < table["back", tire][0][4](tire, "my"))
    # friction that the data name: (PDX1 + PDX2 d) etc. of upright tires, here without the small shifts SV
    number = {}
    with open("truck.tir", encoding="ascii") as file:
        for line in file:
            if "=" in line:
                key, value = line.split("=")
                number[key.strip()] = value.strip()
    f_zo = float(number["LFZO"]) * float(number["FNOMIN"])
    x = [force("truck", "fx") for _, _, _, _, force in table["x", "truck"]]
    y = [force("truck", "fy") for _, _, _, _, force in table["y", "truck"]]
    load = table["x", "truck"][0][4]("load_truck", "fz")
    d = load / f_zo - 1
    for name, forces in (("X", x), ("Y", y)):
        mu = float(number[f"PD{name}1"]) + float(number[f"PD{name}2"]) * d
        peak = (max(forces) - min(forces)) / 2 / load
        # the grid of slips meets the peak to 1e-4, combination at zero slip of the other kind takes less than that
        report(f"truck: peak of F{name.lower()} is D", abs(peak - mu) < 2e-3 * mu, peak, mu)
    forces = [force("easy", "fx") for _, _, _, _, force in table["x", "easy"]]
    # data at friction 0.8 on a road of 1: raised to 5/4
    report("easy: maximum at the nominal load", abs(max(forces) - 7703.547 / 0.8) < 1e-3 * 7703.547, max(forces))
    # the other side: the same with alpha and camber the other way round
    for tire in ("truck", "car"):
        rows = table["mirror", tire]
        there = {(tangent, camber): row for _, tangent, camber, row, _ in rows}
        worst = 0.0
        for (tangent, camber), row in there.items():
            image = there[-tangent, -camber]
            for component, sign in (("fx", 1), ("fy", -1), ("mx", -1), ("my", 1), ("mz", -1)):
                one = float(row[f"{tire}.{component}"])
                other = float(image[f"{tire}_right.{component}"])
                worst = max(worst, abs(one - sign * other) / load)
        report(f"{tire}: the right one mirrors the left one", worst < 1e-13, worst)
        # and the tire is not symmetric: the test would see a side that is not mirrored
        same = max(abs(float(row[f"{tire}.fy"]) - float(row[f"{tire}_right.fy"])) for row in there.values())
        report(f"{tire}: sides differ", same > 1e-3 * load, same)


if __name__ == "__main__":
    states() if sys.argv[1] == "states" else check()
