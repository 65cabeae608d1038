# SPDX-License-Identifier: MIT
"""mechanisms.py GICGEN GICRUN [NAME...]: mechanisms whose joints repeat each other, or whose coordinates are too many,
too few or the wrong ones, with lengths of 1 and axes along x, y and z and askew. The remedies of gicgen's messages are
applied as they are printed until it accepts the model; that must have the degrees of freedom known for the mechanism,
and run, in agreement with the engine `gic`, with the joints that were drawn still fitting."""
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
import remedies  # noqa: E402

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "skew": (1 / 3, 2 / 3, 2 / 3)}
MESSAGES_MOST = 6


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def basis(axis):
    """Two directions perpendicular to it and to each other."""
    other = {"x": (0, 1, 0), "y": (0, 0, 1), "z": (1, 0, 0), "skew": (2 / 3, 1 / 3, -2 / 3)}[axis]
    return other, cross(AXES[axis], other)


def text(vector):
    return "[" + ", ".join(f"{x:.17g}" for x in vector) + "]"


class Mechanism:
    def __init__(self, name, dof):
        self.name, self.dof, self.bodies, self.joints, self.coordinates, self.drawn = name, dof, [], [], [], []

    def body(self, name, com):
        self.bodies.append(f"  {name}: {{mass: 1, com: {text(com)}, inertia: [0.1, 0.1, 0.1]}}")
        return self

    def joint(self, name, kind, bodies, point=None, axis=None, axes=None):
        self.drawn.append((kind, bodies, point, axis))
        keys = [f"type: {kind}", f"bodies: [{', '.join(bodies)}]"]
        keys += [f"point: {text(point)}"] if point else []
        keys += [f"axis: {text(axis)}"] if axis else []
        keys += [f"axes: [{', '.join(text(u) for u in axes)}]"] if axes else []
        self.joints.append(f"  {name}: {{{', '.join(keys)}}}")
        return self

    def coordinate(self, name, kind, bodies, axis):
        self.coordinates.append(f"  {name}: {{type: {kind}, bodies: [{', '.join(bodies)}], axis: {text(axis)}}}")
        return self

    def file(self):
        lines = ["gicgen: 1", f"model: {self.name}", "base: ground", "bodies:", *self.bodies, "joints:", *self.joints]
        return "\n".join(lines + (["coordinates:", *self.coordinates] if self.coordinates else [])) + "\n"


def plane(axis):
    """From coordinates in the plane, and along the axis, to the model's."""
    p, q = basis(axis)
    return lambda x, y, z=0: tuple(x * a + y * b + z * c for a, b, c in zip(p, q, AXES[axis]))


def on_one_body(axis, name, dof, *joints, coordinate="angle"):
    """A door of 1 m: joints (kind, place along the axis, distance from it)."""
    at, u = plane(axis), AXES[axis]
    m = Mechanism(f"{name}_{axis}", dof).body("door", at(0.5, 0.25))
    for i, (kind, along, off) in enumerate(joints):
        bare = kind in ("spherical",)
        m.joint(f"j{i}", kind, ("ground", "door"), at(0, off, along), None if bare else u)
    return m.coordinate("q", coordinate, ("ground", "door"), u) if coordinate else m


def chain(axis, name, dof, points, links, hinges, coordinate=("ground", "b1"), last=None):
    """Plane links: links {body: (point, point)}, hinges [(body, body, point)]; last: another kind of the last one."""
    at, u = plane(axis), AXES[axis]
    m = Mechanism(f"{name}_{axis}", dof)
    for body, (p, q) in links.items():
        m.body(body, at(*(0.5 * (s + t) for s, t in zip(points[p], points[q]))))
    for i, (a, b, p) in enumerate(hinges):
        m.joint(f"j{i}", "revolute", (a, b), at(*points[p]), u)
    if last:
        m.joint("guide", "prismatic", last, at(*points["C"]), at(1, 0))
    return m.coordinate("q", "angle", coordinate, u) if coordinate else m


def four_bar(axis, name, points, coordinate=("ground", "b1")):
    return chain(axis, name, 1, points, {"b1": "AB", "b2": "BC", "b3": "CD"},
                 [("ground", "b1", "A"), ("b1", "b2", "B"), ("b3", "ground", "D"), ("b2", "b3", "C")], coordinate)


def spatial(name, dof, points, axes):
    """A single loop of hinges at points, about axes; link k from point k to the next, the last one is ground."""
    n = len(points)
    m = Mechanism(name, dof)
    body = [f"r{k + 1}" for k in range(n - 1)] + ["ground"]
    for k in range(n - 1):
        m.body(body[k], tuple(0.5 * (a + b) for a, b in zip(points[k], points[k + 1])))
    for k in range(n):
        m.joint(f"j{k}", "revolute", (body[k - 1], body[k]), points[k], axes[k])
    return m.coordinate("q", "angle", ("ground", "r1"), axes[0])


def mechanisms():
    for axis in AXES:
        yield on_one_body(axis, "door", 1, ("revolute", 0, 0), ("revolute", 1, 0))
        yield on_one_body(axis, "door_bare", 1, ("revolute", 0, 0), ("revolute", 1, 0), coordinate=None)
        yield on_one_body(axis, "three_hinges", 1, *(("revolute", k, 0) for k in range(3)))
        yield on_one_body(axis, "hinge_ball", 1, ("revolute", 0, 0), ("spherical", 1, 0))
        yield on_one_body(axis, "hinge_ball_beside", 1, ("revolute", 0, 0), ("spherical", 1, 1))
        yield on_one_body(axis, "hinge_sleeve", 1, ("revolute", 0, 0), ("cylindrical", 1, 0))
        yield on_one_body(axis, "two_sleeves", 2, ("cylindrical", 0, 0), ("cylindrical", 1, 0))
        yield on_one_body(axis, "two_rods", 1, ("cylindrical", 0, 0), ("cylindrical", 0, 1), coordinate="translation")
        yield on_one_body(axis, "two_rods_wrong", 1, ("cylindrical", 0, 0), ("cylindrical", 0, 1))
        yield on_one_body(axis, "two_slides", 1, ("prismatic", 0, 0), ("prismatic", 0, 1), coordinate="translation")
        yield on_one_body(axis, "slide_rod", 1, ("prismatic", 0, 0), ("cylindrical", 0, 1), coordinate="translation")
        yield on_one_body(axis, "two_balls", 1, ("spherical", 0, 0), ("spherical", 1, 0))
        yield on_one_body(axis, "two_balls_bare", 1, ("spherical", 0, 0), ("spherical", 1, 0), coordinate=None)
        yield on_one_body(axis, "three_balls", 1, *(("spherical", k, 0) for k in range(3)))
        yield on_one_body(axis, "hinge_slid", 1, ("revolute", 0, 0), coordinate="translation")
        yield on_one_body(axis, "slide_turned", 1, ("prismatic", 0, 0), coordinate="angle")
        square = {"A": (0, 0), "B": (0, 1), "C": (1, 1), "D": (1, 0)}
        yield four_bar(axis, "square", square)
        yield four_bar(axis, "square_bare", square, None)
        yield four_bar(axis, "rocker", {"A": (0, 0), "B": (0, 1), "C": (2, 2), "D": (2, 0)})
        yield four_bar(axis, "parallelogram", {"A": (0, 0), "B": (0, 1), "C": (2, 1), "D": (2, 0)})
        yield four_bar(axis, "kite", {"A": (0, 0), "B": (0, 1), "C": (2, 2), "D": (1, 0)}, ("b1", "b2"))
        yield chain(axis, "three_bars", 1, {"A": (0, 0), "B": (0, 1), "C": (2, 1), "D": (2, 0), "E": (1, 0), "F": (1, 1)},
                    {"b1": "AB", "b2": "BC", "b3": "CD", "b4": "EF"},
                    [("ground", "b1", "A"), ("b1", "b2", "B"), ("ground", "b3", "D"), ("b2", "b3", "C"),
                     ("ground", "b4", "E"), ("b2", "b4", "F")])
        yield chain(axis, "slider_crank", 1, {"A": (0, 0), "B": (0, 1), "C": (2, 0)}, {"b1": "AB", "b2": "BC", "b3": "CC"},
                    [("ground", "b1", "A"), ("b1", "b2", "B"), ("b2", "b3", "C")], last=("ground", "b3"))
        yield chain(axis, "scissor", 1,
                    {"A": (0, 0), "B": (2, 2), "C": (2, 0), "D": (0, 2), "M": (1, 1), "N": (1, 3), "E": (0, 4), "F": (2, 4)},
                    {"b1": "AB", "b2": "CD", "b3": "CC", "b4": "BE", "b5": "DF"},
                    [("ground", "b1", "A"), ("b1", "b2", "M"), ("b2", "b3", "C"), ("b1", "b4", "B"), ("b2", "b5", "D"),
                     ("b4", "b5", "N")], last=("ground", "b3"))
        yield chain(axis, "six_bar", 1,
                    {"A": (0, 0), "B": (0, 1), "C": (1, 2), "D": (2, 0), "E": (3, 2), "F": (4, 0)},
                    {"b1": "AB", "b2": "BC", "b3": "CD", "b4": "CE", "b5": "EF"},
                    [("ground", "b1", "A"), ("b1", "b2", "B"), ("ground", "b3", "D"), ("b2", "b3", "C"),
                     ("b3", "b4", "C"), ("b4", "b5", "E"), ("b5", "ground", "F")])
    for turn in range(3):
        def around(v):
            return tuple(v[(i - turn) % 3] for i in range(3))

        def all_around(vectors):
            return [around(v) for v in vectors]

        cube = [(0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1)]
        hinge = [(0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0)]
        yield spatial(f"bricard_{turn}", 1, all_around(cube), all_around(hinge))
        # a spherical four-bar linkage: all axes through (0, 0, 0)
        ways = [(1, 0, 0), (1, 1, 0), (0, 1, 1), (0, 0, 1)]
        yield spatial(f"spherical_{turn}", 1, all_around(ways), all_around(ways))
        # a shaft with two universal joints between two hinges that are parallel, 1 m aside
        m = Mechanism(f"shaft_{turn}", 1)
        points = all_around([(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 1, 0)])
        along, up, aside = all_around([(1, 0, 0), (0, 0, 1), (1, -1, 0)])
        for k, body in enumerate(("input", "shaft", "out")):
            m.body(body, tuple(0.5 * (a + b) for a, b in zip(points[k], points[k + 1])))
        m.joint("bearing", "revolute", ("ground", "input"), points[0], along)
        m.joint("cross1", "universal", ("input", "shaft"), points[1], axes=[up, aside])
        m.joint("cross2", "universal", ("shaft", "out"), points[2], axes=[aside, up])
        m.joint("bearing2", "revolute", ("ground", "out"), points[3], along)
        yield m.coordinate("q", "angle", ("ground", "input"), along)


def remedied(gicgen, folder, source, show):
    """(the accepted file, None), or (None, what is wrong)."""
    for count in range(MESSAGES_MOST):
        with open(os.path.join(folder, "m.veh"), "w", encoding="utf-8") as file:
            file.write(source)
        answer = subprocess.run([gicgen, "m.veh", "-o", "m.c"], cwd=folder, capture_output=True, timeout=60)
        said = answer.stderr.decode()
        if answer.returncode == 0:
            return (source, None) if count else (None, "accepted as it is")
        if show:
            print(said)
        after = remedies.whole_rules(source, remedies.Message(said))
        if after is None or after == source:
            return None, f"the remedy can't be applied\n{said}\n{source}"
        source = after
    return None, f"not accepted after {MESSAGES_MOST} remedies\n{said}\n{source}"


def rows(gicrun, folder, *words):
    done = subprocess.run([gicrun, "--quiet", *words, "m.veh", "m.scene", "-o", "-"], cwd=folder, capture_output=True,
                          timeout=120)
    if done.returncode:
        return None, done.stderr.decode()
    lines = done.stdout.decode().split("\n")
    header = [name.split(" ")[0].strip('"') for name in lines[0].split(",")]
    return (header, [[float(x) for x in line.split(",")] for line in lines[1:] if line]), None


def watched(mechanism):
    """[(body or None, point), (body or None, point), axis along which they may part or None]: what the drawn joints hold
    together, None for the ground."""
    pairs = []
    for kind, bodies, point, axis in mechanism.drawn[:1] if "beside" in mechanism.name else mechanism.drawn:
        points = [point]
        if kind != "spherical" and axis:  # others lie beside it and along the axis
            points.append(tuple(p + u for p, u in zip(point, axis)))
        if kind == "prismatic":
            points.append(tuple(p + u for p, u in zip(point, cross(axis, (0.6, 0, 0.8)))))
        for at in points:
            ends = [(None if body == "ground" else body, at) for body in bodies]
            pairs.append((*ends, axis if kind in ("prismatic", "cylindrical") else None))
    return pairs


def outputs_of(pairs):
    lines = []
    for i, (first, second, _) in enumerate(pairs):
        lines += [f"  w{i}{end}: {{type: position, body: {body}, point: {text(point)}}}\n"
                  for end, (body, point) in zip("ab", (first, second)) if body]
    return lines


def apart(pairs, header, row):
    """How far the drawn joints are from fitting, m."""
    value = dict(zip(header, row))
    worst = 0
    for i, (first, second, axis) in enumerate(pairs):
        x = [[value[f"w{i}{end}.{c}"] for c in "xyz"] if body else point
             for end, (body, point) in zip("ab", (first, second))]
        way = [b - a for a, b in zip(*x)]
        if axis and first[0] is None:  # the axis stands still
            way = cross(way, axis)
        elif axis:
            continue
        worst = max(worst, max(map(abs, way)))
    return worst


def judge(gicgen, gicrun, mechanism, show):
    """What is wrong with the remedies for it, or None."""
    with tempfile.TemporaryDirectory() as folder:
        source, wrong = remedied(gicgen, folder, mechanism.file(), show)
        if wrong:
            return wrong
        pairs = watched(mechanism)
        names = re.findall(r"^  ([a-z0-9]+): \{type: (?:angle|translation|length)", source, re.M)
        if len(names) != mechanism.dof:
            return f"{len(names)} coordinates instead of {mechanism.dof}\n{source}"
        with open(os.path.join(folder, "m.veh"), "a", encoding="utf-8") as file:
            file.write("outputs:\n  energy: {type: energy}\n")
            for body in re.findall(r"^  ([a-z0-9]+): \{mass", source, re.M):
                file.write(f"  at_{body}: {{type: position, body: {body}, point: [0.3, 0.7, 0.2]}}\n")
            file.writelines(outputs_of(pairs))
        rates = ", ".join(f"{name}: 0.5" for name in names)
        with open(os.path.join(folder, "m.scene"), "w", encoding="utf-8") as file:
            file.write("gicscene: 1\nduration: 0.1\nstep: 0.001\nintegrator: rk4\noutput_step: 0.05\n" +
                       (f"initial: {{rates: {{{rates}}}}}\n" if rates else ""))
        ours, wrong = rows(gicrun, folder, "--engine", "tape")
        if wrong:
            return f"it does not run: {wrong}\n{source}"
        others, wrong = rows(gicrun, folder, "--engine", "gic")
        if wrong:
            return f"it does not run with the engine gic: {wrong}\n{source}"
        (header, ours), (_, others) = ours, others
        loose = max(apart(pairs, header, row) for row in ours)
        if not loose < 1e-9:
            return f"the joints that were drawn are {loose:.2g} m apart\n{source}"
        far = max(abs(a - b) / (1 + abs(b)) for one, other in zip(ours, others) for a, b in zip(one, other))
        if len(ours) != 3 or len(others) != 3 or not far < 1e-7:
            return f"{far:.2g} from the engine gic\n{source}"
        moved = max(abs(a - b) for a, b in zip(ours[0][1:], ours[-1][1:]))
        return None if mechanism.dof == 0 or moved > 1e-3 else f"it does not move\n{source}"


def main():
    gicgen, gicrun, wanted = os.path.realpath(sys.argv[1]), os.path.realpath(sys.argv[2]), sys.argv[3:]
    passed, failed = 0, 0
    for mechanism in mechanisms():
        if wanted and mechanism.name not in wanted:
            continue
        wrong = judge(gicgen, gicrun, mechanism, bool(wanted))
        passed, failed = passed + (not wrong), failed + bool(wrong)
        if wrong:
            print(f"FAIL {mechanism.name}: {wrong}")
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed != 0)


if __name__ == "__main__":
    main()
