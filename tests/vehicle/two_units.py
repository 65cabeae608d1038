# SPDX-License-Identifier: MIT
"""two_units.py GICRUN MODEL WORK: rearward amplification of tests/data/manoeuvre/two_units.veh against a planar vehicle of two units
with linear tires, written here: gains and phases of the last unit by the first from its equations, the damping of its yaw
oscillation from its eigenvalues, time histories by integrating it along the steering that was driven. Numbers of the tables found
again from the time histories."""
import csv
import subprocess
import sys

import numpy as np
import scipy.signal

gicrun, model, work = sys.argv[1:4]
failed = passed = 0
g = 9.81  # of the model


def check(what, value, wanted, tolerance, least=1e-6):
    global failed, passed
    if abs(value - wanted) <= tolerance * max(abs(wanted), least):
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}: {value!r}, found here {wanted!r}")


def drive(*words):
    trace, table = f"{work}/trace.csv", f"{work}/table.csv"
    done = subprocess.run([gicrun, "--manoeuvre", words[0], model, *words[1:], "-o", table, "--trace", trace], capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    with open(table) as f:
        value = {r["quantity"]: float(r["value"]) for r in csv.DictReader(f)}
    with open(trace) as f:
        rows = list(csv.DictReader(f))
    trials = {}
    for name in dict.fromkeys(r["trial"] for r in rows):
        mine = [r for r in rows if r["trial"] == name]
        trials[name] = {k.split(" [")[0]: np.array([float(r[k]) for r in mine]) for k in mine[0] if k != "trial"}
    return value, trials, done.stderr


# ---- the two units: numbers of the model's file, in the plane; x ahead from the origin of the drawing -------------------------

sheet = {r["quantity"]: float(r["value"])
         for r in csv.DictReader(subprocess.run([gicrun, "--sheet", "-q", model, "-o", "-"], capture_output=True, text=True,
                                                check=True).stdout.splitlines())}
t, relaxation, damper = 0.75, 0.5, 400.0
hinge = -2.2
# mass, x, y, inertia about the vertical; a wheel's own about its spin axis does not turn with the rest
units = [[(1200, 0, 0, 1600)] + [p for s in (t, -t) for p in ((1, 1.2, s, 0.1), (24, 1.2, s, 1), (25, -1.4, s, 1))],
         [(30, -3.2, 0, 10), (800, -5.4, 0, 1200)] + [(25, -5.6, s, 1) for s in (t, -t)]]
m, x, I = (np.zeros(2) for _ in range(3))
for i, unit in enumerate(units):
    mass, at, y, own = np.array(unit).T
    m[i] = mass.sum()
    x[i] = (mass * at).sum() / m[i]
    I[i] = (own + mass * ((at - x[i])**2 + y**2)).sum()
check("mass", sheet["mass"], m.sum(), 1e-9)
a, b, d = 1.2 - x[0], 1.4 + x[0], x[0] - hinge
e, f = hinge - x[1], hinge + 5.6
load = np.array([2 * sheet[f"{w}.load"] for w in ("f_l", "r_l", "t_l")])
C = load * np.array([10, 12.5, 12.5])
check("loads: sum", load.sum(), m.sum() * g, 1e-9)
check("loads: moment about the origin", load @ [1.2, -1.4, -5.6], g * m @ x, 0.01)
turned = 2 * (1 + 0.1)  # by the steering


def system(V):
    """State: lateral velocity of the first unit's centre of mass, yaw rates of both, articulation, slips of the axles."""
    n = 7
    M, A, B = np.eye(n), np.zeros((n, n)), np.zeros((n, 3))
    a2 = np.array([1, -d, -e])  # acceleration of the second centre of mass by the rates, and V times the first yaw rate
    M[:3, :3] = np.diag([m[0], I[0], I[1]]) + m[1] * np.outer(a2, a2)
    A[:3, 1] = -V * (np.array([m[0], 0, 0]) + m[1] * a2)
    arm = np.array([[1, a, 0], [1, -b, 0], [1, -d, -f]])  # lateral velocity of an axle by the three, and so moments of its force
    A[:3, 4:] = -(arm * C[:, None]).T
    A[1, 1:3] += damper * np.array([-1, 1])
    A[2, 1:3] -= damper * np.array([-1, 1])
    A[3, 1:3] = -1, 1
    A[4:, :3] = arm / relaxation
    A[6, 3] = -V / relaxation
    A[4:, 4:] = -V / relaxation * np.eye(3)
    B[4, 0] = -V / relaxation
    B[1, 2] = -turned
    return np.linalg.solve(M, A), np.linalg.solve(M, B)


def outputs(V, A, B):
    """Rows for lateral accelerations of both, yaw rates of both, articulation, and what steering adds at once."""
    unit = np.eye(7)
    first = A[0] + V * unit[1], B[0]
    last = first[0] - d * A[1] - e * A[2], first[1] - d * B[1] - e * B[2]
    return np.array([first[0], last[0], unit[1], unit[2], unit[3]]), np.array([first[1], last[1]] + 3 * [np.zeros(3)])


names = ["ay", "last.ay", "yaw_rate", "last.yaw_rate", "articulation"]
V = 20.0


def response(frequency):
    A, B = system(V)
    Y, D = outputs(V, A, B)
    s = 2j * np.pi * frequency
    by = np.array([1, s, s * s])
    return Y @ np.linalg.solve(s * np.eye(7) - A, B @ by) + D @ by


# ---- frequency response, of a sweep and of random steering ------------------------------------------------------------------------

value, trials, _ = drive("frequency", f"speed={V}", "ay=0.5", "duration=120")
for F in (0.2, 0.5, 1, 1.5, 2, 2.5, 3):
    H = response(F)
    for name, ratio in (("rearward.ay", H[1] / H[0]), ("rearward.yaw_rate", H[3] / H[2])):
        for which, tolerance in (("", 0.01), ("linear.", 0.006)):
            check(f"{name} at {F} Hz {which}", value[f"{name}.at_{F:g}.{which}gain"], abs(ratio), tolerance)
            check(f"{name} at {F} Hz {which}phase", np.angle(np.exp(1j * value[f"{name}.at_{F:g}.{which}phase"]) / ratio), 0, tolerance,
                  1)
trace = trials["chirp"]
straight = (trace["time"] >= 3) & (trace["time"] <= 4)
for F in (0.5, 1.0, 2.0):  # found again by one sum over the record
    turn = np.exp(-2j * np.pi * F * trace["time"]) * (trace["time"] >= 4)
    of = {name: np.sum((trace[name] - trace[name][straight].mean()) * turn) for name in names}
    check(f"rearward.ay at {F} Hz by the time history", value[f"rearward.ay.at_{F:g}.gain"], abs(of["last.ay"] / of["ay"]), 0.01)
    check(f"rearward.yaw_rate at {F} Hz by the time history", value[f"rearward.yaw_rate.at_{F:g}.gain"],
          abs(of["last.yaw_rate"] / of["yaw_rate"]), 0.01)
grid = np.linspace(0.2, 3, 60)
for k, name in ((1, "rearward.ay"), (3, "rearward.yaw_rate")):
    gains = [abs(response(F)[k] / response(F)[k - 1]) for F in grid]
    check(f"{name}: largest", value[f"{name}.peak"], max(gains), 0.01)
    if 0 < np.argmax(gains) < 59:
        check(f"{name}: where", value[f"{name}.peak_frequency"], grid[np.argmax(gains)], 0.1)
value, trials, _ = drive("random", f"speed={V}", "ay=0.5", "duration=120")
for F in (0.5, 1, 1.5):
    H = response(F)
    check(f"random: rearward.ay at {F} Hz", value[f"rearward.ay.at_{F:g}.gain"], abs(H[1] / H[0]), 0.02)
trace = trials["random"]
picked = trace["time"] >= 6 - 1e-9
spectrum = {}
for name in ("steer_angle", "ay", "last.ay"):
    frequencies, spectrum[name] = scipy.signal.csd(trace["steer_angle"][picked], trace[name][picked], 100, "hann", 2048, 1024, detrend="constant")
for F in (0.5, 1, 1.5):
    weight = np.maximum(0, 1 - abs(frequencies - F) / frequencies[1] / 2)
    of = {name: np.sum(weight * s) for name, s in spectrum.items()}
    check(f"random: rearward.ay at {F} Hz by the time history", value[f"rearward.ay.at_{F:g}.gain"], abs(of["last.ay"] / of["ay"]),
          1e-6)

# ---- a period of a sine: peaks, and the oscillation that is left ------------------------------------------------------------------


def extremes(y, time):
    """Vertices of parabolas through three rows about each extreme value."""
    at, when = [], []
    for i in range(1, len(y) - 1):
        if (y[i] - y[i - 1]) * (y[i + 1] - y[i]) < 0:
            p = np.polyfit(time[i - 1:i + 2] - time[i], y[i - 1:i + 2], 2)
            at.append(p[2] - p[1]**2 / (4 * p[0]))
            when.append(time[i] - p[1] / (2 * p[0]))
    return np.array(at), np.array(when)


for V in (20.0, 30.0):
    A, B = system(V)
    Y, D = outputs(V, A, B)
    value, trials, _ = drive("sine", f"speed={V}", "ay=0.5")
    for side in ("left", "right"):
        trace = trials[side]
        time, delta = trace["time"], trace["steer_angle"]
        rate = np.gradient(delta, time)
        u = np.array([delta, rate, np.gradient(rate, time)]).T
        follow = scipy.signal.lsim((A, B, Y, D), u, time)[1]
        for k, name in enumerate(names):
            check(f"{side} {V}: {name} over time", np.max(np.abs(trace[name] - follow[:, k])) / np.max(np.abs(follow[:, k])), 0, 0.015, 1)
        on = time >= 4
        peak = {name: np.max(np.abs(trace[name][on])) for name in names}
        check(f"{side} {V}: rearward.ay", value[f"{side}.rearward.ay"], peak["last.ay"] / peak["ay"], 1e-9)
        check(f"{side} {V}: rearward.ay by the equations", value[f"{side}.rearward.ay"],
              np.max(np.abs(follow[:, 1])) / np.max(np.abs(follow[:, 0])), 0.01)
        check(f"{side} {V}: rearward.yaw_rate", value[f"{side}.rearward.yaw_rate"], peak["last.yaw_rate"] / peak["yaw_rate"], 1e-9)
        check(f"{side} {V}: articulation", value[f"{side}.articulation"], peak["articulation"], 1e-9)
        on = time >= 6 - 1e-9
        at, when = extremes(trace["articulation"][on], time[on])
        swing = np.abs(np.diff(at))
        few = np.argmax(np.append(swing < 0.02 * swing[0], True))
        ratio = np.mean(swing[:few - 1] / swing[1:few])
        damping = np.log(ratio) / np.hypot(np.pi, np.log(ratio))
        check(f"{side} {V}: damping", value[f"{side}.articulation.damping"], damping, 1e-6)
        check(f"{side} {V}: frequency", value[f"{side}.articulation.frequency"], few / 2 / (when[few] - when[0]), 1e-6)
        roots = np.linalg.eigvals(A)
        root = min((r for r in roots if r.imag > 0.1), key=lambda r: -r.real / abs(r))
        check(f"{side} {V}: damping by the eigenvalue", value[f"{side}.articulation.damping"], -root.real / abs(root), 0.05)
        check(f"{side} {V}: frequency by the eigenvalue", value[f"{side}.articulation.frequency"], root.imag / 2 / np.pi, 0.02)

# ---- single lane change: a driver; the motion integrated along what he steered, offtracking by the places of both ------------------

V, ay, F = 20.0, 0.5, 0.4
value, trials, _ = drive("single-lane-change", f"speed={V}", f"ay={ay}", f"frequency={F}")
omega = 2 * np.pi * F
lane = 2 * np.pi * ay / omega**2
check("lane", value["lane"], lane, 1e-12)
A, B = system(V)
Y, D = outputs(V, A, B)
# besides: place aside of the first unit's centre of mass, its heading, articulation once more by the yaw rates
wide = np.zeros((9, 9))
wide[:7, :7], wide[7, 0], wide[7, 8], wide[8, 1] = A, 1, V, 1
places = np.zeros((2, 9))
places[0, 7] = 1
places[1, [7, 8, 3]] = 1, -(d + e), -e  # that of the last one: heading and articulation
for side, sign in (("left", 1), ("right", -1)):
    trace = trials[side]
    time, delta = trace["time"], trace["steer_angle"]
    rate = np.gradient(delta, time)
    u = np.array([delta, rate, np.gradient(rate, time)]).T
    rows, adds = np.hstack([Y, np.zeros((5, 2))]), D
    follow = scipy.signal.lsim((wide, np.vstack([B, np.zeros((2, 3))]), np.vstack([rows, places]), np.vstack([adds, np.zeros((2, 3))])), u, time)[1]
    for k, name in enumerate(names):
        check(f"lane change, {side}: {name} over time", np.max(np.abs(trace[name] - follow[:, k])) / np.max(np.abs(follow[:, k])), 0, 0.02, 1)
    on = time >= 4 - 1e-9
    peak = {name: np.max(np.abs(trace[name][on])) for name in names}
    check(f"lane change, {side}: rearward.ay", value[f"{side}.rearward.ay"], peak["last.ay"] / peak["ay"], 1e-9)
    check(f"lane change, {side}: rearward.ay by the equations", value[f"{side}.rearward.ay"],
          np.max(np.abs(follow[:, 1])) / np.max(np.abs(follow[:, 0])), 0.02)
    off = trace["last.y"] - np.interp(trace["last.x"], trace["x"], trace["y"])
    check(f"lane change, {side}: offtracking by the time history", value[f"{side}.offtracking"], np.max(np.abs(off[on])), 1e-6)
    of_first = np.interp(time - (d + e) / V, time, follow[:, 5])
    check(f"lane change, {side}: offtracking by the equations", value[f"{side}.offtracking"], np.max(np.abs(follow[:, 6] - of_first)), 0.03)
    check(f"lane change, {side}: beyond the lane", value[f"{side}.beyond"], np.max(sign * trace["last.y"][on]) - lane, 1e-6)
    turn = np.clip(omega * (trace["x"] / V - 4), 0, 2 * np.pi)
    path = sign * ay / omega**2 * (turn - np.sin(turn))
    check(f"lane change, {side}: off the path", value[f"{side}.off"], np.max(np.abs(trace["y"] - path)), 1e-6)
    check(f"lane change, {side}: the path is followed", value[f"{side}.off"] / lane, 0, 0.15, 1)
    check(f"lane change, {side}: acceleration as that of the path", value[f"{side}.ay.first"], ay, 0.1)
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0)
