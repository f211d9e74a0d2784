"""The stages of tests/run; see there for the options, and README.md of this folder for the rules."""
import argparse
import collections
import os
import pathlib
import subprocess
import sys
import time

import budget as budgets
import ctest
import flakes
import machine
import report
import touched

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build"
QUARANTINE = ROOT / "tests" / "quarantine.txt"
DEFAULT_BUDGET_S = 4500
NO_BUDGET_S = 86400
TIDY_SOURCES = 5  # clang-tidy reads about one source in five seconds
FUZZ_SECONDS = 60
PROVE_RUNS = 20
PROVE_SECONDS = 180


def parse(arguments):
    parser = argparse.ArgumentParser(prog="tests/run", add_help=False)
    parser.add_argument("--fast", action="store_true")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--prove", metavar="REGEX")
    parser.add_argument("--budget", type=float, metavar="SECONDS")
    filters = {"-R": "REGEX", "-E": "REGEX", "-L": "LABEL"}  # ctest's; its -LE is the gate's own
    for flag, value in filters.items():
        parser.add_argument(flag, action="append", default=[], metavar=value, dest=flag)
    options = parser.parse_args(arguments)
    options.filters = [word for flag in filters for value in getattr(options, flag) for word in (flag, value)]
    return options


class Gate:
    def __init__(self, options, build=BUILD):
        self.options = options
        self.build_folder = pathlib.Path(build)
        self.logs = self.build_folder / "logs"
        loop = machine.measure()
        self.patience = machine.patience(loop)
        seconds = options.budget or (NO_BUDGET_S if options.all else DEFAULT_BUDGET_S)
        self.budget = budgets.Budget(seconds)
        self.summary = report.Summary()
        self.red = False
        self.quarantine = {}
        self.logs.mkdir(parents=True, exist_ok=True)
        self.cache_log = self.logs / "compiler_cache.log"
        self.cache_log.unlink(missing_ok=True)
        os.environ["CCACHE_STATSLOG"] = str(self.cache_log)
        os.environ["RAYLOC_PATIENCE"] = str(self.patience)
        print(f"machine: {machine.describe(loop)}", flush=True)

    # A gate stops at the first red group; a nightly run goes on and lists everything that is wrong.
    def stopped(self, name):
        if self.budget.spent() or (self.red and not self.options.all):
            self.red = True
            self.summary.not_run.append(name)
            return True
        return False

    def step(self, name, *command):
        """Runs one command that builds or checks; its log is build/logs/NAME.log."""
        if self.stopped(name):
            return
        log = self.logs / f"{name}.log"
        log.unlink(missing_ok=True)
        begin = time.monotonic()
        status = budgets.run(command, self.budget, log)
        self.summary.add_step(name, time.monotonic() - begin, "done" if status == 0 else "FAILED")
        if status != 0:
            self.red = True
            print("\n".join(log.read_text(errors="replace").splitlines()[-report.OUTPUT_LINES:]))
            if status is None:
                print(f"{name}: the budget ended it")

    def configure(self, preset):
        self.step(f"configure.{preset}", "cmake", "--preset", preset, f"-DRAYLOC_PATIENCE={self.patience}")

    def build(self, preset, target):
        self.step(f"build.{preset}", "cmake", "--build", "--preset", preset, "-j", str(os.cpu_count()), "--target",
                  target)

    def test(self, name, folder, parallel, *filters):
        """Runs one group of tests; ctest excludes by one regular expression only."""
        if self.stopped(f"tests.{name}"):
            return
        begin = time.monotonic()
        log = self.logs / f"tests.{name}.log"
        log.unlink(missing_ok=True)
        tests = ctest.run(str(self.build_folder / folder), [*filters, *self.options.filters], log, self.budget, parallel,
                          report.progress)
        self.summary.tests += tests
        bad = [each for each in tests if each.status in ("failed", "not run") and each.name not in self.quarantine]
        self.summary.quarantined += [each for each in tests
                                     if each.status == "failed" and each.name in self.quarantine]
        if bad and flakes.may_repeat(bad):
            bad = self.repeat(name, folder, bad)
        for each in bad:
            report.print_failure(each)
        self.red = self.red or bool(bad)
        self.summary.add_step(f"tests.{name}", time.monotonic() - begin,
                              f"{len(bad)} of {len(tests)} FAILED" if bad else f"{len(tests)} tests")

    def repeat(self, name, folder, bad):
        """Repeats failed real-time tests once, alone; returns those that failed again."""
        load = os.getloadavg()[0]
        log = self.logs / f"tests.{name}.repeated.log"
        log.unlink(missing_ok=True)
        again = {test.name: test
                 for test in ctest.run(str(self.build_folder / folder), ctest.only([test.name for test in bad]), log, self.budget,
                                       1)}
        still_bad = []
        for test in bad:
            if again[test.name].status == "passed":
                test.status = "passed"
                seed = flakes.seed_of(test.output)
                self.summary.flaky.append(f"{test.name}, load {load:.1f}, seed {seed}")
                report.print_failure(test)
                with open(self.build_folder / "flaky.tsv", "a", encoding="utf-8") as out:
                    out.write(f"{time.strftime('%F %T')}\t{test.name}\t{load:.1f}\t{seed}\n")
            else:
                test.output += "\n--- repeated:\n" + again[test.name].output
                still_bad.append(test)
        return still_bad

    def finish(self):
        if self.cache_log.exists():
            counts = collections.Counter(self.cache_log.read_text().split())
            hits = counts["direct_cache_hit"] + counts["preprocessed_cache_hit"]
            self.summary.notes.append(f"compiler cache: {hits} hits, {counts['cache_miss']} misses")
        if not any(test.status == "passed" for test in self.summary.tests) and not self.red:
            self.red = True
            self.summary.notes.append("no test ran")
        self.summary.print(not self.red)
        return 1 if self.red else 0


def prove(gate):
    """Runs real-time tests 20 times or for 3 minutes, every second time beside load on all cores."""
    tests = ctest.known(str(BUILD / "dev"), ["-R", gate.options.prove])
    if not tests:
        print(f"--prove: no test matches '{gate.options.prove}'")
        return 2
    print(f"{len(tests)} tests; a run each with and without load, in turn", flush=True)
    begin, failures = time.monotonic(), 0
    for number in range(PROVE_RUNS):
        if number >= 2 and time.monotonic() - begin > PROVE_SECONDS:
            break
        load = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
                for _ in range(os.cpu_count() if number % 2 else 0)]
        try:
            done = ctest.run(str(BUILD / "dev"), ["-R", gate.options.prove], gate.logs / "prove.log", gate.budget, 1)
        finally:
            for each in load:
                each.kill()
                each.wait()
        bad = [test for test in done if test.status == "failed"]
        failures += len(bad)
        print(f"run {number + 1}{' beside load' if load else ''}: "
              + (", ".join(f"{test.name} FAILED" for test in bad) or "passed"), flush=True)
        for test in bad:
            report.print_failure(test)
    print(f"{failures} failures")
    return 1 if failures else 0


def main():
    options = parse(sys.argv[1:])
    os.chdir(ROOT)
    gate = Gate(options)
    try:
        gate.quarantine = flakes.read_quarantine(QUARANTINE)
    except flakes.QuarantineError as error:
        print(error)
        gate.red = True
    cores = os.cpu_count()

    gate.configure("dev")
    nightly = "" if options.all else "|nightly"
    gate.test("lint", "dev/tests", cores, "-L", "^lint$", "-LE", f"^(none{nightly})$")
    gate.build("dev", "all")
    if options.prove:
        return prove(gate) if not gate.red else gate.finish()
    if options.fast:
        gate.test("fast", "dev", cores, "-LE", "^(lint|e2e|slow|nightly)$", *touched.filters(ROOT))
        gate.test("daily", "dev", 1, "-L", "^daily$")
        return gate.finish()

    gate.test("dev", "dev", cores, "-LE", f"^(lint|realtime{nightly})$")
    for preset in ("asan", "tsan"):
        gate.configure(preset)
        gate.build(preset, "rayloc_tests")
        gate.test(preset, preset, cores, "-LE", f"^(none{nightly})$")
    whole = not options.filters
    if whole:
        which = ("all",) if options.all else touched.for_tidy(ROOT, TIDY_SOURCES)
        gate.step("lint.tidy", "tests/lint/tidy", "build/dev", *which)
    gate.test("realtime", "dev", 1, "-L", "^realtime$", "-LE", f"^(none{nightly})$")
    if options.all and whole:
        gate.step("fuzz", "tests/fuzz/run", "all", str(FUZZ_SECONDS))
    return gate.finish()


if __name__ == "__main__":
    sys.exit(main())
