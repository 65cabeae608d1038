# SPDX-License-Identifier: MIT
"""mirrored_axles.py LEFT.csv RIGHT.csv: `gicrun --kc` of a vehicle with other hard points on the left, and of its mirror
image: what is on one side of the one is on the other side of the other, and what has a side has the other sign."""
import csv
import math
import sys

# what has a side; and rates along a motion that the mirror reverses
OTHER_SIGN = ("steer", "contact_y", "centre_y", "roll_centre_y", "mean_steer")
REVERSED = {"opposite": ("track_rate",), "steer": ("track_rate", "camber_rate", "toe_rate"), "parallel": ()}


def rows(path):
    with open(path) as f:
        return [{k.split(" [")[0]: x for k, x in r.items()} for r in csv.DictReader(f)]


def exchanged(name):
    return ".".join(x[:-2] + {"_l": "_r", "_r": "_l"}.get(x[-2:], x[-2:]) for x in name.split("."))


def key(row, sign):
    travel = float(row["travel"]) * (sign if row["motion"] == "opposite" else 1)
    return row["axle"], row["motion"], round(travel, 9), round(float(row["rack"] or 0) * sign, 9)


left, right = rows(sys.argv[1]), {key(r, -1): r for r in rows(sys.argv[2])}
seen = failed = unequal = 0
for a in left:
    b = right.get(key(a, 1))
    if not b:
        print("FAILED: no row for", key(a, 1))
        failed += 1
        continue
    for name, x in a.items():
        if name in ("axle", "motion", "travel", "rack") or not x:
            continue
        y = float(b[exchanged(name)]) * (-1 if name.split(".")[-1] in OTHER_SIGN + REVERSED[a["motion"]] else 1)
        x = float(x)
        seen += 1
        unequal += a[exchanged(name)] != a[name]
        size = 1e6 if math.isinf(x) or abs(x) > 1e6 else max(1, abs(x))
        # a length is as well known as its reciprocal
        if not (x == y or abs(x - y) <= 1e-9 * size or abs(1 / x - 1 / y) < 1e-11):
            print(f"FAILED: {key(a, 1)} {name}: {x!r}, mirrored {y!r}")
            failed += 1
print(f"{seen} numbers, {unequal} unlike those of the other side, {failed} off")
sys.exit(failed > 0 or seen < 3000 or unequal < 1000)
