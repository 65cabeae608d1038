#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# benchmark_bicycle.py GICGEN GICRUN MODELS WORK: eigenvalues of the benchmark bicycle (../data/bicycle/benchmark.veh)
# as published, with 14 decimals, at 1 to 10 m/s: weave, capsize and castering. Prints `good NAME` or `bad NAME: why`
# for each check.
#
# The published bicycle rolls on knife edges without slip, a constraint on velocities, which no model can state. It is
# the limit of tires whose lateral stiffness C by slip angle grows: slip is Fy / C, so that what it changes is a series
# in 1 / C. From three stiffnesses that series gives the limit. To first order lateral motion knows nothing of vertical
# and longitudinal stiffness: tires are made to stand as high, and to roll as far, as the rigid wheels.
import os
import shutil
import subprocess
import sys

import numpy as np

from vehicle import GRAVITY, check

# table 2: real and imaginary part of weave (0: two real eigenvalues), capsize, castering
PUBLISHED = {
    1: (3.52696170990070 + 0.80774027519930j, -3.13423125066578, -7.11008014637442),
    2: (2.68234517512745 + 1.68066296590675j, -3.07158645641514, -8.67387984831735),
    3: (1.70675605663975 + 2.31582447384325j, -2.63366137253667, -10.35101467245920),
    4: (0.41325331521125 + 3.07910818603206j, -1.42944427361326, -12.15861426576447),
    5: (-0.77534188219585 + 4.46486771378823j, -0.32286642900409, -14.07838969279822),
    6: (-1.52644486584142 + 5.87673060598709j, -0.00406690076970, -16.08537123098026),
    7: (-2.13875644258362 + 7.19525913329805j, 0.10268170574766, -18.15788466125262),
    8: (-2.69348683581097 + 8.46037971396931j, 0.14327879765713, -20.27940894394569),
    9: (-3.21675402252485 + 9.69377351531791j, 0.15790184030917, -22.43788559040858),
    10: (-3.72016840437287 + 10.90681139476287j, 0.16105338653172, -24.62459635017404),
}
VERTICAL = 1e6
STIFFNESS = 2.5e7, 5e7, 1e8
FRONT = (85 * 0.3 + 4 * 0.9 + 3 * 1.02) / 1.02 * GRAVITY
LOAD = {'rear': 94 * GRAVITY - FRONT, 'front': FRONT}
RADIUS = {'rear': 0.3, 'front': 0.35}
TIRE = '''[UNITS]
LENGTH = 'meter'
FORCE = 'newton'
ANGLE = 'radian'
MASS = 'kg'
TIME = 'second'
[MODEL]
PROPERTY_FILE_FORMAT = 'PAC2002'
USE_MODE = 4
TYRESIDE = 'SYMMETRIC'
[DIMENSION]
UNLOADED_RADIUS = %r
[VERTICAL]
VERTICAL_STIFFNESS = %r
VERTICAL_DAMPING = 500
FNOMIN = %r
FREFF = 1
[LONGITUDINAL_COEFFICIENTS]
PCX1 = 1
PDX1 = 1e6
PKX1 = 1000
[LATERAL_COEFFICIENTS]
PCY1 = 1
PDY1 = 1e6
PKY1 = %r
PKY2 = 1
'''


def eigenvalues(gicrun, work, stiffness, speed):
    for name, load in LOAD.items():
        with open(os.path.join(work, name + '.tir'), 'w') as file:
            file.write(TIRE % (RADIUS[name] + load / VERTICAL, VERTICAL, load, -stiffness / load))
    scene, out = os.path.join(work, 'bicycle.scene'), os.path.join(work, 'bicycle.npz')
    with open(scene, 'w') as file:
        file.write('gicscene: 1\nduration: 1\nstep: 0.001\ninitial: {speed: %d}\n' % speed)
    model = os.path.join(work, 'benchmark.veh')
    done = subprocess.run([gicrun, '--linearize', '--at', '0', '-q', model, scene, '-o', out], capture_output=True,
                          text=True)
    if done.returncode:
        sys.exit(done.stderr)
    found = np.linalg.eigvals(np.load(out)['A'])
    return np.array([found[np.argmin(abs(found - x))] for x in PUBLISHED[speed]])


gicrun, work = sys.argv[2], sys.argv[4]
here = os.path.dirname(os.path.abspath(__file__))
shutil.copy(os.path.join(here, '..', 'data', 'bicycle', 'benchmark.veh'), work)
for speed, published in PUBLISHED.items():
    one, two, four = (eigenvalues(gicrun, work, C, speed) for C in STIFFNESS)
    limit = (8 * four - 6 * two + one) / 3
    for k, name in enumerate(('weave', 'capsize', 'castering')):
        # rounding in the eigenvalues of a matrix with entries up to C / 2 kg
        what = '%s at %d m/s' % (name, speed)
        check(what + ', to ten decimals', abs(limit[k] - published[k]) < 5e-11,
              '%.14g instead of %.14g' % (limit[k].real, np.real(published[k])))
        change = abs(four[k] - two[k]) / abs(two[k] - one[k])
        check(what + ' differs by half as much at twice the stiffness', 0.49 < change < 0.51, change)
