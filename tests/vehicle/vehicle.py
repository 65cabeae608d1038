# SPDX-License-Identifier: MIT
# vehicle.py: what checks of a vehicle by hand need: its data as dumped, reports of gicrun, runs of its scenes; vectors.
import csv
import json
import math
import os
import re
import subprocess
import sys

GRAVITY = 9.81


def check(name, good, why=''):
    print('good ' + name if good else 'bad %s: %s' % (name, why))


def near(name, a, b, tolerance):
    """a within tolerance of b; an arm that is infinite (parallel lines) is infinite in both."""
    check(name, a == b if math.isinf(b) else abs(a - b) <= tolerance, '%.6g instead of %.6g, %.2g allowed' % (a, b, tolerance))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def scaled(a, s):
    return [x * s for x in a]


def norm(a):
    return math.sqrt(dot(a, a))


class Vehicle:
    def __init__(self, gicgen, gicrun, models, work, name):
        self.gicrun, self.models, self.work = gicrun, models, work
        self.model = os.path.join(models, name + '.veh')
        dumped = json.loads(self.said([gicgen, '--dump-model', self.model]))
        self.dump = dumped
        self.bodies = {b['name']: dict(b, com=self.world(b, b['com'])) for b in dumped['bodies']}
        self.radius = dumped['tires'][0]['radius']
        self.points = self.read_points()
        self.sheet = self.pairs(['--sheet', '-q', self.model, '-o', self.path('sheet.csv')], 'sheet.csv')
        self.kc = self.read_kc()

    def path(self, name):
        return os.path.join(self.work, name)

    def said(self, command):
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            sys.exit(done.stderr)
        return done.stdout

    def world(self, body, point):
        """A point of the body's frame in the drawing."""
        e0, e = body['euler'][0], body['euler'][1:]
        t = cross(e, point)
        return [r + p + 2 * (e0 * a + b) for r, p, a, b in zip(body['position'], point, t, cross(e, t))]

    def read_points(self):
        """Hard points as the model's file has them, left side."""
        text = open(self.model).read()
        found = re.findall(r'^  (\w+): *\[([^\]]*)\]', text[text.index('\npoints:'):], re.M)
        return {name: [float(x) for x in numbers.split(',')] for name, numbers in found if re.match(r'^[-\d., e]*$', numbers)}

    def pairs(self, options, name):
        self.said([self.gicrun, *options])
        rows = list(csv.reader(open(self.path(name))))
        return {row[0]: float(row[1]) for row in rows[1:] if row[1]}

    def table(self, name):
        rows = list(csv.reader(open(self.path(name))))
        names = [n.split(' [')[0] for n in rows[0]]
        return [dict(zip(names, row)) for row in rows[1:]]

    def read_kc(self):
        """The row of no travel of each axle."""
        self.said([self.gicrun, '--kc', '-q', self.model, '-o', self.path('kc.csv')])
        found = {}
        for row in self.table('kc.csv'):
            if row['motion'] == 'parallel' and abs(float(row['travel'])) < 1e-12:
                found[row['axle']] = {k: float(v) for k, v in row.items() if k not in ('axle', 'motion') and v}
        for row in self.table('kc.csv'):
            if row['motion'] == 'steer' and row['steering_ratio'] and abs(float(row['mean_steer'])) < 1e-9:
                found[row['axle']]['steering_ratio'] = float(row['steering_ratio'])
        return found

    def modes(self):
        self.said([self.gicrun, '--modes', '-q', self.model, '-o', self.path('modes.csv')])
        return [{k: float(v or 0) for k, v in row.items()} for row in self.table('modes.csv')]

    def joint(self, name):
        return next(j for j in self.dump['joints'] if j['name'] == name)

    def force(self, name):
        return next(f for f in self.dump['forces'] if f['name'] == name)

    def axis(self, joint):
        """u_a of a joint in the drawing; bodies of which it is asked stand there unturned."""
        body = self.dump['bodies'][joint['a']]
        return self.world(dict(body, position=[0, 0, 0]), joint['axis_a'])

    def solve(self, rows, right):
        """Three linear equations, by Cramer's rule."""
        det = lambda m: dot(m[0], cross(m[1], m[2]))
        whole = det(rows)
        return [det([[right[i] if k == j else rows[i][j] for j in range(3)] for i in range(3)]) / whole for k in range(3)]

    def run(self, scene, edits=(), options=()):
        """Results by names of columns, of a scene edited by pairs (pattern, replacement)."""
        text = open(os.path.join(self.models, 'scenes', scene + '.scene')).read()
        for pattern, replacement in edits:
            text, count = re.subn(pattern, replacement, text, flags=re.M)
            if count != 1:
                sys.exit('%s in %s: %d times' % (pattern, scene, count))
        open(self.path('edited.scene'), 'w').write(text)
        done = subprocess.run([self.gicrun, '-q', *options, self.model, self.path('edited.scene'), '-o', self.path('run.csv')],
                              capture_output=True, text=True)
        check('%s %s ends well, without a word' % (scene, ' '.join(options)), done.returncode == 0 and not done.stderr, done.stderr)
        rows = list(csv.reader(open(self.path('run.csv'))))
        return {name.split(' [')[0]: [float(row[k]) for row in rows[1:]] for k, name in enumerate(rows[0])}


def energy_orders(vehicle, scene, step, ratio, until, edits=()):
    """The energy's change against the integral of the power over all steps, by a quadrature of order 4: what is left
    is the integrator's, of an order of 2.7 at least, in two rates and in one; in one alone with a ratio of 1, which scenes
    do not name."""
    def gap(h, n):
        d = vehicle.run(scene, [*edits, ('^step: .*', 'step: %.10g' % h), ('^duration: .*', 'duration: %g' % until),
                                ('^output_step: .*', 'output_step: %.10g' % h), ('^plot:', 'outputs: [energy]\nplot:')]
                        + [('^ratio: .*', 'ratio: %d' % n)] * (ratio > 1))
        energy = [a + b for a, b in zip(d['energy.kinetic'], d['energy.potential'])]
        p, done, worst = d['energy.power'], 0, 0
        for i in range(1, len(p) - 2):
            done += h * (13 * (p[i] + p[i + 1]) - p[i - 1] - p[i + 2]) / 24
            worst = max(worst, abs(energy[i + 1] - energy[1] - done))
        return worst, max(energy) - min(energy) + max(energy) * 0.01
    for name, h, n in [('two rates', step, ratio)] * (ratio > 1) + [('one rate', step / ratio, 1)]:
        coarse, fine = gap(h, n), gap(h / 2, n)
        check('energy balance of order 3, %s' % name, fine[0] < max(coarse[0] / 6.5, 1e-9 * coarse[1]), (coarse, fine))
        check('energy balance, %s' % name, fine[0] < 1e-4 * coarse[1], fine)
