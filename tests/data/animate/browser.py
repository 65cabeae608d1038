#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# browser.py PROFILE RUN.html RUN.csv SPIN.html SPIN.csv ODD.html LANES.html BESIDE.html TWO.html TURNING.html TURNING.csv UNITS.html UNITS.csv: opens pages of `gicrun --animate` in chromium, uses
# them by mouse and keys, and looks at pictures of them. Prints `good NAME` or `bad NAME: why` for each check.
import json
import math
import os
import sys
import time

from chromium import TALL, WIDTH, Browser, note, read_png
from manners import dark, keyboard, telephone
from page import read_csv


def tires(rows):
    """Columns of the pixels as dark as rubber, in the part of the picture where the vehicle is."""
    return [x for row in rows[TALL // 6:TALL * 6 // 10] for x, p in enumerate(row) if max(p) < 60]


def look(browser, path, results):
    """The vehicle is there and moves as it should in a picture that opens 30 degrees over the window's height, seen
    from 30 m. Of 8 %: the tires are up to 1 m nearer or farther than the middle of the vehicle."""
    rows, distance, seen = read_csv(results), 30, []
    for moment in (0, 1.2):
        browser.open(path, 't=%g&view=side&camera=fixed&distance=%g&toggle=curves' % (moment, distance))
        note('the clock at %g s' % moment, browser.text('clock') == '%.2f s' % moment, browser.text('clock'))
        seen.append(read_png(browser.picture()))
    colours = len({p for row in seen[0] for p in row})
    note('the picture is not blank', colours > 500, '%d colours' % colours)
    one, two = map(tires, seen)
    note('tires are seen', min(len(one), len(two)) > 300, '%d and %d dark pixels' % (len(one), len(two)))
    way = rows['chassis.x'][rows['time'].index(1.2)] - rows['chassis.x'][0]
    shift = sum(two) / max(len(two), 1) - sum(one) / max(len(one), 1)
    expected = way / distance * TALL / 2 / math.tan(math.pi / 12)
    note('they move as the vehicle does', abs(shift - expected) < 0.08 * expected,
         '%.1f pixels instead of %.1f' % (shift, expected))
    arrows = sum(1 for row in seen[0] for r, g, b in row if r > 130 and g < 90 and b < 80)
    note('forces are seen', arrows > 40, '%d red pixels' % arrows)


def compare(browser, path, results):
    """Where the page puts wheel centres while the vehicle turns about, against the results; to two units."""
    rows, worst = read_csv(results), 0
    browser.open(path, 't=0')
    for at in range(0, len(rows['time']), 20):
        wheels = browser.ask('run.wheels.map((w) => [w.name, add(moved(pose(w.body, moment(%r)), w.center), origin)])'
                             % rows['time'][at])
        for name, centre in wheels:
            there = [rows['%s.%s' % (name.replace('tire', 'wheel'), axis)][at] for axis in 'xyz']
            worst = max(worst, math.dist(centre, there))
    note('wheels are where they should be', worst < 2e-4, '%g m beside' % worst)


def use(browser, path):
    clock = 'parseFloat(document.getElementById("clock").textContent)'

    def shows(name, condition):
        note(name, browser.wait(condition, 5), browser.ask('JSON.stringify([state, camera])'))

    browser.open(path)
    shows('it plays when it is opened', '%s > 0.1' % clock)
    browser.ask('go(0); play(true); 1')  # on a busy machine it has come to its end
    browser.press(' ', ' ')
    shows('pause', '!state.playing')
    stopped = browser.ask('state.time')
    time.sleep(0.1)
    shows('it stands', 'state.time === %r' % stopped)
    browser.press('Home')
    shows('Home', '%s === 0' % clock)
    browser.press('ArrowRight')
    shows('a frame on', 'Math.abs(state.time - 0.01) < 1e-9 && %s === 0.01' % clock)
    browser.press('End')
    shows('End', '%s === 4 && document.getElementById("scrub").value === "4"' % clock)
    browser.click('#scrub')
    shows('the bar', 'Math.abs(%s - 2) < 0.1' % clock)
    for share, there in (0.25, 0.6), (0.55, 2):
        browser.click('figure > canvas', share)
        shows('the curves at %g of their width' % share, 'Math.abs(%s - %r) < 0.3' % (clock, there))
    before = browser.ask('state.time')
    began = time.time()
    browser.click('#play')
    browser.wait('state.time > %r + 0.3' % before, 5)
    shows('real time', 'state.time - %r < %r' % (before, time.time() - began + 0.1))
    browser.press(' ', ' ')
    browser.press('-', '-')
    shows('slower', 'state.speed === 0.5 && document.getElementById("speed").value === "0.5"')

    was = browser.ask('({...camera})')
    browser.drag([(200, 100), (260, 100), (260, 130)])
    shows('orbit', 'camera.azimuth < %r && camera.elevation > %r' % (was['azimuth'] - .3, was['elevation'] + .1))
    browser.drag([(200, 100), (260, 100)], modifiers=8)
    shows('shift', 'norm(camera.shift) > 0.1')
    browser.mouse('mouseWheel', 200, 100, deltaX=0, deltaY=100)
    shows('zoom', 'camera.distance > %r' % (1.1 * was['distance']))
    browser.press('3', '3')
    shows('a view by key', 'Math.abs(camera.azimuth) < 0.1 && norm(camera.shift) === 0')
    browser.click('#views button:last-child')
    shows('a view by button', 'camera.elevation > 1.5')
    for mode in ('chase', 'fixed', 'follow'):
        browser.press('c', 'c')
        shows('camera ' + mode,
              '[camera.mode, document.getElementById("camera").value].join() === "%s,%s"' % (mode, mode))
        browser.press('Home')
        browser.wait('!state.changed', 5)
        start = browser.ask('camera.target')
        browser.press('End')
        browser.wait('!state.changed', 5)
        way = math.dist(start, browser.ask('camera.target'))
        note(mode + ' goes along or not', way < 0.01 if mode == 'fixed' else abs(way - 20) < 0.5, '%g m' % way)
    old = browser.picture()
    for key, name in (('b', 'body'), ('a', 'forces'), ('r', 'relief')):
        browser.press(key, key)
        browser.wait('!state.changed', 5)
        new = browser.picture()
        note(name + ' by key', new != old, 'the same picture')
        old = new
    for name in ('body', 'forces', 'relief', 'curves', 'loop'):
        pressed = 'document.getElementById("%s").getAttribute("aria-pressed")' % name
        before = browser.ask(pressed)
        browser.click('#' + name)
        shows(name + ' by button', '[%s, %r].sort().join() === "false,true"' % (pressed, before))
    browser.press('?', '?')
    shows('help', '!document.getElementById("help").hidden')
    note('no trouble', browser.text('trouble') == '', browser.text('trouble'))
    off = browser.ask("""[coil_mesh(), strut_mesh(), ...run.bodies.map(body_mesh).filter((mesh) => mesh)].map((mesh) => mesh.corner.map((_, i, all) => i % 9 ? 0 :
            Math.abs(Math.hypot(...all.slice(i + 3, i + 6)) - 1)).reduce((a, b) => Math.max(a, b), 0))""")
    note('normals of surfaces have length 1', len(off) > 2 and max(off) < 1e-9, str(off))
    solids = (('a box', [(x, y, z) for x in (0, 2) for y in (0, 1) for z in (0, 3)] + [(1, .5, 1)], 6, 12),
              ('a tetrahedron', [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.2, .2, .2)], 4, 6),
              ('a square', [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], 2, 4), ('a line', [(0, 0, 0), (1, 0, 0), (.5, 0, 0)], 0, 1))
    for name, points, faces, edges in solids:
        found = browser.ask('(() => {const h = hull(%s); return [h.faces.length, h.edges.length]})()' %
                            json.dumps([[size * 1.0 for size in p] for p in points]))
        note('the hull of ' + name, found == [faces, edges], '%s faces and edges' % found)


# Visible things that hold text or are used, as they are seen: [what, left, top, right, bottom].
SEEN = """[...document.querySelectorAll(`h1, #subtitle, #clock, #facts, .quantity, .curve, figure > canvas, #controls button,
    #controls select, #controls input`)].flatMap((e) => {
    const r = e.getBoundingClientRect(), c = e.closest('#plots'), p = c ? c.getBoundingClientRect() :
        {left: -1e9, top: -1e9, right: 1e9, bottom: 1e9};
    const box = [Math.max(r.left, p.left), Math.max(r.top, p.top), Math.min(r.right, p.right), Math.min(r.bottom, p.bottom)];
    return r.width && box[0] < box[2] && box[1] < box[3] ? [[e.id || e.className || e.textContent, ...box]] : [];
})"""


def narrow(browser, path):
    """Nothing overlaps or leaves the screen, from a telephone's to a desktop's; all legends are there."""
    for width, tall in ((390, 844), (1280, 800), (844, 390)):
        browser.call('Emulation.setDeviceMetricsOverride', width=width, height=tall, deviceScaleFactor=1, mobile=False)
        browser.open(path, 't=5')
        size = '%d by %d' % (width, tall)
        seen, bad = browser.ask(SEEN), []
        for i, (what, left, top, right, bottom) in enumerate(seen):
            if left < -0.5 or top < -0.5 or right > width + 0.5 or bottom > tall + 0.5:
                bad.append('%s leaves the screen' % what)
            for other, x0, y0, x1, y1 in seen[:i]:
                if min(right, x1) - max(left, x0) > 1 and min(bottom, y1) - max(top, y0) > 1:
                    bad.append('%s on %s' % (what, other))
        note('%s: nothing overlaps' % size, len(seen) > 20 and not bad, '%d things; %s' % (len(seen), '; '.join(bad[:4])))
        wide = browser.ask('[document.documentElement.scrollWidth, document.querySelector("#plots").scrollWidth - '
                           'document.querySelector("#plots").clientWidth]')
        note('%s: no sideways scrolling' % size, wide[0] <= width and wide[1] <= 0, str(wide))
        legends = browser.ask('[...document.querySelectorAll("figure")].map((f) => f.querySelector("figcaption").innerText)')
        units = {'speed of chassis': 'm/s', 'wheel_f_l.y': 'm', 'wheel_r_r.y': 'm', 'chassis_attitude.roll': 'rad'}
        for name, unit in units.items():
            of = [' '.join(text.split()) for text in legends if name in text]
            note('%s: legend of %s' % (size, name),
                 len(of) == 1 and '[%s]' % unit in of[0] and of[0].split(name)[1].split()[1] == unit, str(legends))
        note('%s: panels of one unit each' % size, len(legends) == 3, str(legends))
    browser.call('Emulation.setDeviceMetricsOverride', width=WIDTH, height=TALL, deviceScaleFactor=1, mobile=False)


def course(browser, path):
    """Cones, edges of lanes and the driver's path are seen from above, and nothing of them in a run without."""
    browser.open(path, 't=0&view=top&distance=60&toggle=body,curves')
    rows = read_png(browser.picture())
    # the vehicle covers 3 by 5 of 20 by 30 m; the lane begins 30 m ahead
    browser.ask('camera.shift = [28, 0, 0]; state.changed = true; 1')
    ahead = read_png(browser.picture())

    def count(rows, is_of):
        return sum(1 for row in rows for p in row if is_of(*p))
    orange = count(ahead, lambda r, g, b: r > 180 and 60 < g < 140 and b < 90)
    note('cones are seen', orange > 40, '%d orange pixels' % orange)
    green = count(rows, lambda r, g, b: g > r + 30 and g > b + 10)
    note("the driver's path is seen", green > 100, '%d green pixels' % green)
    white = count(ahead, lambda r, g, b: min(r, g, b) > 245) - count(rows, lambda r, g, b: min(r, g, b) > 245)
    note('lanes are seen', white > 100, '%d white pixels more than before' % white)


def second(browser, path):
    """The second vehicle is seen, goes by its key, and is hidden where both are one."""
    def purple(rows):
        return sum(1 for row in rows[:TALL // 2] for r, g, b in row if r > g + 25 and b > g + 10)
    browser.open(path, 't=5&toggle=body,curves,forces')
    two = purple(read_png(browser.picture()))
    note('the second vehicle is seen', two > 500, '%d pixels' % two)
    note('and how far away it is', '<b>later&.csv' in browser.text('facts') and ' m away' in browser.text('facts'),
         browser.text('facts'))
    browser.press('g', 'g')
    browser.wait('!state.changed', 5)
    gone = purple(read_png(browser.picture()))
    note('G hides it', gone < two / 2 and 'later' not in browser.text('facts'), '%d pixels' % gone)
    browser.open(path, 't=10')
    note('its results have ended', 'ended' in browser.text('facts'), browser.text('facts'))


def turned(rows, name, at, s):
    """A vector of a body's frame in the world, by the Euler parameters of an output."""
    e0, *e = [rows['%s.e%d' % (name, k)][at] for k in range(4)]
    cross = [e[1] * s[2] - e[2] * s[1], e[2] * s[0] - e[0] * s[2], e[0] * s[1] - e[1] * s[0]]
    es = sum(a * b for a, b in zip(e, s))
    return [(2 * e0 * e0 - 1) * s[k] + 2 * es * e[k] + 2 * e0 * cross[k] for k in range(3)]


def readings(browser, path, results):
    """The table of the wheels against outputs, by the definitions of models/KC.md section 3; to their last digit."""
    rows = read_csv(results)
    browser.open(path, 't=4.992')
    browser.press('n', 'n')
    browser.wait('!state.changed && !document.getElementById("wheel_table").hidden', 5)
    at = min(range(len(rows['time'])), key=lambda k: abs(rows['time'][k] - browser.ask('state.time')))
    table = browser.ask('[...document.querySelectorAll("#wheel_table tr")].slice(1).map((r) => [...r.children].map((c) => c.textContent))')
    note('a row a wheel', [row[0] for row in table] == ['tire_f_l', 'tire_f_r', 'tire_r_l', 'tire_r_r'], str(table))
    for name, *cells in table:
        place, side = name.replace('tire_', ''), 1 if name.endswith('l') else -1
        s = turned(rows, 'turn_' + place, at, (0, 1, 0))
        s_x, s_y, s_z = [sum(a * b for a, b in zip(s, turned(rows, 'chassis_orientation', at, axis)))
                         for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
        told = [rows[name + '.fz'][at] / 1000, math.degrees(-side * math.asin(s_z)),
                math.degrees(-side * math.atan2(-s_x, s_y)), 100 * rows['slip_%s.kappa' % place][at],
                math.degrees(rows['slip_%s.alpha' % place][at])]
        note('load, camber, toe and slips of ' + name,
             all(abs(float(cell) - value) <= .51 * 10 ** -len(cell.split('.')[1]) + 2e-3 for cell, value in zip(cells, told)),
             '%s instead of %s' % (cells, told))
    browser.press('n', 'n')
    note('the table goes by N', browser.wait('document.getElementById("wheel_table").hidden', 5), '')


def choice(browser, path, results):
    """Any signal becomes a curve, by keys alone, with the value that results have; and goes again."""
    rows = read_csv(results)
    browser.open(path, 't=5')
    names = browser.ask('[...document.getElementById("add").options].map((o) => o.textContent)')
    note('all outputs can be chosen', all(any(name == n.split(' [')[0] for n in names) for name in rows if name != 'time'),
         str(names[:4]))
    count = browser.ask('shown_curves.length')
    browser.ask('document.getElementById("add").focus()')
    for letter in 'engine.sp':
        browser.press(letter, letter)
    browser.press('Enter')
    if not browser.wait('shown_curves.length > %d' % count, 2):  # a list without a screen may not open
        browser.ask('(() => {const list = document.getElementById("add"), k = run.curves.findIndex((c) => c.name === "drive.engine_speed");'
                    'list.value = k; list.dispatchEvent(new Event("change")); return 1})()')
    browser.wait('!state.changed && shown_curves.length === %d' % (count + 1), 5)
    name = browser.ask('run.curves[shown_curves[shown_curves.length - 1]].name')
    browser.wait('panels[panels.length - 1].curves[0].value.textContent !== ""', 5)
    shown = browser.ask('[...document.querySelectorAll(".curve")].find((e) => e.textContent.startsWith("%s ")).querySelector(".value").textContent' % name)
    at = min(range(len(rows['time'])), key=lambda k: abs(rows['time'][k] - 5))
    size = max(map(abs, rows[name]))
    note('%s as a curve has its value' % name, abs(float(shown) - rows[name][at]) < 1e-2 * size, '%s: %g' % (shown, rows[name][at]))
    browser.ask('[...document.querySelectorAll(".curve button")].pop().focus()')
    browser.press('Enter', '\r')
    note('and goes', browser.wait('shown_curves.length === %d' % count, 5), browser.ask('String(shown_curves)'))


def shown_units(browser, path, results):
    """Curves of both runs and the speed in the units of the scene."""
    rows = read_csv(results)
    browser.open(path, 't=4.2')
    at = rows['time'].index(4.2)
    for name, factor, unit in ('chassis_attitude.roll', 180 / math.pi, 'deg'), ('chassis_velocity.x', 3.6, 'km/h'), ('wheel_f_l.y', 1, 'm'):
        text = browser.ask('[...document.querySelectorAll(".curve")].find((e) => e.textContent.startsWith("%s ")).textContent' % name)
        words = text.replace(name, '').replace('\u00d7', '').split()
        value = factor * rows[name][at]
        note('%s in %s' % (name, unit), words[1::2] == [unit, unit] and
             all(abs(float(w) - value) < .01 * abs(value) + .006 for w in words[::2]), '%s: %g' % (text, value))
    note('the speed in km/h', browser.text('facts').split()[1] == 'km/h' and
         abs(float(browser.text('facts').split()[0]) - 36) < 2, browser.text('facts'))


def save(browser, path, profile):
    """Picture and video arrive as files of their kind; the loop begins again."""
    folder = profile + '/saved'
    os.makedirs(folder)
    browser.whole('Browser.setDownloadBehavior', behavior='allow', downloadPath=folder)

    def file(name, least):
        end = time.time() + 60
        while time.time() < end:
            browser.ask('1')
            if os.path.exists(folder + '/' + name) and os.path.getsize(folder + '/' + name) >= least:
                return open(folder + '/' + name, 'rb').read()
            time.sleep(0.05)
        return b''
    browser.open(path, 't=5')
    browser.click('#picture')
    rows = read_png(file('hmmwv_vehicle_lane_change_5.00s.png', 1000))
    note('the picture has the size of the view', (len(rows[0]), len(rows)) == (WIDTH, TALL),
         '%d by %d' % (len(rows[0]), len(rows)))
    rubber = len(tires(rows))
    note('the vehicle is in it', rubber > 300, '%d dark pixels' % rubber)
    x, y, wide, tall = browser.ask('(() => {const r = document.querySelector("figcaption").getBoundingClientRect();'
                                   'return [r.left, r.top, r.width, r.height].map(Math.round)})()')
    ink = sum(1 for row in rows[y:y + tall] for p in row[x:x + wide] if max(p) < 110)
    note('legends are in it', ink > 50, '%d dark pixels' % ink)
    browser.ask('go(duration - 0.15)')
    browser.press('m', 'm')
    note('it records', browser.ask('recorder !== null && state.playing') is True, '')
    video = file('hmmwv_vehicle_lane_change.webm', 1000)
    note('a video comes', video[:4] == b'\x1a\x45\xdf\xa3' and b'webm' in video[:64] and b'V_VP8' in video,
         '%d bytes: %r' % (len(video), video[:64]))
    browser.press('l', 'l')
    browser.press('End')
    browser.press(' ', ' ')
    browser.ask('go(duration - 0.05)')
    note('the loop begins again', browser.wait('state.playing && state.time < 5', 10), browser.ask('JSON.stringify(state)'))


def main():
    profile, run, results, spin, spin_results, odd, lanes, beside, two, turning, turned, units, unit_rows = sys.argv[1:]
    browser = Browser(profile)
    look(browser, run, results)
    compare(browser, spin, spin_results)
    use(browser, run)
    narrow(browser, lanes)
    course(browser, lanes)
    save(browser, lanes, profile)
    second(browser, two)
    readings(browser, turning, turned)
    choice(browser, turning, turned)
    keyboard(browser, two, 't=5')
    telephone(browser, two, 't=5', 'n')
    dark(browser, lanes, 't=5')
    shown_units(browser, units, unit_rows)
    browser.open(beside, 't=2')
    pairs = browser.ask('panels.flatMap((p) => p.curves.map((c) => c.k === SPEED || c.other !== undefined && '
                        'c.other.ink === c.ink && run.curves[run.curves.findIndex((d) => d.beside === c.k)].name.startsWith(c.name)))')
    note('curves of another run have the colour of their own', len(pairs) > 2 and all(pairs), str(pairs))
    note('no complaint, no request', not browser.complaints, '; '.join(browser.complaints))
    browser.close()

    # names that HTML means something by, and a browser without WebGL
    browser = Browser(profile, '--disable-3d-apis')
    browser.open(odd, 't=250')
    note('the description is text', browser.text('title') == '</script><b>"5 < 6" & \\ Gr\u00f6\u00dfe \u2028 <!-- x',
         browser.text('title'))
    note('so is the name of the scene', browser.text('subtitle') == 'odd \u00b7 <i>&.scene', browser.text('subtitle'))
    note('the rest works without WebGL', browser.text('clock').startswith('250.'), browser.text('clock'))
    note('and says that it is missing', 'no WebGL 2' in browser.text('trouble'), browser.text('trouble'))
    browser.close()


main()
