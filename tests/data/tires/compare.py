# SPDX-License-Identifier: MIT
"""compare.py states RADIUS > states.csv: the grid for a tire of that radius, m.
compare.py check FOLDER MU WHEEL... < results.csv: forces, moments and loads of those wheels of rig.veh, of one radius,
on a road of friction MU, against the published formulas. FOLDER holds the files of tires and rig.veh.

Forces are related to Fz, moments to Fz R. The numbers of a grid's row reach the formulas unchanged (slips are states,
the rig does not turn) but for the deflection, R - height / cos(camber), whose rounding error of 1e-16 R is 2e-14 of
the least one here that carries load; curves are less steep than 100 per unit of slip. So 1e-10 is far above rounding
and below every mistake. TMeasy has 1e-8: TIRES.md adds 1e-12 to the squares of slips, of which the least is 0.02.
"""
import csv
import sys
from itertools import product
from math import atan, cos, tan

import yaml

import pac2002
import tmeasy

SPEED, SPIN = 20.0, 40.0
# from in the air over just touching (below FNOMIN / 1000) to the rim and beyond FZMAX; m
DEFLECTION = (-0.01, 0.0, 2e-5, 5e-4, 0.003, 0.01, 0.02, 0.035, 0.06, 0.09, 0.13)
KAPPA = (-3.0, -1.45, -1.0, -0.3, -0.1, -0.02, 0.0, 0.02, 0.06, 0.15, 0.5, 1.0, 1.3, 5.0)
ALPHA = (-1.5, -1.2, -0.6, -0.25, -0.1, -0.03, 0.0, 0.02, 0.08, 0.18, 0.4, 1.0, 1.25, 1.55)
CAMBER = (-0.5, -0.25, -0.1, -0.02, 0.0, 0.05, 0.15, 0.24, 0.4)


def grid():
    """all loads with all slips upright; a coarser net of slips at every camber"""
    for rho, kappa, alpha in product(DEFLECTION, KAPPA, ALPHA):
        yield rho, kappa, alpha, 0.0
    for rho, kappa, alpha, camber in product(DEFLECTION[2::2], KAPPA[::3], ALPHA[::3], CAMBER):
        yield rho, kappa, alpha, camber


def states(radius):
    rig = yaml.safe_load(open(sys.path[0] + "/rig.veh", encoding="ascii"))
    slips = [f"{wheel}.{state}" for wheel in rig["wheels"] for state in ("spin", "slip_x", "slip_y")]
    out = csv.writer(sys.stdout)
    out.writerow(["along", "height", "camber", "along.rate", "height.rate", "camber.rate"] + slips)
    for rho, kappa, alpha, camber in grid():
        height = (radius - rho) * cos(camber)
        out.writerow([repr(x) for x in [0.0, height, camber, SPEED, 0.0, 0.0]
                      + [SPIN, kappa, tan(alpha)] * len(rig["wheels"])])


class Wheel:
    """What the formulas need of a wheel of the rig, and how far its results are off."""

    def __init__(self, name, rig, folder):
        data = rig["tires"][rig["wheels"][name]["tire"]]
        self.name = name
        self.easy = data if "type" in data else None
        self.file = None if self.easy else pac2002.Tire(folder + "/" + data["file"])
        # a symmetric tire knows no sides
        self.sign = -1 if self.file and rig["wheels"][name].get("side") == "right" else 1
        self.radius = data["radius"] if self.easy else self.file.UNLOADED_RADIUS
        self.worst, self.place = 0.0, None

    def check(self, row, rho, kappa, alpha, camber, mu):
        sign = self.sign
        if self.easy:
            load = tmeasy.vertical(self.easy, rho)
            fx, fy, mx, my, mz = tmeasy.forces(self.easy, load, kappa, alpha, rho, mu, SPIN)
        else:
            load = pac2002.vertical(self.file, rho)
            fx, fy, mx, my, mz = pac2002.forces(self.file, load, kappa, sign * alpha, sign * camber, mu, SPEED, SPIN)
        want = {f"load_{self.name}.fz": load, f"{self.name}.fx": fx, f"{self.name}.fy": sign * fy,
                f"{self.name}.mx": sign * mx, f"{self.name}.my": my, f"{self.name}.mz": sign * mz}
        for key, value in want.items():
            got = float(row["output." + key])
            scale = load * (self.radius if ".m" in key else 1.0)
            error = abs(got - value) / scale if scale > 0 else abs(got)
            if not error <= self.worst:
                self.worst = error
                self.place = f"{key} {got!r}, not {value!r}: rho {rho} kappa {kappa} alpha {alpha} camber {camber}"


def check(folder, mu, names, within=1e-10):
    rig = yaml.safe_load(open(folder + "/rig.veh", encoding="ascii"))
    wheels = [Wheel(name, rig, folder) for name in names]
    rows = 0
    reader = csv.DictReader(sys.stdin)
    for row, (rho, kappa, alpha, camber) in zip(reader, grid(), strict=True):
        row = {key.split(" [")[0]: value for key, value in row.items()}
        if row["status"] != "0":
            sys.exit(f"row {rows + 1}: {row['message']}")
        # rho as the rounded height gives it, for the rim's corner
        radius = wheels[0].radius
        rho = radius - (radius - rho) * cos(camber) / cos(camber)
        for wheel in wheels:
            wheel.check(row, rho, kappa, atan(tan(alpha)), camber, mu)
        rows += 1
    for wheel in wheels:
        good = rows > 0 and wheel.worst <= (1e-8 if wheel.easy else within)
        print(f"{'ok' if good else 'FAIL'} {wheel.name} mu {mu}: {rows} rows, worst {wheel.worst:.1e}")
        if not good:
            print("  " + str(wheel.place))


if __name__ == "__main__":
    if sys.argv[1] == "states":
        states(float(sys.argv[2]))
    else:
        words = sys.argv[4:]  # of tires by table first: --within 1e-6
        known = words[:1] == ["--within"]
        check(sys.argv[2], float(sys.argv[3]), words[2 * known:], float(words[1]) if known else 1e-10)
