"""The summary that closes every run: steps, slowest tests, flakes, failures, counts."""
import sys

SLOWEST = 20
OUTPUT_LINES = 60


def progress(done, total):
    if sys.stderr.isatty():
        sys.stderr.write(f"\r{done}/{total} ")
        sys.stderr.flush()


def print_failure(test):
    print(f"\n--- {test.status}: {test.name} ({test.seconds:.1f} s)")
    print("\n".join(test.output.rstrip().splitlines()[-OUTPUT_LINES:]))


class Summary:
    def __init__(self):
        self.steps = []  # (name, seconds, outcome)
        self.tests = []
        self.flaky = []  # lines
        self.quarantined = []  # tests that failed and do not decide
        self.not_run = []  # names of steps and groups
        self.notes = []

    def add_step(self, name, seconds, outcome):
        self.steps.append((name, seconds, outcome))
        print(f"{name:<18} {outcome} in {seconds:.0f} s", flush=True)

    def print(self, green):
        ignored = {test.name for test in self.quarantined}
        failed = [test for test in self.tests if test.status == "failed" and test.name not in ignored]
        skipped = [test for test in self.tests if test.status == "skipped"]
        left = [test.name for test in self.tests if test.status == "not run"] + self.not_run
        passed = sum(test.status == "passed" for test in self.tests)
        print("\nslowest tests:")
        for test in sorted(self.tests, key=lambda each: -each.seconds)[:SLOWEST]:
            print(f"  {test.seconds:7.1f} s  {test.name}")
        print("\nsteps:")
        for name, seconds, outcome in self.steps:
            print(f"  {seconds:7.0f} s  {name}: {outcome}")
        for note in self.notes:
            print(note)
        for test in skipped:
            print(f"SKIPPED {test.name}")
        for line in self.flaky:
            print(f"FLAKY {line}")
        for test in self.quarantined:
            print(f"QUARANTINED {test.name} failed and does not decide")
        for test in failed:
            print(f"FAILED {test.name}")
        for name, _, outcome in self.steps:
            if outcome == "FAILED":
                print(f"FAILED {name}")
        if left:
            print(f"NOT RUN ({len(left)}): {' '.join(left)}")
        print(f"verdict: {'green' if green else 'RED'}")
        print(f"{passed} passed, {len(failed)} failed, {len(skipped)} skipped")
