#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""library_runs.py LIBRARY.txt GICRUN.csv: exit status 0 if the array "columns" that build/check/library printed has the
names, the rows and every bit of gicrun's results. Times, which the results have to 15 digits, are compared so."""
import csv
import struct
import sys

with open(sys.argv[1]) as file:
    lines = file.read().splitlines()
with open(sys.argv[2]) as file:
    rows = list(csv.reader(file))


def bits(text):
    return struct.pack("d", float(text)) if text else b""


name, count, columns = lines[0].split()
assert name == "columns" and int(columns) == len(rows[0]) and int(count) == len(rows) - 1 > 0, lines[0]
assert lines[1].split(",") == rows[0], (lines[1], rows[0])
for line, row in zip(lines[2:], rows[1:], strict=True):
    values = line.split(",")
    assert f"{float(values[0]):.15g}" == f"{float(row[0]):.15g}", (values[0], row[0])
    for value, other, column in zip(values[1:], row[1:], rows[0][1:], strict=True):
        assert bits(value) == bits(other), (column, row[0], value, other)
