# SPDX-License-Identifier: MIT
"""Kinds of mistakes in the files of a random vehicle, which stand as random/write.c writes them: an entry a line. A
kind changes the files and returns where the mistake is and what a message must name, or None where the vehicle has
nothing that could be broken so."""
import copy
import os
import re

KINDS = {}


class Mistake:
    """`line` None: a place can't be foreseen; `says` all have to be in the message, its remedy or note, and of a list
    in it one."""

    def __init__(self, file, line, *says):
        self.file, self.line, self.says = file, line, says

    def __repr__(self):
        return f"{self.file}:{self.line} {self.says}"


def split(text):
    """Elements between commas at the top level of what stands in brackets, quotes respected."""
    out, depth, quoted, start = [], 0, False, 0
    for i, c in enumerate(text):
        if c == '"':
            quoted = not quoted
        elif not quoted and c in "[{":
            depth += 1
        elif not quoted and c in "]}":
            depth -= 1
        elif not quoted and depth == 0 and c == ",":
            out.append(text[start:i].strip())
            start = i + 1
    return out + [text[start:].strip()]


class Entry:
    """`name: {key: value, ...}` in one line; changes are written into the file at once."""

    def __init__(self, vehicle, file, row):
        self.vehicle, self.file, self.row = vehicle, file, row
        self.lead, self.name, rest = re.match(r"( *(?:- )?)([A-Za-z0-9_]*):? ?(.*)", vehicle.files[file][row]).groups()
        if self.lead.endswith("- "):
            self.name, rest = "", vehicle.files[file][row][len(self.lead):]
        self.is_map = rest.startswith("{")
        inner = split(rest[1:-1])
        self.map = dict(part.split(": ", 1) for part in inner) if self.is_map else {"": rest}

    @property
    def line(self):
        return self.row + 1

    def save(self):
        inner = ", ".join(f"{key}: {value}" for key, value in self.map.items())
        text = "{" + inner + "}" if self.is_map else self.map[""]
        self.vehicle.files[self.file][self.row] = self.lead + (self.name + ": " if self.name else "") + text

    def put(self, text):
        """Other text for the whole value."""
        self.vehicle.files[self.file][self.row] = f"{self.lead}{self.name}: {text}"

    def mistake(self, *says):
        return Mistake(self.file, self.line, *((self.name,) if self.name else ()), *says)


class Vehicle:
    def __init__(self, folder, seed):
        self.main = f"{seed}.veh"
        self.files = {}
        for name in sorted(os.listdir(folder)):
            if name.startswith(f"{seed}.") and not name.endswith(".plain.veh"):
                with open(os.path.join(folder, name)) as file:
                    self.files[name] = file.read().split("\n")[:-1]

    def copy(self):
        return copy.deepcopy(self)

    def write(self, folder):
        for name, lines in self.files.items():
            with open(os.path.join(folder, name), "wb") as file:
                file.write(("\n".join(lines) + "\n").encode("latin-1"))

    def entries(self, section):
        out = []
        for name, lines in self.files.items():
            now = None
            for row, line in enumerate(lines):
                if name.endswith(".tir"):
                    continue
                top = re.match(r"([a-z]+):", line)
                if top:
                    now = top.group(1)
                elif line == "  differentials:":
                    now = "differentials"
                elif now == section:
                    out.append(Entry(self, name, row))
        return out

    def tir(self):
        """The tire's file where a tire uses it."""
        if any("file" in entry.map for entry in self.entries("tires")):
            return next(name for name in self.files if name.endswith(".tir"))
        return None

    def append(self, section, line):
        """A line at the end of a section of the main file, which may be new; its number."""
        lines = self.files[self.main]
        if section + ":" not in lines:
            lines += [section + ":"]
            at = len(lines)
        else:
            at = lines.index(section + ":") + 1
            while at < len(lines) and lines[at].startswith(" "):
                at += 1
        lines.insert(at, line)
        return at + 1

    def drop_titles(self):
        """Sections that have become empty."""
        for file, lines in self.files.items():
            self.files[file] = [line for i, line in enumerate(lines) if not re.fullmatch("[a-z]+:", line) or
                                lines[i + 1:i + 2] and lines[i + 1].startswith(" ")]

    def top(self, key):
        """Row of a key of the main file."""
        return next(row for row, line in enumerate(self.files[self.main]) if re.match(rf"{key}:", line))


def kind(name):
    def note(function):
        assert name not in KINDS, name
        KINDS[name] = function
        return function
    return note


def some(vehicle, rng, section, want=lambda entry: True):
    found = [entry for entry in vehicle.entries(section) if want(entry)]
    return rng.choice(found) if found else None


def has(*keys):
    return lambda entry: all(key in entry.map for key in keys)


def of_type(*types):
    return lambda entry: entry.map.get("type") in types


def both(*conditions):
    return lambda entry: all(condition(entry) for condition in conditions)


# ---- kinds made of tables --------------------------------------------------------------------------------------------

def missing(section, key, want, says=None):
    @kind(f"{section} without {key}" + (f" of {says}" if says else ""))
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, both(has(key), want))
        if not entry:
            return None
        del entry.map[key]
        entry.save()
        return entry.mistake(key)


def value(name, section, key, text, want=lambda entry: True, *says):
    """`key` gets the value `text`; `@` stands for what it was."""
    @kind(f"{section}: {name}")
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, both(has(key), want))
        if not entry:
            return None
        entry.map[key] = text.replace("@", entry.map[key])
        entry.save()
        return entry.mistake(*says)


def added(name, section, text, want=lambda entry: True, *says):
    """Another `key: value`."""
    @kind(f"{section}: {name}")
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, both(want, lambda entry: text.split(":")[0] not in entry.map))
        if not entry or not entry.is_map:
            return None
        key, what = text.split(": ", 1)
        entry.map[key] = what
        entry.save()
        return entry.mistake(*says)


def always(_):
    return True


for section, keys in (("bodies", "mass com inertia"), ("tables", "x y"), ("joints", "type bodies"),
                      ("coordinates", "type bodies"), ("forces", "type"), ("wheels", "body center spin_inertia"),
                      ("outputs", "type body"), ("differentials", "outputs")):
    for key in keys.split():
        missing(section, key, always)
for type_ in ("revolute", "spherical", "cylindrical", "universal", "point_on_line", "point_in_plane"):
    missing("joints", "point", of_type(type_), type_)
for type_ in ("revolute", "cylindrical", "prismatic", "point_on_line", "point_in_plane", "parallel",
              "revolute_spherical"):
    missing("joints", "axis", of_type(type_), type_)
for type_ in ("universal", "perpendicular"):
    missing("joints", "axes", of_type(type_), type_)
for type_ in ("distance", "revolute_spherical"):
    missing("joints", "points", of_type(type_), type_)
missing("coordinates", "points", of_type("length"))
missing("coordinates", "axis", of_type("angle"), "angle")
missing("coordinates", "axis", of_type("translation"), "translation")
missing("forces", "value", of_type("force"))
missing("forces", "body", of_type("load"))
missing("wheels", "radius", always)
missing("wheels", "stiffness", always)
for key in "radius stiffness damping load dfx0 fxm fxs sxm sys trail sqe".split():
    missing("tires", key, of_type("tmeasy"))
for part, keys in (("engine", "inertia throttle torque"), ("converter", "capacity torque"),
                   ("transmission", "forward")):
    for key in keys.split():
        missing("powertrain", key, lambda entry, part=part: entry.name == part, part)

for section in ("bodies", "joints", "coordinates", "forces", "wheels", "tables", "outputs", "inputs", "tires",
                "differentials", "powertrain"):
    added("key that there isn't", section, "colour: 1", lambda entry: entry.is_map, "colour")

    @kind(f"{section}: key twice")
    def _(vehicle, rng, section=section):
        entry = some(vehicle, rng, section, lambda entry: entry.is_map and len(entry.map) > 0)
        if not entry:
            return None
        key, what = rng.choice(list(entry.map.items()))
        entry.map[key] = f"{what}, {key}: {what}"
        entry.save()
        return Mistake(entry.file, entry.line, key)

    @kind(f"{section}: an entry that is a number")
    def _(vehicle, rng, section=section):
        entry = some(vehicle, rng, section)
        if not entry:
            return None
        entry.put("12")
        return entry.mistake()

    @kind(f"{section}: an empty entry")
    def _(vehicle, rng, section=section):
        entry = some(vehicle, rng, section)
        if not entry:
            return None
        entry.put("{}" if section != "inputs" else "")
        return entry.mistake()

    @kind(f"{section}: a name twice")
    def _(vehicle, rng, section=section):
        entry = some(vehicle, rng, section)
        if not entry:
            return None
        vehicle.files[entry.file].insert(entry.row + 1, vehicle.files[entry.file][entry.row])
        return Mistake(entry.file, entry.line + 1, entry.name)

# numbers that are none, in places of all kinds
PLACES = (("bodies", "mass", always), ("joints", "length", always), ("forces", "damping", always),
          ("wheels", "spin_inertia", always), ("tires", "radius", always), ("coordinates", "design", always),
          ("differentials", "ratio", always), ("inputs", "default", always))
for section, key, want in PLACES:
    value(f"{key} not a number", section, key, ".nan", want)
    value(f"{key} too large", section, key, "1e400", want)
    value(f"{key} a word", section, key, "heavy", want, "heavy")
    value(f"{key} a list", section, key, "[1, 2]", want)
    value(f"{key} with a unit", section, key, "12 kg", want)
value("mass with a leading zero", "bodies", "mass", "007")
value("mass hexadecimal", "bodies", "mass", "0x10")
value("mass empty", "bodies", "mass", "")

# numbers out of range
value("mass of zero", "bodies", "mass", "0")
value("mass below zero", "bodies", "mass", "-5")
value("mass of 1e30", "bodies", "mass", "1e30")
value("inertia below zero", "bodies", "inertia", "[-1, 1, 1]")
value("inertia of zero", "bodies", "inertia", "[0, 0, 0]")
value("inertia against the triangle inequality", "bodies", "inertia", "[1, 1, 3]")
value("inertia indefinite", "bodies", "inertia", "{xx: 1, yy: 1, zz: 1, xy: 2}")
value("inertia of two numbers", "bodies", "inertia", "[1, 1]")
value("inertia with another key", "bodies", "inertia", "{xx: 1, yy: 1, zz: 1, ww: 2}", always, "ww")
value("euler parameters too long", "bodies", "orientation", "{euler: [1, 1, 0, 0]}")
value("euler parameters of three", "bodies", "orientation", "{euler: [1, 0, 0]}")
value("orientation by a zero axis", "bodies", "orientation", "{axis: [0, 0, 0], angle: 1}")
value("orientation by parallel directions", "bodies", "orientation", "{x: [1, 0, 0], z: [2, 0, 0]}")
value("orientation by half", "bodies", "orientation", "{x: [1, 0, 0]}")
value("com of two numbers", "bodies", "com", "[1, 2]")
value("com a million away", "bodies", "com", "[1e7, 2, 0]")
value("com at a point that there isn't", "bodies", "com", "nowhere", always, "nowhere")
value("axis of zero", "joints", "axis", "[0, 0, 0]")
value("axis of four numbers", "joints", "axis", "[0, 0, 1, 1]")
value("axes parallel", "joints", "axes", "[[0, 0, 1], [0, 0, 1]]")
value("one axis of two", "joints", "axes", "[[0, 0, 1]]")
value("axes 45 degrees off", "joints", "axes", "[[0, 0, 1], [0, 1, 1]]")
value("point at a place that there isn't", "joints", "point", "nowhere", always, "nowhere")
value("points in one place", "joints", "points", "[[0, 0, 1], [0, 0, 1]]", of_type("distance", "revolute_spherical"))
value("one point of two", "joints", "points", "[[0, 0, 1]]")
added("length of zero", "joints", "length: 0", of_type("distance"), "length")
added("length below zero", "joints", "length: -1", of_type("distance"), "length")
added("offset beyond the length", "joints", "offset: 50", of_type("revolute_spherical"), "offset")
added("length of a revolute", "joints", "length: 1", of_type("revolute"), "length")
added("axis of a ball", "joints", "axis: [0, 0, 1]", of_type("spherical"), "axis")
value("type that there isn't", "joints", "type", "hinge", always, "hinge")
value("type in capitals", "joints", "type", "REVOLUTE", always, "REVOLUTE")
value("type that there isn't", "coordinates", "type", "distance", always, "distance")
value("type that there isn't", "forces", "type", "damper", always, "damper")
value("type that there isn't", "outputs", "type", "speed", always, "speed")
value("type that there isn't", "tires", "type", "fiala", always, "fiala")
value("range the wrong way round", "coordinates", "range", "[5, -5]", always, "range")
value("range of one number", "coordinates", "range", "[5]", always, "range")
value("range without the design", "coordinates", "range", "[90, 91]", of_type("angle", "translation"))
added("initial out of the range", "coordinates", "initial: 1000", always, "initial")
added("design of a length", "coordinates", "design: 1", of_type("length"), "design")
added("points of an angle", "coordinates", "points: [[0, 0, 0], [1, 0, 0]]", of_type("angle"), "points")
value("driven by a number", "coordinates", "driven", "1", always, "driven")
value("points in one place", "coordinates", "points", "[[0, 0, 1], [0, 0, 1]]", of_type("length"))
value("axis of zero", "coordinates", "axis", "[0, 0, 0]")
value("stiffness below zero", "forces", "stiffness", "-100", always, "stiffness")
value("damping below zero", "forces", "damping", "-100", always, "damping")
value("fade of zero", "forces", "fade", "0", always, "fade")
value("low above high", "forces", "low", "1e6", has("high"))
value("force of two components", "forces", "force", "[1, 2]", of_type("load"), "force")
added("coordinate and bodies", "forces", "bodies: [ground, ground]", has("coordinate"))
added("stiffness and table", "forces", "stiffness: 100", both(has("table"), of_type("spring_damper")))
added("value of a spring", "forces", "value: 1", of_type("spring_damper"), "value")
value("radius below zero", "wheels", "radius", "-0.3", always, "radius")
value("stiffness of zero", "wheels", "stiffness", "0", always, "stiffness")
value("fade below zero", "wheels", "fade", "-1", always, "fade")
value("spin inertia of zero", "wheels", "spin_inertia", "0", always, "spin_inertia")
value("spin inertia beyond the body's", "wheels", "spin_inertia", "1e6")
value("side in the middle", "wheels", "side", "middle", always, "middle")
value("windup of zero", "wheels", "windup", "0", always, "windup")
added("radius beside a tire", "wheels", "radius: 0.3", has("tire"), "radius")
added("brake without a tire", "wheels", "brake: 100", has("radius"), "brake")
added("drive body without drive", "wheels", "drive_body: ground", has("radius"), "drive_body")
value("x falls", "tables", "x", "[0, 2, 1, 3, 4]", lambda entry: len(split(entry.map["x"][1:-1])) == 5)
value("fewer x than y", "tables", "x", "[0, 1]")
value("one point", "tables", "x", "[0]")
value("no points", "tables", "x", "[]")
value("interpolation that there isn't", "tables", "interpolation", "quintic", always, "quintic")
value("continuation that there isn't", "tables", "beyond", "zero", always, "zero")
value("sliding force above the maximum", "tires", "fxs", "[1e6, 2e6]")
value("forces that fall", "tires", "fym", "[5000, 100]", always, "fym")
value("slips the wrong way round", "tires", "sxs", "[0.01, 0.01]")
value("load of zero", "tires", "load", "0", always, "load")
value("one number of two", "tires", "dfx0", "[1e5]", always, "dfx0")
value("relaxation below zero", "tires", "relaxation", "[-1, 1]", always, "relaxation")
added("file and type", "tires", "file: a.tir", has("type"))
added("key of another type", "tires", "load: 1000", has("file"), "load")
value("ratio below zero", "differentials", "ratio", "-1", always, "ratio")
value("split of one", "differentials", "split", "1", always, "split")
value("inertia below zero", "differentials", "inertia", "-1", always, "inertia")
value("three outputs", "differentials", "outputs", "[a, b, c]", always, "outputs")
value("output that there isn't", "differentials", "outputs", "[nothing]", lambda entry: "split" not in entry.map and
      "lock" not in entry.map, "nothing")
value("one output twice", "differentials", "outputs", "[same, same]")
added("split of one output", "differentials", "split: 0.5",
      lambda entry: len(split(entry.map["outputs"][1:-1])) == 1, "split")
value("inertia of zero", "powertrain", "inertia", "0", lambda entry: entry.name == "engine", "inertia")
value("idle above the limit", "powertrain", "idle", "1e4", has("limit"))
value("capacity that there isn't", "powertrain", "capacity", "nothing", always, "nothing")
value("too few shift speeds", "powertrain", "up", "[]", always, "up")
added("duration of zero", "powertrain", "duration: 0", lambda entry: entry.name == "transmission", "duration")
missing("powertrain", "up", always, "gears")
missing("powertrain", "down", always, "gears")

# what has no name of its own in the message: the place is enough, and what stands there
def plain(name, section, key, text, *says):
    @kind(f"{section}: {name}")
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, has(key))
        if not entry:
            return None
        entry.map[key] = text
        entry.save()
        return Mistake(entry.file, entry.line, *says)


plain("mass with a tag", "bodies", "mass", "!!float 3", "tag")
plain("file that there isn't", "tires", "file", "none.tir", "none.tir")
plain("file that is a folder", "tires", "file", ".", "folder")
plain("gear of zero", "powertrain", "forward", "[0]", "gear 1")
plain("gear below zero", "powertrain", "forward", "[-3]", "gear 1")
plain("reverse gear forwards", "powertrain", "reverse", "[3]", "gear -1")

# names that there aren't

value("body that there isn't", "forces", "body", "nobody", always, "nobody")

value("coordinate that there isn't", "forces", "coordinate", "nothing", always, "nothing")
value("table that there isn't", "forces", "table", "nothing", always, "nothing")
value("frame that there isn't", "forces", "in", "nobody", always, "nobody")
value("body that there isn't", "wheels", "body", "nobody", always, "nobody")
value("tire that there isn't", "wheels", "tire", "nothing", always, "nothing")
value("drive body that there isn't", "wheels", "drive_body", "nobody", always, "nobody")
value("body that there isn't", "outputs", "body", "nobody", always, "nobody")
value("coordinate that there isn't", "outputs", "coordinate", "nothing", always, "nothing")


def same_bodies(section):
    @kind(f"{section} between one body")
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, has("bodies"))
        if not entry:
            return None
        a = bodies_of(entry)[0]
        entry.map["bodies"] = f"[{a}, {a}]"
        entry.save()
        return entry.mistake(a)


def bodies_of(entry):
    return [name for name in split(entry.map["bodies"][1:-1]) if name != "ground"]


def other_body(section):
    @kind(f"{section}: second body that there isn't")
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, has("bodies"))
        if not entry:
            return None
        entry.map["bodies"] = f"[{bodies_of(entry)[0]}, nobody]"
        entry.save()
        return entry.mistake("nobody")


for section in ("joints", "coordinates", "forces"):
    same_bodies(section)
    other_body(section)


@kind("joints: to the ground of a free base")
def _(vehicle, rng):
    entry = some(vehicle, rng, "joints")
    if not entry or "base: ground" in vehicle.files[vehicle.main]:
        return None
    entry.map["bodies"] = f"[ground, {split(entry.map['bodies'][1:-1])[1]}]"
    entry.save()
    return entry.mistake("ground")


# ---- formulas --------------------------------------------------------------------------------------------------------

def formula(name, change, *says):
    @kind(f"formula: {name}")
    def _(vehicle, rng):
        places = [(entry, key) for section in ("forces", "wheels", "differentials", "powertrain")
                  for entry in vehicle.entries(section) for key, text in entry.map.items()
                  if text.startswith('"') and "[" not in text]
        if not places:
            return None
        entry, key = rng.choice(places)
        entry.map[key] = '"' + change(entry.map[key][1:-1]) + '"'
        entry.save()
        return entry.mistake(key, *says)


formula("parenthesis not closed", lambda text: text + " + (1")
formula("parenthesis not opened", lambda text: text + ")")
formula("ends in an operator", lambda text: text + " *")
formula("begins with an operator", lambda text: "/ " + text)
formula("empty", lambda text: "")
formula("nothing between two numbers", lambda text: "2 3 + " + text)
formula("name that there isn't", lambda text: text + " + nothing", "nothing")
formula("function that there isn't", lambda text: f"cosine({text})", "cosine")
formula("too few arguments", lambda text: f"atan2({text})", "atan2")
formula("too many arguments", lambda text: f"sin({text}, 1)", "sin")
formula("if without an else", lambda text: f"if({text}, 1)", "if")
formula("assignment", lambda text: "x = " + text)
formula("rate of a number", lambda text: text + " + rate(3)", "rate")
formula("rate of what is no coordinate", lambda text: text + " + rate(nothing)", "nothing")
formula("character that there isn't", lambda text: text + " + 1$")
formula("number that is too large", lambda text: text + " + 1e999")
formula("number cut short", lambda text: text + " + 1e")
formula("other brackets", lambda text: f"2 * [{text}]")


@kind("formula: length of no element")
def _(vehicle, rng):
    entry = some(vehicle, rng, "forces", both(of_type("force"), has("coordinate")))
    if not entry:
        return None
    entry.map["value"] = '"3 * length"'
    entry.save()
    return entry.mistake("value", "length")


@kind("parameters: after the one that needs it")
def _(vehicle, rng):
    row = vehicle.top("parameters") + 1
    vehicle.files[vehicle.main].insert(row, '  early: "2 * late"')
    vehicle.append("parameters", "  late: 3")
    return Mistake(vehicle.main, row + 1, "early", "late")


@kind("parameters: of itself")
def _(vehicle, rng):
    return Mistake(vehicle.main, vehicle.append("parameters", '  own: "2 * own"'), "own")


@kind("parameters: tunable and dependent")
def _(vehicle, rng):
    gain = some(vehicle, rng, "parameters", has("tunable"))
    return Mistake(vehicle.main, vehicle.append("parameters", f'  more: {{value: "2 * {gain.name}", tunable: true}}'),
                   "more") if gain and gain.file == vehicle.main else None


def tunable(section, key, text):
    @kind(f"{section}: tunable {key}")
    def _(vehicle, rng):
        entry = some(vehicle, rng, section, has(key))
        if not entry:
            return None
        vehicle.files[vehicle.main].insert(vehicle.top("parameters") + 1, "  tuned: {value: 1, tunable: true}")
        entry = next(e for e in vehicle.entries(section) if e.name == entry.name and e.file == entry.file)
        entry.map[key] = text
        entry.save()
        return entry.mistake(key, "tuned")


tunable("coordinates", "range", "[-10, tuned]")
tunable("bodies", "orientation", "{axis: [tuned, 0, 0], angle: 1}")
tunable("tables", "x", "[0, 1, 2, 3, tuned]")
tunable("wheels", "spin_inertia", "tuned")
tunable("tires", "radius", "tuned")
tunable("inputs", "default", "tuned")


# ---- the whole file --------------------------------------------------------------------------------------------------

def top(name, key, text, *says):
    @kind(f"file: {name}")
    def _(vehicle, rng):
        row = vehicle.top(key)
        if text is None:
            del vehicle.files[vehicle.main][row]
            return Mistake(vehicle.main, None, *says)
        vehicle.files[vehicle.main][row] = f"{key}: {text}"
        return Mistake(vehicle.main, row + 1, *says)


top("no version", "gicgen", None, "gicgen")
top("no model", "model", None, "model")
top("no base", "base", None, "base")
top("version 2", "gicgen", "2", "gicgen")
top("model with a dash", "model", "my-model", "my-model")
top("model that is a keyword", "model", "while", "while")
top("model that is a function of the library", "model", "sinh", "sinh")
top("model of the runtime", "model", "gic_car", "gic_car")
top("base that there isn't", "base", "nobody", "nobody")
top("base a list", "base", "[a]")
for name, line, *says in (("gravity of two numbers", "gravity: [0, 0]", "gravity"),
                          ("gravity a word", "gravity: down", "gravity"),
                          ("key that there isn't", "wings: {}", "wings"),
                          ("key in capitals", "Bodies: {}", "Bodies"),
                          ("joints a list", "joints: [a]", "joint"),
                          ("merge key", "<<: {model: a}", "<<"),
                          ("alias that there isn't", "description: *nothing", "nothing"),
                          ("description of two lines", 'description: "a\\nb"', "description"),
                          ("bracket not closed", "description: [1, 2",),
                          ("quote not closed", 'description: "car',),
                          ("tabulator", "\tdescription: car",),
                          ("bytes that are no UTF-8", "description: \xe9\xff",),
                          ("control character", "description: a\x01b",),
                          ("not a key", "just words",),
                          ("second document", "---",)):
    @kind(f"file: {name}")
    def _(vehicle, rng, line=line, says=says):
        if line.startswith("joints"):
            rows = {entry.row for entry in vehicle.entries("joints") if entry.file == vehicle.main}
            lines = vehicle.files[vehicle.main]
            vehicle.files[vehicle.main] = [text for i, text in enumerate(lines) if i not in rows and text != "joints:"]
        vehicle.files[vehicle.main].insert(1, line)
        return Mistake(vehicle.main, 2 if says else None, *says)

for section, name in (("bodies", "ground"), ("bodies", "world"), ("joints", "a-b"), ("coordinates", "3rd"),
                      ("forces", "_law"), ("outputs", "n" * 41), ("inputs", "é"), ("tables", "a.b"),
                      ("parameters", '""')):
    @kind(f"{section}: name {name}")
    def _(vehicle, rng, section=section, name=name):
        # a prefix would mend it
        entry = some(vehicle, rng, section, lambda entry: entry.file == vehicle.main)
        if not entry:
            return None
        vehicle.files[entry.file][entry.row] = vehicle.files[entry.file][entry.row].replace(
            entry.name, name.encode().decode("latin-1"), 1)
        return Mistake(entry.file, entry.line, *([] if name in ("é", '""') else [name]))


@kind("coordinates: names the same in capitals")
def _(vehicle, rng):
    entry = some(vehicle, rng, "coordinates", lambda entry: entry.file == vehicle.main)
    if not entry:
        return None
    vehicle.files[entry.file].insert(entry.row + 1, vehicle.files[entry.file][entry.row].replace(
        entry.name, entry.name.upper(), 1))
    return Mistake(entry.file, None, entry.name.upper())


@kind("inputs: the name of a driven coordinate")
def _(vehicle, rng):
    entry = some(vehicle, rng, "coordinates", lambda entry: "driven" in entry.map and entry.file == vehicle.main)
    if not entry:
        return None
    return Mistake(vehicle.main, vehicle.append("inputs", f"  {entry.name}: {{default: 1}}"), entry.name)


def removed(section, used):
    """An entry that another needs is gone; a name of another of its map may be meant then."""
    @kind(f"{section}: one that is used is gone")
    def _(vehicle, rng):
        names = [entry for entry in vehicle.entries(section)
                 if any(re.search(used.replace("@", re.escape(entry.name)), "\n".join(lines))
                        for file, lines in vehicle.files.items() if file == entry.file)]
        if not names:
            return None
        entry = rng.choice(names)
        del vehicle.files[entry.file][entry.row]
        vehicle.drop_titles()
        return Mistake(None, None, entry.name)


removed("bodies", r"bodies: \[[^]]*\b@\b")
removed("coordinates", r"coordinate: @[,}]")
removed("points", r"(point|com|position|center): @[,}]")
removed("tables", r"table: @[,}]")
removed("parameters", r"[ \"]@[ ,\")\]]")


@kind("file: key twice")
def _(vehicle, rng):
    vehicle.files[vehicle.main].insert(1, "model: again")
    return Mistake(vehicle.main, 3, "model")


# ---- inclusion -------------------------------------------------------------------------------------------------------

def included(name, change):
    @kind(f"include: {name}")
    def _(vehicle, rng):
        entry = some(vehicle, rng, "include")
        return change(vehicle, entry, entry.map["file"]) if entry else None


def set_include(key, text, *says):
    def change(vehicle, entry, part):
        entry.map[key] = text
        entry.save()
        return entry.mistake(*says)
    return change


def circle(vehicle, entry, part):
    vehicle.files[part].insert(1, f"include: {vehicle.main}")
    return Mistake(part, 2, vehicle.main)


def own(vehicle, entry, part):
    vehicle.files[part].insert(1, f"include: {part}")
    return Mistake(part, 2, part)


def no_version(vehicle, entry, part):
    del vehicle.files[part][0]
    return Mistake(part, None, "gicgen")


def other_version(vehicle, entry, part):
    vehicle.files[part][0] = "gicgen: 3"
    return Mistake(part, 1, "gicgen")


def twice(vehicle, entry, part):
    """The same entries once more, under the same names."""
    if "prefix" not in entry.map:
        return None
    vehicle.files[vehicle.main].insert(entry.row + 1, vehicle.files[vehicle.main][entry.row])
    return Mistake(None, None)


def empty(vehicle, entry, part):
    vehicle.files[part] = []
    return Mistake(part, None)


included("file that there isn't", set_include("file", "none.veh", "none.veh"))
included("folder", set_include("file", "."))
included("place of two numbers", set_include("at", "[1, 2]", "at"))
included("place a word", set_include("at", "here", "at"))
included("prefix with a dash", set_include("prefix", "a-", "a-"))
included("prefix a list", set_include("prefix", "[a]", "prefix"))
included("key that there isn't", set_include("scale", "2", "scale"))
included("in a circle", circle)
included("of itself", own)
included("of a file without version", no_version)
included("of a file of another version", other_version)
included("twice", twice)
included("of an empty file", empty)


# ---- tires -----------------------------------------------------------------------------------------------------------

def tir(name, pattern, text, *says):
    @kind(f"tir: {name}")
    def _(vehicle, rng):
        file = vehicle.tir()
        rows = [row for row, line in enumerate(vehicle.files[file]) if re.match(pattern, line)] if file else []
        if not rows:
            return None
        if text is None:
            del vehicle.files[file][rows[0]]
        else:
            vehicle.files[file][rows[0]:rows[0] + 1] = text.split("\n")
        return Mistake(file, None if text is None else rows[0] + 1 + text.count("\n"), *says)


for key in ("UNLOADED_RADIUS", "FNOMIN", "VERTICAL_STIFFNESS", "LENGTH", "PROPERTY_FILE_FORMAT"):
    tir(f"without {key}", key, None, key)
tir("a word for a number", "FNOMIN", "FNOMIN = large", "FNOMIN")
tir("number of two parts", "FNOMIN", "FNOMIN = 1 2", "FNOMIN")
tir("no value", "FNOMIN", "FNOMIN =", "FNOMIN")
tir("no equals sign", "FNOMIN", "FNOMIN 4000", "KEY = value")
tir("key twice", "FNOMIN", "FNOMIN = 4000\nFNOMIN = 4000", "FNOMIN")
tir("radius below zero", "UNLOADED_RADIUS", "UNLOADED_RADIUS = -1", "UNLOADED_RADIUS")
tir("number that is too large", "FNOMIN", "FNOMIN = 1e999", "FNOMIN")
tir("not a number", "FNOMIN", "FNOMIN = nan", "FNOMIN")
tir("unit that there isn't", "LENGTH", "LENGTH = 'furlong'", "LENGTH")
tir("mode that there isn't", "USE_MODE", "USE_MODE = 7", "USE_MODE")
tir("other format", "PROPERTY_FILE_FORMAT", "PROPERTY_FILE_FORMAT = 'FTIRE'", "FTIRE")
tir("side that there isn't", "TYRESIDE", "TYRESIDE = 'TOP'", "TYRESIDE")
tir("quote not closed", "LENGTH", "LENGTH = 'meter", "LENGTH")
tir("section not closed", r"\[UNITS\]", "[UNITS")
tir("scale of zero", "LMUX", "LMUX = 0", "LMUX")


# ---- mechanisms ------------------------------------------------------------------------------------------------------

@kind("mechanism: a body that nothing holds")
def _(vehicle, rng):
    vehicle.append("bodies", "  loose: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}")
    return Mistake(None, None, "loose")


@kind("mechanism: a rod of an impossible length")
def _(vehicle, rng):
    entry = some(vehicle, rng, "joints", of_type("distance"))
    if not entry:
        return None
    entry.map["length"] = "30"
    entry.save()
    return Mistake(None, None, entry.name)


def sides(names):
    """The names, and those of their images."""
    return sorted({other for name in names for other in (name, re.sub("_l$", "_r", name))})


@kind("mechanism: a coordinate twice")
def _(vehicle, rng):
    entry = some(vehicle, rng, "coordinates", lambda entry: entry.file == vehicle.main)
    if not entry:
        return None
    text = vehicle.files[entry.file][entry.row].replace(entry.name, "again", 1)
    vehicle.files[entry.file].insert(entry.row + 1, text)
    return Mistake(None, None, ["again", *sides([entry.name, *bodies_of(entry)])])


for type_ in ("revolute", "spherical", "distance", "universal", "prismatic", "cylindrical", "parallel",
              "revolute_spherical"):
    @kind(f"mechanism: a {type_} joint twice")
    def _(vehicle, rng, type_=type_):
        entry = some(vehicle, rng, "joints", of_type(type_))
        if not entry:
            return None
        vehicle.files[entry.file].insert(entry.row + 1,
                                         vehicle.files[entry.file][entry.row].replace(entry.name, "again", 1))
        return Mistake(None, None, ["again", *sides([entry.name, *bodies_of(entry)])])

    @kind(f"mechanism: a {type_} joint gone")
    def _(vehicle, rng, type_=type_):
        entry = some(vehicle, rng, "joints", of_type(type_))
        if not entry:
            return None
        del vehicle.files[entry.file][entry.row]
        vehicle.drop_titles()
        return Mistake(None, None, sides(bodies_of(entry)))

for type_ in ("length", "angle", "translation"):
    @kind(f"mechanism: a {type_} gone")
    def _(vehicle, rng, type_=type_):
        entry = some(vehicle, rng, "coordinates", of_type(type_))
        if not entry:
            return None
        # all that would need it goes too
        name = rf"(?<![A-Za-z0-9_])(p\d_)?{re.sub('_l$', '_[lr]', entry.name)}(?![A-Za-z0-9_])"
        for file, lines in vehicle.files.items():
            vehicle.files[file] = [line for line in lines if not re.search(name, line)]
        vehicle.drop_titles()
        return Mistake(None, None, sides(bodies_of(entry)))


@kind("mechanism: a ball instead of a hinge")
def _(vehicle, rng):
    entry = some(vehicle, rng, "joints", of_type("revolute"))
    if not entry:
        return None
    entry.map["type"] = "spherical"
    del entry.map["axis"]
    entry.save()
    return Mistake(None, None, sides([entry.name, *bodies_of(entry)]))


@kind("mechanism: a weld instead of a hinge")
def _(vehicle, rng):
    entry = some(vehicle, rng, "joints", of_type("revolute"))
    if not entry:
        return None
    entry.map["type"] = "fixed"
    del entry.map["axis"]
    entry.save()
    return Mistake(None, None, sides([entry.name, *bodies_of(entry)]))
