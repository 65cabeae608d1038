# SPDX-License-Identifier: MIT
# rules.py modelDescription.xml [terminalsAndIcons.xml]: what the standard demands of it beyond the schema (FMI 2.0 section 2.2, FMI 3.0 section
# 2.4): names, references, units, start values, lists of ModelStructure. Prints each violation; exit status 1 where there
# is one, and how many variables were looked at.
import os
import re
import struct
import sys
import xml.etree.ElementTree as tree

root = tree.parse(sys.argv[1]).getroot()
version = int(root.get("fmiVersion")[0])
mistakes = []


def demand(condition, text):
    if not condition:
        mistakes.append(text)


class Variable:
    def __init__(self, index, node):
        typed = node[0] if version == 2 else node
        self.index, self.name, self.reference = index, node.get("name"), int(node.get("valueReference"))
        self.type = typed.tag
        self.causality = node.get("causality", "local")
        self.real = self.type in ("Real", "Float64")
        self.variability = node.get("variability", "continuous" if self.real else "discrete")
        self.initial, self.start = node.get("initial"), typed.get("start")
        self.unit, self.derivative = typed.get("unit"), typed.get("derivative")
        self.least, self.most = typed.get("min"), typed.get("max")


variables = [Variable(i + 1, node) for i, node in enumerate(root.find("ModelVariables"))]
units = {unit.get("name"): unit for unit in root.find("UnitDefinitions")}

# names and references
identifier = r"[A-Za-z_][A-Za-z0-9_]*"
name = r"%s(\.%s)*" % (identifier, identifier)
names = [v.name for v in variables]
demand(len(set(names)) == len(names), "a name occurs twice")
demand(len({v.reference for v in variables}) == len(variables), "a value reference occurs twice")
for v in variables:
    demand(re.fullmatch(r"%s|der\(%s\)" % (name, name), v.name), "not a structured name: " + v.name)
    demand(not any(other.startswith(v.name + ".") for other in names), v.name + " is both a value and a group")

# units
for v in variables:
    if v.real:
        demand(v.unit in units, "%s: unit %s is not defined" % (v.name, v.unit))


def exponents(unit):
    base = units[unit].find("BaseUnit")
    return None if base is None else {k: int(n) for k, n in base.attrib.items() if k not in ("factor", "offset")}


# start values: the tables of causality, variability and initial
default = {("parameter", "fixed"): "exact", ("parameter", "tunable"): "exact", ("output", "continuous"): "calculated",
           ("output", "discrete"): "calculated", ("local", "continuous"): "calculated",
           ("local", "discrete"): "calculated"}
for v in variables:
    if v.causality in ("input", "independent"):
        demand(v.initial is None, v.name + " may not have `initial`")
        demand((v.start is not None) == (v.causality == "input"), v.name + ": start")
        demand(v.variability in ("continuous", "discrete"), v.name + ": variability")
        continue
    demand((v.causality, v.variability) in default, "%s: %s %s" % (v.name, v.causality, v.variability))
    initial = v.initial or default.get((v.causality, v.variability))
    demand((v.start is not None) == (initial in ("exact", "approx")), v.name + ": start and initial " + str(initial))
    if v.start is not None:
        for bound, sign in (v.least, 1), (v.most, -1):
            demand(bound is None or sign * float(v.start) >= sign * float(bound), v.name + ": start out of bounds")
demand([v.causality for v in variables].count("independent") == 1, "one independent variable")

# lists
structure = root.find("ModelStructure")


def listed(tag2, tag3):
    if version == 3:
        references = [int(node.get("valueReference")) for node in structure.findall(tag3)]
        by_reference = {v.reference: v for v in variables}
        return [by_reference[r] for r in references]
    items = structure.find(tag2)
    return [] if items is None else [variables[int(node.get("index")) - 1] for node in items]


outputs, rates = listed("Outputs", "Output"), listed("Derivatives", "ContinuousStateDerivative")
demand([v.name for v in outputs] == [v.name for v in variables if v.causality == "output"], "Outputs are not the outputs")
states = []
for rate in rates:
    demand(rate.derivative is not None, rate.name + " is no derivative")
    key = int(rate.derivative)
    state = variables[key - 1] if version == 2 else next(v for v in variables if v.reference == key)
    states.append(state)
    demand(rate.name == "der(%s)" % state.name, "%s is not named der(%s)" % (rate.name, state.name))
    have, want = exponents(rate.unit), dict(exponents(state.unit) or {})
    want["s"] = want.get("s", 0) - 1
    demand(have is None or have == {k: n for k, n in want.items() if n}, "%s in %s" % (rate.name, rate.unit))
demand(len(set(map(id, states))) == len(states), "a state has two derivatives")
demand(len(rates) == sum(v.derivative is not None for v in variables), "a derivative is not listed")
calculated = [v for v in variables if (v.causality == "output" or v in states or v in rates)
              and (v.initial or default[(v.causality, v.variability)]) in ("approx", "calculated")]
unknowns = listed("InitialUnknowns", "InitialUnknown")
demand(sorted(v.index for v in unknowns) == [v.index for v in calculated], "InitialUnknowns are not what is calculated")
if version == 2:
    demand([v.index for v in unknowns] == sorted(v.index for v in unknowns), "InitialUnknowns are not in order")

# event indicators are real variables that the FMU computes
for v in listed("", "EventIndicator") if version == 3 else []:
    demand(v.real and v.causality in ("local", "output") and v.start is None, v.name + " can't be an event indicator")

# terminals: members are variables, once a terminal; the icon is within its coordinate system and undistorted
if len(sys.argv) > 2:
    picture = os.path.join(os.path.dirname(sys.argv[2]), "icon.png")
    icon = next(tree.parse(sys.argv[2]).getroot().iter("Icon"), None)
    demand(os.path.exists(picture) == (icon is not None), "a file icon.png or an Icon, not both")
    if icon is not None:
        with open(picture, "rb") as file:
            width, height = struct.unpack(">II", file.read(24)[16:])
        corners = [float(icon.get(name)) for name in ("x1", "y1", "x2", "y2")]
        demand(max(map(abs, corners)) == 100, "the icon does not fill its coordinate system")
        shape = (corners[3] - corners[1]) / (corners[2] - corners[0])
        demand(abs(shape - height / width) < 1e-9, "the icon is distorted")
    for terminal in tree.parse(sys.argv[2]).getroot().iter("Terminal"):
        members = [member.get("memberName") for member in terminal]
        demand(len(set(members)) == len(members), "a member occurs twice in terminal " + terminal.get("name"))
        for member in terminal:
            demand(member.get("variableName") in names, "no variable " + member.get("variableName"))

for mistake in mistakes:
    print(mistake)
print("%d variables, %d states, %d outputs" % (len(variables), len(states), len(outputs)))
sys.exit(1 if mistakes else 0)
