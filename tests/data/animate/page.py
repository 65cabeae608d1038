#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# page.py CHECK ...: checks of the page of `gicrun --animate` for tests/system/test_animate.sh; prints why one failed. It reads
# the page's numbers by itself and knows the HMMWV's road from models/scenes/paper_run.scene.
import csv
import json
import math
import re
import sys

import yaml


def read_run(path):
    text = open(path, encoding='utf-8').read()
    run = json.loads(re.search(r'<script id="data"[^>]*>(.*?)</script>', text, re.S).group(1))
    run['channel'] = []
    for c in run['channels']:
        values, step = c['values'][:1], 0
        for change in c['values'][1:]:
            step += change
            values.append(values[-1] + step)
        values += values[-1:] * (run['frames'] - len(values))
        run['channel'].append([v * c['unit'] for v in values])
    return run


def read_csv(path):
    rows = list(csv.reader(open(path)))
    names = [name.split(' [')[0] for name in rows[0]]
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(names)}


def point(run, body, s, i):
    """World coordinates of a body's point at frame i."""
    q = [run['channel'][run['bodies'][body]['motion'] + k][i] for k in range(7)]
    e0, e = q[3], q[4:]
    es = sum(a * b for a, b in zip(e, s))
    turn = [e[1] * s[2] - e[2] * s[1], e[2] * s[0] - e[0] * s[2], e[0] * s[1] - e[1] * s[0]]
    return [q[k] + (2 * e0 * e0 - 1) * s[k] + 2 * e[k] * es + 2 * e0 * turn[k] for k in range(3)]


def close(what, a, b, tolerance):
    if not abs(a - b) <= tolerance:
        sys.exit('%s: %.9g instead of %.9g' % (what, a, b))


def check_motion(page, results):
    """Poses, wheel centres, forces and curves against the results, rounding alone apart: half of 1e-4 m, 1e-5 of an
    Euler parameter (twice that in rad) at arms below 2.5 m, half a unit of a force or a curve."""
    run, rows = read_run(page), read_csv(results)
    every = round(run['frame_step'] / (rows['time'][1] - rows['time'][0]))
    if run['frames'] != (len(rows['time']) - 1) // every + 1:
        sys.exit('%d frames' % run['frames'])
    names = [body['name'] for body in run['bodies']]
    run['curves'] = [curve for curve in run['curves'] if curve['name'] in rows]  # not inputs
    if not {name for name in rows if name != 'time'} <= {curve['name'] for curve in run['curves']}:
        sys.exit('not all results can be shown as curves')
    for curve in run['curves']:
        if curve['plotted'] and run['channels'][curve['values']]['unit'] > 1.1e-4 * (max(map(abs, rows[curve['name']])) or 1e9):
            sys.exit('the curve of %s has few digits' % curve['name'])
    for i in range(0, run['frames'], 7):
        for k, axis in enumerate('xyz'):
            close('chassis.' + axis, run['channel'][run['bodies'][0]['motion'] + k][i],
                  rows['chassis.' + axis][i * every], 0.51e-4)
        for wheel in run['wheels']:
            place = wheel['name'].replace('tire', 'wheel')
            centre = point(run, names.index(place), wheel['center'], i)
            for k, axis in enumerate('xyz'):
                close(place, centre[k], rows[place + '.' + axis][i * every], 2e-4)
            force = [run['channel'][c][i] for c in wheel['force']]
            contact = [run['channel'][c][i] for c in wheel['contact']]
            close('fz of ' + wheel['name'], force[2], rows[wheel['name'] + '.fz'][i * every],
                  0.51 * run['channels'][wheel['force'][2]]['unit'])
            close('contact of ' + wheel['name'], contact[2], rows[wheel['name'] + '.height'][i * every], 0.51e-4)
            # it rolls without slip: way of the centre over the radius; bumps and steering are second order
            way = rows[place + '.x'][i * every] - rows[place + '.x'][0]
            close('angle of ' + wheel['name'], run['channel'][wheel['angle']][i], way / wheel['radius'],
                  2e-3 + 5e-3 * way / wheel['radius'])
        for curve in run['curves']:
            close(curve['name'], run['channel'][curve['values']][i], rows[curve['name']][i * every],
                  0.51 * run['channels'][curve['values']]['unit'])


def axes(run, body, i):
    """Columns of a body's A at frame i."""
    o = point(run, body, (0, 0, 0), i)
    return [[a - b for a, b in zip(point(run, body, e, i), o)] for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return [x / math.sqrt(dot(a, a)) for x in a]


def check_tires(page, results, slope_x, slope_y, width):
    """Wheels with tires on a plane, a frame a row: they turn by their spin less what their carriers turn (trapezoids
    both, and poses rounded to 1e-5: 5e-3 rad in all), and arrows are the forces of outputs along the axes of the
    contact (axes to 2e-5 of at most 30 kN)."""
    run, rows = read_run(page), read_csv(results)
    if run['frames'] != len(rows['time']):
        sys.exit('%d frames' % run['frames'])
    normal = unit((-slope_x, -slope_y, 1))
    for wheel in run['wheels']:
        name = wheel['name'].replace('tire_', '')
        close('width', wheel['width'], width, 1e-6)
        angle = 0
        for i in range(run['frames']):
            A = axes(run, wheel['body'], i)
            s = [dot(wheel['axis'], row) for row in zip(*A)]
            if i:
                step = rows['time'][i] - rows['time'][i - 1]
                spin = rows['slip_%s.spin' % name]
                # half of the antisymmetric part of what turns the axes of the frame before into these
                turned = [x / 2 for x in map(sum, zip(*(cross(a, b) for a, b in zip(before, A))))]
                angle += step * (spin[i] + spin[i - 1]) / 2 - dot(turned, s)
            before = A
            close('angle of ' + name, run['channel'][wheel['angle']][i], angle, 5e-3)
            e_x = unit(cross(s, normal))
            e_y = cross(normal, e_x)
            told = [rows[key % name][i] for key in ('slip_%s.fx', 'slip_%s.fy', 'tire_%s.fz')]
            for k, axis in enumerate('xyz'):
                c = wheel['force'][k]
                close('force of ' + name, run['channel'][c][i], dot(told, (e_x[k], e_y[k], normal[k])),
                      0.51 * run['channels'][c]['unit'] + 0.6)
                close('contact of ' + name, run['channel'][wheel['contact'][k]][i],
                      rows['contact_%s.%s' % (name, axis)][i], 0.51e-4)
        if not angle > 20:
            sys.exit('%s has turned by %g only' % (name, angle))


def check_road(page, scene):
    """Heights at all corners of tiles against the bumps' formula; half of 1e-4 m, where a tile is plain 1e-4 more."""
    road = read_run(page)['road']
    bumps = yaml.safe_load(open(scene))['road']['bumps']

    def height(x, y):
        h = 0
        for b in bumps:
            on = {'left': y > 0, 'right': y <= 0, 'both': True}[b['tracks']]
            if on and 0 < x - b['x'] < b['length']:
                h += b['height'] * (1 - math.cos(2 * math.pi * (x - b['x']) / b['length'])) / 2
        return h

    covered = set()
    for i, j, *step in road['tiles']:
        covered.add((i, j))
        n = 2 if len(step) == 4 else road['cells'] + 1
        z = []
        for k in range(n * n):
            z.append(step[k] + (z[k - 1] if k % n else z[k - n] if k else 0))
        for k, v in enumerate(z):
            x, y = (i + k % n / (n - 1)) * road['tile'], (j + k // n / (n - 1)) * road['tile']
            close('road at %g, %g' % (x, y), v * road['unit'], height(x, y), 0.51e-4)
        if n == 2:
            for k in range(81):
                x, y = (i + k % 9 / 8) * road['tile'], (j + k // 9 / 8) * road['tile']
                close('plain road at %g, %g' % (x, y), z[0] * road['unit'], height(x, y), 2e-4)
    for x in range(-4, 26):
        if (math.floor(x / road['tile']), 0) not in covered:
            sys.exit('no road at x = %g' % x)


def check_friction(page, scene):
    """Friction at all corners of tiles against the formula of SCENE.md section 3.4, half of a hundredth."""
    road, said = read_run(page)['road'], yaml.safe_load(open(scene))['road']['friction']
    told = {(i, j): f for i, j, *f in road['friction']}

    def smooth(s):
        s = min(max(s, 0), 1)
        return s * s * (3 - 2 * s)

    def friction(x, y):
        mu = said['value']
        for p in said['patches']:
            share = 1
            for at, (low, high) in ((x, p['x']), (y, p['y'])):
                share *= smooth((at - low) / p['fade'] + .5) * smooth((high - at) / p['fade'] + .5)
            mu += share * (p['value'] - mu)
        return mu

    patched = 0
    for i, j, *_ in road['tiles']:
        f, n = told.get((i, j), [100]), road['cells'] + 1
        patched += len(f) > 1
        for k in range(n * n):
            x, y = (i + k % n / (n - 1)) * road['tile'], (j + k // n / (n - 1)) * road['tile']
            close('friction at %g, %g' % (x, y), (f[k] if len(f) > 1 else f[0]) / 100, friction(x, y), 0.0051)
    if not 0 < patched < len(road['tiles']) / 2:
        sys.exit('%d of %d tiles are patched' % (patched, len(road['tiles'])))


def check_same(page, other, units):
    """Two pages with the same motion, to some units of each channel."""
    a, b = read_run(page), read_run(other)
    if a['frames'] != b['frames'] or len(a['channel']) != len(b['channel']):
        sys.exit('%d frames, %d frames' % (a['frames'], b['frames']))
    others = {curve['values'] for curve in a['curves'] if not curve['plotted']}  # with as many digits as they have
    for k, (x, y) in enumerate(zip(a['channel'], b['channel'])):
        if k in others:
            continue
        for v, w in zip(x, y):
            close('channel %d' % k, v, w, (units + 0.1) * a['channels'][k]['unit'])


def check_forces(page, results):
    """Arrows of wheels that no output is about, without slopes, against a model that has such outputs: half a unit."""
    run, rows = read_run(page), read_csv(results)
    for wheel in run['wheels']:
        for i in range(run['frames']):
            close('force of ' + wheel['name'], run['channel'][wheel['force'][2]][i], rows['load_%s.fz' % wheel['name']][i],
                  0.51 * run['channels'][wheel['force'][2]]['unit'])
        if not max(run['channel'][wheel['force'][2]]) > 100:
            sys.exit('no force at ' + wheel['name'])


def check_course(page):
    """Cones and edges of the double lane change of ISO 3888-2 for a width of 2.2 m, by its formulas."""
    course, w = read_run(page)['course'], 2.2
    lanes = [(0, 12, -(1.1 * w + .25) / 2, (1.1 * w + .25) / 2)]
    low = lanes[0][3] + 1  # the second lane begins 1 m beside the first
    lanes.append((25.5, 36.5, low, low + w + 1))
    lanes.append((49, 61, lanes[0][2], lanes[0][2] + 1.3 * w + .25))
    expected = [(x0 + (x1 - x0) * i / 4, y) for x0, x1, *ys in lanes for y in ys for i in range(5)]
    if len(course['cones']) != len(expected):
        sys.exit('%d cones' % len(course['cones']))
    for x, y in expected:
        close('cone at %g, %g' % (x, y), min(math.dist((x, y), cone) for cone in course['cones']), 0, 1e-9)
    edges = [e['points'] for e in course['edges']]
    for x0, x1, *ys in lanes:
        for y in ys:
            close('edge at %g' % y, min(math.dist((x0, y), a) + math.dist((x1, y), b) for a, b in edges), 0, 1e-9)
    path = course['path']
    close('first point of the path', math.dist(path[0], (-40, 0)), 0, 1e-9)
    close('last point of the path', math.dist(path[-1], (95, 0.25)), 0, 1e-9)
    close('the path through the second lane', min(math.dist(p, (34, 3.7)) for p in path), 0, 0.2)


def check_bend(page):
    """A lane of 4 m along x that turns left: its edges are parallel to both ways and meet at the bend."""
    edges = [e['points'] for e in read_run(page)['course']['edges']]
    for way in ([(0, 2), (8, 2), (8, 10)], [(0, -2), (12, -2), (12, 10)]):
        close('edge by %g, %g' % way[1], min(max(map(math.dist, way, e)) for e in edges if len(e) == 3), 0, 1e-9)


def check_looks(page):
    """Shapes of tests/data/animate/shapes.veh, whose inertia is that of the solids that its comments name."""
    run = read_run(page)
    body = {b['name']: b for b in run['bodies']}

    def near(name, key, expected):
        for a, b in zip(body[name][key], expected):
            close('%s of %s' % (key, name), a, b, 1e-4)
    for name, look in (('car', 'frame'), ('trailer', 'glass'), ('drum', 'cylinder'), ('crate', 'box'), ('post', 'cylinder'),
                       ('chest', 'box'), ('wing_l', 'mesh'), ('wing_r', 'mesh'), ('arm', 'hull')):
        if body[name]['look'] != look:
            sys.exit('%s is drawn as %s' % (name, body[name]['look']))
    near('trailer', 'size', (4, 2, 1.2))
    near('trailer', 'middle', (0, 0, 0.1))
    near('drum', 'size', (0.3, 1.2))
    near('drum', 'axis', (0, 1, 0))
    near('crate', 'size', (1, 0.6, 0.4))
    near('post', 'size', (0.1, 2))
    near('post', 'axis', (0, 0, 1))
    near('post', 'middle', (0, 0, 1))
    near('chest', 'size', (0.5, 0.4, 0.3))
    corner = [[body['wing_%s' % side]['corners'][k:k + 3] for k in range(0, 12, 3)] for side in 'lr']
    for left, right in zip(*corner):
        near('wing_r', 'com', body['wing_r']['com'])
        close('corner of the other side', math.dist(left, (right[0], -right[1], right[2])), 0, 1e-9)
    close('corner in m', math.dist(corner[0][2], (0.2, 0.4, 0)), 0, 1e-9)
    for side, sign in zip((0, 1), (1, 1)):
        name = 'wing_' + 'lr'[side]
        a, b, c = [corner[side][k] for k in body[name]['triangles'][:3]]
        normal = cross([q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)])
        if not sign * normal[2] > 0:
            sys.exit('%s is inside out' % name)
    if body['wing_l']['triangles'] != [0, 1, 2, 0, 2, 3]:
        sys.exit('triangles %s' % body['wing_l']['triangles'])


def check_lines(page, *expected):
    """Lines as NAME:KIND:BODY:X,Y,Z:BODY:X,Y,Z, in frames of the bodies."""
    run = read_run(page)
    line = {a['name']: a for a in run['lines']}
    if len(run['lines']) != len(expected):
        sys.exit('%d lines' % len(run['lines']))
    for name, kind, *ends in (words.split(':') for words in expected):
        if line[name]['kind'] != kind:
            sys.exit('%s is drawn as a %s' % (name, line[name]['kind']))
        for body, at, end, place in zip(ends[::2], ends[1::2], 'ab', 'pq'):
            if run['bodies'][line[name][end]]['name'] != body:
                sys.exit('%s is not at %s' % (name, body))
            close('end of ' + name, math.dist(line[name][place], map(float, at.split(','))), 0, 1e-9)


def check_other(page, other):
    """Curves of another run: straight between its rows, up to its end."""
    run, rows = read_run(page), read_csv(other)
    beside = [curve for curve in run['curves'] if 'beside' in curve]
    if not beside:
        sys.exit('there is no curve of another run')
    for curve in beside:
        name = run['curves'][curve['beside']]['name']
        if curve['name'] != '%s (%s)' % (name, other.split('/')[-1]):
            sys.exit('a curve is called ' + curve['name'])
        close('the end of ' + name, curve['until'], rows['time'][-1], 1e-9)
        for i in range(run['frames']):
            time = min(i * run['frame_step'], rows['time'][-1])
            k = max([0] + [k for k, t in enumerate(rows['time'][:-1]) if t <= time + 1e-12])
            share = (time - rows['time'][k]) / (rows['time'][k + 1] - rows['time'][k])
            close(curve['name'], run['channel'][curve['values']][i],
                  rows[name][k] + share * (rows[name][k + 1] - rows[name][k]),
                  0.51 * run['channels'][curve['values']]['unit'])


def check_ghost(page, other):
    """The second vehicle: wheels where the other results put them, by outputs that the page does not read; rounding of
    poses as in check_motion. Its wheels roll. After the end of the results it stays."""
    run, rows = read_run(page), read_csv(other)
    ghost, names = run['ghost'], [body['name'] for body in run['bodies']]
    if ghost['name'] != other.split('/')[-1] or ghost['untold']:
        sys.exit('%s, without %s' % (ghost['name'], ghost['untold']))
    close('the end', ghost['until'], rows['time'][-1], 1e-9)
    own = run['channel']
    run['channel'] = own[ghost['motion']:]  # poses of the second vehicle in place of those of the first
    apart, at = 0, {round(time, 9): k for k, time in enumerate(rows['time'])}
    for i in range(run['frames']):
        k = at.get(round(min(i * run['frame_step'], rows['time'][-1]), 9))
        if k is None:
            continue
        for w, wheel in enumerate(run['wheels']):
            place = wheel['name'].replace('tire', 'wheel')
            centre = point(run, names.index(place), wheel['center'], i)
            for c, axis in enumerate('xyz'):
                close('%s of the second vehicle at frame %d' % (place, i), centre[c], rows['%s.%s' % (place, axis)][k], 2e-4)
            way = rows[place + '.x'][k] - rows[place + '.x'][0]
            close('angle of ' + place, own[ghost['angle'] + w][i], way / wheel['radius'], 2e-3 + 2e-2 * way / wheel['radius'])
        apart = max(apart, abs(own[0][i] - run['channel'][0][i]))
    if not apart > 0.5:
        sys.exit('both vehicles are the same')


def check_units(script, results, *named):
    """Columns of gnuplot's data, of both runs, are those of the results times a factor: NAME FACTOR ..., to 9 digits."""
    rows, text = read_csv(results), open(script).read()
    names = re.findall(r"\$data using 1:(\d+) with lines [^\n]*? title '([^']*)'", re.sub(r', \$', '\n$', text))
    column = {name: int(k) - 1 for k, name in names}
    for block in '$data', '$other':
        table = re.search(re.escape(block) + r' << END\n(.*?)END', text, re.S).group(1).split('\n')[:-1]
        for name, factor in zip(named[::2], map(float, named[1::2])):
            for line, value in zip(table, rows[name]):
                close(name, float(line.split()[column[name]]), factor * value, 1e-8 * (1 + abs(factor * value)))
        if len(table) < 100:
            sys.exit('%d rows' % len(table))


def main():
    check, *words = sys.argv[1:]
    if check == 'motion':
        check_motion(*words)
    elif check == 'other':
        check_other(*words)
    elif check == 'ghost':
        check_ghost(*words)
    elif check == 'units':
        check_units(*words)
    elif check == 'tires':
        check_tires(words[0], words[1], *map(float, words[2:]))
    elif check == 'friction':
        check_friction(*words)
    elif check == 'forces':
        check_forces(*words)
    elif check == 'course':
        check_course(*words)
    elif check == 'lines':
        check_lines(*words)
    elif check == 'bend':
        check_bend(*words)
    elif check == 'looks':
        check_looks(*words)
    elif check == 'road':
        check_road(*words)
    elif check == 'same':
        check_same(words[0], words[1], float(words[2]))


if __name__ == '__main__':
    main()
