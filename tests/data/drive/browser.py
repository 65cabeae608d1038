#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# browser.py PROFILE DRIVE.html RECORDING.csv DRIVER.html HANDED.csv [SCENE.html RESULTS.csv]...: drives in a page of `gicrun --drive` in
# chromium by real keys and fingers, counts what a picture takes, saves the recording; takes over from a driver and hands back in another one; and steps the vehicles of the other pages through their scenes, whose numbers
# must be those of gicrun to the last bit. Prints `good NAME` or `bad NAME: why` for each check.
import json
import math
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'animate'))

from chromium import TALL, WIDTH, Browser, note, read_png  # noqa: E402
from manners import dark, keyboard, telephone  # noqa: E402
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


def others(columns, names, rows):
    """Numbers that are not the same, of how many, and where the first is."""
    off = [(k, name) for k, row in enumerate(rows) for i, name in enumerate(names) if row[i] != columns[name][k]]
    where = ', first %s at %g s' % (off[0][1], columns['time'][off[0][0]]) if off else ''
    return len(off), '%d of %d numbers differ%s' % (len(off), len(rows) * len(names), where)


def scenes(browser, pages):
    for page, results in zip(pages[::2], pages[1::2]):
        columns, name = read_csv(results), os.path.basename(page)
        browser.open(page)
        rows = browser.ask(STEP_THROUGH % json.dumps(columns['time']))
        if not isinstance(rows, list):
            note('%s: a whole scene' % name, False, str(rows))
            continue
        names = [n for n in columns if n != 'time']
        off, text = others(columns, names, rows)
        note('%s: a whole scene, every digit as gicrun has it' % name,
             off == 0 and len(rows) == len(columns['time']) > 10 and len(names) == len(rows[0]) > 1, text)


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
    browser.press('p', 'p')
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


def touch(browser, path):
    """Fingers: one on a pad, a second one that steers meanwhile, and both away."""
    def shows(name, condition):
        note(name, browser.wait(condition, 60), browser.ask('JSON.stringify([driving.pads, target])'))

    def send(kind, **fingers):
        points = []
        for number, (name, share) in enumerate(fingers.items()):
            box = browser.ask('(() => {const r = document.getElementById("%s").getBoundingClientRect();'
                              'return [r.left + %g * r.width, r.top + r.height / 2]})()' % (name, share))
            points.append({'x': box[0], 'y': box[1], 'id': 10 + number})
        browser.call('Input.dispatchTouchEvent', type=kind, touchPoints=points)

    browser.call('Emulation.setTouchEmulationEnabled', enabled=True, maxTouchPoints=2)
    browser.open(path)
    send('touchStart', faster=.9)
    shows('a finger accelerates', 'driving.hold && Math.abs(target[role.accelerator] - .9) < .02')
    send('touchMove', faster=.5)
    shows('it moves', 'Math.abs(target[role.accelerator] - .5) < .02')
    send('touchStart', faster=.5, wheel=.2)
    shows('another one steers meanwhile',
          'Math.abs(driving.steer - .6) < .02 && Math.abs(target[role.accelerator] - .5) < .02')
    shows('and the vehicle goes there', 'live.speed > 1 && live.signals[run.signals.length - run.inputs + '
          'hands[role.steering].input] * Math.sign(run.left) > 0')
    send('touchEnd')
    shows('no finger, no pedal', 'target[role.accelerator] === 0 && driving.pads.wheel === undefined')
    azimuth = browser.ask('camera.azimuth')
    for kind, x in (('touchStart', 300), ('touchMove', 340)):
        browser.call('Input.dispatchTouchEvent', type=kind, touchPoints=[{'x': x, 'y': 200}])
    browser.call('Input.dispatchTouchEvent', type='touchEnd', touchPoints=[])
    shows('a finger turns the view', 'Math.abs(camera.azimuth - %r) > .1' % azimuth)
    browser.call('Emulation.setTouchEmulationEnabled', enabled=False)


# What a picture of a quality asks of the graphics card: calls, corners, pixels a pixel of the page.
COST = """(async () => {
    const P = WebGL2RenderingContext.prototype, old = [P.drawElements, P.drawArrays];
    const view = document.getElementById("view");
    let calls = 0, corners = 0, pictures = 0;
    judge_picture = () => 0;
    const frame = () => new Promise((done) => requestAnimationFrame(done));
    set_quality(%d);
    for (let k = 0; k < 6; ++k)
        await frame();
    P.drawElements = function (...a) { ++calls; corners += a[1]; old[0].apply(this, a); };
    P.drawArrays = function (...a) { ++calls; corners += a[2]; old[1].apply(this, a); };
    const one = draw_in_time;
    draw_in_time = (...a) => (++pictures, one(...a));
    while (pictures < 5)
        await frame();
    [[P.drawElements, P.drawArrays], draw_in_time] = [old, one];
    return [calls / pictures, corners / pictures, view.width * view.height / view.clientWidth / view.clientHeight];
})()"""


def light(browser, path):
    """What makes pictures come in time, as counts, which no load of the computer changes."""
    browser.open(path)
    browser.wait('live.time > 0.2', 60)
    costs = [browser.ask(COST % quality) for quality in range(browser.ask('qualities.length'))]
    text = '; '.join('%.0f calls, %.0f corners, %.2f pixels' % tuple(cost) for cost in costs)
    note('a picture takes few calls', all(cost[0] <= 16 for cost in costs), text)
    note('simple pictures have few corners', all(cost[1] < .5 * costs[0][1] and cost[1] < 60000 for cost in costs[1:]),
         text)
    note('and fewer pixels', all(b[2] < .4 * a[2] for a, b in zip(costs[1:], costs[2:])) and costs[0][2] == 1, text)
    browser.open(path)
    fed = browser.ask("""(() => {
        const feed = (ms, count) => { for (let k = 0; k < count; ++k) judge_picture(ms); return pace.quality; };
        const real = judge_picture;
        set_quality(0);
        return [feed(5, 100), feed(30, 5), feed(30, 5), feed(5, 100), feed(1, 30), feed(30, 5), feed(1, 30), feed(1, 30),
            feed(30, 100)];
    })()""")
    note('slow pictures are made simpler, and quick ones better, at first soon',
         fed == [0, 1, 2, 2, 1, 2, 2, 1, 3], str(fed))
    told = browser.ask("""(() => {
        const place = document.createElement("div");
        Object.assign(run.units, {m: ["mm", 1000]});
        for (const unit of ["m", "N/m", "1"])
            slider(place, "<b>x</b>", unit, 0, 1, .25, () => 0);
        return [place.textContent, place.querySelectorAll("b").length];
    })()""")
    note('sliders have units, those of the scene first, and names are text',
         told == ['<b>x</b>250 mm<b>x</b>0.25 N/m<b>x</b>0.25', 0], str(told))
    done = browser.ask("""(() => {
        const count = [0, 0, 0], chores = count.map((_, k) => () => ++count[k]), most = [];
        for (let k = 0; k < 60; ++k) {
            const before = count[0] + count[1] + count[2];
            do_chores(chores, 1 / 60);
            most.push(count[0] + count[1] + count[2] - before);
        }
        return [Math.min(...count), Math.max(...count), Math.max(...most)];
    })()""")
    note('chores are done ten times a second, one a picture',
         done[0] >= 9 and done[1] <= 11 and done[2] == 1, str(done))


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
    for width, tall in ((390, 844), (640, 480), (1280, 800)):
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
        # what is solid stands free: the middle of the picture above the panel below
        free = browser.ask('(() => {const foot = document.querySelector("footer").getBoundingClientRect().top; return '
                           '[foot / innerHeight, document.elementFromPoint(innerWidth / 2, foot / 2).id]})()')
        note('%s: panels leave the vehicle free' % size, free[0] > .5 and free[1] == 'view', str(free))
        note('%s: nothing overlaps' % size, len(seen) > 20 and not bad, '%d things; %s' % (len(seen), '; '.join(bad[:4])))
    browser.call('Emulation.setDeviceMetricsOverride', width=WIDTH, height=TALL, deviceScaleFactor=1, mobile=False)


def main():
    profile, drive, recording, driver, handed, *pages = sys.argv[1:]
    browser = Browser(profile)
    use(browser, drive, recording, profile)
    hand_back(browser, driver, handed, profile)
    touch(browser, drive)
    light(browser, drive)
    narrow(browser, drive)
    keyboard(browser, driver)
    telephone(browser, drive, keys='xn')
    telephone(browser, drive, keys='xnp')
    dark(browser, driver)
    scenes(browser, pages)
    note('no complaint, no request', not browser.complaints, '; '.join(browser.complaints))
    browser.close()


main()
