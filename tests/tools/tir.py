# SPDX-License-Identifier: MIT
"""tir.py TASK ...: what test_tir.sh needs to know of `.tir` files, found without gicgen.

numbers TIR DUMP: every number of the file that the dumped tire has is the same there, and absent ones are defaults
convert TIR LENGTH FORCE ANGLE TIME: the file, which is in SI units, in others
same DUMP DUMP TOLERANCE: the same tires, to a relative tolerance
fuzz TIR COUNT GICGEN MODEL OUT: spoil the file COUNT times; gicgen must take or refuse each, and not crash"""
import json
import math
import random
import re
import subprocess
import sys

SIZE = {"mm": 1e-3, "millimeter": 1e-3, "cm": 1e-2, "inch": 0.0254, "kN": 1e3, "kilonewton": 1e3, "N": 1.0,
        "lbf": 4.4482216152605, "degree": math.pi / 180, "deg": math.pi / 180, "degrees": math.pi / 180,
        "radians": 1.0, "second": 1.0, "s": 1.0, "ms": 1e-3, "minute": 60.0}
# exponents of length, force, angle, time
UNIT = {"UNLOADED_RADIUS": (1, 0, 0, 0), "RIM_RADIUS": (1, 0, 0, 0), "VERTICAL_STIFFNESS": (-1, 1, 0, 0),
        "VERTICAL_DAMPING": (-1, 1, 0, 1), "FNOMIN": (0, 1, 0, 0), "FZMIN": (0, 1, 0, 0), "FZMAX": (0, 1, 0, 0),
        "LONGVL": (1, 0, 0, -1), "VXLOW": (1, 0, 0, -1), "ALPMIN": (0, 0, 1, 0), "ALPMAX": (0, 0, 1, 0),
        "CAMMIN": (0, 0, 1, 0), "CAMMAX": (0, 0, 1, 0)}
LINE = re.compile(r"^([A-Z0-9_]+) = ([-+.0-9e]+)$")


def file_numbers(path):
    """Numbers of a file as tidy as ours."""
    with open(path, encoding="ascii") as file:
        return {m.group(1): float(m.group(2)) for m in map(LINE.match, file) if m}


def tires(path):
    """The tires of a dumped model."""
    with open(path, encoding="utf-8") as file:
        return json.load(file)["tires"]


def numbers(tir, dump):
    """Compare coefficients with a dump."""
    wanted, tire = file_numbers(tir), tires(dump)[0]
    data = tire["data"]
    for name, value in data.items():
        default = 1 if name[0] == "L" and name != "LONGVL" else 0
        if value != wanted.get(name, default):
            sys.exit(f"{name} is {value} instead of {wanted.get(name, default)}")
    # what is neither an own number of the tire nor unused by it
    rest = set(wanted) - set(data) - set(UNIT) - {
        "USE_MODE", "IP", "IP_NOM", "WIDTH", "ASPECT_RATIO", "RIM_WIDTH", "FILE_VERSION", "LIP", "LGYR", "LCZ", "PTX4"}
    if rest:
        sys.exit(f"numbers that the tire lacks: {sorted(rest)}")
    if len(set(wanted) & set(data)) < 100:
        sys.exit("hardly any numbers compared")
    own = {"radius": 0.4699, "stiffness": 441900, "damping": 500, "mode": 4, "low_speed": 1, "side": "left"}
    for name, value in own.items():
        if tire[name] != value:
            sys.exit(f"{name} is {tire[name]} instead of {value}")


def convert(tir, *units):
    """Print the file in other units."""
    with open(tir, encoding="ascii") as file:
        for line in file:
            line = line.rstrip("\n")
            number = LINE.match(line)
            kind = re.match("(LENGTH|FORCE|ANGLE|TIME) = ", line)
            if kind:
                line = f"{kind.group(1)} = '{units[('LENGTH', 'FORCE', 'ANGLE', 'TIME').index(kind.group(1))]}'"
            elif number and number.group(1) in UNIT:
                value = float(number.group(2))
                for unit, exponent in zip(units, UNIT[number.group(1)]):
                    value /= SIZE[unit] ** exponent
                line = f"{number.group(1)} = {value:.17g}"
            print(line)


def flat(value):
    """All numbers and texts in a value, in order."""
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        return [one for part in value for one in flat(part)]
    return [value]


def same(first, second, tolerance):
    """Compare the tires of two dumps."""
    one, two = flat(tires(first)), flat(tires(second))
    if len(one) != len(two) or len(one) < 100:
        sys.exit("another number of values")
    for x, y in zip(one, two):
        if x != y and not (isinstance(x, (int, float)) and abs(x - y) <= float(tolerance) * abs(x)):
            sys.exit(f"{y!r} instead of {x!r}")


def fuzz(tir, count, gicgen, model, out):
    """Spoil and read."""
    with open(tir, "rb") as file:
        good = file.read()
    refused = 0
    for seed in range(int(count)):
        dice = random.Random(seed)
        text = bytearray(good)
        for _ in range(dice.choice((1, 3, 20))):
            at, length = dice.randrange(len(text)), dice.choice((0, 1, 1, 2, 30))
            text[at:at + length] = bytes(dice.choice((dice.randrange(256), dice.choice(b"[]={}'\"$!\r\n \te.-09")))
                                         for _ in range(dice.choice((0, 1, 1, 2, 9))))
        with open(out, "wb") as file:
            file.write(text)
        result = subprocess.run([gicgen, "--dump-model", model], capture_output=True, timeout=20, check=False)
        refused += result.returncode == 1
        if result.returncode not in (0, 1) or (result.returncode == 1 and b"remedy: " not in result.stderr):
            sys.exit(f"seed {seed}: status {result.returncode}\n{result.stderr.decode(errors='replace')}")
    if not 0.2 * int(count) < refused:
        sys.exit(f"only {refused} refused: nothing is tried")


globals()[sys.argv[1]](*sys.argv[2:])
