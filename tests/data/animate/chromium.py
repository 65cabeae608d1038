#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# chromium.py: a page in chromium without a screen, used by mouse and keys, for tests. It talks the browser's DevTools
# protocol through a pipe: messages are JSON, ended by a zero byte.
import base64
import json
import os
import struct
import subprocess
import sys
import time
import zlib

WIDTH, TALL = 640, 480


class Browser:
    """One page. The sandbox can't be had as root; the processor draws in place of a graphics card."""

    def __init__(self, profile, *options):
        down, self.to = os.pipe()
        self.back, up = os.pipe()
        command = ['chromium', '--headless', '--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
                   '--user-data-dir=' + profile, '--no-first-run', '--disable-background-networking', '--disable-quic',
                   '--disable-sync', '--disable-component-update',
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

    def whole(self, method, **params):
        """Of the browser, not of its page."""
        session, self.session = self.session, None
        self.call(method, **params)
        self.session = session

    def hear(self, event):
        """What the browser complains about, and what pages ask the network for."""
        method, params = event.get('method'), event.get('params', {})
        if method in ('Runtime.exceptionThrown', 'Log.entryAdded'):
            # a note on speed: looking at pixels makes the driver wait
            if 'GL Driver Message (OpenGL, Performance' not in json.dumps(params):
                self.complaints.append(json.dumps(params)[:400])
        if method == 'Network.requestWillBeSent':
            url = params['request']['url']
            if not url.startswith(('file:', 'data:', 'about:', 'blob:')):
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


def note(name, good, why=''):
    print('good %s' % name if good else 'bad %s: %s' % (name, why), flush=True)
