#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# gicrun_ticks.py PICTURE.svg: of a panel of gnuplot with equal scales: ticks along both axes are as many pixels apart for
# the same difference, and numbers, some 8 pixels a character, do not meet. Says what is wrong.
import re
import sys

text = open(sys.argv[1], encoding='utf-8').read()
ticks = {'x': [], 'y': []}
for x, y, words in re.findall(r'<g transform="translate\(([-0-9.]+),([-0-9.]+)\)"[^>]*>\s*<text>(?:<tspan[^>]*>)?'
                              r'\s*([-0-9.e]+)\s*(?:</tspan>)?</text>', text):
    ticks['x'].append((float(y), float(x), float(words), words))
    ticks['y'].append((float(x), float(y), float(words), words))
scale = {}
for axis, found in ticks.items():
    # numbers below the x axis share a height, those beside the y axis an edge
    row = max({f[0] for f in found}, key=lambda at: sum(1 for f in found if f[0] == at))
    line = sorted((f[1], f[2], f[3]) for f in found if f[0] == row)
    if len(line) < 2:
        sys.exit('%s axis: %d numbers' % (axis, len(line)))
    scale[axis] = abs((line[-1][0] - line[0][0]) / (line[-1][1] - line[0][1]))
    for a, b in zip(line, line[1:]):
        room = 4 * (len(a[2]) + len(b[2])) if axis == 'x' else 12
        if b[0] - a[0] < room:
            sys.exit('%s axis: %s and %s are %g pixels apart' % (axis, a[2], b[2], b[0] - a[0]))
if not abs(scale['x'] / scale['y'] - 1) < 0.01:
    sys.exit('%g and %g pixels for 1' % (scale['x'], scale['y']))
