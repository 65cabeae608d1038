# SPDX-License-Identifier: MIT
# ramp.py RESULTS: the largest distance, m, of z in results of ramp.veh from an integration of its own: RK4 in steps of
# 20 us, none of which goes over a point of the road's table, the beginning or end of the contact or of its damper's
# fade, or a change of sign of the load. Standard input has the road of test_contact.sh: places, then heights.
import csv
import sys

MASS, GRAVITY, STIFFNESS, DAMPING, FADE, SPEED = 50.0, 10.0, 2e5, 500.0, 0.01, 14.0
STEP = 2e-5
XS, HS = ([float(word) for word in sys.stdin.readline().replace(",", " ").split()] for _ in range(2))


def slopes():
    found = [0.0]
    for i in range(1, len(XS) - 1):
        d1, d2 = XS[i] - XS[i - 1], XS[i + 1] - XS[i]
        c1, c2 = (HS[i] - HS[i - 1]) / d1, (HS[i + 1] - HS[i]) / d2
        found.append(3 * (d1 + d2) / ((2 * d2 + d1) / c1 + (d2 + 2 * d1) / c2) if c1 * c2 > 0 else 0.0)
    return found + [0.0]


SLOPES = slopes()


def road(piece, x):
    """Height and slope by the cubic between points piece - 1 and piece; level before the first and behind the last."""
    if piece == 0 or piece == len(XS):
        return HS[max(piece - 1, 0)], 0.0
    a, b = piece - 1, piece
    d = XS[b] - XS[a]
    s = (x - XS[a]) / d
    h = HS[a] * (1 - s) ** 2 * (1 + 2 * s) + HS[b] * s * s * (3 - 2 * s)
    h += d * s * (1 - s) * (SLOPES[a] * (1 - s) - SLOPES[b] * s)
    slope = 6 * s * (1 - s) * (HS[b] - HS[a]) / d + SLOPES[a] * (1 - s) * (1 - 3 * s) - SLOPES[b] * s * (2 - 3 * s)
    return h, slope


def press(piece, kind, t, z, v):
    """Depth, and load by the law of a kind: 0 none, 1 in the fade, 2 beyond it, 3 the damper would pull."""
    h, slope = road(piece, SPEED * t)
    depth, rate = h - z, slope * SPEED - v
    s = depth / FADE
    return depth, STIFFNESS * depth + DAMPING * rate * (s * s * (3 - 2 * s) if kind != 2 and s < 1 else 1.0)


def kind_at(piece, t, z, v):
    depth, load = press(piece, 1, t, z, v)
    return 0 if depth <= 0 else 3 if load <= 0 else 2 if depth >= FADE else 1


def step(piece, kind, t, z, v, h):
    def pull(t, z, v):
        return press(piece, kind, t, z, v)[1] / MASS - GRAVITY if kind in (1, 2) else -GRAVITY

    a = pull(t, z, v)
    b = pull(t + h / 2, z + h / 2 * v, v + h / 2 * a)
    vb = v + h / 2 * a
    c = pull(t + h / 2, z + h / 2 * vb, v + h / 2 * b)
    vc = v + h / 2 * b
    d = pull(t + h, z + h * vc, v + h * c)
    vd = v + h * c
    return z + h / 6 * (v + 2 * vb + 2 * vc + vd), v + h / 6 * (a + 2 * b + 2 * c + d)


def go(piece, t, z, v, end):
    """To `end` within a piece of the road."""
    while t < end:
        kind, h = kind_at(piece, t, z, v), min(STEP, end - t)
        z1, v1 = step(piece, kind, t, z, v, h)
        if kind_at(piece, t + h, z1, v1) != kind:
            low, high = 0.0, h
            for _ in range(60):
                middle = (low + high) / 2
                z1, v1 = step(piece, kind, t, z, v, middle)
                if kind_at(piece, t + middle, z1, v1) != kind:
                    high = middle
                else:
                    low = middle
            h = max(high, 1e-15)
            z1, v1 = step(piece, kind, t, z, v, h)
        t, z, v = (end if t + h >= end else t + h), z1, v1
    return z, v


with open(sys.argv[1]) as file:
    rows = [[float(x) for x in row] for row in list(csv.reader(file))[1:]]
t, z, v, off, piece = 0.0, -MASS * GRAVITY / STIFFNESS, 0.0, 0.0, 0
for time, due in (row[:2] for row in rows):
    while piece < len(XS) and XS[piece] <= SPEED * time:
        z, v = go(piece, t, z, v, XS[piece] / SPEED)
        t, piece = XS[piece] / SPEED, piece + 1
    z, v = go(piece, t, z, v, time)
    t, off = time, max(off, abs(z - due))
print(f"{off:.3g}" if len(rows) > 50 else "inf")
