# SPDX-License-Identifier: MIT
# hop.py RESULTS LIMIT: is the motion of hop.veh that of the closed solution in tests/system/test_contact.sh? A wheel of
# 40 kg that hops from 0.05 m on a spring of 16 kN/m, and a load that slides at 0.8 m/s from one stop to the other.
import csv
import math
import sys

W, G, H, U = 20.0, 10.0, 0.05, 0.8  # rad/s of wheel and stops, m/s^2, m, m/s


def wheel(t):
    v = math.sqrt(2 * G * H)
    if t <= v / G:
        return H - G * t * t / 2, -G * t
    stay, flight = 2 * (math.pi - math.atan2(v * W, G)) / W, 2 * v / G
    t = (t - v / G) % (stay + flight)
    if t < stay:
        c, s = math.cos(W * t), math.sin(W * t)
        return -G / W**2 * (1 - c) - v / W * s, -G / W * s - v * c
    t -= stay
    return v * t - G * t * t / 2, v - G * t


def load(t):
    half, way = math.pi / W, 0.25 / U
    if t <= 0.15 / U:
        return U * t, U
    t = (t - 0.15 / U) % (2 * (half + way))
    sign, base = 1, 0.15
    if t >= half + way:
        t, sign, base = t - half - way, -1, -0.1
    if t < half:
        return base + sign * U / W * math.sin(W * t), sign * U * math.cos(W * t)
    return base - sign * U * (t - half), -sign * U


with open(sys.argv[1]) as file:
    rows = [[float(x) for x in row] for row in list(csv.reader(file))[1:]]
off = max([abs(a - b) for row in rows for a, b in zip(row[1:], wheel(row[0]) + load(row[0]))] or [math.inf])
print(f"{off:.3g} off, {len(rows)} rows")
sys.exit(not (len(rows) == 201 and off < float(sys.argv[2])))
