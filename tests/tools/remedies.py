# SPDX-License-Identifier: MIT
"""remedies.py GICGEN: applies the remedy of each message about the files of tests/data/mistakes, message after message, until
gicgen accepts the model. What a remedy names exactly is applied by the rules below, anything else by the edits of
tests/data/mistakes/remedies. `--show NAME` prints the messages and the lines changed."""
import os
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))
BAD = os.path.join(HERE, "data", "mistakes")
MESSAGES_MOST = 8  # of one file, before it is accepted


class Message:
    """What gicgen says about the first mistake of a model."""

    def __init__(self, text):
        match = re.search(r"^(.*?):(\d+):(\d+): error: (.*)$", text, re.M)
        # warnings stand before it
        remedy = re.search(r"^  remedy: (.*)$", text[match.start() if match else 0:], re.M)
        self.whole = text
        self.path, self.line, self.column, self.says = (
            (match.group(1), int(match.group(2)), int(match.group(3)), match.group(4)) if match else (None, 0, 0, text))
        self.remedy = remedy.group(1) if remedy else ""
        named = re.search(r"(?:unknown key|there is no [^']*|prefix|quotes) '([^']*)'", self.says)
        self.culprit = named[1] if named else (re.findall(r"'([^']*)'", self.says) or [""])[-1]


def replace_near(line, column, old, new):
    """The occurrence of `old` in the line that starts nearest to the column, counted from 1, becomes `new`."""
    places = [i for i in range(len(line) - len(old) + 1) if line.startswith(old, i)]
    if not old or not places:
        return None
    at = min(places, key=lambda i: abs(i + 1 - column))
    return line[:at] + new + line[at + len(old):]


def value_end(line, start):
    """Where a value of a flow collection ends that starts there."""
    depth, quoted = 0, False
    for i in range(start, len(line)):
        c = line[i]
        if c == '"':
            quoted = not quoted
        elif not quoted and c in "[{":
            depth += 1
        elif not quoted and depth == 0 and c in ",]}":
            return i
        elif not quoted and c in "]}":
            depth -= 1
    return len(line)


def value_at(line, column):
    return line[column - 1:value_end(line, column - 1)]


def without_key(line, key, column):
    """The line without `key: value` of its flow map."""
    places = [match.start() for match in re.finditer(rf"(?<![A-Za-z0-9_]){re.escape(key)}: ", line)]
    if not places:
        return None
    start = min(places, key=lambda i: abs(i + 1 - column))
    end = value_end(line, start)
    if line[end:end + 1] == ",":
        return line[:start] + line[end + 1:].lstrip()
    return re.sub(r",\s*$", "", line[:start]) + line[end:]


def changed(value, new):
    return lambda line, message: replace_near(line, message.column, value(line, message), new(line, message))


def positive(line, message):
    value = re.search(r"not (-?[0-9.e-]+)$|\((-?[0-9.e-]+)\)$", message.says)
    number = next(group for group in value.groups() if group)
    return replace_near(line, message.column, number, number[1:] if number[0] == "-" else "1")


def renamed(line, message):
    name = re.match(r" *([A-Za-z0-9_]+)", line[message.column - 1:]).group(1)
    return replace_near(line, message.column, name, name + "_other")


# `pattern of the remedy`: the line after it, from (line, message); None: not so
RULES = [
    (r"^save the file as UTF-8 text$", lambda line, m: line + " "),
    (r"^write \[x, y, z\]$", lambda line, m: re.sub(r"\[{9,}\]{9,}", "[0, 1, 0]", line)),
    (r"^nothing in the format is nested more", lambda line, m: re.sub(r"\[{9,}.*\]{9,}", "[0, 0, 0]", line)),
    (r"^take (it|the character) out", lambda line, m: line[:m.column - 1] + line[m.column:]),
    (r"did you mean '([^']*)'",
     lambda line, m: replace_near(line, m.column, m.culprit,
                                  re.search(r"did you mean '([^']*)'", m.remedy).group(1))),
    (r"^one of: ", lambda line, m: replace_near(line, m.column, m.culprit, re.match(r"one of: ([^,]*)", m.remedy).group(1))),
    (r"^its keys are: |^the keys here are: ",
     lambda line, m: without_key(line, re.search(r"key '([^']*)'", m.says).group(1), m.column)),
    (r"^write (zero or )?a positive number$", positive),
    (r"^rename (or remove )?one of (them|the two)|^rename it", renamed),
    (r"^write (-?[0-9.e]+), with a decimal point$",
     lambda line, m: re.sub(r"(-?\d+),(\d+)", r"\1.\2", line[:m.column - 1]) +
     re.sub(r"^(-?\d+),(\d+)", r"\1.\2", line[m.column - 1:])),
    (r"^write (-?[0-9.]+), without a separator of thousands(, or .* with a decimal point)?$",
     lambda line, m: re.sub(r"-?\d{1,3}(,\d{3})+(\.\d+)?",
                            lambda number: number.group(0).replace(",", ""), line)),
    (r"^name two different bodies$", lambda line, m: re.sub(r"\[box, box\]", "[box, arm]", line)),
    (r"^take another name$", renamed),
    (r"^take another name, such as my_model",
     lambda line, m: replace_near(line, m.column, value_at(line, m.column).strip(), "my_model")),
    (r"^use letters, digits and `_`, beginning with a letter",
     lambda line, m: replace_near(line, m.column, m.says.split("'")[1],
                                  "a" + re.sub(r"[^A-Za-z0-9_]", "_", m.says.split("'")[1]))),
    (r"^write a direction, such as \[0, 0, 1\]",
     lambda line, m: replace_near(line, m.column, value_at(line, m.column), "[0, 0, 1]")),
    (r"write `\)` here", lambda line, m: line[:m.column - 1] + ")" + line[m.column - 1:]),
    (r"^write it in decimal, such as (\S+)|^write the number alone|^write a decimal number such as (\S+)|"
     r"^numbers are finite: write a decimal number such as (\S+)",
     lambda line, m: line[:m.column - 1] + "1.5" + line[m.column - 1 + len(value_at(line, m.column)):]),
    (r"the decimal point is a point: write (\S+)",
     lambda line, m: replace_near(line, m.column, m.culprit, m.remedy.split()[-1])),
    (r"^write 1e2$", lambda line, m: replace_near(line, m.column, m.culprit, "1e2")),
    (r"^remove the quotes$", lambda line, m: replace_near(line, m.column, value_at(line, m.column),
                                                          value_at(line, m.column).replace('"', ""))),
    (r"^write digits without `_`$", lambda line, m: replace_near(line, m.column, m.culprit, m.culprit.replace("_", ""))),
    (r"^write it without leading zeros$", lambda line, m: replace_near(line, m.column, m.culprit, m.culprit.lstrip("0"))),
    (r"^write the minus sign as `-`$", lambda line, m: replace_near(line, m.column, "\u2212", "-")),
    (r"^write true or false, without quotes$",
     lambda line, m: replace_near(line, m.column, value_at(line, m.column), "true")),
    (r"^write `gicgen: 1`|or write `gicgen: 1`", lambda line, m: "gicgen: 1"),
    (r"^begin the file with `gicgen: 1`", lambda line, m: "gicgen: 1\n" + line),
]


# joints with so many equations, and their keys
FREED = {2: "point_on_line", 3: "spherical", 4: "cylindrical", 5: "revolute", 6: "fixed"}
FREED_KEYS = {count: "point: [0.3, 0.7, 1.1]" + (", axis: [1, 2, 4]" if count in (2, 4, 5) else "") for count in FREED}


def add_entry(text, section, entry):
    """The file with an entry more, first in its section, which may be a new one."""
    if re.search(rf"^{section}:", text, re.M):
        return re.sub(rf"^{section}:.*$", lambda found: f"{section}:\n  {entry}", text, count=1, flags=re.M)
    return text.rstrip("\n") + f"\n{section}:\n  {entry}\n"


def set_entry(text, name, entry):
    """The file with another entry of that name; None: without it, and without its section if that is empty then."""
    line = f"  {entry}\n" if entry else ""
    text = re.sub(rf"^  {re.escape(name)}: .*\n", lambda found: line, text, count=1, flags=re.M)
    return re.sub(r"^(coordinates|joints):\n(?! )", "", text, flags=re.M)


def suggested(text, remedy):
    """The file with what the remedy says of joints and coordinates."""
    for verb, name, entry in re.findall(r"(make joint|change coordinate|add coordinate|remove joint|remove dual coordinate) "
                                        r"'([^']*)'(?: \([a-z_]+, \d\))?(?: an? [a-z_]+ \(\d\))?(?:: `([^`]*)`)?", remedy):
        if verb == "add coordinate":
            text = add_entry(text, "coordinates", entry)
        else:
            text = set_entry(text, name, entry)
    return text


def freed(text, message):
    """The file with a joint or coordinate of the reader's choice, for bodies of which a message says that so many are
    missing."""
    alone = re.search(r"^body '([^']*)' is connected to nothing", message.says)
    lacks = re.search(r"^body '([^']*)' has (\d) degrees? of freedom more", message.says)
    base = re.search(r"^base: (\w+)", text, re.M)
    if not base or not (alone or lacks):
        return None
    body, want = (alone[1], 6) if alone else (lacks[1], int(lacks[2]))
    if want > 1:
        name = f"added_{body[:20]}"
        return add_entry(text, "joints", f"{name}: {{type: {FREED[want]}, bodies: [{base[1]}, {body}], {FREED_KEYS[want]}}}")
    return add_entry(text, "coordinates", f"added: {{type: length, bodies: [{base[1]}, {body}], "
                                          "points: [[0.3, 2, 0.7], [1.5, 0.4, 0.1]]}")


def whole_rules(text, message):
    """Remedies that change another line than that of the message."""
    if message.remedy.startswith("leave out `tunable: true`"):
        return text.replace(", tunable: true", "")
    if re.search(r"make joint|change coordinate|add coordinate|remove joint", message.remedy):
        return suggested(text, message.remedy)
    unneeded = re.search(r"for example, remove dual coordinate '([^']*)'", message.remedy)
    if unneeded:
        mirrored = not re.search(rf"^  {unneeded[1]}:", text, re.M)
        return set_entry(text, unneeded[1].replace("_r", "_l") if mirrored else unneeded[1], None)
    return freed(text, message)


def read_edits(path):
    """{file: [(old, new), ...]}: tests/data/mistakes/remedies, `NAME: OLD => NEW` or `NAME: rule`."""
    edits = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            line = line.rstrip("\n")
            if not line or line.startswith("#"):
                continue
            name, rest = line.split(": ", 1)
            if rest == "rule":
                edits.setdefault(name, []).append(None)
                continue
            old, new = re.match(r"(.*?) ?=> ?(.*)", rest).groups()
            edits.setdefault(name, []).append((old.replace("\\n", "\n"), new.replace("\\n", "\n")))
    return edits


def named_keys(remedy):
    """Keys that a remedy says to add, as `key: ...`."""
    return [] if "or " in remedy else re.findall(r"^add `([a-z_]+):", remedy)


def apply_edit(text, message, edit):
    """One edit of the table, in the line of the message if it is found there, or else where it is found first."""
    old, new = edit
    if any(key + ":" not in new for key in named_keys(message.remedy)):
        return None, "the table's edit does not add what the remedy says"
    lines = text.split("\n")
    if not old:  # appended to the file
        return text.rstrip("\n") + "\n" + new + "\n", None
    if "\n" not in old and 0 < message.line <= len(lines):
        line = replace_near(lines[message.line - 1], message.column, old, new)
        if line is not None:
            lines[message.line - 1] = line
            return "\n".join(lines), None
    if old not in text:
        return None, f"the table's '{old}' is not there"
    return text.replace(old, new, 1), None


def by_rule(line, message):
    """The message's line after the first rule that changes it, or None."""
    for pattern, rule in RULES:
        if re.search(pattern, message.remedy):
            after = rule(line, message)
            if after is not None and after != line:
                return after
    return None


def remedied(text, message, edits):
    """(the file after the remedy, None) or (None, why not)."""
    edit = edits.pop(0) if edits else None
    if edit:
        return apply_edit(text, message, edit)
    whole = whole_rules(text, message)
    if whole is not None and whole != text:
        return whole, None
    lines = text.split("\n")
    line = by_rule(lines[message.line - 1], message) if message.line else None
    if line is None:
        return None, "no rule and no edit for it"
    lines[message.line - 1] = line
    return "\n".join(lines), None


def why_not(gicgen, name, edits, show):
    """What is wrong with the remedies for this file, or None."""
    with tempfile.TemporaryDirectory() as work:
        folder = os.path.join(work, "bad")
        os.mkdir(folder)
        shutil.copy(os.path.join(BAD, name), folder)
        shutil.copytree(os.path.join(BAD, "parts"), os.path.join(folder, "parts"))
        os.symlink(os.path.join(HERE, "data", "dump"), os.path.join(work, "dump"))
        edits = list(edits)
        for count in range(MESSAGES_MOST):
            answer = subprocess.run([gicgen, name, "-o", "out.c"], cwd=folder, capture_output=True, timeout=60)
            said = answer.stderr.decode(errors="replace")
            if answer.returncode == 0:
                if count == 0:
                    return "accepted as it is"
                return f"edits left over: {edits}" if edits else None
            message = Message(said)
            if show:
                print(said)
            structural = re.match(r"add joints|add a dual|add \d dual", message.remedy)
            path = os.path.join(folder, name if structural else message.path or name)
            with open(path, "rb") as file:
                text = file.read().decode("latin1" if "UTF-8" in message.remedy else "utf-8")
            after, wrong = remedied(text, message, edits)
            if wrong:
                return f"{wrong}\n{said}"
            if show:
                print("\n".join("    " + line for line in after.split("\n") if line not in text.split("\n")))
            with open(path, "w", encoding="utf-8") as file:
                file.write(after)
        return f"not accepted after {MESSAGES_MOST} remedies\n{said}"


def main():
    gicgen = os.path.realpath(sys.argv[1])
    show = sys.argv[3:] if sys.argv[2:3] == ["--show"] else []
    table = read_edits(os.path.join(BAD, "remedies"))
    names = sorted(name for name in os.listdir(BAD) if name.endswith(".veh"))
    failed = 0
    for name in show or names:
        wrong = why_not(gicgen, name, table.get(name[:-4], []), bool(show))
        if wrong:
            failed += 1
            print(f"FAIL {name}: {wrong}")
    for name in table:
        if name + ".veh" not in names:
            failed += 1
            print(f"FAIL tests/data/mistakes/remedies: there is no {name}.veh")
    print(f"{len(names) - failed} passed, {failed} failed")
    sys.exit(failed != 0)


if __name__ == "__main__":
    main()
