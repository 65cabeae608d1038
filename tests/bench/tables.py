#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""tables.py FOLDER PAGE...: writes into pages the tables that gicbench measured (`make bench`, into FOLDER).

A page has marks, `<!-- figures: NAME -->` and `<!-- end of figures -->`; what stands between them becomes the table of
that name, with the date, the machine and how busy it was. A table whose measurement is not in FOLDER stays as it is.
Every number is one that gicbench wrote; nothing is computed here but shares, and roundings for people."""
import csv
import os
import re
import sys

NAMES = {
    'cc': 'generated (`cc`)',
    'tape': "`tape`, the generator's formulas interpreted",
    'gic': "`gic`, the paper's method interpreted",
    'gcp1': '`gcp1`, coordinate partitioning',
    'gcp2': '`gcp2`, the same with MUMPS',
}


def table(folder, *path):
    """Rows as dictionaries of lists, because names of columns (low, high) come more than once; None: not measured."""
    name = os.path.join(folder, *path)
    if not os.path.exists(name):
        return None
    with open(name, newline='') as file:
        rows = list(csv.reader(file))
    out = []
    for row in rows[1:]:
        entry = {}
        for key, cell in zip(rows[0], row):
            entry.setdefault(key, []).append(cell)
        out.append(entry)
    return out


def short(text, digits=2):
    """A number with so many digits, or what is no number as it is."""
    try:
        value = float(text)
    except ValueError:
        return text
    if value == 0:
        return '0'
    if abs(value) < 1e-3:
        return '%.0e' % value
    text = '%.*g' % (digits, value)
    return '%.0f' % float(text) if 'e' in text else text


def spread(row, key, which=0):
    """`median (low to high)` of the columns key, and the lowest and highest after it."""
    low = [k for k in row if k in ('low', 'lowest')][0]
    high = [k for k in row if k in ('high', 'highest')][0]
    values = row[key][0], row[low][which], row[high][which]
    if values[0] == '1' == values[1]:
        return '1'
    return '%s (%s to %s)' % tuple(short(v) for v in values)


def inverse(row, which):
    """The same of one over a ratio."""
    try:
        median, low, high = (float(row[k][i]) for k, i in (('ratio', 0), ('lowest', which), ('highest', which)))
    except ValueError:
        return row['ratio'][0]
    if median == 1:
        return '1'
    return '%s (%s to %s)' % tuple(short(1 / v) for v in (median, high, low))


def drive(folder):
    rows = table(folder, 'full_run', 'drive.csv')
    if not rows:
        return None
    head = ['engine', 'slower', 'times real time', 'step, us', 'multibody', 'tires', 'powertrain', 'rest']
    out = []
    for row in rows:
        cells = [row[k + ' [us]'][0] for k in ('step', 'multibody', 'tires', 'powertrain', 'rest')]
        out.append([name_of(row['engine'][0]), inverse(row, 1), short(row['times real time'][0])] +
                   [short(c, 3) for c in cells])
    return head, out, 'full_run'


def name_of(engine):
    return NAMES.get(engine, '`%s`' % engine if engine.startswith('tcc') else engine)


def headline(folder):
    found = drive(folder)
    if not found:
        return None
    wanted = ['cc fast 4 lanes'] + [NAMES[n] for n in ('cc', 'tape', 'gic', 'gcp2')]
    by_name = {r[0]: r for r in found[1]}
    rows = [['generated, 4 lanes of vectors' if n == wanted[0] else n] + by_name[n][1:4]
            for n in wanted if n in by_name]
    return ['engine', 'slower than generated code', 'times real time', 'a step of 6 ms, us'], rows, 'full_run'


def compare(folder):
    constant, variable = table(folder, 'table2.csv'), table(folder, 'table1.csv')
    longest, profile = table(folder, 'worst.csv'), table(folder, 'table3.csv')
    if not (constant and variable and longest and profile):
        return None
    steps = [r['step'][0] for r in constant]
    step = '5 ms' if '5 ms' in steps else '4 ms'
    head = ['engine', 'AB3, %s: slower' % step, 'Adams, 1e-6: slower', 'error of both, m', 'step of 5 ms, us',
            'of which recovery', 'longest step over median']
    out = []
    for row in (r for r in constant if r['step'][0] == step):
        engine = row['engine'][0]
        other = [r for r in variable if r['tolerance'][0] == '1e-06' and r['engine'][0] == engine][0]
        worst = [r for r in longest if r['engine'][0] == engine][0]
        parts = [r for r in profile if r['engine'][0] == engine][0]
        ratio = [k for k in row if k.endswith('is faster by')][0]
        out.append([name_of(engine), spread(row, ratio, 1), spread(other, ratio, 1),
                    '%s, %s' % (short(row['error'][0]), short(other['error'][0])), short(parts['step'][0], 3),
                    short(parts['D'][0], 3), short(worst['over median'][0], 3)])
    return head, out, '.'


def start(folder):
    rows, later, even = table(folder, 'start.csv'), table(folder, 'start_steps.csv'), table(folder, 'break_even.csv')
    if not (rows and later and even):
        return None
    first = next(iter(even[0]))
    against = [k for k in even[0] if k not in ('low', 'high', first)]
    head = ['engine', 'right-hand side over `cc`', 'compiling, ms', 'until the first step, ms'] + \
        ['ahead of `%s` after steps' % k for k in against]
    out = []
    for row in rows:
        engine = row['engine'][0]
        ratio = [r for r in later if r['engine'][0] == engine][0]
        found = [r for r in even if r[first][0] == engine]
        key = [k for k in ratio if k.startswith('right-hand side over')][0]
        out.append(['`%s`' % engine, spread(ratio, key, 2), short(row['compiling [ms]'][0]), short(row['CPU [ms]'][0])] +
                   [short(found[0][k][0]) if found else '' for k in against])
    return head, out, '.'


def rhs(folder):
    rows = table(folder, 'rhs', 'rhs.csv') or table(folder, 'rhs.csv')
    if not rows:
        return None
    head = ['right-hand side of the HMMWV', '`tape` over it', '`gic` over it', 'time, ns', 'share of the limit']
    out = [[r['variant'][0], short(r['tape over it'][0]), short(r['gic over it'][0]), short(r['time [ns]'][0], 3),
            short(r['part of it'][0])] for r in rows if not r['variant'][0].startswith(('tape', 'gic', 'gcp'))]
    return head, out, 'rhs' if os.path.exists(os.path.join(folder, 'rhs', 'rhs.csv')) else '.'


def batch(folder):
    rows = table(folder, 'batch', 'batch.csv')
    if not rows:
        return None
    out = [[r['way'][0], short(r['throughput'][0]), short(r['time, us'][0])] for r in rows]
    return ['64 vehicles', 'throughput', 'a step of one, us'], out, 'batch'


def scenes(folder):
    rows = table(folder, 'scenes', 'scenes.csv')
    if not rows:
        return None
    head = ['scene', 'operations', 'time (lowest to highest)', 'results differ by']
    out = [['`%s`' % r['scene'][0].replace('.scene', ''), short(r['operations ratio'][0]), spread(r, 'time ratio'),
            short(r['difference'][0], 1)] for r in rows]
    return head, out, 'scenes'


def precision(folder):
    """A row a scene: AB3 and RK4 at its own step, where contacts change with these located, too, and the least time for
    two errors. `below ..`: 0 in comparisons."""
    out = []
    for number in range(1, 100):
        rows = table(folder, 'precision', 'precision%d.csv' % number)
        if not rows:
            break
        good = [r for r in rows if r['CPU [ms]'][0] != '-']
        step = rows[0]['step or tolerance'][0]

        def at_step(way):
            found = [r for r in good if r['way'][0].startswith(way) and r['step or tolerance'][0] == step]
            told = [('located ' if 'located' in r['way'][0] else '', short(r['error [m]'][0]), short(r['CPU [ms]'][0]))
                    for r in found if r is found[0] or 'located' in r['way'][0]]
            return '; '.join('%s%s m, %s ms' % cell for cell in told) or '-'

        def least(most):
            found = [r for r in good if float(r['error [m]'][0].replace('below ', '')) <= most]
            best = min(found, key=lambda r: float(r['CPU [ms]'][0]), default=None)
            return best and '%s, %s: %s ms' % (best['way'][0], best['step or tolerance'][0], short(best['CPU [ms]'][0])) or 'none'

        dual = [r['way'][0] for r in rows if 'dual' in r['way'][0]][:1] or ['ab3, one rate']
        out.append(['`%s`, %s' % (rows[0]['scene'][0].replace('.scene', ''), step), at_step(dual[0].split(' 1:')[0]),
                    at_step('rk4'), least(1e-3), least(1e-5)])
    head = ['scene, its step', 'AB3, dual rate', 'RK4', 'least time within 1 mm', 'within 0.01 mm']
    return (head, out, 'precision') if out else None


def parts(folder):
    name = os.path.join(folder, 'parts.csv')
    rows = table(folder, 'parts.csv') if os.path.exists(name) else None
    if not rows:
        return None
    out = [['`%s`' % r['part'][0], r['s'][0], r['load before'][0]] for r in rows]
    return ['part', 's', 'others at work'], out, None


MAKERS = {f.__name__: f for f in (headline, drive, compare, start, rhs, batch, scenes, precision, parts)}


def said(folder, where):
    """When and on what it was measured, in a sentence."""
    if where is None:
        return None
    with open(os.path.join(folder, where, 'bench.txt')) as file:
        text = file.read()
    processor = re.search(r'^Processor: (.*), (\d+) online', text, re.M)
    compiler = re.search(r'^Compiler of generated code: (.*)$', text, re.M).group(1)
    date = re.search(r'(\d{4}-\d\d-\d\d) \d\d:\d\d UTC', text).group(1)
    quick = ', 3 repetitions' if '(quick' in text else ', 9 repetitions'
    load = {r['part'][0]: r['load before'][0] for r in table(folder, 'parts.csv') or []}
    part = {'full_run': 'drive', '.': 'compare'}.get(where, where)
    busy = ' shared with %s other running programs' % load[part] if float(load.get(part, 0)) >= 1 else ''
    return '%s, one of %s processors %s%s, %s%s.' % (date, processor.group(2), processor.group(1), busy, compiler, quick)


def text_of(name, folder):
    made = MAKERS[name](folder)
    if not made:
        return None
    head, rows, where = made
    lines = ['| ' + ' | '.join(head) + ' |', '|---' * len(head) + '|']
    lines += ['| ' + ' | '.join(row) + ' |' for row in rows]
    note = said(folder, where)
    return '\n'.join(lines + (['', note] if note else []) + [''])


def main():
    folder, pages = sys.argv[1], sys.argv[2:]
    written = 0
    for page in pages:
        with open(page) as file:
            text = file.read()

        def replace(match):
            nonlocal written
            if match.group(1) not in MAKERS:
                sys.exit('tables.py: error: %s has a mark for %r, which is no table' % (page, match.group(1)))
            new = text_of(match.group(1), folder)
            written += new is not None
            return match.group(0) if new is None else '<!-- figures: %s -->%s<!-- end of figures -->' % (
                match.group(1), '\n' + new)

        new = re.sub(r'<!-- figures: (\w+) -->\n(?:.*?\n)??<!-- end of figures -->', replace, text, flags=re.S)
        if new != text:
            with open(page + '.tmp', 'w') as file:
                file.write(new)
            os.replace(page + '.tmp', page)
    print('%d tables written' % written)
    if not written:
        sys.exit('tables.py: error: %s has no measurements; remedy: `make bench` first' % folder)


main()
