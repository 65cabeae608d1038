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

    def change(self, key, text):
        """Another value, None: no such key any more."""
        if text is None:
            del self.map[key]
        else:
            self.map[key] = text
        self.save()
        return self

    def put(self, text):
        """Other text for the whole value."""
        self.vehicle.files[self.file][self.row] = f"{self.lead}{self.name}: {text}"

    def again(self, name=None):
        """The same once more behind it, under another name."""
        text = self.vehicle.files[self.file][self.row]
        self.vehicle.files[self.file].insert(self.row + 1, text.replace(self.name, name, 1) if name else text)

    def drop(self):
        del self.vehicle.files[self.file][self.row]
        self.vehicle.drop_titles()

    def in_main(self):
        return self.file == self.vehicle.main

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


def always(_):
    return True


def kind(name, section=None, want=always):
    """The decorated function breaks (vehicle, rng) or, where a section is given, one of its entries that are wanted."""
    def note(function):
        def picked(vehicle, rng):
            entry = some(vehicle, rng, section, want)
            return function(entry) if entry else None
        assert name not in KINDS, name
        KINDS[name] = picked if section else function
        return function
    return note


def some(vehicle, rng, section, want=always):
    found = [entry for entry in vehicle.entries(section) if want(entry)]
    return rng.choice(found) if found else None


def has(*keys):
    return lambda entry: all(key in entry.map for key in keys)


def of_type(*types):
    return lambda entry: entry.map.get("type") in types


def both(*conditions):
    return lambda entry: all(condition(entry) for condition in conditions)


# ---- kinds made of tables --------------------------------------------------------------------------------------------

def missing(section, key, want=always, says=None):
    @kind(f"{section} without {key}" + (f" of {says}" if says else ""), section, both(has(key), want))
    def _(entry):
        return entry.change(key, None).mistake(key)


def value(name, section, key, text, *says, want=always):
    """`key` gets the value `text`."""
    @kind(f"{section}: {name}", section, both(has(key), want))
    def _(entry):
        return entry.change(key, text).mistake(*says)


def added(name, section, text, *says, want=always):
    """Another `key: value`."""
    key, what = text.split(": ", 1)

    @kind(f"{section}: {name}", section, both(want, lambda entry: key not in entry.map))
    def _(entry):
        return entry.change(key, what).mistake(*says) if entry.is_map else None


for section, keys in (("bodies", "mass com inertia"), ("tables", "x y"), ("joints", "type bodies"),
                      ("coordinates", "type bodies"), ("forces", "type"), ("wheels", "body center spin_inertia"),
                      ("outputs", "type body"), ("differentials", "outputs")):
    for key in keys.split():
        missing(section, key)
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
missing("wheels", "radius")
missing("wheels", "stiffness")
for key in "radius stiffness damping load dfx0 fxm fxs sxm sys trail sqe".split():
    missing("tires", key, of_type("tmeasy"))
for part, keys in (("engine", "inertia throttle torque"), ("converter", "capacity torque"),
                   ("transmission", "forward")):
    for key in keys.split():
        missing("powertrain", key, lambda entry, part=part: entry.name == part, part)

for section in ("bodies", "joints", "coordinates", "forces", "wheels", "tables", "outputs", "inputs", "tires",
                "differentials", "powertrain"):
    added("key that there isn't", section, "colour: 1", "colour", want=lambda entry: entry.is_map)

    @kind(f"{section}: key twice")
    def _(vehicle, rng, section=section):
        entry = some(vehicle, rng, section, lambda entry: entry.is_map and len(entry.map) > 0)
        if not entry:
            return None
        key, what = rng.choice(list(entry.map.items()))
        return Mistake(entry.file, entry.change(key, f"{what}, {key}: {what}").line, key)

    @kind(f"{section}: an entry that is a number", section)
    def _(entry):
        entry.put("12")
        return entry.mistake()

    @kind(f"{section}: an empty entry", section)
    def _(entry, text="{}" if section != "inputs" else ""):
        entry.put(text)
        return entry.mistake()

    @kind(f"{section}: a name twice", section)
    def _(entry):
        entry.again()
        return Mistake(entry.file, entry.line + 1, entry.name)

# numbers that are none, in places of all kinds
for section, key in (("bodies", "mass"), ("joints", "length"), ("forces", "damping"), ("wheels", "spin_inertia"),
                     ("tires", "radius"), ("coordinates", "design"), ("differentials", "ratio"), ("inputs", "default")):
    value(f"{key} not a number", section, key, ".nan")
    value(f"{key} too large", section, key, "1e400")
    value(f"{key} a word", section, key, "heavy", "heavy")
    value(f"{key} a list", section, key, "[1, 2]")
    value(f"{key} with a unit", section, key, "12 kg")
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
value("inertia with another key", "bodies", "inertia", "{xx: 1, yy: 1, zz: 1, ww: 2}", "ww")
value("euler parameters too long", "bodies", "orientation", "{euler: [1, 1, 0, 0]}")
value("euler parameters of three", "bodies", "orientation", "{euler: [1, 0, 0]}")
value("orientation by a zero axis", "bodies", "orientation", "{axis: [0, 0, 0], angle: 1}")
value("orientation by parallel directions", "bodies", "orientation", "{x: [1, 0, 0], z: [2, 0, 0]}")
value("orientation by half", "bodies", "orientation", "{x: [1, 0, 0]}")
value("com of two numbers", "bodies", "com", "[1, 2]")
value("com a million away", "bodies", "com", "[1e7, 2, 0]")
value("com at a point that there isn't", "bodies", "com", "nowhere", "nowhere")
value("axis of zero", "joints", "axis", "[0, 0, 0]")
value("axis of four numbers", "joints", "axis", "[0, 0, 1, 1]")
value("axes parallel", "joints", "axes", "[[0, 0, 1], [0, 0, 1]]")
value("one axis of two", "joints", "axes", "[[0, 0, 1]]")
value("axes 45 degrees off", "joints", "axes", "[[0, 0, 1], [0, 1, 1]]")
value("point at a place that there isn't", "joints", "point", "nowhere", "nowhere")
value("points in one place", "joints", "points", "[[0, 0, 1], [0, 0, 1]]",
      want=of_type("distance", "revolute_spherical"))
value("one point of two", "joints", "points", "[[0, 0, 1]]")
added("length of zero", "joints", "length: 0", "length", want=of_type("distance"))
added("length below zero", "joints", "length: -1", "length", want=of_type("distance"))
added("offset beyond the length", "joints", "offset: 50", "offset", want=of_type("revolute_spherical"))
added("length of a revolute", "joints", "length: 1", "length", want=of_type("revolute"))
added("axis of a ball", "joints", "axis: [0, 0, 1]", "axis", want=of_type("spherical"))
value("type that there isn't", "joints", "type", "hinge", "hinge")
value("type in capitals", "joints", "type", "REVOLUTE", "REVOLUTE")
value("type that there isn't", "coordinates", "type", "distance", "distance")
value("type that there isn't", "forces", "type", "damper", "damper")
value("type that there isn't", "outputs", "type", "speed", "speed")
value("type that there isn't", "tires", "type", "fiala", "fiala")
value("range the wrong way round", "coordinates", "range", "[5, -5]", "range")
value("range of one number", "coordinates", "range", "[5]", "range")
value("range without the design", "coordinates", "range", "[90, 91]", want=of_type("angle", "translation"))
added("initial out of the range", "coordinates", "initial: 1000", "initial")
added("design of a length", "coordinates", "design: 1", "design", want=of_type("length"))
added("points of an angle", "coordinates", "points: [[0, 0, 0], [1, 0, 0]]", "points", want=of_type("angle"))
value("driven by a number", "coordinates", "driven", "1", "driven")
value("points in one place", "coordinates", "points", "[[0, 0, 1], [0, 0, 1]]", want=of_type("length"))
value("axis of zero", "coordinates", "axis", "[0, 0, 0]")
value("stiffness below zero", "forces", "stiffness", "-100", "stiffness")
value("damping below zero", "forces", "damping", "-100", "damping")
value("fade of zero", "forces", "fade", "0", "fade")
value("low above high", "forces", "low", "1e6", want=has("high"))
value("force of two components", "forces", "force", "[1, 2]", "force", want=of_type("load"))
added("coordinate and bodies", "forces", "bodies: [ground, ground]", want=has("coordinate"))
added("stiffness and table", "forces", "stiffness: 100", want=both(has("table"), of_type("spring_damper")))
added("value of a spring", "forces", "value: 1", "value", want=of_type("spring_damper"))
value("radius below zero", "wheels", "radius", "-0.3", "radius")
value("stiffness of zero", "wheels", "stiffness", "0", "stiffness")
value("fade below zero", "wheels", "fade", "-1", "fade")
value("spin inertia of zero", "wheels", "spin_inertia", "0", "spin_inertia")
value("spin inertia beyond the body's", "wheels", "spin_inertia", "1e6")
value("side in the middle", "wheels", "side", "middle", "middle")
value("windup of zero", "wheels", "windup", "0", "windup")
added("radius beside a tire", "wheels", "radius: 0.3", "radius", want=has("tire"))
added("brake without a tire", "wheels", "brake: 100", "brake", want=has("radius"))
added("drive body without drive", "wheels", "drive_body: ground", "drive_body", want=has("radius"))
value("x falls", "tables", "x", "[0, 2, 1, 3, 4]", want=lambda entry: len(split(entry.map["x"][1:-1])) == 5)
value("fewer x than y", "tables", "x", "[0, 1]")
value("one point", "tables", "x", "[0]")
value("no points", "tables", "x", "[]")
value("interpolation that there isn't", "tables", "interpolation", "quintic", "quintic")
value("continuation that there isn't", "tables", "beyond", "zero", "zero")
value("sliding force above the maximum", "tires", "fxs", "[1e6, 2e6]")
value("forces that fall", "tires", "fym", "[5000, 100]", "fym")
value("slips the wrong way round", "tires", "sxs", "[0.01, 0.01]")
value("load of zero", "tires", "load", "0", "load")
value("one number of two", "tires", "dfx0", "[1e5]", "dfx0")
value("relaxation below zero", "tires", "relaxation", "[-1, 1]", "relaxation")
added("file and type", "tires", "file: a.tir", want=has("type"))
added("key of another type", "tires", "load: 1000", "load", want=has("file"))
value("ratio below zero", "differentials", "ratio", "-1", "ratio")
value("split of one", "differentials", "split", "1", "split")
value("inertia below zero", "differentials", "inertia", "-1", "inertia")
value("three outputs", "differentials", "outputs", "[a, b, c]", "outputs")
value("output that there isn't", "differentials", "outputs", "[nothing]", "nothing",
      want=lambda entry: not {"split", "lock"} & set(entry.map))
value("one output twice", "differentials", "outputs", "[same, same]")
added("split of one output", "differentials", "split: 0.5", "split",
      want=lambda entry: len(split(entry.map["outputs"][1:-1])) == 1)
value("inertia of zero", "powertrain", "inertia", "0", "inertia", want=lambda entry: entry.name == "engine")
value("idle above the limit", "powertrain", "idle", "1e4", want=has("limit"))
value("capacity that there isn't", "powertrain", "capacity", "nothing", "nothing")
value("too few shift speeds", "powertrain", "up", "[]", "up")
added("duration of zero", "powertrain", "duration: 0", "duration", want=lambda entry: entry.name == "transmission")
missing("powertrain", "up", says="gears")
missing("powertrain", "down", says="gears")

# what has no name of its own in the message: the place is enough, and what stands there
def plain(name, section, key, text, *says):
    @kind(f"{section}: {name}", section, has(key))
    def _(entry):
        return Mistake(entry.file, entry.change(key, text).line, *says)


plain("mass with a tag", "bodies", "mass", "!!float 3", "tag")
plain("file that there isn't", "tires", "file", "none.tir", "none.tir")
plain("file that is a folder", "tires", "file", ".", "folder")
plain("gear of zero", "powertrain", "forward", "[0]", "gear 1")
plain("gear below zero", "powertrain", "forward", "[-3]", "gear 1")
plain("reverse gear forwards", "powertrain", "reverse", "[3]", "gear -1")

# names that there aren't

value("body that there isn't", "forces", "body", "nobody", "nobody")

value("coordinate that there isn't", "forces", "coordinate", "nothing", "nothing")
value("table that there isn't", "forces", "table", "nothing", "nothing")
value("frame that there isn't", "forces", "in", "nobody", "nobody")
value("body that there isn't", "wheels", "body", "nobody", "nobody")
value("tire that there isn't", "wheels", "tire", "nothing", "nothing")
value("drive body that there isn't", "wheels", "drive_body", "nobody", "nobody")
value("body that there isn't", "outputs", "body", "nobody", "nobody")
value("coordinate that there isn't", "outputs", "coordinate", "nothing", "nothing")


def bodies_of(entry):
    return [name for name in split(entry.map["bodies"][1:-1]) if name != "ground"]


for section in ("joints", "coordinates", "forces"):
    for name, other in ((" between one body", None), (": second body that there isn't", "nobody")):
        @kind(section + name, section, has("bodies"))
        def _(entry, other=other):
            own = bodies_of(entry)[0]
            return entry.change("bodies", f"[{own}, {other or own}]").mistake(other or own)


@kind("joints: to the ground of a free base", "joints")
def _(entry):
    if "base: ground" in entry.vehicle.files[entry.vehicle.main]:
        return None
    return entry.change("bodies", f"[ground, {split(entry.map['bodies'][1:-1])[1]}]").mistake("ground")


# ---- formulas --------------------------------------------------------------------------------------------------------

def formula(name, change, *says, steady=True):
    """In a law and, where nothing in it asks for time, in a number of the geometry."""
    @kind(f"formula: {name}")
    def _(vehicle, rng):
        places = [(entry, key) for section in ("forces", "wheels", "differentials", "powertrain")
                  for entry in vehicle.entries(section) for key, text in entry.map.items()
                  if text.startswith('"') and "[" not in text]
        if not places:
            return None
        entry, key = rng.choice(places)
        return entry.change(key, '"' + change(entry.map[key][1:-1]) + '"').mistake(key, *says)

    if not steady:
        return

    @kind(f"formula of geometry: {name}")
    def _(vehicle, rng):
        places = [(entry, key, piece) for section in ("points", "bodies", "joints", "coordinates")
                  for entry in vehicle.entries(section) for key, text in entry.map.items()
                  if text.startswith("[") for piece in re.findall('"[^"]*"', text)]
        if not places:
            return None
        entry, key, piece = rng.choice(places)
        text = entry.map[key].replace(piece, '"' + change(piece[1:-1]) + '"', 1)
        return entry.change(key, text).mistake(key or entry.name, *says)


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
formula("rate of what is no coordinate", lambda text: text + " + rate(nothing)", "nothing", steady=False)
formula("character that there isn't", lambda text: text + " + 1$")
formula("number that is too large", lambda text: text + " + 1e999")
formula("number cut short", lambda text: text + " + 1e")
formula("other brackets", lambda text: f"2 * [{text}]")


@kind("formula: length of no element", "forces", both(of_type("force"), has("coordinate")))
def _(entry):
    return entry.change("value", '"3 * length"').mistake("value", "length")


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
    @kind(f"{section}: tunable {key}", section, has(key))
    def _(entry):
        vehicle = entry.vehicle
        vehicle.files[vehicle.main].insert(vehicle.top("parameters") + 1, "  tuned: {value: 1, tunable: true}")
        entry = next(e for e in vehicle.entries(section) if e.name == entry.name and e.file == entry.file)
        return entry.change(key, text).mistake(key, "tuned")


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
    @kind(f"{section}: name {name}", section, Entry.in_main)  # a prefix would mend it
    def _(entry, name=name):
        lines = entry.vehicle.files[entry.file]
        lines[entry.row] = lines[entry.row].replace(entry.name, name.encode().decode("latin-1"), 1)
        return Mistake(entry.file, entry.line, *([] if name in ("é", '""') else [name]))


@kind("coordinates: names the same in capitals", "coordinates", Entry.in_main)
def _(entry):
    entry.again(entry.name.upper())
    return Mistake(entry.file, None, entry.name.upper())


@kind("inputs: the name of a driven coordinate", "coordinates", both(has("driven"), Entry.in_main))
def _(entry):
    return Mistake(entry.vehicle.main, entry.vehicle.append("inputs", f"  {entry.name}: {{default: 1}}"), entry.name)


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
        entry.drop()
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
        return entry.change(key, text).mistake(*says)
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


@kind("mechanism: a rod of an impossible length", "joints", of_type("distance"))
def _(entry):
    return Mistake(None, None, entry.change("length", "30").name)


def sides(names):
    """The names, and those of their images."""
    return sorted({other for name in names for other in (name, re.sub("_l$", "_r", name))})


def twice_there(entry):
    entry.again("again")
    return Mistake(None, None, ["again", *sides([entry.name, *bodies_of(entry)])])


kind("mechanism: a coordinate twice", "coordinates", Entry.in_main)(twice_there)
for type_ in ("revolute", "spherical", "distance", "universal", "prismatic", "cylindrical", "parallel",
              "revolute_spherical"):
    kind(f"mechanism: a {type_} joint twice", "joints", of_type(type_))(twice_there)

    @kind(f"mechanism: a {type_} joint gone", "joints", of_type(type_))
    def _(entry):
        entry.drop()
        return Mistake(None, None, sides(bodies_of(entry)))

for type_ in ("length", "angle", "translation"):
    @kind(f"mechanism: a {type_} gone", "coordinates", of_type(type_))
    def _(entry):
        # all that would need it goes too
        name = rf"(?<![A-Za-z0-9_])(p\d_)?{re.sub('_l$', '_[lr]', entry.name)}(?![A-Za-z0-9_])"
        for file, lines in entry.vehicle.files.items():
            entry.vehicle.files[file] = [line for line in lines if not re.search(name, line)]
        entry.vehicle.drop_titles()
        return Mistake(None, None, sides(bodies_of(entry)))


for name, type_ in (("ball", "spherical"), ("weld", "fixed")):
    @kind(f"mechanism: a {name} instead of a hinge", "joints", of_type("revolute"))
    def _(entry, type_=type_):
        entry.change("type", type_).change("axis", None)
        return Mistake(None, None, sides([entry.name, *bodies_of(entry)]))
