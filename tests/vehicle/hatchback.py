#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# hatchback.py GICGEN GICRUN MODELS WORK: the hatchback against what follows by hand from its hard points and its data. Small
# displacements of all bodies about the drawing, joints as linear equations, rubber and springs as a stiffness matrix, in
# NumPy: all natural frequencies on rubber, the static equilibrium, lever ratios. Then its runs and its energy.
# Prints `good NAME` or `bad NAME: why` for each check.
import math
import re
import sys

import numpy

from vehicle import GRAVITY, Vehicle, check, energy_orders, near

car = Vehicle(*sys.argv[1:], 'hatchback')
P = {name: numpy.array(p) for name, p in car.points.items()}
P.update({name[:-2] + '_r': p * [1, -1, 1] for name, p in list(P.items()) if name.endswith('_l')})
NAMES = [b['name'] for b in car.dump['bodies']]
STRUT = numpy.array([-0.0185, -0.0245, 0.25]) # its axis, on the left
X, Y, Z = numpy.eye(3)
WHEELBASE = 2.55


def side(v, s):
    return v if s == 'l' else v * [1, -1, 1]


def skew(p):
    return numpy.array([[0, -p[2], p[1]], [p[2], 0, -p[0]], [-p[1], p[0], 0]])


# ---- small displacements: of each body that of its point in the origin, and a rotation
def moved(body, p):
    """Displacement of the body's point at p: 3 rows."""
    rows = numpy.zeros((3, 6 * len(NAMES)))
    at = 6 * NAMES.index(body)
    rows[:, at:at + 3], rows[:, at + 3:at + 6] = numpy.eye(3), -skew(p)
    return rows


def turned(body):
    rows = numpy.zeros((3, 6 * len(NAMES)))
    at = 6 * NAMES.index(body) + 3
    rows[:, at:at + 3] = numpy.eye(3)
    return rows


def apart(a, b, p):
    """What b's point at p has moved against a's, and b has turned against a."""
    return moved(b, p) - moved(a, p), turned(b) - turned(a)


def longer(a, b, p, q):
    """Change of the distance of p on a from q on b."""
    line = (q - p) / numpy.linalg.norm(q - p)
    return line @ (moved(b, q) - moved(a, p))


def across(axis):
    """Two directions perpendicular to it."""
    return numpy.linalg.svd(axis[None])[2][1:]


def revolute(a, b, p, axis):
    d, r = apart(a, b, p)
    return [d, across(axis) @ r]


def fixed(a, b):
    return list(apart(a, b, numpy.zeros(3)))


def joints():
    rows = fixed('body', 'steering_wheel') + fixed('gear', 'rack') # the steering wheel is held
    d, r = apart('subframe', 'gear', numpy.zeros(3))
    rows += [d[[0, 2]], r]
    for s in 'lr':
        p = lambda name: P[name + '_' + s]
        rows += [apart('arm_' + s, 'strut_' + s, p('f_ball'))[0]]
        rows += [across(side(STRUT, s)) @ apart('strut_' + s, 'body', p('f_top'))[0]]
        rows += [longer('rack', 'strut_' + s, p('f_rod_in'), p('f_rod_out'))]
        rows += revolute('subframe', 'lever_' + s, p('f_lever'), Y)
        rows += [longer('lever_' + s, 'strut_' + s, p('f_drop_in'), p('f_drop_out'))]
    rows += revolute('trail_l', 'trail_r', P['r_shear'], Y)
    return rows


def free(rows):
    """Columns: motions that all these equations leave, orthogonal."""
    a = numpy.vstack(rows)
    _, s, v = numpy.linalg.svd(a)
    return v[numpy.sum(s > 1e-9 * s[0]):].T


# ---- masses, rubber, springs
def mass_matrix():
    m = numpy.zeros((6 * len(NAMES),) * 2)
    for b in car.dump['bodies']:
        rows = moved(b['name'], numpy.array(car.bodies[b['name']]['com']))
        turn = numpy.array([car.world(dict(b, position=[0, 0, 0]), list(e)) for e in numpy.eye(3)]).T
        i = b['inertia']
        own = numpy.array([[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]])
        m += b['mass'] * rows.T @ rows + turned(b['name']).T @ turn @ own @ turn.T @ turned(b['name'])
    return m


def cubic_slope(x, y):
    """Slope of a monotone cubic table at x = 0, by the formula of FORMAT.md section 6."""
    i = x.index(0)
    h0, h1 = x[i] - x[i - 1], x[i + 1] - x[i]
    s0, s1 = (y[i] - y[i - 1]) / h0, (y[i + 1] - y[i]) / h1
    w0, w1 = 2 * h1 + h0, h1 + 2 * h0
    return (w0 + w1) / (w0 / s0 + w1 / s1)


LOSS = 3e-4
# as the file has them: along x, y, z and about them
RUBBER = [('body', 'subframe', 'f_mount', [3e6, 3e6, 2e6, 300, 300, 300], 0),
          ('body', 'subframe', 'f_mount_back', [5e6, 5e6, 3e6, 300, 300, 300], 0),
          ('subframe', 'arm', 'f_arm', [1e6, 5e6, 4e6, 150, 600, 600], 0),
          ('subframe', 'arm', 'f_arm_back', [5e5, 1e6, 4e5, 100, 60, 100], 0),
          ('body', 'trail', 'r_bush', [9e5, 2.5e6, 1.2e6, 150, 90, 150], -0.44)]
SPRING, REAR_SPRING, BAR, BEAM, TOP, TIRE = 24000, 31000, 450, 900, 1e6, 200000


def rubber():
    """Stiffness of all bushings; their damping is LOSS times that."""
    k = numpy.zeros((6 * len(NAMES),) * 2)
    for a, b, point, stiffness, angle in RUBBER:
        for s in 'lr':
            c, n = math.cos(angle), math.sin(angle) * (1 if s == 'l' else -1)
            axes = numpy.array([[c, n, 0], [-n, c, 0], [0, 0, 1]])
            d, r = apart(a, b if b == 'subframe' else b + '_' + s, P[point + '_' + s])
            rows = numpy.vstack([axes @ d, axes @ r])
            k += rows.T @ numpy.diag(stiffness) @ rows
    return k


def outer(row, factor):
    return factor * numpy.outer(row, row)


def strut(s):
    return longer('body', 'strut_' + s, P['f_top_' + s], P['f_seat_' + s])


def rear_spring(s):
    return longer('body', 'trail_' + s, P['r_spring_' + s], P['r_seat_' + s])


def rear_damper(s):
    return longer('body', 'trail_' + s, P['r_top_' + s], P['r_damper_' + s])


def gear():
    return Y @ apart('subframe', 'gear', numpy.zeros(3))[0]


def springs():
    k = outer(gear(), 1.5e6) + outer(Y @ (turned('lever_r') - turned('lever_l')), BAR) + outer(Y @ (turned('trail_r') - turned('trail_l')), BEAM)
    for s in 'lr':
        k += outer(strut(s), SPRING) + outer(rear_spring(s), REAR_SPRING)
    return k


def dampers():
    d = outer(gear(), 2000) + outer(Y @ (turned('lever_r') - turned('lever_l')), 0.2) + outer(Y @ (turned('trail_r') - turned('trail_l')), 2)
    slope = cubic_slope([-1, -0.3, -0.1, 0, 0.1, 0.4, 1.2], [-900, -350, -160, 0, 230, 650, 1400])
    for s in 'lr':
        d += outer(rear_damper(s), slope)
    return d


M, K, S = mass_matrix(), rubber(), springs()
D = LOSS * K + dampers()

# ---- small motions in the air, without weight and with springs that do not press: the drawing is at rest, and every
# eigenvalue has to be there. The top mounts' states follow the struts.
T = free(joints())
n = T.shape[1]
check('32 degrees of freedom', n == 32, n)
give = cubic_slope([-1400, -400, -150, 0, 220, 750, 2000], [-1.2, -0.3, -0.08, 0, 0.08, 0.4, 1.4])
J = numpy.array([strut('l'), strut('r')]) @ T
inverse = numpy.linalg.inv(T.T @ M @ T)
A = numpy.zeros((2 * n + 2,) * 2)
A[:n, n:2 * n] = numpy.eye(n)
A[n:2 * n, :n], A[n:2 * n, n:2 * n] = -inverse @ T.T @ (K + S) @ T, -inverse @ T.T @ D @ T
A[n:2 * n, 2 * n:] = -inverse @ J.T * TOP
A[2 * n:, n:2 * n], A[2 * n:, 2 * n:] = J, -give * TOP * numpy.eye(2)
mine = [z for z in numpy.linalg.eigvals(A) if abs(z) > 1]

text = open(car.model).read()
for pattern, replacement in (('^base: body', 'base: body\ngravity: [0, 0, 0]'), (', free: 0.385', ''), (', free: 0.300', '')):
    text, count = re.subn(pattern, replacement, text, flags=re.M)
    if count != 1:
        sys.exit('%s: %d times' % (pattern, count))
open(car.path('air.veh'), 'w').write(text)
open(car.path('air.scene'), 'w').write('gicscene: 1\nduration: 1\nstep: 0.00025\ninputs: {selector: 0}\n'
                                      'initial: {position: [0.26, -0.001, 3], gear: 0}\n')
car.said([car.gicrun, '--linearize', '--at', '0', '-q', car.path('air.veh'), car.path('air.scene'), '-o', car.path('air.npz')])
theirs = numpy.linalg.eigvals(numpy.load(car.path('air.npz'))['A'])
check('54 eigenvalues that are not 0', len(mine) == 54, len(mine))
worst = max(mine, key=lambda z: min(abs(theirs - z)) / abs(z))
check('natural frequencies and damping on rubber', min(abs(theirs - worst)) < 1e-8 * abs(worst), (worst, min(abs(theirs - worst))))
check('the fastest has 250 to 350 Hz', 250 < max(map(abs, mine)) / 2 / math.pi < 350, max(map(abs, mine)) / 2 / math.pi)

# ---- masses and loads, by moments
mass = sum(b['mass'] for b in car.bodies.values())
first = sum(b['mass'] * numpy.array(b['com']) for b in car.bodies.values()) / mass
front = (first[0] + WHEELBASE / 2) / WHEELBASE
near('mass', car.sheet['mass'], mass, 1e-9)
near('height of the centre of mass in the drawing', car.sheet['com_z'], first[2], 1e-3)
near('share of the front axle', car.sheet['front.share'], front, 1e-3)
check('a car with its engine in front', 0.57 < front < 0.63, front)

# ---- static equilibrium on wheels that turn and slip: what gravity and the springs' preloads do to the drawing
preload = 24000 * (0.385 - numpy.linalg.norm(P['f_top_l'] - P['f_seat_l']))
rear_preload = 31000 * (0.300 - numpy.linalg.norm(P['r_spring_l'] - P['r_seat_l']))
load = numpy.zeros(6 * len(NAMES))
for b in car.dump['bodies']:
    load -= b['mass'] * GRAVITY * moved(b['name'], numpy.array(car.bodies[b['name']]['com']))[2]
road = numpy.zeros_like(K)
hubs = {'front_' + s: moved('strut_' + s, P['f_hub_' + s])[2] for s in 'lr'}
hubs.update({'rear_' + s: moved('trail_' + s, P['r_hub_' + s])[2] for s in 'lr'})
pressed = {w: car.radius - P[w[0] + '_hub_l'][2] for w in hubs}
for w, row in hubs.items():
    road += outer(row, TIRE)
    load += TIRE * pressed[w] * row
for s in 'lr':
    load += preload * strut(s) + rear_preload * rear_spring(s)
whole = T.T @ (K + S + road) @ T
move = T @ numpy.linalg.lstsq(whole, T.T @ load, rcond=1e-12)[0]
for w, row in hubs.items():
    near('load of %s by rubber, springs and tires' % w, car.sheet[w + '.load'], TIRE * (pressed[w] - row @ move), 15)
open(car.path('rest.scene'), 'w').write('gicscene: 1\nduration: 1\nstep: 0.00025\ninputs: {selector: 0}\n'
                                       'initial: {gear: 0, equilibrium: true}\n')
car.said([car.gicrun, '--equilibrium', '-q', car.model, car.path('rest.scene'), '-o', car.path('rest.csv')])
rest = {k: float(v) for k, v in car.table('rest.csv')[0].items()}
for what, at, (d, r), names in (
        ('subframe', 'frame', apart('body', 'subframe', numpy.array(car.bodies['subframe']['com'])), 'xz'),
        ('arm', 'arm', apart('subframe', 'arm_l', P['f_arm_l']), 'xyz'),
        ('beam', 'beam', apart('body', 'trail_l', P['r_bush_l']), 'z')):
    end = '_l' if at == 'arm' else ''
    for k in names:
        value = d['xyz'.index(k)] @ move
        near('%s at rest: %s' % (what, k), rest['%s_%s%s' % (at, k, end)], value, 0.05 * abs(value))
    for k, name in enumerate(('roll', 'pitch', 'yaw')):
        near('%s at rest: %s' % (what, name), rest['%s_%s%s' % (at, name, end)], r[k] @ move, 4e-4)

# ---- lever ratios: wheels that are held at heights, on rubber alone, whose energy is least; the steering gear is held
motions = free(joints() + [numpy.eye(6 * len(NAMES))[:6]] + fixed('subframe', 'gear'))
n = motions.shape[1]


def motion(up, K=K):
    """Displacements for the travel of each wheel: K q = J^T lambda, J q = up."""
    J = numpy.array([hubs[w] for w in up]) @ motions
    k = motions.T @ K @ motions
    right = numpy.append(numpy.zeros(n), list(up.values()))
    return motions @ numpy.linalg.solve(numpy.block([[k, J.T], [J, numpy.zeros((4, 4))]]), right)[:n]


one = motion({'front_l': 1, 'front_r': 0, 'rear_l': 0, 'rear_r': 0})
row = car.kc['front']
near('motion ratio of the strut', row['front_l.ratio.spring_l'], strut('l') @ one, 1e-6)
near('motion ratio of the bar', abs(row['front_l.ratio.bar']), abs(Y @ (turned('lever_r') - turned('lever_l')) @ one), 1e-6)
contact = P['f_hub_l'] - [0, 0, car.radius]
both = motion({'front_l': 1, 'front_r': 1, 'rear_l': 0, 'rear_r': 0}) # the subframe gives way otherwise
near('camber by travel', row['front_l.camber_rate'], -(turned('strut_l') @ both)[0], 1e-6)
near('toe by travel', row['front_l.toe_rate'], -(turned('strut_l') @ both)[2], 1e-6)
lean = motion({'front_l': 1, 'front_r': -1, 'rear_l': 0, 'rear_r': 0})
moves = moved('strut_l', contact) @ lean
near('roll centre', row['roll_centre_height'], contact[1] * moves[1] / moves[2], 1e-6) # of the wheel that does not lean
rate = SPRING * (strut('l') @ one) ** 2
near('wheel rate in front', row['front_l.wheel_rate'], rate, 0.1 * rate)
axis = P['f_top_l'] - P['f_ball_l']
near('kingpin inclination', row['front_l.kingpin_inclination'], math.atan2(-axis[1], axis[2]), 1e-6)
near('caster', row['front_l.caster'], math.atan2(-axis[0], axis[2]), 1e-6)
row = car.kc['rear']
check('the beam gives way, but does not steer', 'steering_ratio' not in row and 'steering_ratio' in car.kc['front'])
one = motion({'front_l': 0, 'front_r': 0, 'rear_l': 1, 'rear_r': 0})
twist = Y @ (turned('trail_r') - turned('trail_l'))
for s in 'lr':
    near('motion ratio of the spring behind, ' + s, row['rear_l.ratio.rear_spring_' + s], rear_spring(s) @ one, 1e-6)
    near('the same of the damper', row['rear_l.ratio.rear_damper_' + s], rear_damper(s) @ one, 1e-6)
near('the same of the torsion spring', row['rear_l.ratio.twist'], twist @ one, 1e-6)
for name, value in row.items():
    sign = -1 if re.search(r'(contact|centre)_y$|\.steer$|twist$', name) else 1
    if name.startswith('rear_l.'):
        other = re.sub('_(l|r)$', lambda m: '_r' if m.group(1) == 'l' else '_l', 'rear_r.' + name[7:])
        near('left and right: ' + name, row[other], sign * value, 1e-8 * max(1, abs(value)))


def roll(K=K):
    """Roll centre and roll rate of springs and torsion spring, at the drawing."""
    half = P['r_hub_l'][1]
    q = motion({'front_l': 0, 'front_r': 0, 'rear_l': half, 'rear_r': -half}, K)
    aside = moved('trail_l', P['r_hub_l'] - [0, 0, car.radius])[1] @ q
    return aside, BEAM * (twist @ q) ** 2 + sum(REAR_SPRING * (rear_spring(s) @ q) ** 2 for s in 'lr')


centre, rate = roll()
near('roll centre behind', row['roll_centre_height'], centre, 1e-6)
near('the same by forces', row['roll_centre_force'], centre, 1e-6)
near('roll rate behind, but for what the springs press', row['roll_rate'], rate, 0.03 * rate)
balls = [d for s in 'lr' for d in [apart('body', 'trail_' + s, P['r_bush_' + s])[0]]]
hard = roll(K + 1e12 * sum(d.T @ d for d in balls))
near('with balls in place of bushings: roll centre', centre, hard[0], 2e-3)
near('with balls in place of bushings: roll rate', rate, hard[1], 0.01 * rate)
# rates are those of what moves: the mean of neighbours' over a step, 1/12 of its cube left over
car.said([car.gicrun, '--kc', '-q', '--travel', '0.02', car.model, '-o', car.path('travel.csv')])
table = car.table('travel.csv')
for axle in 'front', 'rear':
    for way in 'parallel', 'opposite':
        rows = [{k: float(v) for k, v in r.items() if v and k not in ('axle', 'motion')} for r in table
                if r['axle'] == axle and r['motion'] == way]
        check('%s, %s: 41 rows' % (axle, way), len(rows) == 41, len(rows))
        wheel = axle + '_l.'
        for what, by, rate in (('camber', 'travel', 'camber_rate'), ('toe', 'travel', 'toe_rate'), ('force', 'contact_z', 'wheel_rate')):
            change = [b[wheel + what] - a[wheel + what] for a, b in zip(rows, rows[1:])]
            summed = [(b[wheel + by] - a[wheel + by]) * (a[wheel + rate] + b[wheel + rate]) / 2 for a, b in zip(rows, rows[1:])]
            most = max(abs(b[wheel + rate]) * 0.001 for b in rows)
            worst = max(abs(c - d) for c, d in zip(change, summed))
            check('%s, %s: %s and its rate' % (axle, way, what), worst <= 2e-3 * most + 1e-9, (worst, most))

# ---- the double lane change, between the cones of the scene
d = car.run('hatchback_lane_change')
LANES = [(0, 12, 0, 2.12), (25.5, 36.5, 3.41, 2.7), (49, 61, 0.17, 2.46)]
for wheel in ('front_hub_l', 'front_hub_r', 'rear_hub_l', 'rear_hub_r'):
    path = list(zip(d[wheel + '.x'], d[wheel + '.y']))
    check(wheel + ' between the cones', all(abs(y - middle) < width / 2 for low, high, middle, width in LANES for x, y in path if low <= x <= high))
across = max(map(abs, d['acceleration.y']))
check('by 0.6 to 0.75 g', 0.6 * GRAVITY < across < 0.75 * GRAVITY, across)
# tie rods pull at the rack with what turns the wheels about their kingpins, over the steering arm; rubber gives by that
arm = 0.0083 * car.kc['front']['steering_ratio']
trail = car.kc['front']['front_l.caster_trail']
torque = [a + b - trail * (c + e) for a, b, c, e in zip(d['front_slip_l.mz'], d['front_slip_r.mz'], d['front_slip_l.fy'], d['front_slip_r.fy'])]
i = max(range(len(torque)), key=lambda k: abs(torque[k]))
near('the steering gear on its rubber', d['gear.value'][i], -torque[i] / arm / 1.5e6, 0.25 * abs(torque[i]) / arm / 1.5e6)

# ---- from rest through the gears, and down again
d = car.run('hatchback_braking')
at = lambda time: min(range(len(d['time'])), key=lambda i: abs(d['time'][i] - time))
start = next(t for t, v in zip(d['time'], d['ahead.x']) if v > 100 / 3.6)
check('100 km/h in 11 to 15 s', 11 < start - 0.2 < 15, start)
check('it runs straight', max(map(abs, d['body.y'])) < 0.02, max(map(abs, d['body.y'])))
check('through five gears', sorted(set(d['engine.gear'])) == [1, 2, 3, 4, 5], set(d['engine.gear']))
i = at(17)
radius = car.radius - d['front_load_l.deflection'][i]
stop = 0.7 * (2 * 1750 + 2 * 450) / radius
inertia = mass + 2 * (0.95 + 0.85) / radius ** 2
air = 0.5 * 1.225 * 2.1 * 0.31 * d['ahead.x'][i] ** 2
rolling = 0.011 * mass * GRAVITY
near('deceleration by brakes, air and rolling resistance', -d['acceleration.x'][i], (stop + air + rolling) / inertia, 0.25)
for axle, share in (('front', 1), ('rear', -1)):
    moved_load = mass * -d['acceleration.x'][i] * 0.507 / WHEELBASE
    own = mass * GRAVITY * (front if axle == 'front' else 1 - front)
    near('load of the axle in %s' % axle, d[axle + '_load_l.fz'][i] + d[axle + '_load_r.fz'][i], own + share * moved_load, 0.02 * mass * GRAVITY)
# the braking force at the contact, over the strut's levers about its top, at the arm's ball joint: both bushings along x
give = -stop * 1750 / 2200 / 2 * P['f_top_l'][2] / (P['f_top_l'] - P['f_ball_l'])[2] / 1.5e6
near('arms give by the braking force', d['arm_x_l.value'][i] - rest['arm_x_l'], give, 0.1 * abs(give))
v = car.sheet['top_speed']
revs = v / (car.radius - 0.0173) * 3.9 * 0.76 / (2 * math.pi / 60)
power = numpy.interp(revs, [3500, 4500, 5500], [130, 128, 117]) + numpy.interp(revs, [1000, 6000], [-12, -32])
near('power at top speed: air and rolling', power * revs * 2 * math.pi / 60, v * (0.5 * 1.225 * 2.1 * 0.31 * v ** 2 + rolling), 3e3)

# ---- energy: order 3 of AB3, in neutral, for maps of the engine and the converter have bends
energy_orders(car, 'hatchback_lane_change', 0.00025, 1, 1.5,
              [('^  gear: 3', '  gear: 0'), ('^  speed: {target: 15}$', ''), ('^driver:', 'inputs: {selector: 0}\ndriver:')])
