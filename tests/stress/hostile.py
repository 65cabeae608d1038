# SPDX-License-Identifier: MIT
"""hostile.py FOLDER MEGABYTES: writes files that try to make readers fall, hang or take all memory, large ones of so
many megabytes, and prints for each `reader|file|exit status|what the message must say`."""
import os
import sys

folder, size = sys.argv[1], int(sys.argv[2]) << 20
HEAD = """gicgen: 1
model: arm
base: ground
bodies: {arm: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}}
joints: {pin: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 1, 0]}}
coordinates: {w: {type: angle, bodies: [ground, arm], axis: [0, 1, 0]}}
"""
LAW = 'forces: {f: {type: force, coordinate: w, value: "%s"}}\n'
SCENE = "gicscene: 1\nduration: 0.1\nstep: 0.01\n"
TOO_LARGE = "error: larger than the 4 MB"


def write(name, text):
    with open(os.path.join(folder, name), "w", newline="") as file:
        file.write(text)


def case(reader, name, text, status, says=""):
    write(name, text)
    print(f"{reader}|{name}|{status}|{says}")


def veh(name, text, says, status=1):
    case("veh", name + ".veh", text, status, says)


def many(count, line):
    return "".join(line.replace("#", str(i)) for i in range(count))


# large files of one thing
for name, unit in (("blanks", " "), ("lines", "\n"), ("letters", "a"), ("comment", "#"), ("brackets", "["),
                   ("dashes", "- "), ("zeros", "0"), ("quotes", '"'), ("tabs", "\t"), ("carriage", "\r")):
    veh("large_" + name, unit * (size // len(unit)), TOO_LARGE)
    case("scene", "large_" + name + ".scene", unit * (size // len(unit)), 1, TOO_LARGE)
veh("large_list", "x: [" + "1," * (size // 2) + "]", TOO_LARGE)
near = 4_000_000  # as large as may be
veh("near_list", "gicgen: 1\nx: [" + "1," * (near // 2 - 20) + "1]", "unknown key 'x'")
veh("near_lines", HEAD + "\n" * (near - 500) + "x: 1\n", "unknown key 'x'")
veh("near_comment", HEAD + "# " + "a" * (near - 500) + "\nx: 1\n", "unknown key 'x'")
veh("near_text", HEAD + "description: '" + "a" * (near - 500) + "'\n", "", 0)
veh("near_key", HEAD + "? " + "k" * (near - 500) + "\n: 1\n", "unknown key")
veh("near_name", "gicgen: 1\nmodel: m\nbase: ground\nbodies:\n  ? " + "a" * (near - 500) + "\n  : {}\n", "the name 'aaaa")
veh("near_table", HEAD + "tables: {t: {x: [%s], y: [%s]}}\n" % (",".join(map(str, range(250000))), "1," * 249999 + "1"), "", 0)

# deep, wide, shared
veh("deep_list", "x: " + "[" * 1000000, "nested deeper than 64 levels")
veh("deep_map", "x: " + "{a: " * 500000, "nested deeper than 64 levels")
veh("deep_block", "x:\n" + "- " * 1000000, "nested deeper than 64 levels")
veh("deep_questions", "x:\n" + "? " * 1000000, "nested deeper than 64 levels")
veh("many_keys", HEAD + "points:\n" + many(10001, "  p#: [0, 0, 1]\n"), "more than 10000 keys")
veh("many_points", HEAD + "points:\n" + many(10000, "  p#_l: [0, 1, 1]\n"), "", 0)
veh("many_bodies", "gicgen: 1\nmodel: m\nbase: ground\nbodies:\n" + many(1001, "  b#: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}\n"), "one more than the 1000")
veh("many_parameters", HEAD + "parameters:\n" + many(1001, "  p#: 1\n"), "one more than the 1000")
veh("many_forces", HEAD + "forces:\n" + many(10000, "  f#: {type: force, coordinate: w, value: -w}\n"), "", 0)
veh("many_anchors", "x: [" + many(1001, "&a# 1, ") + "1]", "more than 1000 anchors")
bomb = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1]\n" + "".join(f"a{i}: &a{i} [" + ", ".join([f"*a{i - 1}"] * 9) + "]\n" for i in range(1, 20))
veh("alias_bomb", "gicgen: 1\n" + bomb, "aliases written out")
veh("alias_tables", HEAD + "tables:\n  t0_l: &t {x: [%s], y: [%s]}\n" % (",".join(map(str, range(10000))), "1," * 9999 + "1") + "".join(f"  t{i}_l: *t\n" for i in range(1, 5000)), "aliases written out")
veh("alias_cycle", "x: &a [1, *a]", "is inside the value it names")

# formulas
veh("formula_sum", HEAD + LAW % "+".join(["w"] * 1000000), "more than 10000 operations")
veh("formula_nearly", HEAD + LAW % "+".join(["w"] * 5000), "", 0)
veh("formula_powers", HEAD + LAW % "^".join(["w"] * 100000), "nested too deeply")
veh("formula_parentheses", HEAD + LAW % ("(" * 1000000), "nested too deeply")
veh("formula_signs", HEAD + LAW % ("-" * 1000000 + "w"), "nested too deeply")
veh("formula_not", HEAD + LAW % ("not " * 500000 + "w"), "nested too deeply")
veh("formula_name", HEAD + LAW % ("w" * 1000000), "is too long")
veh("formula_digits", HEAD + LAW % ("1" * 1000000), "too large")
veh("formula_fraction", HEAD + LAW % ("0." + "1" * 1000000), "", 0)
veh("formula_exponent", HEAD + LAW % "w^1e9 + w^-1e9 + w^2147483648 + w^0.5", "", 0)
veh("parameter_bomb", HEAD + "parameters:\n  p0: {value: 1e-9, tunable: true}\n" + "".join(f'  p{i}: "p{i - 1} + p{i - 1}"\n' for i in range(1, 100)) + LAW % "p99", "more than 10000 operations")
veh("parameter_chain", HEAD + "parameters:\n  p0: {value: 1, tunable: true}\n" + "".join(f'  p{i}: "p{i - 1} + 1"\n' for i in range(1, 1000)) + LAW % "p999", "", 0)

# inclusion
write("leaf.veh", "gicgen: 1\npoints: {p: [0, 0, 0]}\n")
for level in range(12):
    below = f"twice_{level - 1}.veh" if level else "leaf.veh"
    write(f"twice_{level}.veh", f"gicgen: 1\ninclude: [{{file: {below}, prefix: a_}}, {{file: {below}, prefix: b_}}]\n")
veh("include_bomb", HEAD + "include: twice_11.veh\n", "more than 1000 times")
write("level_0.veh", "gicgen: 1\n")
for level in range(1, 40):
    write(f"level_{level}.veh", f"gicgen: 1\ninclude: level_{level - 1}.veh\n")
veh("include_deep", HEAD + "include: level_39.veh\n", "more than 16 levels deep")
veh("include_many", HEAD + "include: [" + many(1001, "{file: leaf.veh, prefix: a#_}, ") + "leaf.veh]\n", "more than 1000 times")
write("half.veh", "gicgen: 1\n# " + "a" * 1500000 + "\n")
veh("include_large", HEAD + "include: [" + "half.veh, " * 3 + "half.veh]\n", "more than 4 MB with all files")
os.symlink("circle_b.veh", os.path.join(folder, "circle_a.veh"))
os.symlink("circle_a.veh", os.path.join(folder, "circle_b.veh"))
veh("include_circle", HEAD + "include: circle_a.veh\n", "can't include")
os.symlink("include_itself.veh", os.path.join(folder, "other_name.veh"))
veh("include_itself", HEAD + "include: other_name.veh\n", "would include itself")
os.mkfifo(os.path.join(folder, "pipe"))
for name in ("pipe", "/dev/zero", "/dev/stdin"):
    veh("include_" + os.path.basename(name), HEAD + f"include: {name}\n", "it is a device or a pipe")
    veh("tire_" + os.path.basename(name), HEAD + f"tires: {{t: {{file: {name}}}}}\n", "it is a device or a pipe")
    case("scene", "road_" + os.path.basename(name) + ".scene", SCENE + f"road: {{type: grid, file: {name}}}\n", 1,
         "it is a device or a pipe")
veh("include_folder", HEAD + "include: .\n", "it is a folder")

# tires
write("large.tir", "[UNITS]\nLENGTH = " + "9" * size)
veh("tire_large", HEAD + "tires: {t: {file: large.tir}}\n", TOO_LARGE)
write("sections.tir", "[UNITS]\n" * (near // 8))
veh("tire_sections", HEAD + "tires: {t: {file: sections.tir}}\n", "is missing")
write("keys.tir", "[UNITS]\n" + many(300000, "X# = 1\n"))
veh("tire_keys", HEAD + "tires: {t: {file: keys.tir}}\n", "is missing")
write("factor.tir", open(os.path.join(os.path.dirname(__file__), "../../models/tires/hmmwv_pac2002.tir")).read()
      .replace("$", "!").replace("\nLCZ ", "\nLCZ = 1e303 $"))
veh("tire_factor", HEAD + "tires: {t: {file: factor.tir}}\n", "N/m with LCZ")
write("line.tir", "[UNITS]\nLENGTH = " + "9" * (near - 100))
veh("tire_line", HEAD + "tires: {t: {file: line.tir}}\n", "is missing")

# scenes and their tables
case("scene", "outputs.scene", "gicscene: 1\nduration: 1e300\nintegrator: adams\noutput_step: 1e-300\n", 1, "output times")
case("scene", "steps.scene", "gicscene: 1\nduration: 1\nstep: 1\noutput_step: 1e30\n", 1, "before the first output")
case("scene", "small_steps.scene", "gicscene: 1\nduration: 1\nstep: 1e-300\n", 1, "error: ")
case("scene", "sums.scene", SCENE + "road: " + "{type: sum, roads: [" * 60 + "{type: flat}" + "]}" * 60 + "\n", 1, "nested deeper")
case("scene", "bumps.scene", SCENE + "road: {type: bumps, bumps: [" + many(50000, "{x: #, length: 1e6, height: 1e-9}, ") + "]}\n", 0)
case("scene", "random.scene", SCENE + "road: {type: iso8608, class: H, length: 1e300, spacing: 1e-300}\n", 1, "more than 1e+07 points")
case("scene", "knots.scene", SCENE + "inputs: {u: {knots: {times: [0], values: [0]}}}\n", 1, "error: ")


def road(name, text, says, status=1, kind="grid"):
    write(name + ".csv", text)
    case("scene", "road_" + name + ".scene", SCENE + f"road: {{type: {kind}, file: {name}.csv}}\n", status, says)


road("huge", "x,y,z\n0,0,0\n1e308,0,0\n-1e308,1,0\n1e308,1,0\n", "m apart")
road("tiny", "x,y,z\n0,0,0\n5e-324,0,0\n0,1,0\n5e-324,1,0\n", "m apart")
road("columns", ",".join(["x"] + [f"c{i}" for i in range(20000)]) + "\n", "more than 10000 columns")
road("commas", "x,y,z\n" + "," * 5000000 + "\n", "must be a number")
road("rows", "x,height\n" + many(300000, "#,0\n"), "", 0, "table")
road("cell", "x,height\n" + "1" * 5000000 + ",0\n", "is too large", 1, "table")
