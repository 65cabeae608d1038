#!/usr/bin/python3
# SPDX-License-Identifier: MIT
# drive.py PAGE.html FOLDER WIDTHxHEIGHT...: drives in a page of --drive for ten seconds at each size and says how many
# pictures came a second, how much time of the processor chromium's process that draws and the page's own took for one, at
# which of its qualities (0: best) the page arrived, and what a step took. For drive.sh.
import glob
import os
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'data', 'animate'))

from chromium import Browser  # noqa: E402


def processes(first):
    """Seconds of the processor so far, by what chromium's processes are for; `first` is the number of the first one."""
    parent, used, kind = {}, {}, {}
    for path in glob.glob('/proc/[0-9]*'):
        try:
            with open(path + '/stat') as file:
                fields = file.read().rsplit(')', 1)[1].split()
            with open(path + '/cmdline') as file:
                words = file.read()
        except OSError:
            continue
        number = int(os.path.basename(path))
        parent[number] = int(fields[1])
        used[number] = (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')
        kind[number] = next((k for k in ('gpu-process', 'renderer') if '--type=' + k in words), 'other')
    total = {'gpu-process': 0, 'renderer': 0, 'other': 0}
    for number in parent:
        above = number
        while above in parent and above != first:
            above = parent[above]
        if above == first:
            total[kind[number]] += used[number]
    return total


def main():
    page, folder, *sizes = sys.argv[1:]
    print('| window | frames a second | drawing, ms of a processor a frame | page and steps, ms a frame | quality | '
          'a step, us | others at work |')
    print('|---|---|---|---|---|---|---|')
    for size in sizes:
        # the window is put together by the processor, as where there is no graphics card
        browser = Browser(os.path.join(folder, size), '--disable-gpu-compositing')
        width, tall = (int(x) for x in size.split('x'))
        browser.call('Emulation.setDeviceMetricsOverride', width=width, height=tall, deviceScaleFactor=1, mobile=False)
        browser.open(page)
        browser.wait('live.time > 0.5', 60)
        time.sleep(8)  # the page finds its quality
        first, begun, frames = processes(browser.process.pid), time.time(), browser.ask('state.frames')
        time.sleep(10)
        frames = browser.ask('state.frames') - frames
        seconds, last = time.time() - begun, processes(browser.process.pid)
        cost = {k: 1e3 * (last[k] - first[k]) / max(frames, 1) for k in last}
        print('| %s | %.1f | %.1f | %.1f | %d | %.0f | %.0f |' % (
            size, frames / seconds, cost['gpu-process'], cost['renderer'], browser.ask('pace.quality'),
            browser.ask('1000 * state.took / state.steps'), os.getloadavg()[0]), flush=True)
        browser.close()
        os.close(browser.to)
        os.close(browser.back)


main()
