# SPDX-License-Identifier: MIT
"""schema_texts.py SCHEMA KEYS: every key in the JSON Schema has a description, the same one wherever KEYS (what
--list-keys prints) has it; prints `bad KEY: reason` for each that has not, and at last how many there are."""
import json
import re
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
with open(sys.argv[2], encoding="utf-8") as file:
    lines = file.read().splitlines()

listed = set()
for line, following in zip(lines, lines[1:] + [""]):
    key = re.match(r" {2}([a-z][a-z0-9_]*) ", line)
    if not key:
        continue
    text = re.match(r" {6}(\S.*)", following)
    if text:
        listed.add((key.group(1), text.group(1)))
    else:
        print(f"bad {key.group(1)}: --list-keys says nothing about it")

described = set()


def walk(part):
    """Every map of properties in the schema, however deep."""
    if isinstance(part, list):
        for one in part:
            walk(one)
    elif isinstance(part, dict):
        for key, value in part.get("properties", {}).items() if isinstance(part.get("properties"), dict) else ():
            text = value.get("description", "")
            described.add((key, text))
            if len(text) < 5 or "(null)" in text:
                print(f"bad {key}: no description in the schema")
        for one in part.values():
            walk(one)


walk(schema)
for key, text in sorted(described ^ listed):
    print(f"bad {key}: '{text}' is in one of schema and list only")
print(f"{len(described)} described")
