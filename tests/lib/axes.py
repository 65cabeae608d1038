#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""axes.py numbers SVG: numbers along the axes of gnuplot's picture are in it, different ones along an axis, and not over each
other. axes.py inks SOURCE PAGE: colours of curves (runtime/host/axis.c and templates/animate_ink.js.in) are the same in both,
stand out from their ground, and protanopes and deuteranopes tell them apart, as Vienot, Brettel and Mollon (1999) simulate
what they see. axes.py page PAGE FILE: writes a page that prints what axes of pages read. Exit status 1 with what is wrong."""
import math
import re
import sys
import xml.etree.ElementTree as tree

CHARACTER, HEIGHT = 7.5, 10  # pixels of a number at 13 pixels, above its base
APART = 12  # distance in L* a* b* that people tell apart in thin lines
CONTRAST = 3  # of graphics against their ground (WCAG 2.1, 1.4.11)


def texts(element, x=0.0, y=0.0, anchor="start"):
    """x, y, anchor and text of what does not stand upright."""
    transform = element.get("transform") or ""
    if "rotate" in transform:
        return
    move = re.match(r"translate\(([-\d.]+),\s*([-\d.]+)\)", transform)
    if move:
        x, y = x + float(move[1]), y + float(move[2])
    anchor = element.get("text-anchor", anchor)
    if element.tag.endswith("text") and "".join(element.itertext()).strip():
        yield x, y, anchor, "".join(element.itertext()).strip()
    for child in element:
        yield from texts(child, x, y, anchor)


def numbers(path):
    found = [text for text in texts(tree.parse(path).getroot()) if re.fullmatch(r"[-+.\de]+", text[3])]
    assert len(found) > 20, found
    boxes = []
    for x, y, anchor, text in found:
        width = CHARACTER * len(text)
        left = x - (width if anchor == "end" else width / 2)
        assert left >= 0 and left + width <= 900, (text, left)
        for other in boxes:
            apart = left >= other[1] or other[0] >= left + width or y - HEIGHT >= other[2] or other[2] - HEIGHT >= y
            assert apart, f"{text} over {other[3]}"
        boxes.append((left, left + width, y, text, anchor))
    axis, last = set(), None
    for _, _, y, text, anchor in sorted(boxes, key=lambda box: (box[4], box[2])):
        # along x they stand in a row; along y they fall from the top of a diagram to its bottom
        if last is None or anchor != last[1] or (float(text) > last[2] if anchor == "end" else y - last[0] > 1):
            axis = set()
        assert text not in axis, (text, anchor)
        axis.add(text)
        last = y, anchor, float(text)


def linear(ink):
    channels = [int(ink[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055)**2.4 for c in channels]


def seen(color, who):
    """Of linear red, green and blue: by everybody, a protanope or a deuteranope."""
    r, g, b = color
    long, middle = 17.8824 * r + 43.5161 * g + 4.11935 * b, 3.45565 * r + 27.1554 * g + 3.86714 * b
    short = 0.0299566 * r + 0.184309 * g + 1.46709 * b
    if who == "protanope":
        long = 2.02344 * middle - 2.52581 * short
    if who == "deuteranope":
        middle = 0.494207 * long + 1.24827 * short
    return [0.0809444479 * long - 0.130504409 * middle + 0.116721066 * short,
            -0.0102485335 * long + 0.0540193266 * middle - 0.113614708 * short,
            -0.000365296938 * long - 0.00412161469 * middle + 0.693511405 * short]


def lab(color):
    r, g, b = (min(max(c, 0), 1) for c in color)
    white = ((0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.9505, 0.2126 * r + 0.7152 * g + 0.0722 * b,
             (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.089)
    x, y, z = (t**(1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116 for t in white)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def luminance(ink):
    r, g, b = linear(ink)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


def inks(source, page):
    with open(source) as file:
        of_source = re.findall(r"#[0-9a-f]{6}", re.search(r"ink\[.*?\] = \{(.*?)\}", file.read(), re.S)[1])
    with open(page) as file:
        text = file.read()
    dark_on_light, light_on_dark = (re.findall(r"#[0-9a-f]{6}", re.search(rf"const {name} = \[(.*?)\]", text)[1])
                                    for name in ("inks", "light_inks"))
    assert of_source == dark_on_light and len(of_source) > 6, (of_source, dark_on_light)
    for ink in dark_on_light:
        assert 1.05 / (luminance(ink) + 0.05) >= CONTRAST, ink
    for ink in light_on_dark:
        assert (luminance(ink) + 0.05) / (luminance("#20262c") + 0.05) >= CONTRAST, ink
    for which in (dark_on_light, light_on_dark):
        for who in ("all", "protanope", "deuteranope"):
            place = [lab(seen(linear(ink), who)) for ink in which]
            for i, a in enumerate(place):
                for j in range(i):
                    assert math.dist(a, place[j]) >= APART, (which[i], which[j], who, math.dist(a, place[j]))


PROGRAM = """
const ranges = [[0, 1], [-1, 1], [1e5, 1.2e5], [0, 1e12], [0, 1e-12], [1e6, 1e6 + 1], [-1e5 - 2, -1e5], [1000, 1000.1],
    [123456, 123457], [-3e-5, 7e-5], [-250, -249.99], [1e-4, 1.1e-4], [0, 99999], [-99999, 100001], [1.5, 1.50001], [7, 7 + 1e-9]];
let said = "";
for (const [low, high] of ranges)
    for (const most of [2, 3, 5, 8]) {
        const axis = scale_of(low, high, most), seen = new Set();
        for (let k = axis.from; k <= axis.to; ++k) {
            const text = tick_text(k, axis.step), far = Math.abs(Number(text) - k * axis.step);
            if (seen.has(text) || !(far <= 1e-6 * axis.step + 1e-15 * Math.abs(k * axis.step)))
                said += `${low} to ${high}: ${text} at ${k * axis.step}; `;
            seen.add(text);
        }
        if (!(axis.low <= low + 1e-5 * axis.step && axis.high >= high - 1e-5 * axis.step))
            said += `${low} to ${high} is cut off; `;
    }
document.body.textContent = said || "different numbers";
"""


def page(ink, vectors, path):
    """The functions of a page's axes, with ranges nice and nasty."""
    def function(text, name):
        return re.search(rf"^function {name}\(.*?^\}}$", text, re.S | re.M)[0]
    with open(ink) as file:
        text = file.read()
    with open(vectors) as file:
        other = file.read()
    clamp = re.search(r"^const clamp = .*$", other, re.M)[0]
    parts = [clamp, function(other, "nice"), function(text, "scale_of"), function(text, "tick_text"), PROGRAM]
    with open(path, "w") as file:
        file.write("<!DOCTYPE html><body></body><script>" + "\n".join(parts) + "</script>")


if __name__ == "__main__":
    {"numbers": numbers, "inks": inks, "page": page}[sys.argv[1]](*sys.argv[2:])
