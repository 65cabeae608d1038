# SPDX-License-Identifier: MIT
# lock.py GICRUN MODEL: a block and a braked wheel that slide, come to rest, are held, and break loose. MODEL is
# lock.veh, copied into the present folder.
#
# The block (2 kg) has dry friction as the formats let one write it, which is regularized: 4 N against the motion above
# the speed of creep (0.1 m/s), in proportion to the speed below. A rope pulls with 4 N/s. So the law of motion is
# linear in pieces, and the solution is closed: constant deceleration; below the speed of creep an exponential towards
# the speed with which the block creeps under the load, "held"; from where that reaches the speed of creep, 4 N,
# acceleration.
#
# The wheel (2 kg m^2) has the brake of TIRES.md section 4, 4 N m, which is regularized as well: an elastic pad of
# 0.02 rad that slips. From a pad wound up, zeta = 1, it slides with exactly the brake's torque: closed. Then the pad
# swings and holds against a drive of 2 N m/s, until it slips. That part has no closed form: it is integrated here, in
# pieces between all places where the law has kinks, by RK4 in steps of 0.1 ms (errors below 1e-12).
import csv
import math
import subprocess
import sys

gicrun, model = sys.argv[1:3]
M, F, CREEP, PULL = 2.0, 4.0, 0.1, 4.0  # kg, N, m/s, N/s
J, B, WINDUP, TAU, DRIVE = 2.0, 4.0, 0.02, 0.01, 2.0  # kg m^2, N m, rad, s, N m/s
bad = total = 0


def root(f, low, high):
    """Between low, where f is above 0, and high."""
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if f(middle) > 0 else (low, middle)
    return (low + high) / 2


class Block:
    def __init__(self, speed):
        self.speed = speed
        self.arrest = root(lambda t: self.slide(t)[1] - CREEP, 0, F / PULL)
        self.constant = M * CREEP / F  # s, of the exponential
        self.held = PULL * CREEP / F  # m/s^2: the speed of creeping is this times the time, but for its lag
        self.loose = root(lambda t: CREEP - self.stick(t)[1], self.arrest + 5 * self.constant, 2)

    def slide(self, t):
        return self.speed * t - F / M * t * t / 2 + PULL / M * t**3 / 6, self.speed - F / M * t + PULL / M * t * t / 2

    def stick(self, t):
        c, k, start = self.constant, self.held, self.arrest
        left = CREEP - k * (start - c)
        fades = left * math.exp(-(t - start) / c)
        way = k * ((t - c) ** 2 - (start - c) ** 2) / 2 + c * (left - fades)
        return self.slide(start)[0] + way, k * (t - c) + fades

    def at(self, t):
        if t <= self.arrest:
            return self.slide(t)
        if t <= self.loose:
            return self.stick(t)
        x, v = self.stick(self.loose)
        s = t - self.loose
        a = (PULL * self.loose - F) / M
        return x + v * s + a * s * s / 2 + PULL / M * s**3 / 6, v + a * s + PULL / M * s * s / 2


def law(t, u, z, kind):
    """Rates of spin and windup; kind: on which side of each kink of the law this is, frozen."""
    forwards, rubs, worn, full, above, below = kind
    e = u / math.sqrt(1 + (u / (100 * WINDUP)) ** 2)
    s = ((z if z > 0 else -z) - 0.7) / 0.3
    share = 0 if not (rubs and worn) else 1 if full else s * s * (3 - 2 * s)
    rate = e / WINDUP - share * z * (e if forwards else -e) / WINDUP
    grip = 1 if above else -1 if below else z + TAU * rate
    return (DRIVE * t - B * grip) / J, rate


def kind_of(t, u, z):
    kind = [u > 0, z * u > 0, abs(z) > 0.7, abs(z) >= 1, False, False]
    grip = z + TAU * law(t, u, z, kind)[1]
    return kind[:4] + [grip > 1, grip < -1]


def step(t, u, z, h, kind):
    a, p = law(t, u, z, kind)
    b, q = law(t + h / 2, u + h / 2 * a, z + h / 2 * p, kind)
    c, r = law(t + h / 2, u + h / 2 * b, z + h / 2 * q, kind)
    d, s = law(t + h, u + h * c, z + h * r, kind)
    return u + h / 6 * (a + 2 * b + 2 * c + d), z + h / 6 * (p + 2 * q + 2 * r + s)


def wheel(speed, rows):
    """Spin and torque of the brake at output times."""
    arrest = root(lambda t: speed - B / J * t + DRIVE / J * t * t / 2, 0, B / DRIVE)
    out, t, u, z = [], arrest, 0.0, 1.0
    kind = [False, False, True, True, False, False]  # the pad is full, and it begins to turn back
    for time in rows:
        if time <= arrest:
            out.append((speed - B / J * time + DRIVE / J * time * time / 2, B))
            continue
        while t < time:
            h = min(1e-4, time - t)
            there = step(t, u, z, h, kind)
            if kind_of(t + h, *there) != kind:
                low, high = 0.0, h
                while low < (low + high) / 2 < high and high - low > 1e-16:
                    middle = (low + high) / 2
                    if kind_of(t + middle, *step(t, u, z, middle, kind)) == kind:
                        low = middle
                    else:
                        high = middle
                h, there = high, step(t, u, z, high, kind)
                kind = kind_of(t + h, *there)
            t, (u, z) = t + h, there
        t = time
        out.append((u, DRIVE * t - J * law(t, u, z, kind)[0]))
    return out


def run(lines, engine, speeds):
    text = "gicscene: 1\nduration: 3\noutput_step: 0.05\noutputs: [x.value, x.rate, wheel.spin, wheel.brake]\n" + lines
    text += f"\ninitial: {{rates: {{x: {speeds[0]!r}}}, states: {{wheel.spin: {speeds[1]!r}, wheel.brake: 1}}}}\n"
    with open("now.scene", "w") as file:
        file.write(text)
    done = subprocess.run([gicrun, "--engine", engine, model, "now.scene", "-o", "-"], capture_output=True, text=True)
    if done.returncode:
        print(done.stderr)
        return []
    return [[float(x) for x in row] for row in list(csv.reader(done.stdout.splitlines()))[1:]]


ways = [(f"integrator: {name}\nstep: {step}{ratio}", engine) for name, step, ratio, engine in
        (("rk4", 2e-6, "", "tcc"), ("ab3", 1e-6, "", "tcc"), ("ab3", 4e-6, "\nratio: 4", "tcc"))]
ways += [(f"integrator: {name}\ntolerance: 1e-13", engine) for name in ("rkck", "adams")
         for engine in ("tcc", "tape", "gic")]
# general numbers; then both come to the end of sliding at 0.25 s, the end of a step
for speeds in (0.5, 0.47), (0.5375, 0.46875):
    block = Block(speeds[0])
    spins = wheel(speeds[1], [0.05 * k for k in range(61)])
    for lines, engine in ways:
        rows = run(lines, engine, speeds)
        name = f"{engine}, {lines}, from {speeds}".replace("\n", ", ")
        off = [math.inf] * 4
        if len(rows) == 61:
            exact = [block.at(row[0]) + spin for row, spin in zip(rows, spins)]
            off = [max(abs(a - b[i]) for a, b in zip([row[1 + i] for row in rows], exact)) for i in range(4)]
            off[3] /= B
        for what, distance in zip(("way", "speed", "spin", "torque"), off):
            total += 1
            if not distance <= 1e-10:
                bad += 1
                print(f"{name}: {what} is {distance:.3g} off")
        print(f"{name}: off by " + ", ".join(f"{x:.2g}" for x in off))
print(f"block at rest after {block.arrest:.12g} s, loose at {block.loose:.12g} s; {total} numbers, {bad} bad")
sys.exit(bad > 0)
