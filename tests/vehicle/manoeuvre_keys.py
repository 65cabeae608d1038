# SPDX-License-Identifier: MIT
"""manoeuvre_keys.py GICRUN MODELS WORK: keys of manoeuvres in the table of MANOEUVRES.md against what the program says of them."""
import re
import subprocess
import sys
from pathlib import Path

from counted import check, finish

gicrun, models = sys.argv[1:3]


def said(*words):
    done = subprocess.run([gicrun, "--manoeuvre", *words], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


page = Path(f"{models}/MANOEUVRES.md").read_text().split("## 10.")[1]
rows, name = {}, None
for line in page.splitlines():
    cell = [c.strip() for c in line.strip("|").split("|")]
    if line.startswith("| `") or line.startswith("|  | `"):
        name = cell[0].strip("`") or name
        rows.setdefault(name, []).append((cell[1].strip("`"), *cell[2:]))
# a pendulum is no vehicle, which is looked at later than the words are
model = f"{models}/pendulum.veh"
kinds = re.search("one of (.*)", said("none", model)[1])[1].split(", ")
check(f"the page has all manoeuvres: {kinds}", kinds == list(rows))
for kind in kinds:
    status, text = said(kind, model, "none=1")
    check(f"{kind}: an unknown key", status == 2 and f"{kind} takes no 'none=1'" in text)
    keys = ", ".join(f"{key}={value}{' ' if unit else ''}{unit} ({about}; {least} to {most})" for key, about, value, least, most, unit in rows[kind])
    check(f"{kind}: the keys of the page: {keys}; of the program: {text}", f"one of {keys}\n" in text)
    for key, about, value, least, most, unit in rows[kind]:
        for bound, beyond in ((float(least), -1), (float(most), 1)):
            outside = bound + beyond if unit == "" else bound * (1 + beyond * 1e-6) if bound else -1e-6
            status, text = said(kind, model, f"{key}={outside!r}")
            check(f"{kind} {key}={outside}: {status} {text}", status == 2 and key in text)
finish()
