#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# compare.py RECORDING.csv RESULTS.csv DIGITS: the outputs of a recording of a page of `gicrun --drive`, and results of its
# replay, or two results, agree at all times that both have, as shares of the largest value of each column; 0: every digit.
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'animate'))

from page import read_csv  # noqa: E402

recording, results, digits = read_csv(sys.argv[1]), read_csv(sys.argv[2]), float(sys.argv[3])
row = {round(time, 9): k for k, time in enumerate(recording['time'])}
common = [(row[round(time, 9)], k) for k, time in enumerate(results['time']) if round(time, 9) in row]
names = [name for name in results if name in recording and name != 'time']
worst, where = 0, ''
for name in names:
    size = max([1e-3] + [abs(value) for value in results[name]])
    for i, k in common:
        off = abs(recording[name][i] - results[name][k]) / size
        if not off <= worst:
            worst, where = off, '%s at %g s' % (name, results['time'][k])
print('%d columns at %d times: %g, %s' % (len(names), len(common), worst, where))
moved = max(recording['chassis_velocity.x']) > 3 if 'chassis_velocity.x' in recording else True
sys.exit(not (len(names) >= 2 and len(common) > 20 and moved and worst <= digits))
