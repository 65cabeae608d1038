# SPDX-License-Identifier: MIT
"""pages.py, for pages.sh, with hostile names and texts:

write                   a model text_N.veh for each text; prints the number of names and that of texts
name N                  prints name number N and an x
csv FILE N              a table whose head must have text number N in a cell, ends of lines in it as blanks
svg FILE N              a picture that must show text number N
page FILE N HARMLESS    a page that must show text number N and have the tags of another one
tables FOLDER           all tables of a report must have rows of the same number of cells

The last four print what is wrong, or nothing."""
import csv
import glob
import html.parser
import json
import os
import re
import sys
import xml.etree.ElementTree

BACK = chr(96)
# of files, which can't have a slash
NAMES = [
    "plain", "two words", "it's", "'; system(\"touch spoilt\"); '", "a'\nsystem('touch spoilt')\nset title 'b",
    "a\nsystem(\"touch spoilt\")\n", f"{BACK}touch spoilt{BACK}", f"a\n{BACK}touch spoilt{BACK}", "$(touch spoilt)",
    "\"; touch spoilt; \"", "|touch spoilt; cat >", "-e system('touch spoilt')", "~root", "a,b", "%s%n%d", "<b>&amp;",
    "a\\nb\\", "\u00e9\u6f22", "@x", "a\tb", "#a", "$data", "a\"b", "]]>",
]
TEXTS = NAMES + ["</script><script>alert(1)</script><!--", "a\",\"b", "m [s], kg", "x\ny", "PREFIX UPPER",
                 "<!--@data@-->"]
MODEL = """gicgen: 1
model: car
description: %s
base: ground
bodies: {arm: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}}
joints: {pin: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}}
coordinates: {w: {type: angle, bodies: [ground, arm], axis: [0, 1, 0]}}
inputs: {u: {unit: %s}}
parameters: {p: {value: 1, tunable: true, unit: %s}}
forces: {f: {type: force, coordinate: w, value: p * u}}
outputs: {tip: {type: position, body: arm}}
"""


class Page(html.parser.HTMLParser):
    """Tags with the names of their attributes, and what is to be read, in attributes and in JSON too."""

    def __init__(self, path):
        super().__init__()
        self.tags, self.words = [], []
        with open(path, encoding="utf-8") as file:
            self.feed(file.read())

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, [key for key, _ in attrs]))

    def handle_data(self, data):
        self.words.append(data)
        if data.lstrip().startswith("{") and '"channels"' in data:
            self.words += strings(json.loads(data))


def strings(value):
    if isinstance(value, str):
        return [value]
    return [s for part in (value.values() if isinstance(value, dict) else value if isinstance(value, list) else [])
            for s in strings(part)]


def cells(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    lengths = sorted({len(row) for row in rows})
    if len(rows) < 2 or len(lengths) != 1:
        print(f"{path} has {len(rows)} rows of {lengths} cells")
    return rows


def look(what, path, text, harmless):
    if what == "csv":
        plain = re.sub("[\x00-\x1f]", " ", text)
        rows = cells(path)
        if not any(plain in cell for cell in rows[0]):
            print(f"{path}: no such cell in {rows[0]}")
    elif what == "svg":
        # where lines break and how wide blanks are is up to gnuplot
        words = "".join(xml.etree.ElementTree.parse(path).getroot().itertext())
        if re.sub(r"\s", "", text) not in re.sub(r"\s", "", words):
            print(f"{path}: not in the picture")
    elif what == "page":
        page = Page(path)
        if page.tags != Page(harmless).tags:
            print(f"{path}: other tags")
        if not any(text in word for word in page.words):
            print(f"{path}: not on the page")


def main():
    what, argument = sys.argv[1], sys.argv[2:]
    if what == "write":
        for i, text in enumerate(TEXTS):
            with open(f"text_{i}.veh", "w", encoding="utf-8") as file:
                file.write(MODEL % ((json.dumps(text, ensure_ascii=False),) * 3))
        print(len(NAMES), len(TEXTS))
    elif what == "name":
        sys.stdout.write(NAMES[int(argument[0])] + "x")
    elif what == "tables":
        for path in glob.glob(os.path.join(glob.escape(argument[0]), "*.csv")):
            cells(path)
    else:
        look(what, argument[0], TEXTS[int(argument[1])], *(argument[2:] or [None]))


main()
