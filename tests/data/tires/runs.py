# SPDX-License-Identifier: MIT
"""runs.py GICGEN GICRUN MODELS FOLDER: what wheels do along runs, against what mechanics says without any formula of a
tire. Prints `ok` or `FAIL` a check; FOLDER is for files."""
import csv
import json
import subprocess
import sys
from math import cos, hypot, log, sin, sqrt

gicgen, gicrun, models, folder = sys.argv[1:5]
here = sys.path[0]
TIRES, EASY = f"{models}/hmmwv_tires.veh", f"{models}/hmmwv_tmeasy.veh"
CORNERS = ("f_l", "f_r", "r_l", "r_r")


def report(name, good, *numbers):
    print("ok" if good else "FAIL", name, *(f"{x:.4g}" if isinstance(x, float) else x for x in numbers))


def scene(duration, step, output_step, text="", **keys):
    lines = ["gicscene: 1", f"duration: {duration}", f"step: {step}", f"output_step: {output_step}"]
    return "\n".join(lines + [f"{key}: {value}" for key, value in keys.items()] + [text, ""])


def run(model, text, engine="tape"):
    """columns of a run by their names"""
    path = f"{folder}/run.scene"
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    out = subprocess.run([gicrun, "-q", "--engine", engine, model, path], capture_output=True, text=True)
    if out.returncode:
        sys.exit(out.stderr + text)
    rows = list(csv.reader(out.stdout.splitlines()))
    return {name.split(" [")[0]: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}


def installed(name, **changes):
    """the text of a scene of the models with other values of some of its keys, or without them"""
    with open(f"{models}/scenes/{name}.scene", encoding="ascii") as file:
        lines = [line.rstrip("\n") for line in file]
    for key, value in changes.items():
        start = next((i for i, line in enumerate(lines) if line.startswith(key + ":")), len(lines))
        end = next((i for i in range(start + 1, len(lines)) if not lines[i].startswith(" ")), len(lines))
        lines[start:end] = [f"{key}: {value}"] if value is not None else []
    return "\n".join(lines) + "\n"


def gap(a, b, names=None):
    """largest difference of two runs, relative to 1 + the largest value of the column; at the common times"""
    worst = 0.0
    for name in names or a:
        size = 1 + max(abs(x) for x in b[name])
        worst = max(worst, max(abs(x - y) for x, y in zip(a[name], b[name], strict=True)) / size)
    return worst


def weight(model):
    dump = json.loads(subprocess.run([gicgen, "--dump-model", model], check=True, capture_output=True).stdout)
    return 9.81 * sum(body["mass"] for body in dump["bodies"])


def at(columns, time):
    return min(range(len(columns["time"])), key=lambda i: abs(columns["time"][i] - time))


def changes(values, above):
    """how often the sign changes, of what is not rounding"""
    signs = [x > 0 for x in values if abs(x) > above]
    return sum(a != b for a, b in zip(signs, signs[1:]))


# ---- braking, standing, parking ---------------------------------------------------------------------------------

def braking(model, friction, sliding):
    """sliding: friction of locked tires, least and largest"""
    name = "PAC2002" if model == TIRES else "TMeasy"
    road = f"{{type: flat, friction: {{value: {friction}}}}}"
    a = run(model, installed("tires_brake", duration=20, road=road))
    kappa = a["slip_f_l.kappa"]
    report(f"{name}: rolls before it brakes", max(abs(k) for k in kappa[:at(a, 0.5)]) < 2e-3)
    slide = slice(at(a, 1.3), at(a, 3.5))
    slips, spins = ([x for c in ("f_l", "r_l") for x in a[f"slip_{c}.{what}"][slide]] for what in ("kappa", "spin"))
    report(f"{name}: all wheels lock", all(-1.02 < k < -0.98 for k in slips), min(slips), max(slips))
    report(f"{name}: locked wheels stand", max(abs(x) for x in spins) < 0.15, max(abs(x) for x in spins))
    still = at(a, 12)
    v = [(x1 - x0) / (t1 - t0) for x0, x1, t0, t1 in
         zip(a["chassis.x"], a["chassis.x"][1:], a["time"], a["time"][1:])]
    report(f"{name}: comes to rest", max(abs(x) for x in v[still:]) < 1e-3, max(abs(x) for x in v[still:]))
    report(f"{name}: and stays", max(a["chassis.x"][still:]) - min(a["chassis.x"][still:]) < 1e-3)
    distance = a["chassis.x"][still] - a["chassis.x"][at(a, 0.6)]
    report(f"{name}: braking distance", sliding[0] < 20**2 / (2 * 9.81 * distance) < sliding[1], distance)
    loads = sum(a[f"tire_{c}.fz"][-1] for c in CORNERS)
    report(f"{name}: loads sum to the weight after that", abs(loads / weight(model) - 1) < 1e-4, loads, weight(model))
    report(f"{name}: loads move forwards while it brakes",
           a["tire_f_l.fz"][slide.start] > 1.2 * a["tire_r_l.fz"][slide.start])
    report(f"{name}: no chatter", changes(a["slip_f_l.spin"], 1e-4) < 60, changes(a["slip_f_l.spin"], 1e-4))
    release = run(model, installed("tires_brake", duration=3, road=road,
                                   inputs="{brake: {knots: {times: [0.5, 0.7, 1.6, 1.7], values: [0, 1, 1, 0]}}}"))
    again = max(abs(k) for k in release["slip_f_l.kappa"][at(release, 2.6):])
    report(f"{name}: released wheels roll again", again < 2e-3 and release["slip_f_l.spin"][-1] * 0.46 > 5, again)
    report(f"{name}: without the brake's torque", all(x == 0 for x in release["slip_f_l.brake"][at(release, 1.7) + 1:]))


def standing():
    """at rest on the level: nothing is left but the weight"""
    a = run(TIRES, scene(30, 0.004, 1, ratio=2, inputs="{brake: 0.5}"))
    loads = sum(a[f"tire_{c}.fz"][-1] for c in CORNERS)
    report("loads of a standing vehicle sum to its weight", abs(loads / weight(TIRES) - 1) < 1e-9,
           loads / weight(TIRES) - 1)


def parking(model, engine, duration):
    name = "PAC2002" if model == TIRES else "TMeasy"
    a = run(model, installed("tires_park", duration=duration), engine)
    settled, end = at(a, 20), at(a, duration)
    drift = max(a["chassis.x"][settled:]) - min(a["chassis.x"][settled:])
    report(f"{name}, {engine}: parked on a slope, drift from 20 s to {duration} s", drift < 1e-7, drift)
    for c in ("f_l", "r_l"):
        spin = a[f"slip_{c}.spin"]
        # the body swings on the tires at some 2 Hz until the swing has died away
        turns = changes(spin, 1e-9)
        report(f"{name}, {engine}: no chatter of {c}", turns <= 4 * 20, turns)
        report(f"{name}, {engine}: {c} stands", max(abs(x) for x in spin[settled:]) < 1e-8)
    slope = hypot(1, 0.15)
    loads = sum(a[f"tire_{c}.fz"][end] for c in CORNERS)
    held = 2 * sum(a[f"slip_{c}.fx"][end] for c in ("f_l", "r_l"))
    # toe and camber turn some thousandth of the forces
    loads, held = loads * slope / weight(model), held * slope / 0.15 / weight(model)
    report(f"{name}, {engine}: loads and what tires hold balance the weight",
           abs(loads - 1) < 2e-3 and abs(held - 1) < 2e-2, loads, held)


def reversing():
    text = scene(4, 0.004, 0.02, ratio=2, initial="{velocity: [3, 0, 0]}", inputs="{drive_torque: -2400}")
    a = run(TIRES, text)
    v = [(x1 - x0) / 0.02 for x0, x1 in zip(a["chassis.x"], a["chassis.x"][1:])]
    jumps = max(abs(v2 - 2 * v1 + v0) for v0, v1, v2 in zip(v[10:], v[11:], v[12:]))
    report("backs up through standstill", v[0] > 2.8 and v[-1] < -3, v[0], v[-1])
    report("speed has no jump there", all(v1 < v0 for v0, v1 in zip(v[10:], v[11:])) and jumps < 0.01, jumps)
    report("slip stays small", max(abs(k) for k in a["slip_f_l.kappa"][5:]) < 0.05,
           max(abs(k) for k in a["slip_f_l.kappa"][5:]))
    # the same force before and after: 4 wheels' torque less rolling resistance, against mass and spin inertia
    before, after = (v[40] - v[20]) / 0.4, (v[-1] - v[-21]) / 0.4
    report("same acceleration both ways but for rolling resistance", abs(before / after - 1) < 0.15, before, after)
    report("gic agrees", gap(run(TIRES, text, "gic"), a) < 1e-9, gap(run(TIRES, text, "gic"), a))


def rolling_on():
    a = run(TIRES, installed("tires_coast"))
    v = [(x1 - x0) / 0.1 for x0, x1 in zip(a["chassis.x"], a["chassis.x"][1:])]
    # QSY1 = 0.008 of the weight, with R_0 over the rolling radius (2 percent); spin inertia moves along with the mass
    mass = weight(TIRES) / 9.81 + 4 * 7.38782 / 0.46**2
    want = 0.008 * weight(TIRES) / mass
    found = (v[20] - v[-1]) / (a["time"][-1] - a["time"][20])
    report("coasting slows by the rolling resistance", abs(found / want - 1) < 0.05, found, want)
    report("straight on", max(abs(y) for y in a["chassis.y"]) < 1e-6)
    rough = run(TIRES, installed("tires_rough"))
    loads = [rough[f"tire_{c}.fz"] for c in CORNERS]
    mean = sum(map(sum, loads)) / len(loads[0])
    report("on a rough road loads sum to the weight on average", abs(mean / weight(TIRES) - 1) < 0.05, mean)
    report("and vary", max(loads[0]) > 1.5 * mean / 4 and min(loads[0]) >= 0)


def agreeing():
    """Engines along the scenes: with equal integrators and coordinates they differ by rounding, which the motion
    amplifies; gcp1 has other coordinates and its own truncation error."""
    for name, duration in (("tires_brake", 2), ("tires_jump", 1.3), ("tires_rough", 2), ("tires_park", 2)):
        text = installed(name, duration=duration)
        tape = run(TIRES, text)
        for engine in ("cc", "gic"):
            found = gap(run(TIRES, text, engine), tape)
            report(f"{engine} agrees on {name}", found < 1e-8, found)
    text = installed("tires_park", duration=1, step=0.002, integrator="rk4", ratio=None)
    found = gap(run(TIRES, text, "gcp1"), run(TIRES, text), ["chassis.x", "chassis.z", "slip_f_l.spin"])
    report("gcp1 agrees on tires_park", found < 1e-5, found)


# ---- in the air -------------------------------------------------------------------------------------------------

def jumping():
    a = run(TIRES, installed("tires_jump"))
    air = [i for i in range(len(a["time"])) if all(a[f"tire_{c}.fz"][i] == 0 for c in CORNERS)]
    whole = air == list(range(air[0], air[-1] + 1)) if air else False
    report("all wheels are in the air for a quarter of a second", whole and len(air) >= 20, len(air))
    for c in ("f_l", "r_l"):
        spins = [a[f"slip_{c}.spin"][i] for i in air[10:]]
        report(f"nothing changes the spin of {c} there", max(spins) - min(spins) < 1e-10, max(spins) - min(spins))
    report("it lands and drives on", abs(a["chassis.z"][-1] - a["chassis.z"][0]) < 0.03)
    driven = run(TIRES, installed("tires_jump", inputs="{drive_torque: 2000}"))
    rates = [driven["slip_r_l.spin_rate"][i] for i in range(len(driven["time"]))
             if all(driven[f"tire_{c}.fz"][i] == 0 for c in CORNERS)]
    report("in the air the drive meets the spin inertia alone",
           max(abs(x - 500 / 7.38782) for x in rates[10:]) < 1e-9, max(abs(x - 500 / 7.38782) for x in rates[10:]))
    report("gic agrees", gap(run(TIRES, installed("tires_jump", duration=1), "gic"),
                             run(TIRES, installed("tires_jump", duration=1))) < 1e-9)


GYRO = f"{here}/gyro.veh"
A, C, SPIN_INERTIA = 3.0, 2.5, 1.5  # what is left of the hub across and along the axis; the wheel


def turned(e, x):
    """x turned by Euler parameters"""
    e0, v = e[0], e[1:]
    c = [v[1] * x[2] - v[2] * x[1], v[2] * x[0] - v[0] * x[2], v[0] * x[1] - v[1] * x[0]]
    d = [v[1] * c[2] - v[2] * c[1], v[2] * c[0] - v[0] * c[2], v[0] * c[1] - v[1] * c[0]]
    return [x[i] + 2 * (e0 * c[i] + d[i]) for i in range(3)]


def gyroscope(engine):
    """Its axis goes round the angular momentum L = A omega_across + (C omega_along + I Omega) s at the rate |L| / A."""
    omega, spin = (0.3, 0.7, -0.5), 40.0
    a = run(GYRO, scene(2, 0.001, 0.01, integrator="rk4", initial="{position: [0, 0, 50], angular_velocity: "
                        f"{list(omega)}, states: {{wheel.spin: {spin}}}}}"), engine)
    L = [A * omega[0], C * omega[1] + SPIN_INERTIA * spin, A * omega[2]]
    size = sqrt(sum(x * x for x in L))
    u = [x / size for x in L]
    worst = 0.0
    for i, t in enumerate(a["time"]):
        s = turned([a[f"hub.e{k}"][i] for k in range(4)], [0.0, 1.0, 0.0])
        c, n = cos(size / A * t), sin(size / A * t)
        # Rodrigues' formula for s at t = 0, (0, 1, 0)
        cross = [-u[2], 0.0, u[0]]
        want = [c * (k == 1) + n * cross[k] + (1 - c) * u[1] * u[k] for k in range(3)]
        worst = max(worst, max(abs(p - q) for p, q in zip(s, want)))
    turns = size / A * 2 / 6.283185307179586
    report(f"{engine}: a spinning wheel precesses ({turns:.0f} turns)", worst < 1e-6, worst)
    along = a["turn_own.y"]
    report(f"{engine}: spin and turning about the axis stay",
           max(abs(x - 0.7) for x in along) < 1e-9 and max(abs(x - 40) for x in a["wheel.spin"]) < 1e-9)
    kinetic = a["energy.kinetic"]
    report(f"{engine}: energy stays", max(kinetic) - min(kinetic) < 1e-7 * kinetic[0], max(kinetic) - min(kinetic))


def once():
    """pushed about the axis: a free wheel leaves the hub its own inertia, a locked one moves with it, once the swing of
    its elastic pad has died away"""
    for brake, inertia, name in ((0, C, "free"), (1, C + SPIN_INERTIA, "locked")):
        a = run(GYRO, scene(1, 0.0002, 0.1, integrator="rk4", initial="{position: [0, 0, 50]}",
                            inputs=f"{{push: 5, brake: {brake}}}"))
        report(f"spin inertia counts once, wheel {name}", abs(a["turn_own.y"][-1] * inertia / 5 - 1) < 1e-5,
               a["turn_own.y"][-1] * inertia / 5)


# ---- symmetry, energy, orders -----------------------------------------------------------------------------------

def drive(step, integrator, output_step, more="", sign=1.0):
    """a smooth drive: turning in, driven, brakes on the way out, over long waves that no wheel leaves"""
    return scene(0.96, step, output_step, more, integrator=integrator, initial="{velocity: [12, 0, 0]}",
                 road=f"{{type: sine, amplitude: 0.01, wavelength: 8, start: 2, phase_per_y: {sign * 0.2}}}",
                 inputs=f"{{rack: {{knots: {{times: [0, 1], values: [0, {sign * 0.03}]}}}}, drive_torque: {{knots: "
                        "{times: [0, 0.5], values: [0, 1500]}}, brake: {knots: {times: [0.3, 0.9], values: [0, 0.1]}}}")


def mirrored():
    left, right = (run(TIRES, drive(0.004, "ab3", 0.048, "ratio: 3", sign)) for sign in (1.0, -1.0))
    other = {"chassis.x": ("chassis.x", 1), "chassis.y": ("chassis.y", -1), "slip_f_l.spin": ("slip_f_r.spin", 1),
             "slip_f_r.fy": ("slip_f_l.fy", -1), "slip_r_l.mz": ("slip_r_r.mz", -1), "slip_r_r.fx": ("slip_r_l.fx", 1)}
    worst = max(abs(x - sign * y) / (1 + abs(x)) for name, (image, sign) in other.items()
                for x, y in zip(left[name], right[image]))
    report("a mirrored drive runs mirrored", worst < 1e-9, worst)
    report("and turns", abs(left["chassis.y"][-1]) > 0.5, left["chassis.y"][-1])


BOOLE = (7, 32, 12, 32)


def imbalance(step, integrator, more=""):
    """energy that is there at the end less what power brought; Boole's rule is of order 6"""
    a = run(TIRES, drive(step, integrator, step, more))
    power, n = a["energy.power"], len(a["time"]) - 1
    work = sum((14 if 0 < i < n and i % 4 == 0 else BOOLE[i % 4] if i % 4 else 7) * x for i, x in enumerate(power))
    return abs(a["energy.kinetic"][-1] + a["energy.potential"][-1] - a["energy.kinetic"][0] - a["energy.potential"][0]
               - work * step * 2 / 45)


def energy():
    for integrator, order, steps in (("rk4", 4, (0.001, 0.0005)), ("ab3", 3, (0.001, 0.0005)),
                                     ("dual", 3, (0.0005, 0.00025))):
        name, more = ("ab3", "ratio: 4") if integrator == "dual" else (integrator, "")
        coarse, fine = (imbalance(step, name, more) for step in steps)
        found = log(coarse / fine) / log(2)
        report(f"energy balance closes with the order of {integrator}", abs(found - order) < 0.4, found, coarse, fine)


def orders():
    names = ["chassis.x", "chassis.y", "chassis.z", "slip_f_l.spin", "slip_r_r.spin"]
    exact = run(TIRES, drive(0.000125, "rk4", 0.048))
    for integrator, order, steps, more in (("rk4", 4, (0.002, 0.001), ""), ("ab3", 3, (0.002, 0.001), ""),
                                           ("ab3", 3, (0.002, 0.001), "ratio: 4")):
        coarse, fine = (gap(run(TIRES, drive(step, integrator, 0.048, more)), exact, names) for step in steps)
        found = log(coarse / fine) / log(2)
        report(f"order of {integrator} {more}", abs(found - order) < 0.3, found, coarse, fine)
    # another partition of the coordinates has other truncation errors, of the size that RK4 has here
    other = run(TIRES, drive(0.001, "rk4", 0.048), "gcp1")
    report("gcp1 agrees", gap(other, exact, names) < 1e-7, gap(other, exact, names))


# mux is 0.8 at its maximum, and 0.55 where it slides; fxs / pn is 0.46 at friction 0.8, where the brakes just lock
braking(TIRES, 1, (0.5, 0.8))
braking(EASY, 0.8, (0.4, 0.9))
for car in (TIRES, EASY):
    parking(car, "tape", 60)
parking(TIRES, "gic", 30)
standing()
reversing()
rolling_on()
agreeing()
jumping()
gyroscope("tape")
gyroscope("gic")
once()
mirrored()
energy()
orders()
