#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""batch_cost.py STEPS.so MODEL SCENE VEHICLES LANES STEP ROUNDS: processor time of a step of a batch by Python, against
the same steps in C (batch_steps.c) of the same batch: least of the rounds, which alternate. Prints both, s, and the
quotient."""
import ctypes
import sys
import time

import gicgen
from gicgen import _library

steps, path, scene, vehicles, lanes, step, rounds = sys.argv[1:]
in_c = ctypes.CDLL(steps).batch_steps
in_c.argtypes = [ctypes.c_void_p, ctypes.c_uint64, ctypes.c_double, ctypes.c_int]
vehicles, step = int(vehicles), float(step)
batch = gicgen.Model(path).batch(vehicles, scene, int(lanes))
MANY = 20


def by_python():
    for _ in range(MANY):
        batch.step(step)


def by_c():
    assert in_c(_library._library, batch._handle, step, MANY) == 0


least = {by_python: 1.0, by_c: 1.0}
for _ in range(int(rounds)):
    for steps in least:
        batch.reset()
        by_python()
        begin = time.thread_time()
        steps()
        least[steps] = min(least[steps], (time.thread_time() - begin) / MANY)
print(f"{least[by_python]:.6f} {least[by_c]:.6f} {least[by_python] / least[by_c]:.4f}")
