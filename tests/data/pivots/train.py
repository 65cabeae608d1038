# SPDX-License-Identifier: MIT
"""train.py STATES RESULTS: accelerations of train.veh against M a = Q, solved with 60 digits: within 1e-8 of the largest,
or a status; far from the bound there is none."""
import csv
import decimal
import sys

decimal.getcontext().prec = 60


def number(x):
    return decimal.Decimal(float(x))


def directions(apart):
    for v in ((1, apart, 0), (1, number(-0.3) * apart, number(0.9) * apart), (1, number(-0.4) * apart, number(-0.7) * apart)):
        norm = sum(x * x for x in v).sqrt()
        yield [x / norm for x in v]


def solve(A, b):
    rows = [row + [right] for row, right in zip(A, b)]
    for k in range(3):
        for i in range(k + 1, 3):
            part = rows[i][k] / rows[k][k]
            rows[i] = [x - part * y for x, y in zip(rows[i], rows[k])]
    x = [decimal.Decimal(0)] * 3
    for k in (2, 1, 0):
        x[k] = (rows[k][3] - sum(rows[k][j] * x[j] for j in range(k + 1, 3))) / rows[k][k]
    return x


def main():
    mass = [number(1e-9), number(1e-9), number(1.3)]
    good = refused = 0
    with open(sys.argv[1]) as states, open(sys.argv[2]) as results:
        for state, result in zip(csv.DictReader(states), csv.DictReader(results)):
            apart = number(state["apart"])
            if result["status"] != "0":
                refused += 1
                if apart > decimal.Decimal("0.05"):
                    sys.exit(f"refused with directions {apart} apart: {result['message']}")
                continue
            u = list(directions(apart))
            M = [[sum(mass[max(i, j):]) * sum(p * q for p, q in zip(u[i], u[j])) for j in range(3)] for i in range(3)]
            wanted = solve(M, [decimal.Decimal(force) for force in (7, -3, 5)])
            error = max(abs(number(result[name + ".acceleration [m/s^2]"]) - x) for name, x in zip("xyz", wanted))
            if not error <= decimal.Decimal("1e-8") * max(abs(x) for x in wanted):
                sys.exit(f"directions {apart} apart: off by {error:.3g} of {max(abs(x) for x in wanted):.3g} m/s^2")
            good += 1
    if good < 50 or refused < 10:
        sys.exit(f"{good} rows are good and {refused} refused")


main()
