#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# formula_student.py GICGEN GICRUN MODELS WORK: the Formula Student car against what follows by hand from its hard points and
# its data: loads, lever ratios, wheel rates, roll centres, ride frequencies, acceleration, downforce, the skid pad; its energy.
# Prints `good NAME` or `bad NAME: why` for each check.
import math
import sys

from vehicle import GRAVITY, Vehicle, check, cross, dot, energy_orders, near, norm, scaled, sub

car = Vehicle(*sys.argv[1:], 'formula_student')
P = car.points
HUB = {'front': 'f_', 'rear': 'r_'}
WHEELBASE = 1.55


def hinge(axle, arm):
    """Direction of a wishbone's hinge."""
    joint = car.joint(axle + {'lower': '_lower_l', 'upper': '_upper_l'}[arm])
    return car.axis(joint)


def velocity_field(axle):
    """Angular velocity and velocity of the upright at the ball joint for a unit turn of the lower wishbone: the upper
    ball joint moves perpendicular to its wishbone's plane, the tie rod and the rack stay as long as they are."""
    p = lambda name: P[HUB[axle] + name + '_l']
    rod = ('rod' if axle == 'front' else 'toe')
    v0 = cross(hinge(axle, 'lower'), sub(p('lower_out'), p('lower_in')))
    normal = cross(hinge(axle, 'upper'), sub(p('upper_out'), p('upper_in')))
    rows, right = [], []
    # velocity v0 + w x r of the upper ball joint is along the normal: two directions in the plane of the wishbone
    r = sub(p('upper_out'), p('lower_out'))
    for d in (hinge(axle, 'upper'), sub(p('upper_out'), p('upper_in'))):
        rows.append(cross(r, d))
        right.append(-dot(v0, d))
    r, d = sub(p(rod + '_out'), p('lower_out')), sub(p(rod + '_out'), p(rod + '_in'))
    rows.append(cross(r, d))
    right.append(-dot(v0, d))
    assert norm(normal) > 0
    return v0, car.solve(rows, right)


def corner(axle):
    """Per unit of wheel travel: change of the spring's length, turn of the lever, velocity of the contact."""
    p = lambda name: P[HUB[axle] + name + '_l']
    v0, w = velocity_field(axle)
    at = lambda point: [a + b for a, b in zip(v0, cross(w, sub(point, p('lower_out'))))]
    travel = at(p('hub'))[2]
    contact = at([p('hub')[0], p('hub')[1], p('hub')[2] - car.radius])
    # pushrod: both ends have the same velocity along it; the wishbone turns by 1 about its hinge, the rocker about x
    rod = sub(p('push_in'), p('push_out'))
    along = dot(cross(hinge(axle, 'lower'), sub(p('push_out'), p('lower_in'))), rod)
    x = [1, 0, 0]
    rocker = along / dot(cross(x, sub(p('push_in'), p('rocker'))), rod)
    spring = sub(p('spring_out'), p('spring_in'))
    length = rocker * dot(cross(x, sub(p('spring_out'), p('rocker'))), spring) / norm(spring)
    drop = sub(p('drop_in'), p('drop_out'))
    lever = rocker * dot(cross(x, sub(p('drop_in'), p('rocker'))), drop) / dot(cross([0, 1, 0], sub(p('drop_out'), p('lever'))), drop)
    return length / travel, lever / travel, scaled(contact, 1 / travel), contact[2] / travel


# ---- masses and loads
mass = sum(b['mass'] for b in car.bodies.values())
first = {name: sum(b['mass'] * b['com'][k] for b in car.bodies.values()) / mass for k, name in enumerate('xyz')}
near('mass', car.sheet['mass'], mass, 1e-9)
near('height of the centre of mass in the drawing', car.sheet['com_z'], first['z'], 1e-4)
front = (first['x'] + WHEELBASE / 2) / WHEELBASE
near('share of the front axle by moments', car.sheet['front.share'], front, 2e-4)
check('balance of a car with the driver in the middle', 0.45 < front < 0.5, front)
near('mass of a car with its driver', mass, 250, 5)

# ---- kinematics by the geometry of the drawing
stiffness = {}
for axle in ('front', 'rear'):
    ratio, lever, contact, _ = corner(axle)
    row = car.kc[axle]
    near(axle + ': motion ratio of the spring', row['%s_tire_l.ratio.%s_spring_l' % (axle, axle)], ratio, 1e-6)
    check(axle + ': the spring is shortened by 0.6 to 0.9 of the travel', 0.6 < -ratio < 0.9, ratio)
    near(axle + ': lever of the bar', abs(row['%s_tire_l.ratio.%s_bar' % (axle, axle)]), abs(lever), 1e-6)
    hub = P[HUB[axle] + 'hub_l']
    centre = hub[1] * contact[1] / contact[2] # normals of P' meet in the middle: z / y = P'y / P'z
    near(axle + ': roll centre', row['roll_centre_height'], centre, 1e-6)
    k, force = car.force(axle + '_spring_l')['stiffness'], abs(row['%s_tire_l.force' % axle] / ratio)
    rate = row['%s_tire_l.wheel_rate' % axle]
    # without the share of the spring's force in a ratio that changes
    near(axle + ': wheel rate', rate, k * ratio ** 2, 0.08 * rate)
    bar = car.force(axle + '_bar')['stiffness']
    spring, twist = rate * 2 * hub[1] ** 2, bar * (2 * lever * hub[1]) ** 2
    near(axle + ': roll rate of springs and bar', row['roll_rate'], spring + twist, 0.02 * (spring + twist))
    check(axle + ': the bar adds to it, but not as much again', 0.1 < twist / spring < 0.7, twist / spring)
    check(axle + ': roll centre of a racing car', 0.01 < centre < 0.08, centre)
    stiffness[axle] = rate
# the kingpin, through both ball joints
low, top = P['f_lower_out_l'], P['f_upper_out_l']
near('kingpin inclination', car.kc['front']['front_tire_l.kingpin_inclination'], math.atan2(low[1] - top[1], top[2] - low[2]), 1e-9)
near('caster', car.kc['front']['front_tire_l.caster'], math.atan2(low[0] - top[0], top[2] - low[2]), 1e-9)
# from the steering wheel by the pinion and the steering arm's length ahead of the kingpin, to some percent
arm = low[0] + (P['f_rod_out_l'][2] - low[2]) / (top[2] - low[2]) * (top[0] - low[0]) - P['f_rod_out_l'][0]
near('steering ratio', car.kc['front']['steering_ratio'], arm / 0.0095, 0.06 * arm / 0.0095)

# ---- ride: each end on its wheel rate and tire in series
tire = 110000
for axle, share in (('front', front), ('rear', 1 - front)):
    k = 1 / (1 / stiffness[axle] + 1 / tire)
    sprung = mass * share / 2 - car.bodies[axle + '_wheel_l']['mass'] - car.bodies[axle + '_wishbone_l']['mass'] / 2
    check(axle + ': ride frequency of 3 to 5 Hz', 3 < math.sqrt(k / sprung) / 2 / math.pi < 5, math.sqrt(k / sprung) / 2 / math.pi)
    stiffness[axle] = 2 * k, 2 * sprung
heave = math.sqrt(sum(k for k, _ in stiffness.values()) / sum(m for _, m in stiffness.values())) / 2 / math.pi
modes = car.modes()
near('heave', min((m['frequency'] for m in modes if m['share.z'] > 0.5), default=0), heave, 0.12 * heave)
check('pitch below 6 Hz', any(m['share.pitch'] > 0.5 and m['frequency'] < 6 for m in modes))

# ---- acceleration: the traction control holds the slip, the rear tires carry it; the wings press
d = car.run('formula_student_acceleration')
at = lambda time: min(range(len(d['time'])), key=lambda i: abs(d['time'][i] - time))
start, end = d['chassis.x'][0], next(t for t, x in zip(d['time'], d['chassis.x']) if x > d['chassis.x'][0] + 75)
check('75 m in 3.5 to 4.5 s', 3.5 < end - 0.3 < 4.5, end)
check('it runs straight', max(map(abs, d['chassis.y'])) < 0.01, max(map(abs, d['chassis.y'])))
i = at(2.4)
air = 0.5 * 1.225 * d['ahead.x'][i] ** 2
loaded = lambda w: car.radius - d['%s_load_l.deflection' % w][i]
pull = sum(2 * (d['%s_slip_l.drive' % w][i] + d['%s_slip_l.my' % w][i] - inertia * d['%s_slip_l.spin_rate' % w][i]) / loaded(w)
           for w, inertia in (('front', 0.17), ('rear', 0.22)))
near('acceleration by torque, air, rolling resistance and wheels that turn', d['acceleration.x'][i],
     (pull - 1.2 * air) / mass, 0.1)
loads = sum(d['%s_load_%s.fz' % (w, s)][i] for w in ('front', 'rear') for s in 'lr')
near('loads: weight and 2.75 m^2 of downforce', loads, mass * GRAVITY + 2.75 * air, 0.02 * loads)
check('slip is held', all(d['rear_slip_l.kappa'][k] < 0.16 for k in range(at(1), at(4.4))), max(d['rear_slip_l.kappa'][at(1):at(4.4)]))
check('by the control', min(d['share_l']) < 0.95, min(d['share_l']))
check('it brakes by more than 1.5 g', min(d['acceleration.x']) < -1.5 * GRAVITY, min(d['acceleration.x']))

# ---- the skid pad
d = car.run('formula_student_skid_pad')
v, w = d['ahead.x'][-1], d['turn.z'][-1]
radius = [math.hypot(x, y - 9.125) for x, y in zip(d['chassis.x'], d['chassis.y'])]
check('the circle is held within 0.3 m', max(abs(r - 9.125) for r in radius[at(6):]) < 0.3, max(abs(r - 9.125) for r in radius[at(6):]))
near('speed times yaw rate', math.hypot(v, d['ahead.y'][-1]) * w, 12, 0.5)
across = mass * math.hypot(v, d['ahead.y'][-1]) * w
moved = [(d['%s_load_r.fz' % a][-1] - d['%s_load_l.fz' % a][-1]) / 2 for a in ('front', 'rear')]
near('load that goes to the outer side', moved[0] * 1.2 + moved[1] * 1.16, across * first['z'], 0.08 * across * first['z'])
# by the springs' and bars' roll rates and the height over the roll axis; tires yield, too
axis = (car.kc['front']['roll_centre_height'] * front + car.kc['rear']['roll_centre_height'] * (1 - front))
rates = [1 / (1 / car.kc[a]['roll_rate'] + 2 / (tire * t ** 2)) for a, t in (('front', 1.2), ('rear', 1.16))]
lean = across * (first['z'] - axis) / (sum(rates) - mass * GRAVITY * (first['z'] - axis))
near('roll', d['attitude.roll'][-1], lean, 0.15 * lean)
check('understeer: it needs more than a car that rolls', d['steering.value'][-1] > car.kc['front']['steering_ratio'] * math.atan(WHEELBASE / 9.125),
      d['steering.value'][-1])

# ---- energy: order 3 of AB3, in one rate and two
energy_orders(car, 'formula_student_skid_pad', 0.003, 6, 2)
