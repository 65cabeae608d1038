#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""in_parallel.py [--jobs N] BUILD NAME...: runs tests that are built, as many at once as there are processors, for
tests/run.sh.

The tests that take longest start first, by the processor times that earlier runs left in BUILD/test_seconds, otherwise
by those of tests/seconds.txt. Each test has its own session, log and TMPDIR; all of them go when it ends, with every
process that it left. They share one GICGEN_CACHE, which is new: what one compiled the others have, by the compiler, its
options and the code itself. A line is printed as each test ends, the whole log of every failed one after all. The
last line is `N passed, N failed`; the exit status is 0 when none failed and some passed. An interrupt ends all tests.
"""
import argparse
import collections
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.realpath(__file__))
LIMIT = 3600  # s that one test may take: a hang ends
UNKNOWN = 20  # s, of a test that nobody has measured

# process: subprocess would wait for one that nobody holds
Running = collections.namedtuple("Running", "name folder start process")


def read_seconds(path):
    """Lines `NAME SECONDS` as a dictionary; {} where there is no file."""
    if not os.path.exists(path):
        return {}
    with open(path) as file:
        lines = [line.split() for line in file if line.strip() and not line.startswith("#")]
    return {name: float(seconds) for name, seconds in lines}


def write_seconds(path, seconds):
    with open(path + ".new", "w") as file:
        file.writelines(f"{name} {value:.1f}\n" for name, value in sorted(seconds.items()))
    os.replace(path + ".new", path)


def command(build, name):
    """Words that run a test: a script with the paths of the programs that its first comment names, or a program."""
    script = os.path.join(HERE, "system", name + ".sh")
    if not os.path.exists(script):
        return [os.path.join(build, "check", name)]
    find = 'build=$1; . "$2"; paths "$3"'
    paths = subprocess.run(["sh", "-c", find, "sh", build, os.path.join(HERE, "paths.sh"), script], capture_output=True, text=True)
    return ["sh", script] + paths.stdout.split()


def count(name, log):
    """How many checks of a test passed and failed, by its log."""
    if os.path.exists(os.path.join(HERE, "system", name + ".sh")):
        last = re.fullmatch(r"(\d+) passed, (\d+) failed", log.rstrip("\n").rpartition("\n")[2])
        return (int(last[1]), int(last[2])) if last else (0, 0)
    failed = set(re.findall(r"^\[  FAILED  \] (\S+)$", log, re.M))
    return len(re.findall(r"^\[       OK \]", log, re.M)), len(failed)


def end_session(session):
    """Kills all processes of a session; True if there was one."""
    found = False
    for name in os.listdir("/proc"):
        try:
            if name.isdigit() and os.getsid(int(name)) == session and int(name) != session:
                os.kill(int(name), signal.SIGKILL)
                found = True
        except (ProcessLookupError, PermissionError):
            pass
    return found


class Tests:
    def __init__(self, build, jobs, names, work):
        self.build, self.jobs, self.work = build, jobs, work
        os.mkdir(os.path.join(work, "cache"), 0o700)
        self.measured = read_seconds(os.path.join(build, "test_seconds"))
        self.expected = {**read_seconds(os.path.join(HERE, "seconds.txt")), **self.measured}
        self.waiting = sorted(names, key=self.seconds)
        self.count = len(names)
        self.running = {}
        self.logs = {}
        self.passed = self.failed = self.ended = 0
        self.begin = time.monotonic()
        self.done = 0.0
        self.signal = 0  # that came, and ends everything

    def seconds(self, name):
        return self.expected.get(name, UNKNOWN)

    def start(self, name):
        folder = os.path.join(self.work, name)
        os.makedirs(os.path.join(folder, "tmp"))
        environment = dict(os.environ, TMPDIR=os.path.join(folder, "tmp"), GICGEN_CACHE=os.path.join(self.work, "cache"),
                           BUILD=self.build, PYTHONDONTWRITEBYTECODE="1")
        with open(os.path.join(folder, "log"), "w") as log:
            process = subprocess.Popen(command(self.build, name), stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                       env=environment, start_new_session=True)
        self.running[process.pid] = Running(name, folder, time.monotonic(), process)

    def left(self):
        """A word for the time that is left: what the tests are expected to take yet, at the pace of those that ended."""
        now = time.monotonic()
        going = sum(min(now - test.start, self.seconds(test.name)) for test in self.running.values())
        rest = sum(map(self.seconds, self.waiting)) + sum(self.seconds(test.name) for test in self.running.values()) - going
        pace = max(self.done + going, 1) / max(now - self.begin, 0.1)
        least = max([self.seconds(name) for name in self.waiting[-1:]] + [0])
        seconds = max(rest / pace, least)
        return f"{seconds / 60:.0f} min left" if seconds >= 90 else f"{seconds:.0f} s left"

    def finish(self, pid, status, usage):
        test = self.running.pop(pid)
        test.process.returncode = status
        end_session(pid)
        with open(os.path.join(test.folder, "log"), errors="replace") as file:
            log = file.read()
        shutil.rmtree(test.folder, ignore_errors=True)
        passed, failed = count(test.name, log)
        seconds = time.monotonic() - test.start
        self.ended += 1
        self.done += self.seconds(test.name)
        said = f"{passed} passed, "
        # a test that stops halfway, or that tests nothing, has failed
        if status != 0 or passed == 0 or failed:
            failed = max(failed, 1)
            self.logs[test.name] = log
            said += f"{failed} FAILED, {'exit status ' + str(status) if status >= 0 else signal.Signals(-status).name}, "
        else:
            self.measured[test.name] = usage.ru_utime + usage.ru_stime
        self.passed += passed
        self.failed += failed
        left = f"   ({self.left()})" if self.ended < self.count else ""
        print(f"[{self.ended:3}/{self.count}] {test.name:27} {said}{seconds:.0f} s{left}", flush=True)

    def run(self):
        while (self.waiting or self.running) and not self.signal:
            while self.waiting and len(self.running) < self.jobs:
                self.start(self.waiting.pop())
            pid, status, usage = os.wait4(-1, os.WNOHANG)
            if pid in self.running:
                self.finish(pid, os.waitstatus_to_exitcode(status), usage)
            elif not pid:
                for each, test in self.running.items():
                    if time.monotonic() - test.start > LIMIT:
                        end_session(each)
                        os.kill(each, signal.SIGKILL)
                time.sleep(0.05)

    def stop(self):
        """Ends what runs: first tests, with time to tidy up, then whatever is left of them."""
        for pid in self.running:
            os.killpg(pid, signal.SIGTERM)
        end = time.monotonic() + 2
        while self.running and time.monotonic() < end:
            pid, _ = os.waitpid(-1, os.WNOHANG)
            if pid in self.running:
                self.running.pop(pid).process.returncode = 0
                end_session(pid)
            else:
                time.sleep(0.05)
        for pid, test in self.running.items():
            end_session(pid)
            test.process.kill()
            test.process.wait()
            end_session(pid)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    arguments.add_argument("build")
    arguments.add_argument("names", nargs="*")
    given = arguments.parse_args()
    for name in given.names:
        words = command(given.build, name)
        if not os.path.exists(words[1] if words[0] == "sh" else words[0]):
            print(f"no test {name}: there is neither tests/system/{name}.sh nor tests/unit/{name}.c", file=sys.stderr)
            return 2
    work = tempfile.mkdtemp(prefix="gt")
    os.chmod(work, 0o711)  # a test may start a program as another user
    tests = Tests(os.path.abspath(given.build), given.jobs, given.names, work)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: setattr(tests, "signal", number))
    try:
        tests.run()
    finally:
        tests.stop()
        shutil.rmtree(work, ignore_errors=True)
        write_seconds(os.path.join(given.build, "test_seconds"), tests.measured)
    if tests.signal:
        return 128 + tests.signal
    for name, log in tests.logs.items():
        print(f"\n==== {name}\n{log}", end="" if log.endswith("\n") else "\n")
    minutes, seconds = divmod(round(time.monotonic() - tests.begin), 60)
    if tests.logs:
        print("\nfailed:", *tests.logs)
    print(f"{tests.count} tests in {minutes} min {seconds} s on {given.jobs} processors")
    print(f"{tests.passed} passed, {tests.failed} failed")
    return 1 if tests.failed or not tests.passed else 0


if __name__ == "__main__":
    sys.exit(main())
