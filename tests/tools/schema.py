# SPDX-License-Identifier: MIT
"""schema.py SCHEMA FILE...: whether each file fits the JSON Schema; prints `good FILE` or `bad FILE: reason`."""
import json
import re
import sys

import jsonschema
import yaml

class Loader(yaml.SafeLoader):
    """YAML 1.2 numbers: 1e5 is one, which YAML 1.1 takes for a text."""

def number(loader, node):
    """A scalar as the model reader takes it."""
    try:
        return float(node.value)
    except ValueError:
        return node.value

Loader.yaml_implicit_resolvers = {
    key: [(tag, pattern) for tag, pattern in pairs if tag not in ("tag:yaml.org,2002:float", "tag:yaml.org,2002:int")]
    for key, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
}

Loader.add_implicit_resolver("!number", re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"), list("-+.0123456789"))
Loader.add_constructor("!number", number)

with open(sys.argv[1], encoding="utf-8") as file:
    validator = jsonschema.Draft7Validator(json.loads(file.read().replace("$defs", "definitions")))
for path in sys.argv[2:]:
    with open(path, encoding="utf-8", errors="replace") as file:
        text = file.read()
    try:
        model = json.loads(text) if text.lstrip()[:1] == "{" else yaml.load(text, Loader)
        error = next((found.message for found in validator.iter_errors(model)), None)
    except (ValueError, yaml.YAMLError) as problem:
        error = str(problem)
    print(f"bad {path}: {error[:100]}" if error else f"good {path}")
