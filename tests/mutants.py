#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""mutants.py: draws small semantic changes of generator, runtime and templates at random, builds each and runs tests
until one notices. Which change each line may get: mutants/sites.py; which tests judge it: mutants/tests.txt. Nothing
that compares with generated/ takes part.

A change that compiles to the same object (of templates: generated code does) is equivalent, and one that the compiler
warns about or refuses is none; others are drawn in their place, and both are counted. A test that takes far longer
than without the change has noticed: a hang. The journal has one row a change; a run that is stopped goes on where it
stopped, and the order of the draw doesn't change where other lines do.

    python3 tests/mutants.py --count 200          go on until 200 changes have been judged
    python3 tests/mutants.py --table              what the journal says, as a table
    python3 tests/mutants.py --again KEY...       judge these once more (open, survived: all such)
"""
import argparse
import collections
import fcntl
import fnmatch
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(HERE, "mutants"))
import sites  # noqa: E402

KINDS = ("generator/*.c", "runtime/*.c", "templates/*.c.in", "templates/*.h.in", "templates/*.js.in")
WAYS = ([], ["--lanes", "4"], ["--batch", "8"], ["--solve", "augmented", "--recovery", "newton"])
NOTICED, SURVIVED, OPEN, EQUIVALENT, REFUSED = "noticed", "SURVIVED", "open", "equivalent", "refused"
# s of processor time: as a factor of what a test takes without a change; at most where that is not known
PATIENCE, LONGEST = 4, 900
MOST = 6 << 30  # bytes of a process: a change may make it write without end
OWN = 5  # tests that are there for one file may take so many times --longest
# how much of what tests draw at random
AMOUNTS = {"ROWS": "8", "VEHICLES": "1", "MECHANISMS": "12", "COMPILED": "2", "MISTAKES": "60"}

Row = collections.namedtuple("Row", "key file line what text verdict test seconds")


class Journal:
    """Rows of a text file in the order of their keys, which are only ever added or replaced; several runs may do so."""

    def __init__(self, path):
        self.path, self.rows = path, {}
        self.read()

    def read(self):
        if os.path.exists(self.path):
            with open(self.path) as file:
                rows = [Row(*line.rstrip("\n").split("\t")) for line in file if not line.startswith("#")]
            self.rows = {row.key: row for row in rows}

    def add(self, row):
        """On the disk before anything else is done."""
        with open(self.path + ".lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.read()
            self.rows[row.key] = row
            with open(self.path + ".new", "w") as file:
                file.write("# " + "\t".join(Row._fields) + "\n")
                file.writelines("\t".join(self.rows[key]) + "\n" for key in sorted(self.rows))
                file.flush()
                os.fsync(file.fileno())
            os.replace(self.path + ".new", self.path)

    def judged(self):
        return [row for row in self.rows.values() if row.verdict.split()[0] in (NOTICED, SURVIVED, OPEN)]


def totals(journal):
    verdicts = collections.Counter(row.verdict for row in journal.rows.values())
    judged = journal.judged()
    noticed = sum(row.verdict.startswith(NOTICED) for row in judged)
    share = 100 * noticed / len(judged) if judged else 0
    return (f"{len(judged)} changes, {noticed} noticed ({share:.1f} %), {verdicts[SURVIVED]} survived, "
            f"{verdicts[OPEN]} still open, for the longer tests have not been asked; drawn again: "
            f"{verdicts[EQUIVALENT]} equivalent, {verdicts[REFUSED]} refused by the compiler")


def table(journal):
    print("| key | place | change | line | noticed by |\n|---|---|---|---|---|")
    for row in journal.judged():
        text = row.text.replace("|", "\\|")
        print(f"| {row.key} | {row.file}:{row.line} | {row.what.replace('|', chr(92) + '|')} | `{text}` | "
              f"{row.test if row.verdict.startswith(NOTICED) else '**nothing**' if row.verdict == SURVIVED else 'open'}{' (hang)' if 'hang' in row.verdict else ''} |")
    print()
    print(totals(journal))


class Scratch:
    """A copy of the project in which changes are built and tested."""

    def __init__(self, root, folder, flags):
        self.folder, self.flags = folder, flags
        os.makedirs(folder, exist_ok=True)
        for name in ("Makefile", "README.md", "generator", "runtime", "templates", "models", "tests"):
            source = os.path.join(root, name)
            if os.path.exists(source):
                self.copy(source, os.path.join(folder, name))
        self.stop_early()
        self.environment = dict(os.environ, **AMOUNTS, BUILD="build", GICGEN_CACHE=os.path.join(folder, "cache"),
                                WANTED=os.path.join(folder, "wanted"), LC_ALL="C")
        for name in ("GICGEN_CACHE", "WANTED"):
            os.makedirs(self.environment[name], mode=0o700, exist_ok=True)
        os.makedirs(self.path("equivalence"), exist_ok=True)
        if os.path.isdir("/usr/lib/ccache"):  # tests compile the same code again and again
            self.environment["PATH"] = "/usr/lib/ccache:" + self.environment["PATH"]

    def path(self, name):
        return os.path.join(self.folder, name)

    @staticmethod
    def copy(source, target):
        """What is the same already keeps its time, so that make builds nothing for it."""
        files = [""] if os.path.isfile(source) else [
            os.path.relpath(os.path.join(at, name), source) for at, _, names in os.walk(source) for name in names]
        for name in files:
            old, new = os.path.join(target, name).rstrip("/"), os.path.join(source, name).rstrip("/")
            with open(new, "rb") as file:
                data = file.read()
            if not os.path.exists(old) or open(old, "rb").read() != data:
                os.makedirs(os.path.dirname(old), exist_ok=True)
                shutil.copy(new, old)

    def stop_early(self):
        """A script of ours ends with its first failure."""
        path = self.path("tests/lib/checking.sh")
        if os.path.exists(path):
            with open(path) as file:
                text = file.read()
            with open(path, "w") as file:
                file.write(text.replace("failed=$((failed + 1))", "echo 'FAILED:' \"$2\"; exit 1", 1))

    def run(self, command, limit=None):
        """(exit status, output), None and what there was where it takes longer than `limit` s of processor time."""
        wall = None if limit is None else 30 * limit + 600

        def limits():
            os.setsid()
            resource.setrlimit(resource.RLIMIT_DATA, (MOST, MOST))
            if limit is not None:  # later than what is looked at every second, which tells a hang
                resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 5, int(limit) + 10))
        with open(self.path("output"), "w+", errors="replace") as output:
            process = subprocess.Popen(command, cwd=self.folder, env=self.environment, stdin=subprocess.DEVNULL,
                                       stdout=output, stderr=subprocess.STDOUT, preexec_fn=limits)
            begun, before, hang = time.time(), children_seconds(), False
            try:
                while process.poll() is None and not hang:
                    try:
                        process.wait(1)
                    except subprocess.TimeoutExpired:
                        hang = limit is not None and (time.time() - begun > wall or group_seconds(process.pid) > limit)
            finally:  # with all that it left behind
                try:
                    os.killpg(process.pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
                process.wait()
            output.seek(0)
            text = output.read()
        self.seconds = children_seconds() - before
        return (None if hang else process.returncode), text

    def make(self, *targets):
        return self.run(["make", "--no-print-directory", "-s", f"CFLAGS={self.flags}", "WERROR=-Werror",
                         "CC=ccache gcc" if shutil.which("ccache") else "CC=gcc", *targets])

    def programs(self, test):
        """What a test runs: make's targets."""
        if not os.path.exists(self.path(f"tests/system/{test}.sh")):
            return [f"build/check/{test}"]
        script = f". tests/paths.sh; build=build; paths tests/system/{test}.sh"
        names = subprocess.run(["sh", "-c", script], cwd=self.folder, capture_output=True, text=True).stdout.split()
        ours = ("gicgen", "gicrun", "gicsweep", "gicbench")
        return ["build/" + os.path.basename(name) if os.path.basename(name) in ours
                else "build/check/" + os.path.basename(name) for name in names]

    def test(self, test, limit=None):
        """None: it passes; else a word for how it noticed."""
        programs = self.programs(test)
        status, self.said = self.make(*programs) if programs else (0, "")
        if status:
            return "build"
        script = os.path.exists(self.path(f"tests/system/{test}.sh"))
        status, self.said = self.run(["sh", f"tests/system/{test}.sh", *programs] if script else programs, limit)
        if status is None or -status in (signal.SIGXCPU, signal.SIGKILL):
            return "hang"
        counted = re.search(r"^[1-9]\d* passed, 0 failed$" if script else r"^\[       OK \]", self.said, re.M)
        return None if status == 0 and counted else "fails"


def children_seconds():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def group_seconds(group):
    """Processor time of the processes of a group that live, with that of their children that ended."""
    total, tick = 0, os.sysconf("SC_CLK_TCK")
    for name in os.listdir("/proc"):
        if name.isdigit():
            try:
                with open(f"/proc/{name}/stat") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
            except OSError:
                continue
            if int(fields[2]) == group:
                total += sum(int(field) for field in fields[11:15]) / tick
    return total


class Judge:
    """Builds changes and asks tests."""

    def __init__(self, scratch, tests, longest, grace):
        self.scratch, self.lists, self.longest, self.grace = scratch, tests, longest, grace
        self.usual = {}  # s of processor time of each test without a change

    def tests_for(self, file):
        """{test: is it one for this kind of file}, in their order."""
        names = {}
        for pattern, tests in self.lists:
            if fnmatch.fnmatch(file, pattern):
                names.update({test: "/" in pattern + test for test in tests if test not in names})
        return names

    def prepare(self, test):
        """How long a test that noticed takes; it must pass where nothing is changed."""
        if test not in self.usual:
            how = self.scratch.test(test)
            if how:
                sys.exit(f"mutants.py: {test} {how} without any change\n{self.scratch.said[-2000:]}")
            self.keep(test)

    def keep(self, test):
        self.usual[test] = self.scratch.seconds
        with open(self.scratch.path("usual"), "a") as file:
            file.write(f"{test} {self.usual[test]:.2f}\n")

    def recall(self):
        if os.path.exists(self.scratch.path("usual")):
            with open(self.scratch.path("usual")) as file:
                self.usual = {line.split()[0]: float(line.split()[1]) for line in file}

    def generated(self, folder):
        """Code of all models in all ways: {model and way: (text, path of its header, text of that)}; where gicgen refuses
        them: (exit status, None, None)."""
        made = {}
        models = sorted(name for name in os.listdir(self.scratch.path("models")) if name.endswith(".veh"))
        out = self.scratch.path(folder)
        shutil.rmtree(out, ignore_errors=True)
        os.makedirs(out)
        for model in models:
            for i, way in enumerate(WAYS):
                name = os.path.join(out, f"{model[:-4]}{'_batch' if '--batch' in way else ''}.c")
                status, _ = self.scratch.run(["build/gicgen", *way, "models/" + model, "-o", name], 60)
                if status:
                    made[model, i] = (str(status), None, None)
                    continue
                with open(name) as file, open(name[:-1] + "h") as header:
                    made[model, i] = (file.read(), name[:-1] + "h", header.read())
        return made

    def template_is_equivalent(self):
        """Does all code that changed compile to the same objects? None: some does not compile."""
        new = self.generated("equivalence/new")
        changed = [key for key in self.base if self.base[key][0] != new[key][0]]
        for key in changed[:3]:
            if not new[key][1] or not self.base[key][1]:
                return False
            objects = []
            for text, header, declarations in (self.base[key], new[key]):
                name = os.path.join(os.path.dirname(header), "code.c")
                with open(name, "w") as file, open(header, "w") as other:
                    file.write(text)
                    other.write(declarations)
                status, said = self.scratch.run(["gcc", "-std=c99", "-O1", "-Iruntime", "-Wno-psabi", "-I" +
                                                 os.path.dirname(name), "-c", name, "-o", name[:-1] + "o"])
                if status:
                    return None
                with open(name[:-1] + "o", "rb") as file:
                    objects.append(file.read())
            if objects[0] != objects[1]:
                return False
        return bool(changed)

    def judge(self, key, name, line, site, whole):
        """The verdict on one change, which is taken back before this returns."""
        path = self.scratch.path(name)
        with open(path) as file:
            before = file.read()
        made = self.scratch.path("build/" + name[:-1] + "o") if name.endswith(".c") else None
        if made and not os.path.exists(made):
            self.scratch.make("build/" + name[:-1] + "o")
        if made:
            with open(made, "rb") as file:
                compiled = file.read()
        elif name.endswith(".c.in") and not hasattr(self, "base"):
            self.scratch.make("build/gicgen")
            self.base = self.generated("equivalence/base")
        begun = children_seconds()
        try:
            with open(path, "w") as file:
                file.write(whole[:site.start] + site.new + whole[site.end:])
            verdict, test = self.ask(name, made, compiled if made else None)
        finally:
            with open(path, "w") as file:
                file.write(before)
            if made:  # later than its source: it is not compiled again
                with open(made, "wb") as file:
                    file.write(compiled)
        text = " ".join(whole.splitlines()[line - 1].split())
        return Row(key, name, str(line), site.what, text, verdict, test, f"{children_seconds() - begun:.0f}")

    def ask(self, name, made, compiled):
        if made:
            status, self.scratch.said = self.scratch.make("build/" + name[:-1] + "o")
            if status:
                return REFUSED, "-"
            with open(made, "rb") as file:
                if file.read() == compiled:
                    return EQUIVALENT, "-"
        elif name.endswith(".c.in"):
            if self.scratch.make("build/gicgen")[0]:
                return REFUSED, "-"
            same = self.template_is_equivalent()
            if same is None:
                return REFUSED, "-"
            if same:
                return EQUIVALENT, "-"
        verdict = SURVIVED
        for test, own in self.tests_for(name).items():
            known = test in self.usual
            longest = self.longest * (OWN if own else 1)
            if known and self.usual[test] > longest:
                verdict = OPEN
                continue
            how = self.scratch.test(test, PATIENCE * self.usual[test] + self.grace if known else min(LONGEST, longest))
            if how == "hang" and not known and longest < LONGEST:  # perhaps it is just a long one
                verdict, self.usual[test] = OPEN, LONGEST
                continue
            if how:
                return NOTICED + (" (hang)" if how == "hang" else ""), test
            if not known:
                self.keep(test)
        return verdict, "-"


def read_tests(path):
    """Lines `PATTERN: TEST...`, in the order in which tests are asked."""
    with open(path) as file:
        lines = [line.split("#")[0].split(":", 1) for line in file if line.split("#")[0].strip()]
    return [(pattern.strip(), tests.split()) for pattern, tests in lines]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200, help="changes to judge in all (200)")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (1)")
    parser.add_argument("--journal", default=os.path.join(HERE, "mutants", "journal.txt"))
    parser.add_argument("--tests", default=os.path.join(HERE, "mutants", "tests.txt"), help="which tests judge which file")
    parser.add_argument("--only", default="*", help="files to draw from, as a pattern")
    parser.add_argument("--scratch", default="/tmp/gicgen_mutants", help="folder for the copy that is built")
    parser.add_argument("--root", default=os.path.dirname(HERE), help="the project")
    parser.add_argument("--flags", default="-O1", help="of the compiler")
    parser.add_argument("--longest", type=float, default=1e9, metavar="SECONDS",
                        help="leave general tests that take more processor time for later: what none of the others notices is open")
    parser.add_argument("--grace", type=float, default=20, metavar="SECONDS",
                        help=f"of processor time, on top of {PATIENCE} times the usual, after which a test hangs (20)")
    parser.add_argument("--part", default="1/1", metavar="K/N",
                        help="of the draw, every N-th change from the K-th: for N runs at once, with a scratch folder each")
    parser.add_argument("--again", nargs="+", metavar="KEY", help="judge these rows of the journal once more; open, survived: all such")
    parser.add_argument("--table", action="store_true", help="print the journal as a table")
    parser.add_argument("--list", action="store_true", help="print the first changes of the draw, and judge none")
    arguments = parser.parse_args()
    journal = Journal(arguments.journal)
    if arguments.table:
        return table(journal)
    names = sorted(os.path.relpath(os.path.join(place, name), arguments.root) for folder in ("generator", "runtime", "templates")
                   for place, _, inside in os.walk(os.path.join(arguments.root, folder)) for name in inside)
    files = {}
    for name in names:
        if any(fnmatch.fnmatch(name, kind) for kind in KINDS) and fnmatch.fnmatch(name, arguments.only):
            with open(os.path.join(arguments.root, name)) as file:
                files[name] = file.read()
    part, parts = (int(number) for number in arguments.part.split("/"))
    drawn = sites.draw(files, arguments.seed)[part - 1::parts]
    if arguments.list:
        for key, name, line, site in drawn[:arguments.count]:
            print(f"{key} {name}:{line}: {site.what}")
        return None
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    scratch = Scratch(arguments.root, os.path.realpath(arguments.scratch), arguments.flags)
    judge = Judge(scratch, read_tests(arguments.tests), arguments.longest, arguments.grace)
    judge.recall()
    again = arguments.again or []
    for word, verdict in (("open", OPEN), ("survived", SURVIVED)):
        if word in again:
            again += [row.key for row in journal.rows.values() if row.verdict == verdict]
    for key, name, line, site in drawn:
        journal.read()
        if key not in again if again else key in journal.rows:
            continue
        if not again and len(journal.judged()) >= arguments.count:
            break
        row = judge.judge(key, name, line, site, files[name])
        if row.verdict.startswith(NOTICED):
            judge.prepare(row.test)
        journal.add(row)
        print(f"{row.key} {row.file}:{row.line} {row.what}: {row.verdict} {row.test} {row.seconds} s", flush=True)
    print(totals(journal))
    return None


if __name__ == "__main__":
    main()
