# SPDX-License-Identifier: MIT
# scene.py SCENE DURATION OUTPUT_STEP [INPUT=VALUE ...] [gear=NUMBER] [road=SLOPE_X,SLOPE_Y,FRICTION]: the scene as an FMU can have it, on standard output:
# flat road, no search for equilibrium, constant inputs, no driver; JSON, which is YAML.
import json
import sys
import yaml


class Loader(yaml.SafeLoader):
    pass


# 2e-6 is a number
Loader.add_implicit_resolver(
    "tag:yaml.org,2002:float", __import__("re").compile(r"^[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?$"),
    list("-+.0123456789"))

with open(sys.argv[1], encoding="utf-8") as file:
    scene = yaml.load(file, Loader)
for key in "road", "driver", "inputs", "plot", "outputs", "sleep", "course", "steady":
    scene.pop(key, None)
scene.get("initial", {}).pop("equilibrium", None)
scene["duration"] = float(sys.argv[2])
scene["output_step"] = float(sys.argv[3])
inputs = {}
for word in sys.argv[4:]:
    name, value = word.split("=")
    if name == "gear":
        scene["initial"]["gear"] = int(value)
        continue
    if name == "road":
        x, y, friction = map(float, value.split(","))
        scene["road"] = {"type": "slope", "x": x, "y": y, "friction": {"value": friction}}
        continue
    inputs[name] = {"knots": {"times": [0, 1], "values": [float(value), float(value)]}}
if inputs:
    scene["inputs"] = inputs
json.dump(scene, sys.stdout, indent=1)
