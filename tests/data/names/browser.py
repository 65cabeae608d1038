#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# browser.py PROFILE FILE...: opens pages and pictures made from texts that HTML and scripts mean something by, in chromium:
# none of them becomes an element or runs, and each page shows some as they are. Prints `good NAME` or `bad NAME: why`.
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'animate'))

from chromium import Browser, note  # noqa: E402

# Elements and attributes that only the texts have: no page of ours has a picture from a file, or a handler in its text.
FOREIGN = """(() => {
    const bad = [...document.querySelectorAll('*')].filter((e) => e.localName === 'img' || e.localName === 'iframe' ||
        [...e.attributes].some((a) => /^on/i.test(a.name)) || (e.localName === 'script' && /boom/.test(e.textContent) &&
        !/json|octet/.test(e.type)));
    return bad.map((e) => e.outerHTML.slice(0, 100)).join('; ');
})()"""
SHOWN = """(() => {
    let text = document.documentElement.textContent;
    for (const e of document.querySelectorAll('script, style'))
        text = text.replace(e.textContent, '');
    return text + document.title;
})()"""


def main():
    profile, *files = sys.argv[1:]
    browser = Browser(profile)
    browser.call('Page.addScriptToEvaluateOnNewDocument', source='window.boom = () => window.ran = true;')
    for path in files:
        name = os.path.basename(path)
        browser.call('Page.navigate', url='about:blank')
        browser.call('Page.navigate', url='file://' + path.replace('%', '%25').replace('#', '%23'))
        browser.wait('document.readyState === "complete"')
        browser.wait('!document.getElementById("clock") || document.getElementById("clock").textContent !== ""')
        browser.ask("""(() => { for (const e of document.querySelectorAll('body *')) {
            e.dispatchEvent(new MouseEvent('mouseover')); e.dispatchEvent(new MouseEvent('mousemove')); } return 1})()""")
        time.sleep(.2)
        shown = browser.ask(SHOWN)
        note('%s: nothing of a text is an element' % name, browser.ask(FOREIGN) == '', browser.ask(FOREIGN))
        note('%s: nothing of a text runs' % name, browser.ask('window.ran === undefined') is True, '')
        note('%s: texts are shown' % name, '<img src=x onerror=boom()>' in shown or '</script><b onmouseover' in shown or
             '</svg><script>boom()</script>' in shown or '<b onmouseover>&' in shown, repr(shown[:300]))
    note('no complaint, no request', not browser.complaints, '; '.join(browser.complaints))
    browser.close()


main()
