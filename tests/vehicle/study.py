# SPDX-License-Identifier: MIT
"""study.py GICRUN MODELS DATA WORK: `gicrun --vary`. Each run of a grid has, digit for digit, the numbers of a model whose
file has that number: hard points and their mirror images, parameters, keys of manoeuvres, and those that a scene gives."""
import csv
import pathlib
import subprocess
import sys

gicrun, models, data, work = sys.argv[1], *(pathlib.Path(x) for x in sys.argv[2:5])


def table(*words):
    path = work / "study.csv"
    subprocess.run([gicrun, *map(str, words), "-q", "-o", str(path)], check=True, stderr=subprocess.DEVNULL)
    with open(path) as f:
        return list(csv.DictReader(f))


def edited(source, old, new, name):
    text = (models / source).read_text()
    assert text.count(old) == 1, (old, text.count(old))
    path = work / name
    path.write_text(text.replace(old, new).replace("parts/", f"{models.resolve()}/parts/"))
    return path


def bare(row):
    return {k.split(" [")[0]: x for k, x in row.items() if x}


def set_up(rows):
    """What --kc --compare shows: the numbers of the position of set-up."""
    return {r["quantity"]: r["value"] for r in rows}


def by_motion(numbers):
    """A sheet numbers its small motions by speed, runs by their shapes: their numbers without their order, and all others."""
    motions = {}
    for k, x in numbers.items():
        if k.startswith("mode_"):
            motions.setdefault(k.split(".")[0], []).append((k.split(".")[1], x))
    return {k: x for k, x in numbers.items() if not k.startswith("mode_")} | {"motions": sorted(map(sorted, motions.values()))}


def same(name, row, alone):
    row = by_motion({k: x for k, x in bare(row).items() if k not in ("run", *varied)})
    assert len(alone) > 5, (name, len(alone))
    alone = by_motion(alone)
    assert row == alone, (name, {k: (row.get(k), alone.get(k)) for k in row.keys() | alone.keys() if row.get(k) != alone.get(k)})
    print(f"{name}: {len(alone)} numbers")


# a hard point, with that on the other side, and a parameter, with kinematics and the sheet
car = models / "formula_student.veh"
varied = "f_upper_out_l.z", "bar_front"
heights, bars = (0.27, 0.28, 0.29), (0.0, 50.0)
grid = table("--kc", car, "--vary", "f_upper_out_l.z=0.27:0.29:3", "--vary", "bar_front=0:50:2")
sheets = table("--sheet", car, "--vary", "f_upper_out_l.z=0.27:0.29:3", "--vary", "bar_front=0:50:2")
assert len(grid) == len(sheets) == 6
seen = set()
for i, row in enumerate(grid):
    z, bar = heights[i // 2], bars[i % 2]
    assert int(row["run"]) == i and abs(float(row["f_upper_out_l.z [m]"]) - z) < 1e-15 and float(row["bar_front [N m/rad]"]) == bar
    z = row["f_upper_out_l.z [m]"]
    if i in (1, 4, 5):
        one = edited("formula_student.veh", "[0.765, 0.525, 0.280]", f"[0.765, 0.525, {z}]", "one.veh")
        one.write_text(one.read_text().replace("bar_front: {value: 50,", f"bar_front: {{value: {bar},"))
        same(f"kinematics {i}", row, set_up(table("--kc", "--compare", one, one)))
        same(f"sheet {i}", sheets[i], set_up(table("--sheet", one)))
    seen.add(bare(row)["front_tire_l.camber_rate"])
    assert abs(float(bare(row)["front_tire_l.camber_rate"]) - float(bare(row)["front_tire_r.camber_rate"])) < 1e-12
assert len(seen) == 3

# compliance, and what joints carry
for what in "--loads", "--joints":
    grid = table("--kc", what, "--axle", "front", car, "--vary", "f_upper_out_l.z=0.27:0.29:3")
    for i, row in enumerate(grid):
        z = row["f_upper_out_l.z [m]"]
        one = edited("formula_student.veh", "[0.765, 0.525, 0.280]", f"[0.765, 0.525, {z}]", "one.veh")
        same(f"{what} {i}", row, set_up(table("--kc", what, "--axle", "front", "--compare", one, one)))

# two vehicles: the second one with the same number where it has it; numbers of wheels at the same place
varied = ("f_upper_out_l.z",)
full = edited("formula_student.veh", "bar_front: {value: 50,", "bar_front: {value: 20,", "full.veh")
for kind in ("--kc",), ("--sheet",), ("--kc", "--loads"), ("--kc", "--joints"):
    vary = "--vary", "f_upper_out_l.z=0.27:0.29:" + ("1" if kind == ("--sheet",) else "2") # sheets take their time
    own, other, both = table(*kind, car, *vary), table(*kind, full, *vary), table(*kind, car, *vary, "--compare", full)
    fixed = table(*kind, car, *vary, "--compare", models / "five_link.veh") if "--kc" in kind else both
    count = 0
    for a, b, ab, f in zip(own, other, both, fixed):
        for name, x in a.items():
            stem, _, unit = name.partition(" [")
            if stem in ("run", *varied):
                assert x == ab[name] == f[name], name
            elif not stem.startswith("mode_"): # those of the same shape stand beside each other
                p, q = f"{stem}.other [{unit}", f"{stem}.difference [{unit}"
                assert (x, b[name]) == (ab[name], ab[p]), (name, x, b[name], ab[name], ab[p])
                assert float(ab[q]) == float(ab[p]) - float(x) if ab[q] else not x or "inf" in x + ab[p], name
                assert f is ab or x == f[name], name
                count += x != b[name]
    if fixed is not both: # it does not have that point
        others = [[x for name, x in row.items() if ".other [" in name] for row in fixed]
        alone = set_up(table(*kind, "--compare", models / "five_link.veh", models / "five_link.veh"))
        assert others[0] == others[1] and sum(map(bool, others[0])) > 10
        assert {x for x in others[0] if x} == set(alone.values())
    print(f"{' '.join(kind)}: {count} numbers differ between two vehicles")

# a scene beside: its parameters, but for what is varied
scene = work / "beside.scene"
scene.write_text("gicscene: 1\nduration: 1\nstep: 0.01\nparameters: {bar_front: 20, bar_rear: 10}\n")
varied = ("bar_front",)
both = table("--kc", car, "--vary", "bar_front=30:60:2", "--compare", scene)
for i, row in enumerate(both):
    one = edited("formula_student.veh", "bar_front: {value: 50,", f"bar_front: {{value: {30 + 30 * i},", "one.veh")
    rear = work / "rear.veh"
    rear.write_text(one.read_text().replace("bar_rear: {value: 70,", "bar_rear: {value: 10,"))
    a, b = set_up(table("--kc", "--compare", one, one)), set_up(table("--kc", "--compare", rear, rear))
    for name in "front.roll_rate", "rear.roll_rate":
        assert row[f"{name} [N m/rad]"] == a[name] and row[f"{name}.other [N m/rad]"] == b[name], (name, row)
    assert a["rear.roll_rate"] != b["rear.roll_rate"]
print("a scene beside")

# geometry that is tunable: what a scene sets up
car = data / "tuning/car.veh"
varied = ("ball_l",)
grid = table("--kc", car, "--vary", "ball_l=0.775:0.795:2")
for row in grid:
    value = row["ball_l [m]"]
    scene = work / "set.scene"
    scene.write_text("gicscene: 1\nduration: 1\nstep: 0.01\n"
                     f"parameters: {{ball_l: {value}, ball_r: {value}}}\n")
    rows = [r for r in table("--kc", car, scene) if r["motion"] == "parallel" and abs(float(r["travel [m]"])) < 1e-15]
    alone = {k: x for r in rows for k, x in bare(r).items()}
    both = bare(table("--kc", car, scene, "--vary", f"ball_l={value}:{value}:1")[0])
    close = 0
    for name, x in bare(row).items():
        if name.startswith("tire_") and name in alone and name in both and not name.endswith((".force", ".wheel_rate")):
            for other in alone, both:
                assert abs(float(x) - float(other[name])) <= 1e-10 * max(1, abs(float(x))), (name, x, other[name])
            close += 1
    assert close > 30, close
    print(f"as a scene sets up: {close} numbers")

# hard points beside a scene, whose parameters have mirror images with values of their own
scene = work / "sides.scene"
scene.write_text("gicscene: 1\nduration: 1\nstep: 0.01\nparameters: {ball_l: 0.775, ball_r: 0.795}\n")
varied = ("upper_u_f_l.z",)
for row in table("--kc", "--axle", "front", car, scene, "--vary", "upper_u_f_l.z=0.67:0.71:2", "--compare", scene):
    z = row["upper_u_f_l.z [m]"]
    text = car.read_text().replace("../../../models", str(models.resolve())).replace("ball_l: {value: 0.786511", "ball_l: {value: 0.775")
    text = text.replace("points:\n", f"points:\n  upper_u_f_l: [1.6359298, 0.715518, {z}]\n")
    one = work / "sides.veh"
    one.write_text(text.replace("  hinge_l:", "  ball_r: {value: 0.795, unit: m, tunable: true}\n  hinge_l:"))
    alone = set_up(table("--kc", "--axle", "front", "--compare", one, one))
    close = 0
    for name, x in bare(row).items():
        stem = name.removesuffix(".other")
        if stem in alone and x != "inf":
            assert abs(float(x) - float(alone[stem])) <= 1e-9 * max(1, abs(float(x))), (name, x, alone[stem])
            close += 1
    assert close > 60, close
print(f"a point beside a scene: {close} numbers")

# a run and a rig of a scene that sets geometric parameters: those of a file that has the numbers
for i, more in enumerate(("", "base: fixed\ndriven: {spring_f_l: {sine: {amplitude: 0.005, frequency: 2, offset: 0.245}}}\n")):
    run = "gicscene: 1\nduration: 0.1\nstep: 0.002\n" + more
    scene, plain, one = work / "tuned.scene", work / "plain.scene", work / "tuned.veh"
    scene.write_text(run + "parameters: {ball_l: 0.775, ball_r: 0.775, upper: 0.7}\n")
    plain.write_text(run)
    text = car.read_text().replace("../../../models", str(models.resolve()))
    for old, new in ("ball_l: {value: 0.786511", "ball_l: {value: 0.775"), ("upper: {value: 0.708", "upper: {value: 0.7"):
        assert text.count(old) == 1
        text = text.replace(old, new)
    one.write_text(text)
    a, b = table(car, scene), table(one, plain)
    assert len(a) == len(b) == 51 and a[0].keys() == b[0].keys()
    for x, y in zip(a, b):
        for name in x:
            p, q = float(x[name]), float(y[name])
            assert abs(p - q) <= 1e-6 * max(1, abs(q)), (name, p, q)
    print(f"scene {i}: {len(a[0])} columns")

# keys of a manoeuvre
car = data / "manoeuvre/linear.veh"
varied = ("speed",)
for i, row in enumerate(table("--manoeuvre", "step-steer", car, "ay=2", "--vary", "speed=15:25:2")):
    same(f"manoeuvre {i}", row, set_up(table("--manoeuvre", "step-steer", car, "ay=2", f"speed={15 + 10 * i}")))
