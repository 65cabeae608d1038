#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""snippets.py GICGEN GICRUN GICBENCH: what stands between back quotes on the pages works.

Commands are completed with a model, a scene and files where the page leaves them open, and must succeed. Pieces of
models and scenes are put into a frame, their placeholders replaced by values of the frame, and must be accepted; those
that a page says are refused must be refused with the words given here. A piece without a row in the tables below is a
failure, so that pages and tables stay together. Prints `ok` or `FAILED` and a name on each line."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PAGES = ["README.md", "generator/README.md", "generator/THEORY.md", "runtime/README.md", "models/README.md",
         "models/FORMAT.md", "models/SCENE.md", "models/TIRES.md", "models/POWERTRAIN.md", "tests/README.md",
         "tests/mutants.md", "tests/proofs.md", "tests/bench/README.md", "tests/bench/tried.md"]

# ---- commands -----------------------------------------------------------------------------------------------

PLACES = {"MODEL.veh": "models/quarter_car.veh", "SCENE": "models/scenes/quarter_car.scene", "[SCENE]": "",
          "FILE.html": "report.html", "PAGE.html": "page.html", "NAME": "rk4", "N": "16", "W": "4"}
COMPLETE = {  # a command that begins so, and what it lacks
    "gicgen --dump-model": "models/quarter_car.veh",
    "gicgen --solve reduced": "models/quarter_car.veh -o -",
    "gicgen --lanes": "models/hmmwv.veh -o -",
    "gicgen --batch": "models/quarter_car.veh -o -",
    "gicgen --report": "report.html models/quarter_car.veh",
    "gicgen --scene models": "models/quarter_car.veh -o code.c",
    "gicgen --scene": "models/scenes/quarter_car.scene models/quarter_car.veh -o code.c",
    "gicrun --animate": "page.html models/quarter_car.veh models/scenes/quarter_car.scene -o run.csv",
    "gicrun --modes": "models/quarter_car.veh",
    "gicrun --equilibrium": "models/quarter_car.veh",
    "gicrun --general": "models/quarter_car.veh models/scenes/quarter_car.scene -o run.csv",
    "gicrun --integrator": "models/quarter_car.veh models/scenes/quarter_car.scene -o run.csv",
    "gicrun --engine": "models/quarter_car.veh models/scenes/quarter_car.scene -o run.csv",
    "gicrun models": "-o run.csv",
    "gicbench --scenes": "--quick models/pendulum.veh models/scenes/pendulum.scene -o bench",
    "gicbench --rhs": "--help",
}
BATCHES = "gicgen --batch"  # of which the number may be missing


def complete(command):
    words = [PLACES.get(word, word) for word in command.split()]
    text = " ".join(word for word in words if word)
    if text == BATCHES:
        text += " 16"
    for start, rest in COMPLETE.items():
        if text.startswith(start) and (start == "gicrun models" or ".veh" not in text):
            return text + " " + rest
    if text.startswith("gicgen --scene") and "-o" not in text and "--report" not in text:
        return text + " -o code.c"
    return text


def run(command, folder):
    done = subprocess.run(command, shell=True, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          check=False)
    return done.returncode, done.stdout + done.stderr


def command_works(command, folder):
    """Of other programs than ours: the target, the page, the option must be there."""
    first = command.split()[0]
    if first == "make":
        return run(f"make --no-print-directory -s -C '{ROOT}' -n {command[5:]}", folder)
    if first == "man":
        name = os.path.basename(command.split()[1]).removesuffix(".1")
        found = subprocess.run(["find", ROOT + "/generator", ROOT + "/runtime", "-name", name + ".1"],
                               capture_output=True, text=True, check=False).stdout
        return (0 if found else 1), "no manual " + name
    if first == "pkg-config":
        text = open(ROOT + "/tests/system/test_install.sh", encoding="utf-8").read()
        return (0 if command.split()[1] in text else 1), "test_install.sh does not ask it"
    if first == "python3":
        text = open(os.path.join(ROOT, command.split()[1]), encoding="utf-8").read()
        lost = [word for word in command.split() if word.startswith("--") and f'"{word}"' not in text]
        return len(lost), "no option " + " ".join(lost)
    return run("build/" + complete(command), folder)


# ---- pieces of models ---------------------------------------------------------------------------------------

# The frame: an arm on a hinge with a weight welded to it and a rack that slides on the ground. Each line has a name, by
# which a row replaces it; a name that the frame lacks is a section of its own.
MODEL = {
    "head": "gicgen: 1\nmodel: frame", "base": "base: ground", "gravity": "", "points": "points: {p: [0.4, 0, 0.2]}",
    "parameters": "parameters: {m_arm: 1.5, a: 0, k: 10}",
    "inputs": "inputs: {x: {default: 0.5}}",
    "tables": "tables:\n  push: {x: [0, 1], y: [0, 2]}",
    "bodies": "bodies:\n  arm: {mass: 2, com: [0.3, 0, 0], inertia: [1, 1, 1]}\n"
              "  slide: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}",
    "weight": "  weight: {mass: 1, com: [0.5, 0, 0], inertia: [1, 1, 1]}",
    "joints": "joints:\n  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}\n"
              "  rail: {type: prismatic, bodies: [ground, slide], axis: [1, 0, 0]}",
    "weld": "  weld: {type: fixed, bodies: [arm, weight]}",
    "coordinates": "coordinates:\n  strut: {type: angle, bodies: [ground, arm], axis: [0, 1, 0]}\n"
                   "  rack: {type: translation, bodies: [ground, slide], axis: [1, 0, 0]}",
    "forces": "forces:\n  hold: {type: spring_damper, coordinate: strut, stiffness: 5}",
    "force": "", "tires": "", "wheels": "", "ports": "", "outputs": "",
}
FREE = {"base": "base: chassis", "bodies": "bodies:\n  chassis: {mass: 9, com: [0, 0, 1], inertia: [1, 2, 2]}",
        "weight": "", "joints": "", "weld": "", "coordinates": "", "forces": "", "force": ""}
FORMULA = "  law: {type: force, coordinate: strut, value: \"@\"}"
WEIGHT = "  weight: {mass: 1, com: [0.5, 0, 0], inertia: [1, 1, 1], "
BETWEEN = "  pull: {type: spring_damper, bodies: [ground, arm], points: [[0, 1, 1], [0.4, 0, 0]]}"


def place(name, text, *replace):
    return {"line": name, "text": text, "replace": replace}


ENDS = ("a, b", "ground, arm")
PIECES = {
    "[0, 0, -9.81]": place("gravity", "gravity: @"),
    "[Ixx, Iyy, Izz]": place("weight", "  weight: {mass: 1, com: [0.5, 0, 0], inertia: @}", ("Ixx", "1"), ("Iyy", "1"),
                             ("Izz", "1")),
    "{xx:, yy:, zz:, xy:, xz:, yz:}": place("weight", "  weight: {mass: 1, com: [0.5, 0, 0], inertia: @}",
                                            (":", ": 0.1"), ("xx: 0.1", "xx: 1"), ("yy: 0.1", "yy: 1"),
                                            ("zz: 0.1", "zz: 1")),
    "[a, b]": place("weld", "  weld: {type: fixed, bodies: @}", ("a, b", "arm, weight")),
    "[low, high]": place("coordinates", MODEL["coordinates"].replace("axis: [0, 1, 0]", "axis: [0, 1, 0], range: @"),
                         ("low, high", "-0.2, 0.3")),
    "[p_a, p_b]": place("force", BETWEEN.replace("[[0, 1, 1], [0.4, 0, 0]]", "@"), ("p_a", "[0, 1, 1]"), ("p_b", "p")),
    "axes: [u_a, u_b]": place("weld", "  weld: {type: universal, bodies: [arm, weight], point: p, @}\n"
                              "  stay: {type: distance, bodies: [arm, weight], points: [[0, 0, 1], [0.5, 0.3, 0]]}\n"
                              "  stop: {type: distance, bodies: [arm, weight], points: [[0, 1, 0], [0.5, 0, 0.3]]}",
                              ("u_a", "[1, 0, 0]"), ("u_b", "[0, 1, 0]")),
    "axes: [u, v]": place("weld", "  pin: {type: revolute, bodies: [ground, weight], point: p, axis: [0, 1, 0]}\n"
                          "  teeth: {type: rack_and_pinion, bodies: [slide, weight], point: p, @, ratio: 0.01}",
                          ("u, v", "[0, 1, 0], [1, 0, 0]")),
    "base: ground": place("base", "@"),
    "gicgen: 1": place("head", "@\nmodel: frame"),
    "bodies: [a, b]": place("force", BETWEEN.replace("bodies: [ground, arm]", "@"), ENDS),
    "points: [p_a, p_b]": place("force", BETWEEN.replace("points: [[0, 1, 1], [0.4, 0, 0]]", "@"),
                                ("p_a", "[0, 1, 1]"), ("p_b", "p")),
    "coordinate: name": place("force", "  law: {type: force, @, value: 1}", ("name", "rack")),
    "force: [x, y, z]": place("force", "  law: {type: load, body: arm, @}", ("x, y, z", "1, x, 2 * time")),
    "moment: [x, y, z]": place("force", "  law: {type: aero, body: arm, area: 2, length: 1, @}", ("x, y, z", "0, sideslip, 0.1")),
    "wind: [x, y, z]": place("force", "  law: {type: aero, body: arm, area: 2, drag: 1, @}", ("x, y, z", "1, x, 2 * time")),
    "force: [0, 0, -0.2]": place("force", "  law: {type: aero, body: arm, area: 2, @}"),
    "torque: [x, y, z]": place("force", "  law: {type: load, body: arm, @}", ("x, y, z", "1, x, 2 * time")),
    "table: name": place("force", "  law: {type: stop, coordinate: rack, high: 0.04, @}", ("name", "push")),
    "mass: \"2 * m_arm\"": place("weight", "  weight: {@, com: [0.5, 0, 0], inertia: [1, 1, 1]}"),
    "name: number": place("parameters", "parameters: {a: 0, k: 10, m_arm: 1, @}", ("name", "b"), ("number", "3")),
    "name: {value: number, unit: text, tunable: true}": place(
        "parameters", "parameters: {a: 0, k: 10, m_arm: 1, @}", ("name", "b"), ("number", "3"), ("text", "kg")),
    "{unit: text, default: number}": place("inputs", "inputs: {x: @}", ("text", "N"), ("number", "3")),
    "name: {type: ..., ...}": place("outputs", "outputs: {@}", ("name", "turn"),
                                    ("type: ..., ...", "type: coordinate, coordinate: strut")),
    "{body: name, point: p, in: body}": place("ports", "ports: {tow: @}", ("body: name", "body: arm"),
                                              ("in: body", "in: slide")),
    "{x: [..], y: [..], interpolation: linear | cubic, beyond: constant | linear}": place(
        "tables", "tables:\n  push: @", ("x: [..], y: [..]", "x: [0, 1], y: [0, 2]"), ("linear | cubic", "cubic"),
        ("constant | linear", "linear")),
    "{axis: [x, y, z], angle: phi}": place("weight", WEIGHT + "orientation: @}", ("x, y, z", "1, 0, 0"), ("phi", "0.3")),
    "{euler: [e0, e1, e2, e3]}": place("weight", WEIGHT + "orientation: @}", ("e0, e1, e2, e3", "0.6, 0.8, 0, 0")),
    "{x: [..], z: [..]}": place("weight", WEIGHT + "orientation: @}", ("x: [..], z: [..]", "x: [1, 0, 0], z: [0, 1, 0]")),
    "{type: box, size: [x, y, z], center: point}": place("weight", WEIGHT + "shape: @}", ("x, y, z", "1, 1, 2"),
                                                         ("point", "p")),
    "{type: cylinder, radius: r, length: l, axis: [x, y, z], center: point}": place(
        "weight", WEIGHT + "shape: @}", ("radius: r", "radius: 1"), ("length: l", "length: 1"), ("x, y, z", "1, 0, 0"),
        ("point", "p")),
    "{type: mesh, file: path, scale: s}": place("weight", WEIGHT + "shape: @}", ("path", "tetrahedron.obj"),
                                                ("scale: s", "scale: 0.1")),
    "center: [1.6, -0.9, 0.4562]": {"line": "wheels", "replace": (), "frame": FREE,
                                    "text": "wheels: {w: {body: chassis, @, radius: 0.4, stiffness: 9}}"},
    "{type: force, coordinate: w, value: \"...\"}": place("force", "  law: @", ("coordinate: w", "coordinate: strut"),
                                                          ("...", "-k * strut")),
    # formulas
    "-k * strut - 300 * rate(strut)": place("force", FORMULA),
    "-x^2": place("force", FORMULA), "a < b": place("force", FORMULA, ("b", "x")),
    "if(condition, a, b)": place("force", FORMULA, ("condition", "x > 1"), ("b)", "x)")),
    "atan2(y, x)": place("force", FORMULA, ("y", "k")), "pow(x, y)": place("force", FORMULA, ("y", "k")),
    "rate(name)": place("force", FORMULA, ("name", "strut")), "name(x)": place("force", FORMULA, ("name", "push")),
    "name(w - free)": place("force", FORMULA, ("name", "push"), ("w - free", "strut - 0.1")),
    "min(1/a, 5)": place("force", FORMULA), "if(a > 0, x/a, 0)": place("force", FORMULA),
    "2 * (a + b)": place("force", FORMULA, ("b", "x")), "2 * a + 2 * b": place("force", FORMULA, ("b", "x")),
}
# what pages say is refused, and a word of the message
REFUSED = {
    "x/a": (place("force", FORMULA), "divides by 0"),
    "sqrt(-1)": (place("force", FORMULA), "finite"),
}

# ---- pieces of scenes ---------------------------------------------------------------------------------------

SCENE = {"head": "gicscene: 1\nduration: 0.02", "step": "step: 0.01", "initial": "", "road": "", "inputs": "", "more": "",
         "output": "", "driver": ""}
HMMWV = "models/hmmwv.veh"
VEHICLE = "models/hmmwv_vehicle.veh"
TIRES = "models/hmmwv_tires.veh"


def scene(line, text, *replace, model=HMMWV, drop=()):
    return {"line": line, "text": text, "replace": replace, "model": model, "drop": drop}


RACK = "inputs: {rack: @}"
DRIVER = "driver: {steering: {path: @, per_angle: 0.1, wheelbase: 3.3, input: rack}}"
SCENE_PIECES = {
    "[3, 8]": scene("driver", "driver: {speed: {target: 5, full: @}}", model=VEHICLE),
    "[[x, y], ...]": scene("more", "course: {cones: @}", ("[[x, y], ...]", "[[1, 2], [3, 4]]")),
    "[x, y, z]": scene("initial", "initial: {velocity: @}", ("x, y, z", "1, 0, 0")),
    "base: fixed": scene("more", "@"),
    "below: 6": scene("more", "massless: {@}", model="models/hmmwv14.veh"),
    "massless: {below: 6}": scene("more", "@", model="models/hmmwv14.veh"),
    "closed: true": scene("driver", DRIVER, ("closed: true", "{points: [[0, 0], [9, 0], [9, 9]], closed: true}"),
                          model=TIRES),
    "driven: {rack: 0}": scene("more", "@"),
    "equilibrium: true": scene("initial", "initial: {@}"),
    "initial: {equilibrium: true}": scene("initial", "@"),
    "friction: {value: 0.8, patches: [{x: [60, 80], y: [-2, 0], value: 0.1, fade: 0.5}]}":
        scene("road", "road: {type: flat, @}", model=TIRES),
    "name: number": scene("more", "parameters: {@}", ("name: number", "bar: 20000"), model="models/tutorial/4_roll.veh"),
    "name: profile": scene("inputs", "inputs: {@}", ("name: profile", "rack: {constant: 0.01}"), model=TIRES),
    "ratio: 2": scene("more", "@", model=TIRES),
    "sleep: {within: 1e-4, after: 1}": scene("more", "@"), "sleep: {}": scene("more", "@"),
    "until: CONDITION": scene("more", "@", ("CONDITION", "speed < 0.1"), model=TIRES),
    "steady: 1e-4": scene("more", "ratio: 4\n@", model=TIRES),
    "tracks: left": scene("road", "road: {type: bumps, bumps: [{x: 1, length: 1, height: 0.1, @}]}"),
    "y: [low, high]": scene("road", "road: {type: bumps, bumps: [{x: 1, length: 1, height: 0.1, @}]}",
                            ("low, high", "-1, 1")),
    "{x, length, height, tracks \\| y}": scene(
        "road", "road: {type: bumps, bumps: [@]}",
        ("x, length, height, tracks \\| y", "x: 1, length: 2, height: 0.1, tracks: both")),
    "x: [x_0, x_1]": scene("road", "road: {type: flat, friction: {patches: [{@, y: [0, 1], value: 0.5}]}}",
                           ("x_0, x_1", "0, 1"), model=TIRES),
    "y: [y_0, y_1]": scene("road", "road: {type: flat, friction: {patches: [{@, x: [0, 1], value: 0.5}]}}",
                           ("y_0, y_1", "0, 1"), model=TIRES),
    "{circle: {center: [x, y], radius: r}}": scene("driver", DRIVER, ("x, y", "0, 20"), ("radius: r", "radius: 20"),
                                                   model=TIRES),
    "{points: [[x, y], ...]}": scene("driver", DRIVER, ("[[x, y], ...]", "[[0, 0], [9, 0], [30, 9]]"), model=TIRES),
    "{file: name.csv}": scene("driver", DRIVER, ("name.csv", "path.csv"), model=TIRES),
    "{constant: c}": scene("inputs", RACK, ("constant: c", "constant: 0.01"), model=TIRES),
    "{knots: {times: [..], values: [..]}}": scene("inputs", RACK, ("times: [..], values: [..]",
                                                                   "times: [0, 1], values: [0, 0.01]"), model=TIRES),
    "{step: {to, rise, start, from}}": scene("inputs", RACK, ("to, rise, start, from",
                                                              "to: 0.01, rise: 0.1, start: 0.2, from: 0"), model=TIRES),
    "{ramp: {to, duration, start, from, blend}}": scene(
        "inputs", RACK, ("to, duration, start, from, blend", "to: 0.01, duration: 1, start: 0.2, from: 0, blend: 0.1"),
        model=TIRES),
    "{pulse: {to, rise, duration, start, from, count, period}}": scene(
        "inputs", RACK, ("to, rise, duration, start, from, count, period",
                         "to: 0.01, rise: 0.1, duration: 0.5, start: 0.2, from: 0, count: 2, period: 1"), model=TIRES),
    "{chirp: {amplitude, from, to, duration, growth, offset, start}}": scene(
        "inputs", RACK, ("amplitude, from, to, duration, growth, offset, start",
                         "amplitude: 0.01, from: 1, to: 2, duration: 3, growth: logarithmic, offset: 0, start: 0"),
        model=TIRES),
    "growth: linear": scene("inputs", "inputs: {rack: {chirp: {amplitude: 0.01, from: 1, to: 2, duration: 3, @}}}",
                            model=TIRES),
    "{knots: {times, values}}": scene("inputs", RACK, ("times, values", "times: [0, 1], values: [0, 0.01]"), model=TIRES),
    "{samples: {times, values, fit}}": scene(
        "inputs", RACK, ("times, values, fit", "times: [0, 1, 2], values: [0, 0.01, 0], fit: spline"), model=TIRES),
    "fit: spline": scene("inputs", "inputs: {rack: {samples: {times: [0, 1, 2], values: [0, 0.01, 0], @}}}", model=TIRES),
    "fit: monotone": scene("inputs", "inputs: {brake: {samples: {times: [0, 1, 2], values: [0, 0.01, 0], @}}}",
                           model=TIRES),
    "{file: {name, column, fit, scale, offset}}": scene(
        "inputs", RACK, ("name, column, fit, scale, offset",
                         "name: drive.csv, column: brake, fit: spline, scale: 0.1, offset: 0"), model=TIRES),
    "{formula: \"0.1 * sin(2 * pi * time ^ 2)\"}": scene("inputs", RACK, ("0.1", "0.01"), model=TIRES),
    "input_file: drive.csv": scene("more", "@", model=TIRES),
    "input_file: {name: drive.csv, fit: spline}": scene("more", "@", model=TIRES),
    "{sine: {amplitude, frequency, offset, start}}": scene(
        "inputs", RACK, ("amplitude, frequency, offset, start",
                         "amplitude: 0.01, frequency: 1, offset: 0, start: 0.5"), model=TIRES),
    "{euler: [e0, e1, e2, e3]}": scene("initial", "initial: {orientation: @}", ("e0, e1, e2, e3", "1, 0, 0, 0")),
    "{yaw, pitch, roll}": scene("initial", "initial: {orientation: @}", ("yaw, pitch, roll", "yaw: 1, pitch: 0, roll: 0")),
    "{name: value}": scene("initial", "initial: {coordinates: @}", ("name: value", "rack: 0.01")),
    "{name: rate}": scene("initial", "initial: {rates: @}", ("name: rate", "rack: 0.01")),
    "{wheel_f_l.spin: 12, engine.speed: 200}": scene("initial", "initial: {states: @}", ("wheel_f_l", "tire_f_l"),
                                                     model=VEHICLE),
    "{points: [[x, y], ...], width: w, cones: n}": scene("more", "course: {lanes: [@]}", ("[[x, y], ...]", "[[0, 0], [9, 0]]"),
                                                         ("width: w", "width: 3"), ("cones: n", "cones: 4")),
    "{x: chassis.x, y: chassis.y}": scene("more", "plot: [@]"),
}
# pieces of other files, and words between brackets that are none
OTHERS = {"[m]", "[s]", "[ms]", "[min]", "[SECTION]", "{...}", "[at pn, at 2 pn]", "[0, 1, 0]", "[sigma_x, sigma_y]", "type: powertrain",
          "type: tmeasy", "angle [deg]", "angle [rad]", "1e-3", "gcc -O2", "loads->power"}

OPEN = re.compile(r"^[\[{]|: |^[-a-z0-9]+ ?[-*/^<] ?|^(if|min|atan2|pow|rate|sqrt|name)\(")


def is_piece(code):
    """Something that can stand in a model or a scene, and is more than a word."""
    return bool(OPEN.search(code)) and not re.match(r"^(--|-[A-Za-z]( [A-Z]|$|[A-Z0-9])|[-a-z0-9_.]+/)", code)


def model_text(row, piece):
    lines = dict(MODEL, **row.get("frame", {}))
    lines[row["line"]] = row["text"].replace("@", piece)
    return "\n".join(line for line in lines.values() if line) + "\n"


def scene_text(row, piece):
    lines = dict(SCENE)
    lines[row["line"]] = row["text"].replace("@", piece)
    return "\n".join(line for line in lines.values() if line) + "\n"


def filled(row, code):
    for old, new in row["replace"]:
        if old not in code:
            raise KeyError(f"'{old}' does not stand in '{code}'")
        code = code.replace(old, new)
    return code


def in_model(folder, row, code):
    with open(os.path.join(folder, "frame.veh"), "w", encoding="utf-8") as file:
        file.write(model_text(row, filled(row, code)))
    return run("build/gicgen --dump-model frame.veh", folder)


def in_scene(folder, row, code):
    with open(os.path.join(folder, "frame.scene"), "w", encoding="utf-8") as file:
        file.write(scene_text(row, filled(row, code)))
    return run(f"build/gicrun --engine tape {row['model']} frame.scene -q -o frame.csv", folder)


TRUCK = """gicgen: 1
model: frame
base: frame
points: {rear_hub: [-1, 0, 0.5]}
parameters: {soft: 1e5}
bodies:
  frame: {mass: 9, com: [0, 0, 1], inertia: [1, 2, 2]}
  bogie: {mass: 9, com: [0, 0, 1], inertia: [1, 2, 2]}
joints: {pivot: {type: revolute, bodies: [frame, bogie], point: [0, 0, 1], axis: [0, 1, 0]}}
coordinates:
  nod: {type: angle, bodies: [frame, bogie], axis: [0, 1, 0]}
  front: {type: translation, bodies: [frame, front_beam], axis: [0, 0, 1]}
  rear: {type: translation, bodies: [bogie, rear_beam], axis: [0, 0, 1]}
"""


def block_works(page, text, before, folder):
    """A piece of several lines, indented on a page, and the one before it."""
    if text.startswith("include:") and "with:" in text:
        with open(os.path.join(folder, "axle.veh"), "w", encoding="utf-8") as file:
            file.write(before)
        text = TRUCK + text + "\n"
    elif text.startswith("include:"):
        lines = {"gicgen": "1", "model": "frame", "base": "chassis"}
        text = "".join(f"{k}: {v}\n" for k, v in lines.items()) + text + "\nbodies:\n" + \
            "  chassis: {mass: 9, com: [0, 0, 1], inertia: [1, 2, 2]}\n"
        shutil.copy(os.path.join(ROOT, "models/tutorial/axle.veh"), folder)
    elif text.startswith("powertrain:"):
        # in place of the part that has it: that of a model which includes another counts first
        with open(os.path.join(ROOT, "models/hmmwv_vehicle.veh"), encoding="utf-8") as file:
            text = file.read().replace("parts/", ROOT + "/models/parts/") + text + "\n" + \
                "tables: {full: {x: [0, 300], y: [400, 500]}, losses: {x: [0, 300], y: [0, -90]},\n" \
                "  capacity: {x: [0, 1], y: [9, 15]}, multiplication: {x: [0, 1], y: [2, 1]}}\n"
    elif page.endswith("SCENE.md"):
        with open(os.path.join(folder, "frame.scene"), "w", encoding="utf-8") as file:
            file.write(SCENE["head"] + "\n" + SCENE["step"] + "\n" + text)
        return run(f"build/gicrun --engine tape {HMMWV} frame.scene -q -o frame.csv", folder)
    with open(os.path.join(folder, "frame.veh"), "w", encoding="utf-8") as file:
        file.write(text)
    return run("build/gicgen --dump-model frame.veh", folder)


def report(works, name, said=""):
    print(("ok " if works else "FAILED ") + name)
    if not works:
        print("    " + said.strip().replace("\n", "\n    ")[:2000])


def main():
    folder = tempfile.mkdtemp()
    os.mkdir(folder + "/build")
    for program in sys.argv[1:]:
        os.symlink(os.path.abspath(program), folder + "/build/" + os.path.basename(program))
    for entry in ("models", "templates", "tests"):
        os.symlink(f"{ROOT}/{entry}", f"{folder}/{entry}")
    with open(folder + "/path.csv", "w", encoding="utf-8") as file:
        file.write("x,y\n0,0\n9,0\n30,9\n")
    with open(folder + "/drive.csv", "w", encoding="utf-8") as file:
        file.write("time [s],rack [m],brake\n0,0,0\n1,0.01,0.1\n2,0,0\n")
    with open(folder + "/tetrahedron.obj", "w", encoding="utf-8") as file:
        file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    with open(folder + "/states.csv", "w", encoding="utf-8") as file:
        columns = run("build/gicrun --equilibrium models/quarter_car.veh -o states.csv", folder)
        if columns[0]:
            report(False, "states of equilibrium", columns[1])
    seen = {}
    for page in PAGES:
        with open(os.path.join(ROOT, page), encoding="utf-8") as file:
            text = file.read()
        outside = re.sub(r"```.*?```", "", text, flags=re.S)
        for code in re.findall(r"`([^`\n]+)`", outside):
            if re.match(r"(gicgen|gicrun|gicsweep|gicbench|make|man|pkg-config|python3) \S", code):
                key = ("command", code)
                if key not in seen:
                    seen[key] = True
                    status, said = command_works(code, folder)
                    report(status == 0, f"{page}: `{code}`", said)
            elif page.startswith("models/") or page == "generator/README.md":
                scenes = page in ("models/SCENE.md", "models/README.md")
                key = (scenes, code)
                if key in seen or code in OTHERS:
                    continue
                if code in REFUSED:
                    status, said = in_model(folder, REFUSED[code][0], code)
                    report(status != 0 and REFUSED[code][1] in said, f"{page}: `{code}` is refused", said)
                elif scenes and code in SCENE_PIECES:
                    report(*turned(in_scene(folder, SCENE_PIECES[code], code), page, code))
                elif code in PIECES:
                    report(*turned(in_model(folder, PIECES[code], code), page, code))
                elif is_piece(code):
                    report(False, f"{page}: `{code}`", "no row of snippets.py says how to try it")
                seen[key] = True
        before = ""
        for block in re.findall(r"(?:^    (?:[a-z]+:|  +\S).*\n)+", outside, flags=re.M):
            if re.match(r"    [a-z]+:( |$)", block.split("\n", maxsplit=1)[0]) and ":" in block:
                lines = "\n".join(line[4:] for line in block.rstrip("\n").split("\n"))
                block, before = before, lines
                if not re.match(r"(include|powertrain|base):", lines):
                    continue
                status, said = block_works(page, lines, block, folder)
                report(status == 0, f"{page}: {lines.splitlines()[0]} ...", said)
    shutil.rmtree(folder)


def turned(result, page, code):
    return result[0] == 0, f"{page}: `{code}`", result[1]


if __name__ == "__main__":
    main()
