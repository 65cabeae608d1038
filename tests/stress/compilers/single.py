# SPDX-License-Identifier: MIT
"""single.py: states on standard input to such whose numbers are single precision's, for both precisions to begin where
the reference does. The largest Euler parameter, which follows from the others, is what they make it."""
import math
import struct
import sys

lines = sys.stdin.read().split()
names = lines[0].split(",")
euler = [i for i, name in enumerate(names) if name in ("e0", "e1", "e2", "e3")]
print(lines[0])
for line in lines[1:]:
    row = [struct.unpack("f", struct.pack("f", float(x)))[0] for x in line.split(",")]
    if euler:
        largest = max(euler, key=lambda i: abs(row[i]))
        rest = math.fsum([1] + [-row[i] ** 2 for i in euler if i != largest])
        row[largest] = math.copysign(math.sqrt(rest), row[largest])
    print(*row, sep=",")
