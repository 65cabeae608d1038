#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# width.py PROFILE PAGE...: opens benchmark pages in chromium, 1280 pixels wide: nothing is wider than the window, no
# number is broken over lines. Prints `good NAME` or `bad NAME: why` for each check.
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'animate'))
from chromium import Browser, note  # noqa: E402

# Cells that begin with a digit or a sign and have more than one line of text.
BROKEN = '''[...document.querySelectorAll("td")].filter((td) => /^[-0-9]/.test(td.textContent)).filter((td) => {
    const range = document.createRange();
    range.selectNodeContents(td);
    return new Set([...range.getClientRects()].map((r) => Math.round(r.top))).size > 1;
}).map((td) => td.textContent)'''


def main():
    profile, *pages = sys.argv[1:]
    browser = Browser(profile)
    browser.call('Emulation.setDeviceMetricsOverride', width=1280, height=800, deviceScaleFactor=1, mobile=False)
    for page in pages:
        name = os.path.basename(os.path.dirname(page))
        browser.call('Page.navigate', url='file://' + page)
        browser.wait('document.readyState === "complete" && document.querySelectorAll("td").length > 0')
        wide = browser.ask('[document.documentElement, ...document.querySelectorAll(".wide")]'
                           '.map((e) => e.scrollWidth - e.clientWidth)')
        note(name + ': no sideways scrolling at 1280 pixels', wide and max(wide) <= 0, str(wide))
        broken = browser.ask(BROKEN)
        note(name + ': numbers stay in one piece', broken == [], str(broken))
    note('no complaint, no request', not browser.complaints, '; '.join(browser.complaints))
    browser.close()


main()
