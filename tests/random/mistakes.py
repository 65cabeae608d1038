# SPDX-License-Identifier: MIT
"""mistakes.py GICGEN RANDOM_VEHICLE TIRE COUNT [KIND]: makes COUNT times one mistake in a random vehicle
(random_vehicle --rich, tires like the file TIRE), of all kinds of broken.py or of one, and looks at the answer:
exit status 1, one message at the line where the mistake stands, with the culprit's name and a remedy, and no
output. A remedy that tests/tools/remedies.py can apply as it is printed must end that message. Prints what is not so,
and how many kinds there were. KEEP=folder: files whose answer is wrong are left there."""
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(__file__))
sys.path.insert(1, os.path.join(os.path.dirname(os.path.dirname(os.path.realpath(__file__))), "tools"))
import broken  # noqa: E402
import remedies  # noqa: E402

VEHICLES = 60


def why(answer, mistake, folder, before):
    """The first thing wrong with gicgen's answer, or None."""
    text = answer.stderr.decode(errors="replace")
    errors = [line for line in text.split("\n") if ": error: " in line]
    if answer.returncode != 1:
        return f"exit status {answer.returncode}"
    if answer.stdout or set(os.listdir(folder)) != before:
        return "something was written"
    if len(errors) != 1:
        return f"{len(errors)} errors"
    place = re.match(r"([^:]*)(?::(\d+):(\d+))?: error: ", errors[0])
    if mistake.line and (place.group(1), place.group(2)) != (mistake.file, str(mistake.line)):
        return f"not at {mistake.file}:{mistake.line}"
    if not mistake.line and mistake.file and place.group(1) != mistake.file:
        return f"not in {mistake.file}"
    # warnings stand before the message
    text = text[text.index(errors[0]):]
    remedies = [line for line in text.split("\n") if line.startswith("  remedy: ")]
    if len(remedies) != 1:
        return "no remedy"
    said = errors[0] + remedies[0] + "".join(line for line in text.split("\n") if line.startswith("  note: "))
    for name in mistake.says:
        # a name of an included file may be told as it is in the whole
        if not any(re.search(rf"(?<![A-Za-z0-9_])(p\d_)?{re.escape(one)}(?![A-Za-z0-9_])", said)
                   for one in ([name] if isinstance(name, str) else name)):
            return f"does not name {name}"
    return None


def remedy_fails(gicgen, answer, folder, main_file):
    """Whether the remedy, applied, brings the same message again; None: it says nothing that can be applied by rule."""
    message = remedies.Message(answer.stderr.decode(errors="replace"))
    if not message.path or not re.search("|".join(pattern for pattern, _ in remedies.RULES), message.remedy):
        return None
    path = os.path.join(folder, message.path)
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except (OSError, UnicodeDecodeError):
        return None
    lines = text.split("\n")
    after = remedies.by_rule(lines[message.line - 1], message)
    if after is None:
        return None
    lines[message.line - 1] = after
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    again = subprocess.run([gicgen, "--dump-model", main_file], cwd=folder, capture_output=True, timeout=120)
    return again.returncode != 0 and remedies.Message(again.stderr.decode(errors="replace")).says == message.says


def main():
    gicgen, random_vehicle, tire, count = *(os.path.realpath(path) for path in sys.argv[1:4]), int(sys.argv[4])
    kinds = {name: kind for name, kind in broken.KINDS.items() if name in sys.argv[5:] or not sys.argv[5:]}
    folder = tempfile.mkdtemp()
    vehicles = []
    for seed in range(VEHICLES):
        subprocess.run([random_vehicle, "--seed", str(seed), "--rich", folder, "--tire", tire], check=True)
        vehicles.append(broken.Vehicle(folder, seed))
    shutil.rmtree(folder)
    passed, failed, applied, used = 0, 0, 0, set()
    for i in range(count):
        rng = random.Random(i)
        name = list(kinds)[i % len(kinds)]
        mistake = None
        for vehicle in rng.sample(vehicles, VEHICLES):
            broken_one = vehicle.copy()
            mistake = kinds[name](broken_one, rng)
            if mistake:
                break
        if not mistake:
            print(f"FAIL {name}: no vehicle for it")
            failed += 1
            continue
        folder = tempfile.mkdtemp()
        broken_one.write(folder)
        before = set(os.listdir(folder))
        answer = subprocess.run([gicgen, broken_one.main, "-o", "out.c"], cwd=folder, capture_output=True, timeout=120)
        wrong = why(answer, mistake, folder, before)
        heeded = None if wrong else remedy_fails(gicgen, answer, folder, broken_one.main)
        wrong = wrong or ("the remedy does not end the message" if heeded else None)
        applied += heeded is not None
        if wrong:
            failed += 1
            print(f"FAIL {name} ({i}): {wrong}; {mistake}\n{answer.stderr.decode(errors='replace')[:1000]}")
        else:
            passed += 1
            used.add(name)
        if wrong and os.environ.get("KEEP"):
            shutil.copytree(folder, os.path.join(os.environ["KEEP"], f"{name}_{i}".replace(" ", "_")),
                            dirs_exist_ok=True)
        shutil.rmtree(folder)
    print(f"{len(used)} kinds, {applied} remedies applied")
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed != 0)


main()
