#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# semitrailer.py GICGEN GICRUN MODELS WORK: the tractor with its semitrailer against what follows by hand from its
# masses, springs and lengths: loads of the axles, the ratio of the steering gear, deceleration and loads while it
# brakes, how far the trailer cuts in; its energy. Prints `good NAME` or `bad NAME: why` for each check.
import math
import sys

from vehicle import GRAVITY, Vehicle, check, energy_orders, near

truck = Vehicle(*sys.argv[1:], 'semitrailer')
AXLES = {'steer': 0, 'drive_1': -4.9, 'drive_2': -6.2, 'trailer_1': -16.85, 'trailer_2': -18.15}
COUPLING, HEIGHT = -5.3, 1.25
TIRE, RADIUS = 900000, 0.515
SPRING, PRELOAD = {'steer': 2.5e5, 'drive_1': 3e5, 'drive_2': 3e5, 'trailer_1': 3e5, 'trailer_2': 3e5}, \
    {'steer': 24100, 'drive_1': 32000, 'drive_2': 32000, 'trailer_1': 34000, 'trailer_2': 34000}


def wheels(axle):
    if axle == 'steer':
        return ['steer_tire_l', 'steer_tire_r']
    return ['%s_%s_%s' % (axle, where, side) for where in ('outer', 'inner') for side in 'lr']


def parts(names):
    """Mass and first moments about the origin of the drawing."""
    bodies = [truck.bodies[n] for n in names]
    return [sum(b['mass'] * x for b, x in ((b, ([1] + b['com'])[k]) for b in bodies)) for k in range(4)]


# ---- masses: of the tractor with what turns in it, of the trailer, of each axle
cab = parts(['tractor', 'plate', 'steering_wheel', 'nut', 'pitman'])
box = parts(['trailer'])
beam = {a: parts([a + '_beam'] + (['knuckle_l', 'knuckle_r'] if a == 'steer' else [])) for a in AXLES}
rigid = [sum(p[k] for p in [cab, box, *beam.values()]) for k in range(4)]
near('mass: 80,000 lb', rigid[0], 80000 * 0.45359237, 1)
near('mass, as the sheet has it', truck.sheet['mass'], rigid[0], 1e-6)


# ---- loads at rest: two rigid bodies, pinned to each other, on five springs, each of them in series with its tires
def gauss(rows, right):
    n = len(right)
    m = [list(r) + [x] for r, x in zip(rows, right)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(m[i][k]))
        m[k], m[pivot] = m[pivot], m[k]
        for i in range(n):
            if i != k:
                factor = m[i][k] / m[k][k]
                m[i] = [a - factor * b for a, b in zip(m[i], m[k])]
    return [m[k][n] / m[k][k] for k in range(n)]


def rest():
    """Loads of the axles on the road, and of the coupling. Unknown are the forces F of the springs of each axle, that
    of the coupling, and how far both bodies have gone down at x = 0 and how they slope: 10."""
    names = list(AXLES)
    rows, right = [], []
    at = lambda x, body: ([1, x, 0, 0] if body == 0 else [0, 0, 1, x])
    for i, a in enumerate(names):
        body = 0 if i < 3 else 1
        weight = beam[a][0] * GRAVITY
        tires = TIRE * len(wheels(a))
        k, load = 2 * SPRING[a], 2 * PRELOAD[a]
        sunk = RADIUS - 0.494 # of the tires, in the drawing
        # the body has gone down by what the spring is shorter and the tires have sunk more than in the drawing:
        # (F - load) / k + (F + weight) / tires - sunk
        rows.append([(1 / k + 1 / tires) * (j == i) for j in range(5)] + [0] + [-x for x in at(AXLES[a], body)])
        right.append(load / k + sunk - weight / tires)
    for body, part in ((0, cab), (1, box)):
        mine = [i for i in range(5) if (i < 3) == (body == 0)]
        sign = -1 if body == 0 else 1 # the coupling carries the trailer
        rows.append([1.0 * (j in mine) for j in range(5)] + [sign, 0, 0, 0, 0])
        right.append(part[0] * GRAVITY)
        rows.append([AXLES[names[j]] * (j in mine) for j in range(5)] + [sign * COUPLING, 0, 0, 0, 0])
        right.append(part[1] * GRAVITY)
    rows.append([0] * 6 + [1, COUPLING, -1, -COUPLING])
    right.append(0)
    x = gauss(rows, right)
    return {a: x[i] + beam[a][0] * GRAVITY for i, a in enumerate(names)}, x[5]


loads, carried = rest()
found = {a: sum(truck.sheet[w + '.load'] for w in wheels(a)) for a in AXLES}
for a in AXLES:
    near('%s: load of the axle at rest' % a, found[a], loads[a], 0.01 * loads[a])
near('all loads', sum(found.values()), rigid[0] * GRAVITY, 1e-6 * rigid[0] * GRAVITY)
tandem = found['trailer_1'] + found['trailer_2']
middle = (found['trailer_1'] * AXLES['trailer_1'] + found['trailer_2'] * AXLES['trailer_2']) / tandem
own = beam['trailer_1'][0] + beam['trailer_2'][0]
moment = box[0] * (COUPLING - box[1] / box[0]) + own * (COUPLING + 17.5)
moment *= GRAVITY
near('moments of the trailer about the kingpin', tandem * (COUPLING - middle), moment, 1e-3 * moment)
for names, limit in ((['drive_1', 'drive_2'], 34000), (['trailer_1', 'trailer_2'], 34000), (['steer'], 12500)):
    load = sum(found[a] for a in names) / GRAVITY / 0.45359237
    check('%s: within %d lb' % (' and '.join(names), limit), load < limit, load)

# ---- steering gear: screw, rack and pitman arm, drag link; the lever of the link about the inclined kingpin
link, knuckle = truck.points['drag_out'], truck.points['knuckle_l']
lever = knuckle[1] - 0.09 * (link[2] - knuckle[2]) - link[1]
ratio = 0.045 / 0.00225 * lever / (truck.points['pitman'][2] - link[2])
near('ratio of the steering gear', truck.kc['front']['steering_ratio'], ratio, 0.01 * ratio)

# ---- braking: all brakes slip, wheels do not lock; the trailer pushes with what its own brakes leave of its share
d = truck.run('semitrailer_braking')
at = lambda time: min(range(len(d['time'])), key=lambda i: abs(d['time'][i] - time))
i, end = at(3.5), d['time'][-1]
pedal = 0.8
BRAKE = {a: 5500 if a == 'steer' else 5000 for a in AXLES}
retard = {a: 0 for a in AXLES}
for a in AXLES:
    for w in wheels(a):
        load = 'steer_load_' + w[-1] if a == 'steer' else w.replace(a + '_', a + '_load_', 1)
        radius = RADIUS - d[load + '.deflection'][i]
        inertia = 12 if a == 'steer' else 11
        near('%s: its brake holds back with its torque' % w, d[w + '.brake'][i], BRAKE[a] * pedal, 1e-9 * BRAKE[a])
        # the wheel: inertia spin' = -radius Fx + My - brake, and what evens out a pair, which cancels out in the sum
        retard[a] += (BRAKE[a] * pedal - d[w + '.my'][i] + inertia * d[w + '.spin_rate'][i]) / radius
air = 0.5 * 1.225 * 10 * 0.6 * d['ahead.x'][i] ** 2
slower = (sum(retard.values()) + air) / rigid[0]
near('deceleration by torques of brakes, rolling resistance and air', -d['acceleration.x'][i], slower, 0.01 * slower)
behind = [a + b + c for a, b, c in zip(box, beam['trailer_1'], beam['trailer_2'])]
push = behind[0] * slower - retard['trailer_1'] - retard['trailer_2']
near('force along in the kingpin', d['coupling.force.x'][i], -push, 0.03 * push)
# moments of the trailer about the road under its axles: inertia at its height, the kingpin's two forces; axles at rest
# relative to it
low = lambda part: part[3] / part[0]
rear = (AXLES['trailer_1'] + AXLES['trailer_2']) / 2
still = d['coupling.force.z'][0]
extra = (behind[0] * slower * low(behind) - push * HEIGHT) / (COUPLING - rear)
near('load that braking moves onto the kingpin', d['coupling.force.z'][i] - still, extra, 0.1 * extra)
front = sum(d['steer_load_%s.fz' % s][i] for s in 'lr') - sum(d['steer_load_%s.fz' % s][0] for s in 'lr')
check('the steering axle takes load from braking', front > 0.1 * found['steer'], front)
stopped = next(t for t, v in zip(d['time'], d['ahead.x']) if v < 0.05)
near('time to rest from 22 m/s', stopped, 0.5 + 0.2 + 22 / slower, 0.25)
check('it stays straight', max(map(abs, d['bend.value'])) < 0.01 and max(map(abs, d['tractor.y'])) < 0.3,
      (max(map(abs, d['bend.value'])), max(map(abs, d['tractor.y']))))

# ---- a slow turn: all axles of a body are about one centre, pairs of axles as one in their middle. That the two of a
# pair scrub against each other is left out.
d = truck.run('semitrailer_turn')
v, w = d['ahead.x'][-1], d['turn.z'][-1]
near('the trailer turns as fast as the tractor', d['trailer_turn.z'][-1], w, 2e-3 * w)
inner = v / w                                             # of the tractor along its middle, abreast of the pair
pair, arm = -5.55, COUPLING + 17.5
ahead = COUPLING - pair
hitch = math.hypot(inner, ahead)
tail = math.sqrt(hitch ** 2 - arm ** 2)
bend = math.asin(arm / hitch) - math.atan(ahead / inner) # the kingpin, ahead of the pair, moves inward there
check('the trailer cuts in by more than a metre', inner - tail > 1, inner - tail)
near('angle between tractor and trailer', abs(d['bend.value'][-1]), bend, 0.01 * bend)
k = next(i for i in range(len(d['time'])) if d['time'][i] > d['time'][-1] - math.pi / w) # half a turn before
across = {n: math.hypot(*(d[n + c][k] - d[n + c][-1] for c in ('.x', '.y'))) / 2 for n in ('tractor', 'trailer')}
near('circle of the steering axle', across['tractor'], math.hypot(inner, pair), 0.02 * across['tractor'])
near('circle in the middle of the trailer\'s axles', across['trailer'], tail, 0.03 * tail)

# ---- the lane change: both bodies follow, and nothing rolls over
d = truck.run('semitrailer_lane_change')
near('the new lane', d['tractor.y'][-1], 3.5, 0.1)
near('the trailer in it', d['trailer.y'][-1], 3.5, 0.15)
peak = {n: max(map(abs, d[n + '.y'])) for n in ('acceleration', 'trailer_acceleration')}
ratio = peak['trailer_acceleration'] / peak['acceleration']
check('acceleration of the trailer over that of the tractor', 0.6 < ratio < 1.6, ratio)
check('all wheels stay on the road', all(min(f) > 0 for n, f in d.items() if n.endswith('.fz')))

# ---- energy: order 3 of AB3, in one rate and two. In two rates 2.5 ms are not yet short enough for the order to show.
energy_orders(truck, 'semitrailer_lane_change', 0.00125, 5, 2)
