#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# gicrun_overlay.py ALONE.svg BOTH.svg SAME [OTHERS]: of BOTH's dotted curves SAME lie point by point on a curve drawn through,
# OTHERS (0) do not, and there is none in ALONE.
import re
import sys


def curves(path):
    """Curves drawn through, and dotted ones, each as its points; the first two are the line beside its name."""
    through, dotted = [], []
    for tag in re.findall(r'<path[^>]*>', open(path).read()):
        points = re.search(r"d='([^']*)'", tag).group(1).split()
        if len(points) > 10:
            (dotted if 'dasharray' in tag else through).append(' '.join(points[2:]))
    return through, dotted


alone, both = curves(sys.argv[1]), curves(sys.argv[2])
same = sum(curve in both[0] for curve in both[1])
others = len(both[1]) - same
print(len(alone[0]), len(alone[1]), len(both[0]), same, others)
sys.exit(bool(alone[1]) or len(alone[0]) != len(both[0]) or same != int(sys.argv[3]) or
         others != int(sys.argv[4] if len(sys.argv) > 4 else 0))
