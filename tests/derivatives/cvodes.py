# SPDX-License-Identifier: MIT
"""cvodes.py GICGEN GICRUN ROOT WORK LIBRARY...: `gicrun --gradient` with small steps of RK4 against the continuous adjoint by
CVODES (cvodes.c). Both come near the gradient of the motion: steps of h leave h^4, CVODES its tolerance of 1e-11, which adds up
over its steps. So the difference has to fall with h^4 until it is below what is asked for, of the largest derivative of a kind:
1e-9 for a double pendulum, 1e-8 for the HMMWV with steps of 0.5 ms."""
import csv
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[3]) / "tests/vehicle"))
from counted import check, finish, runner  # noqa: E402

gicgen, gicrun, root, work = sys.argv[1:5]
libraries = sys.argv[5:]
gic = runner(gicrun)

swing = f"{work}/swing.veh"
Path(swing).write_text("""gicgen: 1
model: swing
gravity: [0, 0, "-g"]
base: ground
parameters:
  g: {value: 9.81, unit: m/s^2, tunable: true}
  l: {value: 0.8, unit: m, tunable: true}
  m: {value: 2, unit: kg, tunable: true}
  k: {value: 30, unit: N m/rad, tunable: true}
  c: {value: 0.4, unit: N m s/rad, tunable: true}
bodies:
  upper: {mass: m, com: [0.1, 0, "-l / 2"], inertia: [0.2, 0.3, 0.2]}
  lower: {mass: 1.5, com: [0, 0, "-l - 0.4"], inertia: [0.1, 0.2, 0.1]}
joints:
  hinge: {type: revolute, bodies: [ground, upper], point: [0, 0, 0], axis: [0, 1, 0]}
  knee: {type: revolute, bodies: [upper, lower], point: [0, 0, "-l"], axis: [0, 1, 0.2]}
coordinates:
  a: {type: angle, bodies: [ground, upper], axis: [0, 1, 0], range: [-2, 2]}
  b: {type: angle, bodies: [upper, lower], axis: [0, 1, 0.2], range: [-2, 2]}
forces:
  knee: {type: force, coordinate: b, value: "-k * sin(b) - c * rate(b)"}
outputs:
  foot: {type: position, body: lower, point: [0, 0, "-l - 0.8"]}
""")


def by_cvodes(model, header, name, output, duration, tolerance, states):
    subprocess.run([gicgen, "--derivatives", model, "-o", f"{work}/{header}.c"], check=True)
    subprocess.run(["cc", "-O1", "-std=c11", f"-DNAME={name}", f'-DHEADER="{header}.h"', f"-I{work}", f"-I{root}/runtime",
                    f"{root}/tests/derivatives/cvodes.c", f"{work}/{header}.c", f"{root}/runtime/gic_runtime.c", *libraries,
                    "-o", f"{work}/{header}"], check=True)
    said = subprocess.run([f"{work}/{header}", repr(duration), repr(tolerance), output,
                           *[f"{k}={v!r}" for k, v in states.items()]], check=True, capture_output=True, text=True).stdout
    return {row[0]: float(row[1]) for row in csv.reader(said.splitlines())}


def by_steps(model, scene, formula):
    rows = list(csv.DictReader(gic("--gradient", formula, model, scene, "-o", "-").splitlines()))
    return float(rows[0]["value"]), {r["variable"]: float(r["derivative"]) for r in rows[1:]}


def compare(what, model, header, name, output, duration, states, initial, names, steps, last):
    """names: of a variable of gicrun, that of the state in generated code, for those that are a state each."""
    want = by_cvodes(model, header, name, output, duration, 1e-11, states)
    off = []
    for step in steps:
        path = f"{work}/{header}.scene"
        Path(path).write_text(f"gicscene: 1\nduration: {duration}\nstep: {step}\nintegrator: rk4\noutput_step: {duration}\n{initial}\n")
        value, found = by_steps(model, path, output)
        pairs = {"": [(value, want[output])]}
        for variable, number in found.items():
            kind = variable.split("/")[0] + variable.endswith(".rate") * ".rate"
            other = want.get(variable, want.get(names.get(variable, variable.split("/", 1)[1])))
            if other is not None:
                pairs.setdefault(kind, []).append((number, other, variable))
        compared = sum(len(p) for p in pairs.values())
        off.append(max(abs(p[0] - p[1]) / max(abs(q[1]) for q in those) for those in pairs.values() for p in those))
    print(f"{what}: {compared} numbers, off by {', '.join(f'{x:.2g}' for x in off)} with steps of {steps} s")
    check(f"{what}: there are many", compared >= 10)
    check(f"{what}: {off}", off[-1] < last and all(b < a / 8 or b < last for a, b in zip(off, off[1:])))


pairs = {"initial/a": "a", "initial/b": "b", "initial/a.rate": "a.rate", "initial/b.rate": "b.rate"}
compare("a double pendulum", swing, "swing", "swing", "foot.x", 2.0, {"a": 0.7, "b": -0.4, "a.rate": 0.5},
        "initial: {coordinates: {a: 0.7, b: -0.4}, rates: {a: 0.5}}", pairs, (0.01, 0.005, 0.0025, 0.00125, 0.000625), 1e-9)
pairs = {"initial/x.rate": "v.x", "initial/y.rate": "v.y", "initial/z.rate": "v.z", "initial/roll.rate": "omega.x",
         "initial/pitch.rate": "omega.y", "initial/yaw.rate": "omega.z"}
compare("the HMMWV", f"{root}/models/hmmwv.veh", "hmmwv", "hmmwv", "chassis_attitude.pitch", 0.4, {"v.x": 8.0, "omega.y": 0.1},
        "initial: {velocity: [8, 0, 0], angular_velocity: [0, 0.1, 0]}", pairs, (0.004, 0.002, 0.001, 0.0005), 1e-8)
finish()
