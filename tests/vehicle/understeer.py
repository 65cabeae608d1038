#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# understeer.py GICRUN MODELS WORK: how the axles of the complete HMMWV slip in slow bends, against its wheel loads at
# rest and the cornering stiffness of the tire at these loads. Prints `ok NAME: numbers` or `FAIL NAME: numbers`.
#
# An axle of static load W takes W a / g of a steady bend with the lateral acceleration a; its two tires, of stiffness C
# together, run there at a slip angle of (W / C) a / g. The front axle's less the rear axle's is the understeer, in rad
# a g. Loads are those of `gicrun --equilibrium`; stiffnesses are differences of the force as tests/data/tires/pac2002.py has
# it, which shares nothing with the generator.
import csv
import math
import os
import re
import subprocess
import sys

gicrun, models, work = sys.argv[1:]
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'tires'))
import pac2002  # noqa: E402

GRAVITY, WHEELBASE, RACK_PER_ANGLE, CHASSIS_MASS, OUTPUT_STEP = 9.81, 3.302, -0.142, 2086.52, 0.06

# on locked brakes, with nothing in gear
REST = '''gicscene: 1
duration: 1
step: 0.006
initial: {position: [0, 0, 0.4825], gear: 0}
inputs: {brake: 1}
'''
# two bends to the left, of some 0.25 and 0.5 m/s^2, each long enough to be steady at its end
BENDS = '''gicscene: 1
duration: 36
step: 0.006
ratio: 6
output_step: %g
initial:
  equilibrium: true
  position: [0, 0, 0.4825]
  speed: 10
  gear: 3
  states: {engine.speed: 140}
driver: {period: 0.024, speed: {target: 10}}
inputs:
  rack: {knots: {times: [1, 2, 18, 19], values: [0, -0.0012, -0.0012, -0.0024]}}
''' % OUTPUT_STEP
# scales of what a tire does beside a side force by its slip: forces without slip (ply steer) and by camber, moments
# about the road's normal, side force by longitudinal slip
BESIDE = ('LHY', 'LVY', 'LKG', 'LTR', 'LRES', 'LS', 'LVYKA')


def check(name, good, *numbers):
    print(('ok ' if good else 'FAIL ') + name + ':', *('%.6g' % x for x in numbers))


def near(name, value, expected, tolerance):
    check(name, abs(value - expected) <= tolerance, value, expected, tolerance)


def read(*path):
    with open(os.path.join(models, *path), encoding='ascii') as file:
        return file.read()


def write(name, text):
    path = os.path.join(work, name)
    with open(path, 'w', encoding='ascii') as file:
        file.write(text)
    return path


def replaced(pattern, new, text):
    text, count = re.subn(pattern, new, text, flags=re.M)
    if count != 1:
        sys.exit('%s: %d times' % (pattern, count))
    return text


def call(*arguments):
    done = subprocess.run([gicrun, '--engine', 'tape', *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return done.stdout


def tire_file(name, changes):
    """The HMMWV's tire with other numbers."""
    text = read('tires', 'hmmwv_pac2002.tir')
    for key, value in changes.items():
        text = replaced('^%s *=.*' % key, '%s = %r' % (key, value), text)
    return write(name + '.tir', text)


def vehicle(name, shift):
    """The HMMWV on name.tir, its chassis' centre of mass moved forwards by shift."""
    line = re.search(r'^  chassis: \{mass.*', read('parts', 'chassis.veh'), re.M).group()
    x = float(re.search(r'com: \[([^,]*),', line).group(1))
    text = 'gicgen: 1\nmodel: %s\ninclude: %s\ntires: {it: {file: %s.tir}}\nbodies:\n%s\nwheels:\n' % (
        name, os.path.relpath(os.path.join(models, 'hmmwv_vehicle.veh'), work), name,
        replaced(r'com: \[[^,]*,', 'com: [%r,' % (x + shift), line))
    for axle in 'fr':
        text += ('  tire_%s_l: {body: wheel_%s_l, center: centre_%s_l, tire: it, spin_inertia: 7.78782, '
                 'brake: 4000 * brake}\n' % ((axle,) * 3))
    return write(name + '.veh', text)


def loads_at_rest(model):
    """Of one wheel of each axle, N."""
    said = call('--equilibrium', model, write('rest.scene', REST))
    return [float(re.search(r'^tire_%s_l +(\S+) N ' % axle, said, re.M).group(1)) for axle in 'fr']


def stiffness(tire, load):
    """Of both tires of an axle, N/rad. The right tire is the mirror image of the left one, so that their mean slope is
    that of one of them to either side of zero."""
    step = 1e-4
    right, left = (pac2002.forces(tire, load, 0, alpha, 0, 1, 10, 22)[1] for alpha in (-step, step))
    return (right - left) / step


def bends(model):
    """What grows with the lateral acceleration, rad a g: mean slip angles of front and rear axle, and the steering
    angle beyond that of a vehicle that rolls."""
    path = os.path.join(work, 'bends.csv')
    call('-q', model, write('bends.scene', BENDS), '-o', path)
    with open(path, encoding='ascii') as file:
        rows = list(csv.reader(file))
    names = [name.split(' [')[0] for name in rows[0]]
    points = []
    for time in (18, 36):
        d, before = (dict(zip(names, map(float, rows[1 + round(t / OUTPUT_STEP)]))) for t in (time, time - 1.2))
        turn = d['chassis_angular_velocity.z']
        check('steady', turn > 0 and abs(turn - before['chassis_angular_velocity.z']) < 0.002 * turn, turn)
        speed = math.hypot(d['chassis_velocity.x'], d['chassis_velocity.y'])
        # axes of ISO 8855: side force to the left by slip angles below zero
        slips = [-(d['slip_%s_l.alpha' % axle] + d['slip_%s_r.alpha' % axle]) / 2 for axle in 'fr']
        points.append((speed * turn, *slips, d['rack.value'] / RACK_PER_ANGLE - WHEELBASE * turn / speed))
    low, high = points
    return [(b - a) / (high[0] - low[0]) * GRAVITY for a, b in zip(low[1:], high[1:])]


def understeer(name, shift, share):
    """Measured and predicted for name.tir; each axle's slip within that share of what is predicted."""
    model, tire = vehicle(name, shift), pac2002.Tire(os.path.join(work, name + '.tir'))
    loads = loads_at_rest(model)
    slips = [2 * load / stiffness(tire, load) for load in loads]
    front, rear, steering = bends(model)
    name = '%s, mass %+g m: ' % (name, shift)
    near(name + 'slip of the front axle', front, slips[0], share * slips[0])
    near(name + 'slip of the rear axle', rear, slips[1], share * slips[1])
    near(name + 'understeer', front - rear, slips[0] - slips[1], share * max(slips))
    # a driver notices that, but for what wheels steer by roll and by bump: 0.002 here
    near(name + 'steering', steering, front - rear, 0.004)
    return front - rear, slips[0] - slips[1], loads


def main():
    data = pac2002.Tire(os.path.join(models, 'tires', 'hmmwv_pac2002.tir'))
    # The data's tire is about as stiff as it is loaded: any axle slips alike. This one has its greatest stiffness at
    # 6050 N, the data's there, so that it changes little with the load and an axle slips as it is loaded.
    at = 6050 / (data.FNOMIN * data.LFZO)
    levelled = {'PKY1': data.PKY1 * math.sin(2 * math.atan(at / data.PKY2)), 'PKY2': at}
    alone = {**dict.fromkeys(BESIDE, 0.0), 'QSY1': 0.0}  # no rolling resistance either
    # With nothing but side forces by slip, 1 % covers curvature of the tire, shift of load sideways and drive. What
    # tires do beside that, and rolling resistance, which grows on the outer side, bring some 4 % of an axle's slip.
    for kind, beside, share in (('slip_alone', alone, 0.01), ('all', {}, 0.05)):
        tire_file('data_' + kind, beside)
        understeer('data_' + kind, 0, share)
        tire_file('levelled_' + kind, {**levelled, **beside})
        back, even, front = (understeer('levelled_' + kind, shift, share) for shift in (-0.5, 0, 0.5))
        check(kind + ': signs', back[0] < -0.05 and front[0] > 0.05 and even[0] > 0, back[0], even[0], front[0])
        for name, moved, shift in (('back', back, -0.5), ('forwards', front, 0.5)):
            change = moved[1] - even[1]
            # two differences of slips of two axles, each as above
            near('%s: change by mass moved %s' % (kind, name), moved[0] - even[0], change, 0.05 * abs(change))
            # statics; pitch moves the mass on by less than 3 %
            load = CHASSIS_MASS * GRAVITY * shift / WHEELBASE / 2
            near('%s: load by mass moved %s' % (kind, name), moved[2][0] - even[2][0], load, 0.03 * abs(load))


main()
