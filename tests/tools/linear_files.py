#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""linear_files.py STEM: STEM.csv, STEM.npz and STEM.mat of `gicrun --linearize` have the same numbers to the bit, and the
same names. The MAT-file is read here after MathWorks' "MAT-File Format", chapter 2 (level 4)."""
import csv
import struct
import sys

import numpy as np

stem = sys.argv[1]
npz = np.load(stem + ".npz")

mat = {}
with open(stem + ".mat", "rb") as file:
    data = file.read()
at = 0
while at < len(data):
    kind, rows, columns, imaginary, size = struct.unpack_from("<5i", data, at)
    at += 20
    name = data[at:at + size]
    assert name.endswith(b"\0") and len(name) <= 20 and not imaginary
    at += size
    assert kind in (0, 51)
    values = np.frombuffer(data, "<f8" if kind == 0 else "u1", rows * columns, at).reshape((rows, columns), order="F")
    at += rows * columns * (8 if kind == 0 else 1)
    mat[name[:-1].decode()] = values if kind == 0 else [bytes(row).decode().rstrip() for row in values]
assert set(mat) == set(npz.files), set(mat) ^ set(npz.files)
for name in npz.files:
    array = npz[name]
    if array.dtype.kind == "U":
        assert list(array) == list(mat[name]), name
    else:
        assert array.size == mat[name].size and np.array_equal(array.reshape(mat[name].shape), mat[name]), name

with open(stem + ".csv", newline="") as file:
    head, *lines = list(csv.reader(file))
table = {line[0]: line[1:] for line in lines}
assert head[:3] == ["row", "unit", "value"]
names = [f"{kind[:-1]}/{name} [{unit}]" for kind in ("states", "inputs", "parameters")
         for name, unit in zip(npz[kind], npz[kind[:-1] + "_units"])]
assert head[3:] == names
width = len(names)


def same(row, numbers):
    cells = table[row][2:2 + len(numbers)]
    assert [float(cell) for cell in cells] == list(numbers), row


same("at", np.concatenate([npz["z0"], npz["u0"], npz["p0"]]))
for kind, names, value, parts in (("rate", "states", "f", "ABE"), ("output", "outputs", "y0", "CDF")):
    for i, name in enumerate(npz[names]):
        same(f"{kind}/{name}", np.concatenate([npz[part][i] for part in parts]))
        assert float(table[f"{kind}/{name}"][1]) == npz[value][i]
for k, name in enumerate(npz["neutral"]):
    same(f"neutral/{name}", npz["N"][:, k])
assert len(lines) == 1 + len(npz["base"]) + len(npz["held"]) + 1 + len(npz["f"]) + len(npz["y0"]) + len(npz["neutral"])
assert float(table["time"][1]) == npz["time"]
