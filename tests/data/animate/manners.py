# SPDX-License-Identifier: MIT
# manners.py: what every page owes those who use it: all of it by keys alone, with a focus that is seen; controls large
# enough for a finger on a telephone; texts with contrast on dark and light grounds.
from chromium import TALL, WIDTH, note, read_png

# Controls that are there: [name, width, height].
CONTROLS = """[...document.querySelectorAll('button, select, input, [tabindex="0"]')].filter((e) => e.getClientRects().length &&
    !e.disabled).map((e) => {const r = e.getBoundingClientRect(); return [NAME(e), r.width, r.height]})"""
NAME = "(e.id || e.getAttribute('aria-label') || e.title || e.textContent)"
FOCUS = """(() => {const e = document.activeElement, s = getComputedStyle(e), r = e.getBoundingClientRect(),
    c = e.closest('.group, #plots, #side'), offset = parseFloat(s.outlineOffset), width = parseFloat(s.outlineWidth);
    const inside = !c || c.scrollHeight > c.clientHeight || offset + width <= 0 || getComputedStyle(c).overflowX === 'visible';
    const screen = r.left - offset - width >= -1 && r.top - offset - width >= -1;
    return [NAME(e), s.outlineStyle !== 'none' && width >= 2 && inside && screen]})()"""


def ask(browser, text):
    return browser.ask(text.replace('NAME(e)', NAME))


def press(browser, key, code, text=None):
    more = {'text': text} if text else {}
    browser.call('Input.dispatchKeyEvent', type='keyDown', key=key, code=key, windowsVirtualKeyCode=code, **more)
    browser.call('Input.dispatchKeyEvent', type='keyUp', key=key, code=key, windowsVirtualKeyCode=code)


def keyboard(browser, path, address=''):
    """Tab reaches every control, and one sees where it is; Space and Enter do what a button does; keys turn the view."""
    browser.open(path, address)
    there = {name for name, _, _ in ask(browser, CONTROLS)}
    seen, hidden = set(), set()
    for _ in range(len(there) + 4):
        press(browser, 'Tab', 9)
        name, good = ask(browser, FOCUS)
        seen.add(name)
        if name in there and not good:
            hidden.add(name)
    note('Tab reaches all controls', len(there) > 15 and there <= seen, 'not %s' % sorted(there - seen))
    note('the focus is seen', not hidden, 'not on %s' % sorted(hidden))
    pressed = 'document.getElementById("wheels").getAttribute("aria-pressed")'
    for key, code, text in ((' ', 32, ' '), ('Enter', 13, '\r')):
        browser.ask('document.getElementById("wheels").focus()')
        before = browser.ask(pressed)
        press(browser, key, code, text)
        note('a button by %r' % key, browser.wait('%s !== "%s"' % (pressed, before), 5), before)
    browser.ask('document.activeElement.blur()')
    for key, changed in (('q', 'azimuth'), ('u', 'elevation'), ('PageDown', 'distance')):
        before = browser.ask('camera.' + changed)
        browser.press(key)
        note('%s of the view by %s' % (changed, key), browser.wait('camera.%s > %r' % (changed, before), 5), before)
        browser.press({'q': 'e', 'u': 'j'}.get(key, 'PageUp'))
        note('and back', browser.wait('Math.abs(camera.%s - %r) < 1e-9' % (changed, before), 5), browser.ask('camera.' + changed))
    browser.press('Q', modifiers=8)
    note('it is moved by Shift and a key', browser.wait('norm(camera.shift) > .01', 5), browser.ask('camera.shift'))


def telephone(browser, path, address='', keys=''):
    """Controls are 24 pixels wide and high at least; nothing is wider than the screen, and panels, those that keys show as
    well, stand beside each other."""
    browser.call('Emulation.setDeviceMetricsOverride', width=390, height=844, deviceScaleFactor=2, mobile=True)
    browser.open(path, address)
    for key in keys:
        browser.press(key)
    controls = ask(browser, CONTROLS)
    small = ['%s %.0f by %.0f' % tuple(c) for c in controls if min(c[1:]) < 24]
    note('390 by 844: controls are large enough', len(controls) > 15 and not small, '; '.join(small))
    note('390 by 844: no overflow', browser.ask('document.documentElement.scrollWidth <= 390 && innerWidth <= 390'),
         browser.ask('document.documentElement.scrollWidth'))
    browser.ask('new Promise((done) => setTimeout(() => done(1), 300))')
    seen, bad = browser.ask("""[...document.querySelectorAll('header, #readings, #wheel_table, #gg_box, #side, footer, #wheel_table td')]
        .filter((e) => e.getClientRects().length).map((e) => {const r = e.getBoundingClientRect();
        return [e.id || e.localName, r.left, r.top, r.right, r.bottom]})"""), []
    for i, (what, left, top, right, bottom) in enumerate(seen):
        if left < 0 or top < 0 or right > 390 or bottom > 844:
            bad.append('%s leaves the screen' % what)
        bad += ['%s on %s' % (what, other) for other, x0, y0, x1, y1 in seen[:i] if what != 'td' and other != 'td' and
                min(right, x1) - max(left, x0) > 1 and min(bottom, y1) - max(top, y0) > 1]
    note('390 by 844: panels stand beside each other', len(seen) > 3 and not bad, '; '.join(bad))
    browser.call('Emulation.setDeviceMetricsOverride', width=WIDTH, height=TALL, deviceScaleFactor=1, mobile=False)


def shine(colour):
    def part(c):
        return c / 3294.6 if c <= 10 else ((c / 255 + .055) / 1.055) ** 2.4
    return sum(w * part(c) for w, c in zip((.2126, .7152, .0722), colour))


def contrast(one, two):
    low, high = sorted((shine(one), shine(two)))
    return (high + .05) / (low + .05)


def dark(browser, path, address=''):
    """On a dark ground texts are light, with contrast, and so is what is light otherwise dark."""
    for scheme in 'dark', 'light':
        browser.call('Emulation.setEmulatedMedia', features=[{'name': 'prefers-color-scheme', 'value': scheme}])
        browser.open(path, address)
        rows = read_png(browser.picture())
        mean = sum(map(sum, rows[TALL // 3])) / 3 / WIDTH
        note('%s: the ground' % scheme, mean < 110 if scheme == 'dark' else mean > 150, '%g' % mean)
        x, y = browser.ask('(() => {const r = document.querySelector("footer").getBoundingClientRect();'
                           'return [r.left + 5, r.top + r.height / 2].map(Math.round)})()')
        panel = rows[y][x]
        inks = browser.ask('["--ink", "--quiet", "--accent"].map((name) => {const e = document.createElement("i"); e.style.color = '
                           'style_color(name); document.body.append(e); const c = getComputedStyle(e).color.match(/[0-9.]+/g)'
                           '.slice(0, 3).map(Number); e.remove(); return c})')
        for name, colour, least in zip(('texts', 'quiet texts', 'the focus'), inks, (4.5, 4.5, 3)):
            note('%s: contrast of %s' % (scheme, name), contrast(colour, panel) > least, '%s on %s' % (colour, panel))
        faint = browser.ask("""[...document.querySelectorAll('button, select')].filter((e) => e.getClientRects().length &&
            !e.disabled).map((e) => {const s = getComputedStyle(e); return [NAME(e), ...[s.color, s.backgroundColor].map((c) =>
            c.match(/[0-9.]+/g).map(Number))]})""".replace('NAME(e)', NAME))
        bad = [name for name, ink, ground in faint if contrast(ink[:3], ground[:3] if len(ground) == 3 else panel) < 3.5]
        note('%s: contrast of buttons' % scheme, len(faint) > 10 and not bad, str(bad))
    browser.call('Emulation.setEmulatedMedia', features=[])
