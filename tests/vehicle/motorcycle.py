#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# motorcycle.py GICGEN GICRUN MODELS WORK: the motorcycle against what follows by hand from its masses, points and
# springs: loads, forces of springs at rest, wheel rates, hop of the wheels, balance in a steady turn, the way into a
# lane change; its energy. Prints `good NAME` or `bad NAME: why` for each check.
import math
import sys

from vehicle import GRAVITY, Vehicle, check, cross, dot, energy_orders, near, norm, sub

bike = Vehicle(*sys.argv[1:], 'motorcycle')
P = bike.points
WHEELBASE, CASTER, TRAIL = 1.45, math.radians(25), 0.1
TIRE = {'front': 150000, 'rear': 180000}
SPIN = {'front': 0.45, 'rear': 0.65}
CROWN = {'front': 0.197 * 0.305, 'rear': 0.286 * 0.315} # m: QSX2 times the radius

# ---- masses and loads
mass = sum(b['mass'] for b in bike.bodies.values())
first = {name: sum(b['mass'] * b['com'][k] for b in bike.bodies.values()) / mass for k, name in enumerate('xyz')}
near('mass', bike.sheet['mass'], mass, 1e-9)
near('share of the front wheel by moments', bike.sheet['front.share'], first['x'] / WHEELBASE, 5e-3)
front = first['x'] / WHEELBASE * mass * GRAVITY
load = {'front': front, 'rear': mass * GRAVITY - front}
near('caster', bike.kc['front']['front.caster'], CASTER, 1e-3)
# where the steering axis meets the road before the contact, both in the drawing
axis = math.tan(CASTER) * P['head'][2] + P['head'][0] - P['front_hub'][0]
near('trail of the drawing', axis, TRAIL, 1e-3)

# ---- the swing arm turns about its pivot: lever of the spring, and of the wheel
spring = sub(P['spring_arm'], P['spring_frame'])
lever = dot(cross([0, 1, 0], sub(P['spring_arm'], P['pivot'])), spring) / norm(spring) # change of length a rad
reach = P['pivot'][0] - P['rear_hub'][0]                                                # rise of the hub a rad
ratio = lever / reach
k = bike.force('spring')['stiffness']
near('rear wheel rate', bike.sheet['wheel.rear.wheel_rate'], k * ratio ** 2, 0.1 * k * ratio ** 2)
arm, fork = bike.bodies['arm'], bike.bodies['fork']
held = (load['rear'] * reach - arm['mass'] * GRAVITY * (P['pivot'][0] - arm['com'][0])) / abs(lever)
d = bike.run('motorcycle_circle')
rest = k * (bike.force('spring')['free'] - d['spring.value'][0])
near('force of the spring at rest by moments about the pivot', rest, held, 0.02 * held)

# ---- the fork slides along the steering axis: the wheel's load along it
k = bike.force('springs')['stiffness']
near('front wheel rate', bike.sheet['wheel.front.wheel_rate'], k / math.cos(CASTER) ** 2, 1e-3 * k)
held = (load['front'] - fork['mass'] * GRAVITY) * math.cos(CASTER)
near('force of the fork at rest', k * (d['travel.value'][0] - bike.force('springs')['free']), held, 0.01 * held)

# ---- hop of the wheels, between tire and spring; the frame stands nearly still
hop = {'front': math.sqrt((TIRE['front'] * math.cos(CASTER) ** 2 + k) / fork['mass']) / 2 / math.pi}
about = arm['inertia'][1] + 0.65 + arm['mass'] * norm(sub(arm['com'], P['pivot'])) ** 2 # with what spins
hop['rear'] = math.sqrt((TIRE['rear'] * reach ** 2 + bike.force('spring')['stiffness'] * lever ** 2) / about)
hop['rear'] /= 2 * math.pi
modes = bike.modes()
for wheel, name in (('front', 'travel'), ('rear', 'spring')):
    found = [m for m in modes if m['share.' + name] > 0.5]
    near('hop of the %s wheel' % wheel, found[0]['frequency'] if found else 0, hop[wheel], 0.1 * hop[wheel])

# ---- steady turn, leaning to the left: moments about the line through both contacts. Gravity leans it further; what
# the turn takes, wheels as gyroscopes, the products of the turn and inertia, and crowns on which contacts move inward
# raise it.
lean, speed = -d['attitude.roll'][-1], math.hypot(d['pace.x'][-1], d['pace.y'][-1])
turn = math.sqrt(sum(d['turn.' + c][-1] ** 2 for c in 'xyz'))
check('it is steady', abs(d['attitude.roll'][-1] - d['attitude.roll'][-100]) < 1e-4, d['attitude.roll'][-1])
near('it leans as the rider wants, but for what his torque is for', lean, 0.5236, 0.1)
height = bike.sheet['com_height']
gyro = sum(SPIN[w] * d[w + '_tire.spin'][-1] for w in SPIN) * turn * math.cos(lean)
crown = sum(CROWN[w] * d[w + '_load.fz'][-1] for w in CROWN) * lean
inertia = (bike.sheet['inertia_zz'] - bike.sheet['inertia_yy']) * turn ** 2 * math.sin(lean) * math.cos(lean)
raising = mass * speed * turn * height * math.cos(lean) + gyro + crown + inertia
near('balance in the turn', raising, mass * GRAVITY * height * math.sin(lean), 0.02 * raising)
thin = math.atan(speed * turn / GRAVITY)
check('crowns and gyroscopes make it lean by 3 degrees more', lean > thin + 0.05, (lean, thin))
# the wheels' directions on the road, by steering geometry and slip
steer = math.atan(math.tan(d['steer.value'][-1]) * math.cos(CASTER) / math.cos(lean))
bent = steer + d['front_tire.alpha'][-1] - d['rear_tire.alpha'][-1]
near('curvature by the directions of both wheels', turn / speed, bent / WHEELBASE, 0.03 * turn / speed)
near('forces across', sum(d[w + '_tire.fy'][-1] for w in SPIN), mass * speed * turn, 0.01 * mass * speed * turn)

# ---- the lane change to the left: steering to the right comes first, then the lean to the left, then the way
d = bike.run('motorcycle_lane_change')
when = lambda test: next((t for t, ok in zip(d['time'], map(test, range(len(d['time'])))) if ok), None)
right = when(lambda i: d['steer.value'][i] < -5e-4)
left = when(lambda i: d['attitude.roll'][i] < -0.02)
over = when(lambda i: d['place.y'][i] > 0.1)
check('it is steered to the right, leans to the left, goes to the left', right < left < over, (right, left, over))
near('the new line', d['place.y'][-1], 3.5, 0.02)
check('it is upright again', abs(d['attitude.roll'][-1]) < 2e-3, d['attitude.roll'][-1])
check('wheels stay on the road', min(d['front_load.fz'] + d['rear_load.fz']) > 500)

# ---- energy: order 3 of AB3, in one rate and two; falling over without hands, for torques that are held jump
energy_orders(bike, 'motorcycle_lane_change', 0.0005, 4, 0.5,
              [('^  speed: 18', '  speed: 18\n  angular_velocity: [0.3, 0, 0]'),
               ('^  speed: {.*', '  grip: {constant: 0}')])
