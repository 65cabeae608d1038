#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# browser.py PROFILE RUN.html RUN.csv SPIN.html SPIN.csv ODD.html: opens pages of `gicrun --animate` in chromium without a screen, uses
# them by mouse and keys, and looks at pictures of them. Prints `good NAME` or `bad NAME: why` for each check. It talks
# the browser's DevTools protocol through a pipe: messages are JSON, ended by a zero byte.
import base64
import json
import math
import os
import struct
import subprocess
import sys
import time
import zlib

from page import read_csv

WIDTH, TALL = 640, 480


class Browser:
    """One page. The sandbox can't be had as root; the processor draws in place of a graphics card."""

    def __init__(self, profile, *options):
        down, self.to = os.pipe()
        self.back, up = os.pipe()
        command = ['chromium', '--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
                   '--user-data-dir=' + profile, '--no-first-run', '--disable-background-networking',
                   '--force-device-scale-factor=1', '--window-size=%d,%d' % (WIDTH, TALL), '--remote-debugging-pipe',
                   *options, 'about:blank']
        self.process = subprocess.Popen(['sh', '-c', 'exec "$@" 3<&%d 4>&%d' % (down, up), 'sh'] + command,
                                        pass_fds=(down, up), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(down)
        os.close(up)
        self.rest, self.number, self.session, self.complaints = b'', 0, None, []
        target = next(t for t in self.call('Target.getTargets')['targetInfos'] if t['type'] == 'page')['targetId']
        self.session = self.call('Target.attachToTarget', targetId=target, flatten=True)['sessionId']
        for domain in ('Page', 'Runtime', 'Log', 'Network'):
            self.call(domain + '.enable')
        self.call('Emulation.setDeviceMetricsOverride', width=WIDTH, height=TALL, deviceScaleFactor=1, mobile=False)

    def call(self, method, **params):
        self.number += 1
        message = {'id': self.number, 'method': method, 'params': params}
        if self.session:
            message['sessionId'] = self.session
        os.write(self.to, json.dumps(message).encode() + b'\0')
        while True:
            while b'\0' not in self.rest:
                more = os.read(self.back, 1 << 20)
                if not more:
                    sys.exit('the browser has ended')
                self.rest += more
            one, self.rest = self.rest.split(b'\0', 1)
            answer = json.loads(one)
            self.hear(answer)
            if answer.get('id') == self.number:
                if 'error' in answer:
                    sys.exit('%s: %s' % (method, answer['error']))
                return answer['result']

    def hear(self, event):
        """What the browser complains about, and what pages ask the network for."""
        method, params = event.get('method'), event.get('params', {})
        if method in ('Runtime.exceptionThrown', 'Log.entryAdded'):
            self.complaints.append(json.dumps(params)[:400])
        if method == 'Network.requestWillBeSent':
            url = params['request']['url']
            if not url.startswith(('file:', 'data:', 'about:')):
                self.complaints.append('asks for ' + url)

    def open(self, path, address=''):
        self.call('Page.navigate', url='about:blank')
        self.call('Page.navigate', url='file://' + path + ('#' + address if address else ''))
        self.wait('document.readyState === "complete" && document.getElementById("clock") !== null && '
                  'document.getElementById("clock").textContent !== ""')

    def ask(self, expression):
        result = self.call('Runtime.evaluate', expression=expression, returnByValue=True, awaitPromise=True)
        return result['result'].get('value')

    def wait(self, condition, seconds=20):
        """Until it holds; True: it does."""
        end = time.time() + seconds
        while self.ask(condition) is not True:
            if time.time() > end:
                return False
            time.sleep(0.02)
        return True

    def text(self, name):
        return self.ask('document.getElementById("%s").textContent' % name)

    def picture(self):
        # twice, for the first may show the frame before
        self.ask('new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))')
        return base64.b64decode(self.call('Page.captureScreenshot', format='png')['data'])

    def press(self, key, text=None, modifiers=0):
        self.call('Input.dispatchKeyEvent', type='keyDown', key=key, modifiers=modifiers,
                  **({'text': text} if text else {}))
        self.call('Input.dispatchKeyEvent', type='keyUp', key=key, modifiers=modifiers)

    def mouse(self, kind, x, y, **more):
        self.call('Input.dispatchMouseEvent', type=kind, x=x, y=y, **more)

    def drag(self, path, **more):
        self.mouse('mousePressed', *path[0], button='left', buttons=1, clickCount=1, **more)
        for x, y in path[1:]:
            self.mouse('mouseMoved', x, y, button='left', buttons=1, **more)
        self.mouse('mouseReleased', *path[-1], button='left', clickCount=1, **more)

    def click(self, selector, share=0.5):
        x, y = self.ask('(() => {const r = document.querySelector(%s).getBoundingClientRect();'
                        'return [r.left + %g * r.width, r.top + r.height / 2]})()' % (json.dumps(selector), share))
        self.drag([(x, y)])

    def close(self):
        self.session = None
        self.call('Browser.close')
        self.process.wait(20)


def read_png(data):
    """Rows of (r, g, b)."""
    at, body = 8, b''
    while at < len(data):
        size, kind = struct.unpack('>I4s', data[at:at + 8])
        if kind == b'IHDR':
            width, tall, depth, colour = struct.unpack('>IIBB', data[at + 8:at + 18])
        if kind == b'IDAT':
            body += data[at + 8:at + 8 + size]
        at += 12 + size
    n = {2: 3, 6: 4}[colour]
    raw, rows, before = zlib.decompress(body), [], bytearray(width * n)
    for y in range(tall):
        start = y * (width * n + 1)
        kind, line = raw[start], bytearray(raw[start + 1:start + 1 + width * n])
        if kind == 1:
            for x in range(n, width * n):
                line[x] = (line[x] + line[x - n]) & 255
        elif kind:
            for x in range(width * n):
                a, b, c = line[x - n] if x >= n else 0, before[x], before[x - n] if x >= n else 0
                near = b if kind == 2 else (a + b) // 2
                if kind == 4:
                    p = a + b - c
                    near = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[x] = (line[x] + near) & 255
        rows.append([tuple(line[x:x + 3]) for x in range(0, width * n, n)])
        before = line
    return rows


def tires(rows):
    """Columns of the pixels as dark as rubber, in the part of the picture where the vehicle is."""
    return [x for row in rows[TALL // 6:TALL * 6 // 10] for x, p in enumerate(row) if max(p) < 60]


def note(name, good, why=''):
    print('good %s' % name if good else 'bad %s: %s' % (name, why), flush=True)


def look(browser, path, results):
    """The vehicle is there and moves as it should in a picture that opens 30 degrees over the window's height, seen
    from 30 m. Of 8 %: the tires are up to 1 m nearer or farther than the middle of the vehicle."""
    rows, distance, seen = read_csv(results), 30, []
    for moment in (0, 1.2):
        browser.open(path, 't=%g&view=side&camera=fixed&distance=%g' % (moment, distance))
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
    shows('it plays when it is opened', 'state.playing && %s > 0.1' % clock)
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
    browser.click('#plot', 0.25)
    shows('the curves', 'Math.abs(%s - 2) < 0.3' % clock)
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
    browser.press('?', '?')
    shows('help', '!document.getElementById("help").hidden')
    note('no trouble', browser.text('trouble') == '', browser.text('trouble'))


def main():
    profile, run, results, spin, spin_results, odd = sys.argv[1:]
    browser = Browser(profile)
    look(browser, run, results)
    compare(browser, spin, spin_results)
    use(browser, run)
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
