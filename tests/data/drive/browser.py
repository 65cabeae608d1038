#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# browser.py PROFILE DRIVE.html RECORDING.csv DRIVER.html HANDED.csv [SCENE.html RESULTS.csv DIGITS]...: drives in a page of `gicrun --drive` in
# chromium by real keys, saves the recording; takes over from a driver and hands back in another one; and steps the vehicles of the other pages through their scenes, whose results
# must be those of gicrun to DIGITS of the largest value of each column. Prints `good NAME` or `bad NAME: why` for each check.
import json
import math
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'animate'))

from chromium import TALL, WIDTH, Browser, note, read_png  # noqa: E402
from page import read_csv  # noqa: E402

# The module of a page by itself: all rows of the scene's results.
STEP_THROUGH = """(async () => {
    const x = (await WebAssembly.instantiate(bytes, {})).instance.exports;
    const place = Array.from(new Uint32Array(x.memory.buffer, x.places(), 10));
    new Float64Array(x.memory.buffer, place[0], run.parameters.length).set(run.parameters.map(({value}) => value));
    const rows = [];
    let status = x.start(), n = 0;
    for (const time of %s) {
        while (status >= 0 && n < Math.round(time / run.step)) {
            status = x.step();
            ++n;
        }
        status = status < 0 ? status : x.show();
        if (status < 0)
            return 'status ' + status + ' at ' + x.now();
        const outputs = new Float64Array(x.memory.buffer, place[4], run.outputs);
        const inputs = new Float64Array(x.memory.buffer, place[5], run.signals.length - run.outputs);
        rows.push(run.columns.map((k) => k < run.outputs ? outputs[k] : inputs[k - run.outputs]));
    }
    return rows;
})()"""


def worst_of(columns, names, rows):
    """The largest difference, as a share of the largest magnitude in its column, but of 1e-3 of any unit at least."""
    worst, where = 0, ''
    for i, name in enumerate(names):
        size = max([1e-3] + [abs(value) for value in columns[name]])
        for k, row in enumerate(rows):
            off = abs(row[i] - columns[name][k]) / size
            if not off <= worst:
                worst, where = off, '%s at %g s' % (name, columns['time'][k])
    return worst, where


def scenes(browser, pages):
    for page, results, digits in zip(pages[::3], pages[1::3], pages[2::3]):
        columns, name = read_csv(results), os.path.basename(page)
        browser.open(page)
        rows = browser.ask(STEP_THROUGH % json.dumps(columns['time']))
        if not isinstance(rows, list):
            note('%s: a whole scene' % name, False, str(rows))
            continue
        worst, where = worst_of(columns, [n for n in columns if n != 'time'], rows)
        note('%s: a whole scene, as gicrun has it' % name, worst <= float(digits), '%g: %s' % (worst, where))


class Keys:
    def __init__(self, browser):
        self.browser = browser

    def down(self, key):
        self.browser.call('Input.dispatchKeyEvent', type='keyDown', key=key)

    def up(self, key):
        self.browser.call('Input.dispatchKeyEvent', type='keyUp', key=key)


def use(browser, path, recording, profile):
    keys = Keys(browser)

    def shows(name, condition, seconds=60):
        note(name, browser.wait(condition, seconds), browser.ask('JSON.stringify([state, live.time, live.speed, '
                                                                 'driving.steer, [...driving.down], target])') +
             browser.text('trouble'))

    browser.open(path)
    shows('the scene drives when the page opens', 'live.time > 0.1 && !driving.hold')
    # before the vehicle has rolled far
    keys.down('w')
    shows('a key takes over', 'driving.hold')
    shows('it pulls away', 'live.speed > 4')
    yaw = browser.ask('base_yaw[1]')
    keys.down('ArrowLeft')
    shows('it steers to the left', 'base_yaw[1] > %r' % (yaw + .15))
    a = browser.ask('[live.ahead, live.left, ...["x", "y"].map((c) => live.signals[run.signals.findIndex('
                    '({name}) => name === "chassis_acceleration." + c)])]')
    note('accelerations of the g-g diagram are those of the outputs',
         a[1] > .5 and abs(math.hypot(a[0], a[1]) - math.hypot(a[2], a[3])) < .1 + .05 * math.hypot(a[2], a[3]), str(a))
    keys.up('ArrowLeft')
    keys.up('w')
    keys.down('s')
    shows('it is slowed down on the g-g diagram', 'live.ahead < -2')
    shows('it brakes', 'live.speed < 1')
    keys.up('s')
    shows('gears, speed and time are shown', '/gear [1-9N]/.test(document.getElementById("facts").textContent) && '
          '/km/.test(document.getElementById("velocity").textContent)')
    browser.press('g', 'g')
    browser.press('g', 'g')
    keys.down('ArrowUp')
    shows('it backs up', 'live.gear < 0 && live.speed > 0.5')
    keys.up('ArrowUp')

    browser.press('n', 'n')
    told = 'document.querySelector("#wheel_table td").textContent'
    shows('the table of the wheels', 'Math.abs(%s - live.signals[run.wheels[0].told[0]] / 1000) < .2 && %s > 1' % (told, told))
    browser.press('x', 'x')
    shows('the g-g diagram', '!document.getElementById("gg_box").hidden && document.getElementById("gg")'
          '.toDataURL().length > 2500 && document.getElementById("gg_left").textContent !== ""')
    browser.press('x', 'x')
    browser.press('n', 'n')

    # a moment that is kept, and what comes after it forgotten
    browser.press('k', 'k')
    shows('a moment is kept', 'state.kept')
    kept = browser.ask('live.time')
    shows('time goes on', 'live.time > %r' % (kept + .3))
    rows = browser.ask('state.rows')
    browser.press('l', 'l')
    shows('back to it', 'live.time < %r && state.rows < %r' % (kept + .25, rows))
    browser.press('-', '-')
    shows('slow motion', 'state.speed === 0.5 && document.getElementById("speed").value === "0.5"')
    browser.press(' ', ' ')
    shows('pause', '!state.playing && !state.waiting')
    save(browser, profile, recording)

    # pads, by the mouse; sliders
    browser.press('r', 'r')
    shows('reset', 'live.time < 5 && state.rows < 250')
    shows('and on', 'state.playing && live.time > 0.1')
    box = browser.ask('(() => {const r = document.getElementById("faster").getBoundingClientRect();'
                      'return [r.left + .9 * r.width, r.top + r.height / 2]})()')
    browser.mouse('mousePressed', *box, button='left', buttons=1, clickCount=1)
    shows('a pad accelerates', 'target[role.accelerator] > 0.8')
    browser.mouse('mouseReleased', *box, button='left', clickCount=1)
    shows('and lets go', 'target[role.accelerator] === 0')
    shows('a panel of inputs', 'document.querySelectorAll("#inputs input").length === hands.length && '
          '!document.getElementById("side").hidden')
    browser.press('p', 'p')
    shows('the panel goes by a key', 'document.getElementById("side").hidden')
    for key, mode in (('c', 'follow'), ('c', 'fixed'), ('c', 'chase')):
        browser.press(key, key)
        shows('camera ' + mode, 'camera.mode === "%s"' % mode)
    old = browser.picture()
    browser.press('5', '5')
    browser.ask('new Promise((done) => setTimeout(() => done(1), 300))')
    note('a view by key', browser.picture() != old, 'the same picture')
    count = browser.ask('shown_curves.length')
    browser.ask('(() => {const list = document.getElementById("add"); list.value = run.signals.length - 1;'
                'list.dispatchEvent(new Event("change")); return 1})()')
    note('one more curve', browser.ask('shown_curves.length') == count + 1, str(count))
    note('no trouble', browser.text('trouble') == '', browser.text('trouble'))
    rows = read_png(browser.picture())
    note('the picture is not blank', len({p for row in rows for p in row}) > 500, '%d by %d' % (WIDTH, TALL))


def save(browser, profile, recording):
    """The recording by its key."""
    folder = profile + '/saved'
    os.makedirs(folder, exist_ok=True)
    browser.whole('Browser.setDownloadBehavior', behavior='allow', downloadPath=folder)
    browser.press('o', 'o')
    end = time.time() + 60
    while time.time() < end and not [f for f in os.listdir(folder) if f.endswith('.csv')]:
        browser.ask('1')
        time.sleep(.05)
    saved = [f for f in os.listdir(folder) if f.endswith('.csv')]
    note('%s is saved' % os.path.basename(recording), len(saved) == 1, str(os.listdir(folder)))
    if saved:
        os.replace(folder + '/' + saved[0], recording)


def hand_back(browser, path, recording, profile):
    """A driver's vehicle with a parameter moved, taken over by a gamepad, and handed back."""
    def shows(name, condition):
        note(name, browser.wait(condition, 60), browser.ask('JSON.stringify([state, live.time, driving.steer, target])') +
             browser.text('trouble'))

    browser.open(path)
    browser.ask("""(() => {const bar = document.querySelector('#parameters input'); bar.value = 1.5 * bar.value;
        bar.dispatchEvent(new Event('input')); return 1})()""")
    browser.press('r', 'r')
    shows('a parameter is moved, and the run begins again', 'live.time > 0.3 && live.time < 5 && !driving.hold')
    browser.ask("""(() => {navigator.getGamepads = () => [{connected: true, axes: [window.stick],
        buttons: Array.from({length: 8}, (_, k) => ({value: k === 7 ? .4 : 0}))}]; window.stick = -.5; return 1})()""")
    shows('a gamepad takes over', 'driving.hold && driving.steer === .5 && target[role.accelerator] === .4')
    taken = browser.ask('live.time')
    shows('and drives', 'live.time > %r' % (taken + .5))
    browser.ask('(() => {navigator.getGamepads = () => []; return 1})()')
    browser.press('t', 't')
    shows('the driver has it back', '!driving.hold && /Driver/.test(document.getElementById("who").textContent)')
    given = browser.ask('live.time')
    shows('the driver drives', 'live.time > %r' % (given + 1))
    save(browser, profile, recording)


# Visible things that hold text or are used: [what, left, top, right, bottom].
SEEN = """[...document.querySelectorAll(`h1, #subtitle, #clock, #facts, #velocity, .pad, #controls button, #controls select,
    #side .row`)].flatMap((e) => {
    const r = e.getBoundingClientRect(), c = e.closest('#side'), p = c ? c.getBoundingClientRect() :
        {left: -1e9, top: -1e9, right: 1e9, bottom: 1e9};
    const box = [Math.max(r.left, p.left), Math.max(r.top, p.top), Math.min(r.right, p.right), Math.min(r.bottom, p.bottom)];
    return r.width && box[0] < box[2] && box[1] < box[3] ? [[e.id || e.className || e.textContent, ...box]] : [];
})"""


def narrow(browser, path):
    """Nothing overlaps or leaves the screen, from a telephone's to a desktop's."""
    for width, tall in ((390, 844), (1280, 800)):
        browser.call('Emulation.setDeviceMetricsOverride', width=width, height=tall, deviceScaleFactor=1, mobile=False)
        browser.open(path)
        size, bad = '%d by %d' % (width, tall), []
        seen = browser.ask(SEEN)
        for i, (what, left, top, right, bottom) in enumerate(seen):
            if left < -0.5 or top < -0.5 or right > width + 0.5 or bottom > tall + 0.5:
                bad.append('%s leaves the screen' % what)
            for other, x0, y0, x1, y1 in seen[:i]:
                if min(right, x1) - max(left, x0) > 1 and min(bottom, y1) - max(top, y0) > 1:
                    bad.append('%s on %s' % (what, other))
        note('%s: nothing overlaps' % size, len(seen) > 20 and not bad, '%d things; %s' % (len(seen), '; '.join(bad[:4])))
    browser.call('Emulation.setDeviceMetricsOverride', width=WIDTH, height=TALL, deviceScaleFactor=1, mobile=False)


def main():
    profile, drive, recording, driver, handed, *pages = sys.argv[1:]
    browser = Browser(profile)
    use(browser, drive, recording, profile)
    hand_back(browser, driver, handed, profile)
    narrow(browser, drive)
    scenes(browser, pages)
    note('no complaint, no request', not browser.complaints, '; '.join(browser.complaints))
    browser.close()


main()
