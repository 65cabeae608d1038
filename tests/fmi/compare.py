# SPDX-License-Identifier: MIT
# compare.py A.csv B.csv TOLERANCE [UNIT ...]: each column of A that is an output of an FMU, B, has the same name and unit
# there and the same numbers: bit for bit where TOLERANCE is 0, else within TOLERANCE times 1 and the column's largest
# magnitude. With units only columns of these are compared. Prints the largest difference, so scaled, and where it is.
import csv
import sys


def table(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


a, b = table(sys.argv[1]), table(sys.argv[2])
tolerance = float(sys.argv[3])
units = sys.argv[4:]
worst, where, columns = 0.0, "", 0
for name, values in a.items():
    if name.startswith(("time", "input.")) or (units and name.split("[")[-1][:-1] not in units):
        continue
    if name not in b:
        sys.exit("no output " + name)
    if len(values) != len(b[name]):
        sys.exit("%d rows and %d" % (len(values), len(b[name])))
    columns += 1
    scale = 1 + max(abs(x) for x in values)
    for k, (x, y) in enumerate(zip(values, b[name])):
        difference = abs(x - y) / scale
        if not difference <= worst:
            worst, where = difference, "%s, row %d: %r and %r" % (name, k, x, y)
print("%d columns, %d rows, largest difference %.3g %s" % (columns, len(next(iter(a.values()))), worst, where))
if not columns or len(next(iter(a.values()))) < 3:
    sys.exit("too little to compare")
sys.exit(not worst <= tolerance)
