# SPDX-License-Identifier: MIT
"""counted.py: checks that are counted, and runs of gicrun that have to end well, for the programs beside it."""
import subprocess
import sys

passed = failed = 0


def check(what, good):
    global passed, failed
    passed += bool(good)
    failed += not good
    if not good:
        print("FAILED:", what)


def near(what, value, wanted, tolerance):
    """The absolute difference is within the tolerance."""
    check(f"{what}: {value!r}, wanted {wanted!r}", abs(value - wanted) <= tolerance)


def runner(gicrun):
    """gic(words): what gicrun prints on standard output."""
    def gic(*words):
        done = subprocess.run([gicrun, *words], capture_output=True, text=True)
        assert done.returncode == 0, (words, done.stderr)
        return done.stdout
    return gic


def finish():
    print(f"{passed} passed, {failed} failed")
    sys.exit(failed != 0)
