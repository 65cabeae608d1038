# SPDX-License-Identifier: MIT
"""kc_figures.py ROOT [--check]: draws the figure of each column of models/KC.md: models/kc/COLUMN.svg, and all of them in
templates/kc_figures.html.in for the page of `gicrun --kc --report`. One table, FIGURES, in one style: grey what is there,
black the vehicle, blue what the column says. --check: compares with the files, writes nothing."""
import math
import os
import sys

GREY, INK, BLUE = "#999", "#222", "#1f6fb2"


class Figure:
    def __init__(self):
        self.parts = []

    def line(self, *p, color=INK, width=1.5, dash=False, closed=False):
        d = " ".join(f"{'L' if i else 'M'}{x:g} {y:g}" for i, (x, y) in enumerate(p)) + (" z" if closed else "")
        self.parts.append(f'<path d="{d}" fill="none" stroke="{color}" stroke-width="{width:g}"' + (' stroke-dasharray="5 3"' if dash else "") + "/>")
        return self

    def text(self, x, y, s, color=INK, at="start"):
        self.parts.append(f'<text x="{x:g}" y="{y:g}" fill="{color}" text-anchor="{at}">{s}</text>')
        return self

    def dot(self, x, y, s="", dx=6, dy=-4, color=INK):
        self.parts.append(f'<circle cx="{x:g}" cy="{y:g}" r="3" fill="{color}"/>')
        return self.text(x + dx, y + dy, s, color, "end" if dx < 0 else "start") if s else self

    def arrow(self, x0, y0, x1, y1, color=BLUE, both=False):
        self.line((x0, y0), (x1, y1), color=color)
        for (ax, ay), (bx, by) in (((x0, y0), (x1, y1)), ((x1, y1), (x0, y0)))[: 2 if both else 1]:
            way = math.atan2(by - ay, bx - ax)
            tip = [(round(bx - 7 * math.cos(way + s), 1), round(by - 7 * math.sin(way + s), 1)) for s in (0.4, -0.4)]
            self.line(tip[0], (bx, by), tip[1], color=color)
        return self

    def size(self, x0, y0, x1, y1, s, dx=0, dy=-5, at="middle"):
        return self.arrow(x0, y0, x1, y1, both=True).text((x0 + x1) / 2 + dx, (y0 + y1) / 2 + dy, s, BLUE, at)

    def arc(self, x, y, r, a0, a1, s="", dx=4, dy=0, at="start"):
        """From angle a0 to a1, degrees, counted from the right to the top."""
        p = [(round(x + r * math.cos(math.radians(a)), 1), round(y - r * math.sin(math.radians(a)), 1))
             for a in [a0 + (a1 - a0) * i / 12 for i in range(13)]]
        self.line(*p[:-1], color=BLUE)
        self.arrow(*p[-2], *p[-1])
        mx, my = p[6]
        return self.text(mx + dx, my + dy, s, BLUE, at) if s else self

    def axes(self, right, up):
        return self.arrow(12, 30, 12, 10, GREY).arrow(12, 30, 32, 30, GREY).text(16, 14, up, GREY).text(34, 34, right, GREY)


def tilted(x, y, half_w, half_h, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return [(round(x + a * c + b * s, 1), round(y - a * s + b * c, 1)) for a, b in
            ((-half_w, -half_h), (half_w, -half_h), (half_w, half_h), (-half_w, half_h))]


def behind(lean=0, x=90):
    """A left wheel seen from behind, on the road at y = 150; inward is to the right."""
    f = Figure().line((20, 150), (260, 150), color=GREY)
    f.line(*tilted(x, 95, 14, 55, lean), closed=True)
    return f.dot(x, 95, "C", -6).dot(x - 55 * math.sin(math.radians(-lean)), 150, "P", -6, 14)


def kingpin(x=90):
    return behind(0, x).line((x + 40, 150), (x + 70, 25), color=BLUE, width=2)


def beside():
    """A left wheel seen from the left, forward is to the left; the road at y = 150."""
    f = Figure().line((20, 150), (260, 150), color=GREY)
    f.parts.append('<circle cx="100" cy="95" r="55" fill="none" stroke="#222" stroke-width="1.5"/>')
    return f.dot(100, 95, "C", 6, -6).dot(100, 150, "P", 6, 14)


def caster():
    return beside().line((86, 150), (118, 20), color=BLUE, width=2)


def above(left=0, right=0):
    """An axle from above, forward is up, left to the left; wheels turned to the left by degrees."""
    f = Figure().line((60, 90), (220, 90), color=GREY)
    return f.line(*tilted(60, 90, 8, 32, left), closed=True).line(*tilted(220, 90, 8, 32, right), closed=True)


def axle():
    """An axle from behind, on the road at y = 150."""
    f = Figure().line((10, 150), (270, 150), color=GREY).line((60, 110), (220, 110), color=GREY)
    for x in (60, 220):
        f.line(*tilted(x, 110, 10, 40, 0), closed=True).dot(x, 150)
    return f


def curve(x, y, slope):
    """A quantity over another one, with its tangent."""
    f = Figure().arrow(40, 140, 250, 140, GREY).arrow(40, 140, 40, 20, GREY).text(250, 155, x, GREY, "end").text(46, 24, y)
    f.line(*[(50 + 10 * i, round(130 - 0.28 * i * i, 1)) for i in range(19)])
    return f.line((86, 139.7), (230, 55), color=BLUE, width=2).dot(155, 99.1).text(140, 62, slope, BLUE, "end")


def moved(word, dx, dy, s, at="C"):
    f = behind()
    y = 95 if at == "C" else 150
    return f.line(*tilted(90 + 45, 80, 14, 55, -8), color=GREY, dash=True, closed=True).arrow(90, y, 90 + dx, y + dy).text(165, y + 4, s, BLUE).text(165, 30, word, GREY)


def pole_front():
    return behind(-4).dot(250, 100, "pole", -6, -6).line((90, 150), (250, 100), color=GREY, dash=True)


def pole_side():
    return beside().dot(240, 90, "pole", -4, -8).line((100, 150), (240, 90), color=GREY, dash=True)


def roll():
    f = axle().line((60, 150), (140, 118), color=GREY, dash=True).line((220, 150), (140, 118), color=GREY, dash=True)
    return f.dot(140, 118, "", color=BLUE).arrow(60, 150, 50, 125, INK).arrow(220, 150, 210, 175, INK).text(36, 120, "P'", INK)


def turn():
    """A left turn from above: front wheels, the line of the unsteered axle, the centre of the curve."""
    f = Figure().line((20, 140), (260, 140), color=GREY, dash=True).dot(30, 140, "centre", 0, 16)
    for x, a in ((150, 40), (230, 27)):
        f.line((x, 60), (30, 140), color=GREY).line(*tilted(x, 60, 5, 18, math.degrees(math.atan2(80, x - 30))), closed=True)
    return f.text(200, 155, "unsteered axle", GREY).text(150, 36, "inner", INK, "middle").text(232, 36, "outer", INK, "middle")


def car(front):
    """A vehicle from the left, forward is to the left, with the support line of one axle."""
    f = Figure().line((10, 150), (270, 150), color=GREY)
    for x in (60, 220):
        f.parts.append(f'<circle cx="{x}" cy="128" r="22" fill="none" stroke="#222" stroke-width="1.5"/>')
    f.dot(140, 80, "centre of mass", 6, -6).size(60, 165, 220, 165, "L", 0, -3).size(140, 80, 140, 150, "h", 8, 4, "start")
    return f


FIGURES = {  # column: (of what, figure)
    "travel": ("wheel", lambda: behind().size(130, 95, 130, 55, "travel of C, up", 6, 4, "start").line((90, 55), (140, 55), color=GREY, dash=True)),
    "camber": ("wheel", lambda: behind(12).line((101, 150), (101, 20), color=GREY, dash=True).line((101, 149), (74, 22), color=BLUE).arc(101, 149, 105, 90, 102, "camber &gt; 0: top outward", 18, -6)),
    "toe": ("wheel", lambda: above(-10, 10).line((60, 90), (60, 30), color=GREY, dash=True).arc(60, 90, 50, 90, 80, "toe &gt; 0", 10, -4).text(140, 20, "forward", GREY, "middle").arrow(140, 60, 140, 25, GREY)),
    "steer": ("wheel", lambda: above(20, 20).line((60, 90), (60, 30), color=GREY, dash=True).line((60, 90), (40, 34), color=BLUE).arc(60, 90, 52, 90, 110, "steer &gt; 0: left", 18, -6)),
    "camber_rate": ("wheel", lambda: curve("travel", "camber", "camber_rate")),
    "toe_rate": ("wheel", lambda: curve("travel", "toe", "toe_rate")),
    "centre_x": ("wheel", lambda: beside().arrow(100, 95, 60, 95).text(30, 90, "centre_x &gt; 0", BLUE).text(175, 40, "C moved forward", GREY)),
    "centre_y": ("wheel", lambda: behind().line(*tilted(55, 85, 14, 55, 8), color=GREY, dash=True, closed=True).arrow(90, 95, 58, 95).text(120, 90, "centre_y &gt; 0:", BLUE).text(120, 104, "C moved to the left", BLUE)),
    "contact_x": ("wheel", lambda: beside().size(100, 160, 240, 160, "contact_x of P", 0, 14).line((240, 20), (240, 165), color=GREY, dash=True).text(236, 16, "origin", GREY, "end")),
    "contact_y": ("wheel", lambda: behind().line((230, 20), (230, 165), color=GREY, dash=True).size(90, 160, 230, 160, "contact_y of P", 0, 14).text(226, 16, "middle y = 0", GREY, "end")),
    "contact_z": ("wheel", lambda: behind().line((20, 125), (260, 125), color=GREY, dash=True).text(260, 120, "z = 0 of the drawing", GREY, "end").size(150, 125, 150, 150, "contact_z (here &lt; 0)", 6, 4, "start")),
    "front_arm": ("wheel", lambda: pole_front().size(90, 164, 250, 164, "front_arm &gt; 0", 0, 13).line((250, 100), (250, 168), color=GREY, dash=True)),
    "front_angle": ("wheel", lambda: pole_front().arc(90, 150, 80, 0, 17, "front_angle &gt; 0", 2, 14)),
    "side_arm": ("wheel", lambda: pole_side().size(100, 164, 240, 164, "side_arm &gt; 0", 0, 13).line((240, 90), (240, 168), color=GREY, dash=True)),
    "side_angle": ("wheel", lambda: pole_side().arc(100, 150, 90, 0, 23, "side_angle", 6, 2)),
    "brake_angle": ("wheel", lambda: pole_side().arc(100, 150, 90, 0, 23, "brake_angle", 6, 2).arrow(100, 150, 160, 150, INK).text(170, 30, "locked wheel: force at P", GREY, "middle")),
    "drive_angle": ("wheel", lambda: beside().dot(240, 60, "pole", -4, -8).line((100, 95), (240, 60), color=GREY, dash=True).line((100, 95), (250, 95), color=GREY).arc(100, 95, 95, 0, 14, "drive_angle", 6, 2).text(190, 30, "by shafts: from C", GREY, "middle")),
    "force": ("wheel", lambda: behind().arrow(90, 172, 90, 154).text(104, 168, "force of the road on the wheel", BLUE)),
    "wheel_rate": ("wheel", lambda: curve("height of P", "force", "wheel_rate")),
    "motion_ratio": ("wheel", lambda: behind().line((104, 110), (230, 118)).dot(230, 118).line((160, 112), (190, 30), color=BLUE, width=3).text(180, 26, "x of the element", BLUE).size(50, 95, 50, 60, "z", -6, 4, "end").text(20, 16, "ratio.ELEMENT = dx/dz", BLUE)),
    "kingpin_inclination": ("wheel", lambda: kingpin().line((130, 150), (130, 30), color=GREY, dash=True).arc(130, 150, 105, 90, 77, "kingpin_inclination &gt; 0", 24, 4)),
    "scrub_radius": ("wheel", lambda: kingpin().dot(130, 150, "G", 6, 14, BLUE).size(90, 160, 130, 160, "scrub_radius &gt; 0", 30, 14, "start")),
    "kingpin_offset": ("wheel", lambda: kingpin().dot(143, 95, "H", 6, -4, BLUE).size(90, 95, 143, 95, "kingpin_offset &gt; 0", 40, 20, "start")),
    "caster": ("wheel", lambda: caster().line((86, 150), (86, 20), color=GREY, dash=True).arc(86, 150, 122, 90, 76, "caster &gt; 0", 20, 0)),
    "caster_trail": ("wheel", lambda: caster().dot(86, 150, "G", -6, 14, BLUE).size(86, 164, 100, 164, "caster_trail &gt; 0: G ahead of P", 14, 4, "start")),
    "caster_offset": ("wheel", lambda: beside().line((60, 150), (92, 20), color=BLUE, width=2).dot(73.5, 95, "H", -6, -4, BLUE).size(73.5, 95, 100, 95, "caster_offset &gt; 0: H ahead of C", 20, 24, "start")),
    "track": ("axle", lambda: axle().size(60, 162, 220, 162, "track", 0, 14)),
    "track_rate": ("axle", lambda: curve("travel", "track", "track_rate")),
    "roll_centre_height": ("axle", lambda: roll().size(140, 150, 140, 118, "roll_centre_height", 0, -32, "middle").text(140, 30, "normals of P' meet", GREY, "middle")),
    "roll_centre_y": ("axle", lambda: roll().line((140, 20), (140, 160), color=GREY, dash=True).text(140, 16, "y = 0 of the drawing", GREY, "middle").text(140, 90, "roll_centre_y (here 0)", BLUE, "middle")),
    "roll_centre_force": ("axle", lambda: axle().arrow(90, 165, 62, 165, INK).arrow(250, 165, 222, 165, INK).text(156, 172, "equal forces", INK, "middle").arrow(180, 118, 140, 118).size(140, 150, 140, 118, "roll_centre_force", 0, -32, "middle")),
    "roll_rate": ("axle", lambda: axle().line((40, 134), (240, 166), color=GREY, dash=True).arc(140, 150, 105, 180, 171, "roll angle", 8, -12).arrow(60, 175, 60, 154).arrow(220, 154, 220, 172).text(140, 40, "roll_rate = sum y dF / d(angle)", BLUE, "middle")),
    "anti_brake": ("axle", lambda: car(True).line((60, 150), (240, 100), color=BLUE).arc(60, 150, 60, 0, 16, "brake_angle", 6, 4).text(140, 30, "anti_brake = tan(brake_angle) L / h", BLUE, "middle")),
    "anti_drive": ("axle", lambda: car(False).line((220, 128), (60, 88), color=BLUE).line((220, 128), (150, 128), color=GREY).arc(220, 128, 60, 180, 166, "drive_angle", 4, -14, "start").text(140, 30, "anti_drive = tan(drive_angle) L / h", BLUE, "middle")),
    "mean_steer": ("axle", lambda: above(24, 16).line((60, 90), (40, 45), color=INK).line((220, 90), (207, 45), color=INK).text(140, 150, "mean_steer: of both steer angles", BLUE, "middle").text(140, 168, "steer &gt; 0 to the left", GREY, "middle")),
    "steering_ratio": ("axle", lambda: curve("mean_steer", "steering coordinate", "steering_ratio")),
    "turning_radius": ("axle", lambda: turn().arrow(30, 140, 228, 62).text(120, 92, "turning_radius", BLUE)),
    "ackermann_error": ("axle", lambda: turn().line((150, 60), (60, 140), color=BLUE).arc(150, 60, 70, 214, 222, "", 0, 0).text(16, 40, "ackermann_error:", BLUE).text(16, 54, "inner less ideal", BLUE)),
    "ackermann": ("axle", lambda: turn().text(20, 16, "ackermann = (inner - outer) / (ideal inner - outer)", BLUE)),
    "loads": ("load", lambda: behind().arrow(90, 150, 45, 150, BLUE).text(72, 142, "lateral", BLUE, "end").arrow(90, 95, 45, 95, BLUE).text(72, 88, "hub_lateral", BLUE, "end").arrow(90, 175, 90, 154).text(98, 170, "vertical", BLUE).arrow(90, 95, 90, 60).text(98, 66, "hub_vertical", BLUE).arc(90, 40, 16, 200, 340, "aligning, about z", 26, -14).text(150, 120, "longitudinal at P,", BLUE).text(150, 134, "hub_longitudinal at C:", BLUE).text(150, 148, "along x", BLUE)),
    "gives": ("load", lambda: moved("the loaded wheel", 40, -12, "centre_x, centre_y,").text(165, 112, "centre_z of C", BLUE).arrow(90, 150, 128, 142).text(150, 134, "contact_x, contact_y,", BLUE).text(150, 146, "contact_z of P", BLUE).text(150, 54, "steer, toe, camber, turn", BLUE)),
    "carries": ("load", lambda: Figure().line((20, 60), (110, 90), width=4, color=GREY).text(20, 52, "a, the first body", GREY)
                .line((110, 90), (150, 30), (190, 60), width=4).text(160, 28, "b, the second body").dot(110, 90).arrow(110, 90, 70, 120).text(64, 134, "force.x .y .z on b", BLUE, "middle")
                .arc(110, 90, 20, -60, 60, "torque.x .y .z on b", 6, 8).line((190, 60), (262, 76)).dot(190, 60).dot(262, 76)
                .arrow(215, 52, 192, 47).arrow(237, 57, 260, 62).text(200, 44, "rod: tension &gt; 0", BLUE)
                .line((150, 150), (262, 150), width=4, color=GREY).line((262, 76), (262, 150)).arrow(150, 150, 120, 150).text(116, 154, "holds", BLUE, "end").text(200, 168, "steering, held", GREY, "middle")),
}


def svg(name, indent=""):
    f = FIGURES[name][1]()
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 280 180" width="280" height="180" font-family="sans-serif" font-size="10">'
    rows = [head, f"<title>{name}</title>", *f.parts]
    return "\n".join(indent + r for r in rows) + "\n" + indent + "</svg>\n"


def files(root):
    out = {}
    for name in FIGURES:
        text = svg(name).replace("\n<title>", "\n<!-- SPDX-License-Identifier: MIT -->\n<rect width=\"280\" height=\"180\" fill=\"#fff\"/>\n<title>", 1)
        out[os.path.join(root, "models", "kc", name + ".svg")] = text
    page = "<!--- SPDX-License-Identifier: MIT -->\n<!--- Drawn by tests/tools/kc_figures.py: the figure of each column, for the page of gicrun --kc. -->\n"
    page += "<h2>Definitions</h2>\n<p>The figure of each column of the files, by its name there; <code>models/KC.md</code> has the formulas.</p>\n<div class=\"curves\">\n"
    for name, (of, _) in FIGURES.items():
        if of != "load":
            inside = svg(name).replace(' xmlns="http://www.w3.org/2000/svg"', "")  # a page knows it, and names no address
            page += f"<figure>\n<figcaption>{name}</figcaption>\n{inside}</figure>\n"
    out[os.path.join(root, "templates", "kc_figures.html.in")] = page + "</div>\n"
    return out


if __name__ == "__main__":
    stale = 0
    for path, text in files(sys.argv[1]).items():
        if sys.argv[2:] == ["--check"]:
            with open(path, encoding="utf-8") as f:
                if f.read() != text:
                    stale += 1
                    print(f"{path}: not what tests/tools/kc_figures.py draws")
        else:
            with open(path, "w", encoding="utf-8") as f:
                f.write(text)
    sys.exit(stale > 0)
