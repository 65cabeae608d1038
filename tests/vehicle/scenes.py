#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# scenes.py GICRUN MODELS WORK: what the complete HMMWV does in its scenes, against what follows from mechanics,
# geometry and the tire's data. Prints `good NAME` or `bad NAME: why` for each check.
import csv
import math
import os
import re
import subprocess
import sys

gicrun, models, work = sys.argv[1:]
model = os.path.join(models, 'hmmwv_vehicle.veh')
GRAVITY, WHEELBASE, RACK_PER_ANGLE = 9.81, 3.302, -0.142
WHEELS = ('f_l', 'f_r', 'r_l', 'r_r')


def check(name, good, why=''):
    print('good ' + name if good else 'bad %s: %s' % (name, why))


def near(name, a, b, tolerance):
    check(name, abs(a - b) <= tolerance, '%.6g instead of %.6g, %.2g allowed' % (a, b, tolerance))


def run(scene, edits=(), options=(), of=model):
    """Results by names of columns, of a scene edited by pairs (pattern, replacement)."""
    text = open(os.path.join(models, 'scenes', scene + '.scene')).read()
    for pattern, replacement in edits:
        text, count = re.subn(pattern, replacement, text, flags=re.M)
        if count != 1:
            sys.exit('%s in %s: %d times' % (pattern, scene, count))
    path, results = os.path.join(work, 'edited.scene'), os.path.join(work, 'results.csv')
    open(path, 'w').write(text)
    done = subprocess.run([gicrun, '-q', *options, of, path, '-o', results], capture_output=True, text=True)
    check('%s %s ends well, without a word' % (scene, ' '.join(options)), done.returncode == 0 and not done.stderr,
          done.stderr)
    rows = list(csv.reader(open(results)))
    return {name.split(' [')[0]: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}


def step_of(step, ratio):
    return [(r'^step: 0\.006', 'step: %g' % step), (r'^ratio: 6', 'ratio: %d' % ratio)]


def along(d):
    """Speed at each row."""
    return [math.hypot(x, y) for x, y in zip(d['chassis_velocity.x'], d['chassis_velocity.y'])]


def at(d, time):
    return min(range(len(d['time'])), key=lambda i: abs(d['time'][i] - time))


def distance(a, b):
    """Largest distance of two paths of the chassis."""
    return max(math.dist(p, q) for p, q in zip(*(list(zip(*(d['chassis.' + c] for c in 'xyz'))) for d in (a, b))))


def gears(d):
    all_of = d['drive.gear']
    return [all_of[0]] + [b for a, b in zip(all_of, all_of[1:]) if b != a]


# ---- 30 s

def check_full_run():
    d = run('full_run')
    check('30 s', d['time'][-1] == 30 and len(d['time']) == 1001, d['time'][-1])
    # the search for rest moves it by a millimetre at most
    near('it starts where the paper does', math.hypot(d['chassis.x'][0] - 200, d['chassis.y'][0] - 50), 0, 0.001)
    near('its yaw then', d['chassis_attitude.yaw'][0], 0.5, 1e-6)
    check('at rest', max(abs(d['chassis_acceleration.' + c][0]) for c in 'xyz') < 1e-9)
    check('it shifts up, back and up again', gears(d) == [1, 2, 3, 2, 3], gears(d))
    check('no wheel leaves the ground', min(min(d['tire_%s.fz' % w]) for w in WHEELS) > 1000)
    # in third gear the engine's limit of 2700 rpm ends near 280 rad/s / (1.25 * 5) * 0.47 m = 21 m/s
    check('speeds', 15 < max(along(d)) < 21, max(along(d)))
    # the limit of friction
    level = max(math.hypot(x, y) for x, y in zip(d['chassis_acceleration.x'], d['chassis_acceleration.y']))
    check('accelerations along the road', 3 < level < GRAVITY, level)
    # tires and powertrain at 6 ms / 6 = 1 ms beside everything at 1 ms. Shifts are noticed at the end of a step, up to
    # 6 ms later: four of them, at some 1 m/s^2 of difference and 15 s on the way, are 0.4 m at most
    near('single rate', distance(d, run('full_run', step_of(0.001, 1))), 0, 0.2)


def energy_gap(step, ratio, until, more=()):
    """By how much the energy's change differs from the integral of the power over all steps, by a quadrature of order
    4: at most up to a time, and at most in all. What is left is the integrator's."""
    d = run('full_run', step_of(step, ratio) + [('^output_step: .*', 'output_step: %g' % step),
                                                ('^plot:', 'outputs: [energy]\nplot:')] + list(more))
    energy = [a + b for a, b in zip(d['energy.kinetic'], d['energy.potential'])]
    p, done, gaps = d['energy.power'], 0, []
    for i in range(1, len(p) - 2):
        done += step * (13 * (p[i] + p[i + 1]) - p[i - 1] - p[i + 2]) / 24
        gaps.append(abs(energy[i + 1] - energy[1] - done))
    return max(gaps[:round(until / step)]), max(gaps)


def check_energy():
    # an order of 2.7 at least; 3 halves to an eighth. In the first 2 s no gear changes
    dual = [energy_gap(step, 6, 2) for step in (0.006, 0.003)]
    check('energy balance of order 3, dual rate', dual[1][0] < dual[0][0] / 6.5, dual)
    # up to where the accelerator takes over from the governor of idling, which is a kink: shorter steps feel it more
    single = [energy_gap(step, 1, 0.45, [('^duration: .*', 'duration: 0.5')]) for step in (0.003, 0.0015)]
    check('energy balance of order 3, single rate', single[1][0] < single[0][0] / 6.5, single)
    # 1.2 MJ go through tires and engine in 30 s; gears that change at the end of a step leave a part of order 1
    check('energy balance of all', dual[0][1] < 1e-4 * 1.2e6 and dual[1][1] < dual[0][1] / 2, dual)


# ---- along a line

def check_acceleration_braking():
    d = run('acceleration_braking')
    v = d['chassis_velocity.x']
    check('it shifts up twice and down twice', gears(d) == [1, 2, 3, 2, 1], gears(d))
    check('it runs straight', max(map(abs, d['chassis.y'])) < 0.1, max(map(abs, d['chassis.y'])))
    check('top speed', 18 < max(v) < 21, max(v))
    end = range(at(d, 19), len(v))
    # it rocks on its tires
    check('it stands in the end', max(abs(v[i]) for i in end) < 0.3, [v[i] for i in end][::10])
    near('and stays', d['chassis.x'][-1], d['chassis.x'][end[0]], 0.05)
    # Braked by 4 * 0.35 * 4000 N m in third gear, with what the turbine gives: all mass, and all that turns with the
    # wheels (7.78782 each), 5 times as fast (three shafts of 0.5) and 6.25 times (0.3)
    mass = 2086.52 + 9.072 + 4 * (23.965 + 90.555)
    radius, turned = 0.4553, 4 * 7.78782 + 3 * 0.5 * 25 + 0.3 * 6.25 ** 2
    for time in (13.6, 14, 14.4):
        i = at(d, time)
        resistance = sum(d['slip_%s.my' % w][i] for w in WHEELS)
        force = (-4 * 0.35 * 4000 + 6.25 * d['drive.turbine_torque'][i] + resistance) / radius
        near('braking at %g s' % time, d['chassis_acceleration.x'][i], force / (mass + turned / radius ** 2), 0.1)
    # load goes to the front axle, against what it has just before: mass at the height of the centre of mass, and wheels
    # that are slowed down
    height = (2086.52 * 0.6955 + 9.072 * 0.5367 + 4 * 23.965 * 0.4234 + 4 * 90.555 * 0.4562) / mass
    i, k = at(d, 14), at(d, 12)
    change = {name: d[name][i] - d[name][k] for name in d}
    front = change['tire_f_l.fz'] + change['tire_f_r.fz']
    moment = -mass * height * change['chassis_acceleration.x']
    moment -= 7.78782 * sum(change['slip_%s.spin_rate' % w] for w in WHEELS)
    near('load of the front axle', front, moment / WHEELBASE, 0.03 * front)


# ---- bends

def check_step_steer():
    d = run('step_steer')
    yaw, v = d['chassis_angular_velocity.z'], along(d)
    last = yaw[-1]
    check('straight before', max(abs(w) for w, t in zip(yaw, d['time']) if t < 3) < 0.01)
    near('the driver keeps the speed', v[-1], 16, 0.2)
    check('steady in the end', max(abs(w - last) for w in yaw[at(d, 7):]) < 0.005 * last)
    half = next(t for w, t in zip(yaw, d['time']) if w > last / 2)
    check('half the yaw rate within 0.3 s of the middle of the step', 3.1 < half < 3.4, half)
    check('little overshoot', 1 < max(yaw) / last < 1.1, max(yaw) / last)
    across = [a * math.cos(y) - b * math.sin(y) for a, b, y in
              zip(d['chassis_acceleration.y'], d['chassis_acceleration.x'], d['chassis_attitude.yaw'])]
    near('acceleration across is speed times yaw rate', across[-1], v[-1] * last, 0.1)
    check('it leans out of the bend', 0.01 < d['chassis_attitude.roll'][-1] < 0.06, d['chassis_attitude.roll'][-1])


def check_steady_circle():
    d = run('steady_circle')
    off = [math.hypot(x, y - 30) - 30 for x, y in zip(d['chassis.x'], d['chassis.y'])]
    late = range(at(d, 20), len(off))
    # the driver aims along the vehicle's axis, off the direction of its motion by a sideslip angle of some hundredths
    near('the circle closes', max(abs(off[i]) for i in late), 0, 0.1)
    near('and better in the end', abs(off[-1]), 0, 0.03)
    near('the driver keeps the speed', along(d)[-1], 10, 0.05)
    # of a vehicle that rolls: atan(wheelbase / radius); there is little understeer: next check
    near('steering', d['rack.value'][-1],
         RACK_PER_ANGLE * math.atan(WHEELBASE / 30), 0.001)


def cornering_stiffness(load, factor):
    """Two tires, N/rad: K_y of PAC2002 upright."""
    text = open(os.path.join(models, 'tires', 'hmmwv_pac2002.tir')).read()
    p = {key: float(value) for key, value in re.findall(r'^\s*(\w+)\s*=\s*([-+.\dEe]+)', text, re.M)}
    nominal = p['FNOMIN'] * p['LFZO']
    return -2 * factor * p['LKY'] * p['PKY1'] * nominal * math.sin(2 * math.atan(load / (p['PKY2'] * nominal)))


def understeer(name, factor):
    """Front wheel angle more than that of the rolling vehicle, rad a g, on a circle of 80 m: measured between 6 and 9
    m/s, and by axle loads over axle stiffnesses. factor: of the stiffness of front and rear tires."""
    text = open(os.path.join(models, 'tires', 'hmmwv_pac2002.tir')).read()
    wheels = ''
    for axle, f in zip('fr', factor):
        soft, count = re.subn(r'^LKY\s*=.*', 'LKY = %g' % f, text, flags=re.M)
        if count != 1:
            sys.exit('no LKY in the tire')
        open(os.path.join(work, axle + '.tir'), 'w').write(soft)
        wheels += ('  tire_%s_l: {body: wheel_%s_l, center: centre_%s_l, tire: %s, spin_inertia: 7.78782, '
                   'brake: 4000 * brake}\n' % ((axle,) * 4))
    path = os.path.join(work, name + '.veh')
    open(path, 'w').write('gicgen: 1\nmodel: %s\ninclude: %s\ntires: {f: {file: f.tir}, r: {file: r.tir}}\nwheels:\n%s'
                          % (name, os.path.relpath(model, work), wheels))
    points, load = [], {}
    for speed in (6, 9):
        outputs = 'input.rack, chassis_velocity, chassis_angular_velocity, tire_f_l, tire_f_r, tire_r_l, tire_r_r'
        d = run('steady_circle', [('radius: 30', 'radius: 80'), (r'\[0, 30\]', '[0, 80]'),
                                  ('^  speed: 10', '  speed: %d' % speed), ('target: 10', 'target: %d' % speed),
                                  ('speed: 140', 'speed: %d' % (14 * speed)),
                                  ('^plot:', 'outputs: [%s]\nplot:' % outputs)], of=path)
        v, w = along(d)[-1], d['chassis_angular_velocity.z'][-1]
        points.append((v * w / GRAVITY, d['input.rack'][-1] / RACK_PER_ANGLE - math.atan(WHEELBASE * w / v)))
        load = {a: sum(d['tire_%s_%s.fz' % (a, s)][-1] for s in 'lr') for a in 'fr'}
    (a, angle), (b, more) = points
    predicted = [load[axle] / cornering_stiffness(load[axle] / 2, f) for axle, f in zip('fr', factor)]
    return (more - angle) / (b - a), predicted[0] - predicted[1]


def check_understeer():
    even, expected = understeer('even', (1, 1))
    # each axle takes 0.16 rad a g; of the difference nothing is left by tires at their static load, and what roll,
    # camber and the loads' shift sideways do to it is less than a tenth of that
    check('about neutral with the same tires', abs(expected) < 0.001 and abs(even) < 0.016, (even, expected))
    front, more = understeer('front', (0.8, 1))
    rear, less = understeer('rear', (1, 0.8))
    # against that, what softer tires bring; a tenth for what grows with slip beside it
    near('understeer of soft front tires', front - even, more - expected, 0.1 * more)
    near('oversteer of soft rear tires', rear - even, less - expected, 0.1 * more)
    check('signs', front > 0.03 and rear < -0.03, (front, rear))


def check_lane_change():
    d = run('lane_change')
    worst = math.inf
    # x from, to, y from, to, and half a tire's width
    for low, high, right, left in ((0, 12, -1.335, 1.335), (25.5, 36.5, 2.335, 5.535), (49, 61, -1.335, 1.775)):
        for w in WHEELS:
            inside = [y for x, y in zip(d['wheel_%s.x' % w], d['wheel_%s.y' % w]) if low <= x <= high]
            check('wheel %s passes the lane from %g m' % (w, low), len(inside) > 50)
            worst = min(worst, left - 0.159 - max(inside), min(inside) - 0.159 - right)
    check('all wheels stay 0.1 m from the cones', worst > 0.1, worst)
    check('no slower than 9.5 m/s', min(along(d)) > 9.5, min(along(d)))
    roll = d['chassis_attitude.roll']
    check('it leans to both sides', max(roll) > 0.02 and min(roll) < -0.02)
    # everything at 1 ms, the driver as often
    near('single rate', distance(d, run('lane_change', step_of(0.001, 1))), 0, 0.001)
    # looks and commands are those of the engine it is run by; partitioned coordinates have errors of their own, of order 3
    half = step_of(0.003, 6)
    fine = run('lane_change', half)
    for engine, most in (('tape', 0), ('gic', 1e-10), ('gcp1', 1e-4), ('gcp2', 1e-4)):
        other = run('lane_change', options=('--engine', engine))
        near('the same with ' + engine, distance(d, other), 0, most)
        near('commands with ' + engine, max(abs(a - b) for a, b in zip(d['rack.value'], other['rack.value'])), 0, most)
        if most > 1e-10:
            near('the same with %s, half the step' % engine, distance(fine, run('lane_change', half, ('--engine', engine))), 0,
                 distance(d, other) / 6)
    # variable steps, which stop wherever the driver looks: error of AB3 and dual rate at 6 ms
    near('variable steps', distance(d, run('lane_change', options=('--integrator', 'rkck', '--tolerance', '1e-7'))), 0,
         0.001)


def check_roll_over():
    d = run('roll_over')
    roll = d['chassis_attitude.roll']
    check('it lies on its side', roll[-1] < -1.3, roll[-1])
    air = [i for i in range(len(roll)) if d['tire_f_r.fz'][i] == 0 and d['tire_r_r.fz'][i] == 0]
    check('the right wheels are in the air first', len(air) > 0.7 / 0.012 and abs(roll[air[0]]) < 0.2, len(air))
    check('then all', any(all(d['tire_%s.fz' % w][i] == 0 for w in WHEELS) for i in range(len(roll))))
    check('and it turns on about its long axis', roll[-1] < roll[-15] < roll[-30] < -0.4, roll[-30:])
    usual = run('roll_over', [('value: 2', 'value: 1')])
    check('with ordinary friction it slides', max(map(abs, usual['chassis_attitude.roll'])) < 0.15,
          max(map(abs, usual['chassis_attitude.roll'])))
    near('single rate', distance(d, run('roll_over', step_of(0.001, 1))), 0, 0.01)


for part in (check_full_run, check_energy, check_acceleration_braking, check_step_steer, check_steady_circle,
             check_understeer, check_lane_change, check_roll_over):
    part()
