# SPDX-License-Identifier: MIT
"""dual_wheels.py GICRUN MODEL WORK: tests/data/manoeuvre/linear.veh with two rear tires a side in place of one, each half as stiff,
braked and driven half as much and half as heavy to spin. 0.1 mm apart they are that vehicle in all that --sheet and manoeuvres say;
0.3 m apart they also hold the body, to which their sliders are fixed, upright: roll gradient in closed form, widths, loads."""
import csv
import re
import subprocess
import sys

gicrun, model, work = sys.argv[1:4]
failed = passed = 0
g = 9.81  # of the model


def check(what, value, wanted, tolerance, least=1e-9):
    global failed, passed
    if abs(value - wanted) <= tolerance * max(abs(wanted), least):
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}: {value!r}, found here {wanted!r}")


def table(*words):
    done = subprocess.run([gicrun, *words, "-q", "-o", "-"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {r["quantity"]: float(r["value"]) for r in csv.DictReader(done.stdout.splitlines())}, done.stderr


def dual(apart):
    with open(model) as f:
        text = f.read()
    wheel = "  r_l: {body: rear_l, center: [-1.4, 0.75, 0.3], tire: rear, spin_inertia: 1, drive: 600 * accelerator, brake: 2000 * brake}\n"
    halves = "".join(f"  {name}: {{body: rear_l, center: [-1.4, {0.75 + side * apart / 2:.9g}, 0.3], tire: rear, spin_inertia: 0.5, "
                     "drive: 300 * accelerator, brake: 1000 * brake}\n" for name, side in (("in_l", -1), ("out_l", 1)))
    assert wheel in text
    text = text.replace(wheel, halves)
    tire = re.search(r"  rear: \{type: tmeasy.*\n", text)[0]
    half = tire.replace("stiffness: 250000, damping: 200, load: 3000", "stiffness: 125000, damping: 100, load: 1500")
    half = re.sub(r"((?:dfx0|fxm|fxs|dfy0|fym|fys): )\[([^]]*)\]",
                  lambda found: found[1] + "[" + ", ".join(f"{float(x) / 2:.9g}" for x in found[2].split(",")) + "]", half)
    path = f"{work}/dual_{apart:g}.veh"
    with open(path, "w") as f:
        f.write(text.replace(tire, half))
    return path


# ---- close together: the vehicle with one wheel in their place

close, apart = dual(1e-4), dual(0.3)
single, said = table("--sheet", model)
double, said = table("--sheet", close)
check("--sheet leaves nothing out", float("can't travel" in said), 0.0, 0)
for name, value in single.items():
    if not name.startswith(("r_l", "r_r", "mode")):
        check(f"--sheet: {name}", double[name], value, 1e-6, 1e-6)
for side in "lr":
    pair = f"in_{side}+out_{side}"
    for name in ("camber", "toe", "wheel_rate"):
        if f"r_{side}.{name}" in single:
            check(f"--sheet: {name} of {pair}", double[f"{pair}.{name}"], single[f"r_{side}.{name}"], 1e-6, 1e-6)
    for name in (f"in_{side}", f"out_{side}"):
        check(f"--sheet: load of {name}", double[f"{name}.load"], single[f"r_{side}.load"] / 2, 1e-6)
        check(f"--sheet: deflection of {name}", double[f"{name}.deflection"], single[f"r_{side}.deflection"], 1e-6)

# steps of runs are as they come, within 1e-6; what is found by search is found to less
for words, near in ((["step-steer", "speed=20", "ay=1"], 1e-3), (["steady-speed", "speed=20"], 2e-3), (["braking", "speed=20", "brake=0.5"], 1e-4),
                    (["turn-braking", "speed=20", "ay=1", "brake=0.2"], 2e-3),
                    (["ride", "speed=10", "class=1", "duration=10"], 1e-3),
                    (["four-post", "speed=10", "class=1", "duration=10"], 1e-3), (["lane-change", "width=1.7"], 1e-2)):
    one, _ = table("--manoeuvre", words[0], model, *words[1:])
    two, _ = table("--manoeuvre", words[0], close, *words[1:])
    for name, value in one.items():
        if ".r_" in name or name.startswith(("r_l", "r_r")):
            continue
        check(f"{words[0]}: {name}", two.get(name, float("nan")), value, near, 1e-2)
    for name in (n for n in one if n.startswith("r_l") or ".r_l." in n):
        for part in ("in_l", "out_l"):
            value = one[name] / (2 if ".load.at_" in name and "phase" not in name else 1)
            check(f"{words[0]}: {name} of {part}", two.get(name.replace("r_l", part), float("nan")), value, near, 1e-2)

# ---- apart: they lean with the body, so that the outer one of both sides is compressed more

sheet, _ = table("--sheet", apart)
m, h, t = sheet["mass"], sheet["com_height"], 0.75
k, kt = 3e4, 2.5e5
stiffness = 2 * 2 * t * t * k * kt / (k + kt)
leaning = 4 * (kt / 2) * 0.15**2
spin = 4 / (0.313 - m * g / 4 / kt / 3)  # wheels are gyroscopes: their part of the roll moment by yaw rate and speed
check("one wheel: roll gradient", single["at_20.roll_gradient"], (m * h + spin) / (stiffness - m * g * h), 2e-3)
check("0.3 m apart: roll gradient by one wheel's", sheet["at_20.roll_gradient"] / single["at_20.roll_gradient"],
      (stiffness - m * g * h) / (stiffness + leaning - m * g * h), 1e-3)
check("0.3 m apart: understeer", sheet["at_20.understeer"], single["at_20.understeer"], 1e-3)
lane, _ = table("--manoeuvre", "lane-change", apart)
check("0.3 m apart: width", lane["width"], 2 * 0.9 + 0.25, 1e-6)
print(f"{passed} passed, {failed} failed")
sys.exit(failed > 0 or passed < 100)
