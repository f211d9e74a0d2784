"""Runs ctest over a build tree and reads what it found."""
import dataclasses
import json
import os
import re
import subprocess
import xml.etree.ElementTree

import budget as budgets

STARTED = re.compile(r"^\s*Start\s+\d+: (\S+)")


@dataclasses.dataclass
class Test:
    name: str
    labels: frozenset
    status: str = "not run"  # passed, failed, skipped, not run
    seconds: float = 0.0
    output: str = ""


def known(tree, filters):
    """Returns the tests of a build tree that the ctest options `filters` select, in the order of ctest."""
    listing = subprocess.run(["ctest", "--test-dir", tree, "--show-only=json-v1", *filters],
                             check=True, capture_output=True, text=True).stdout
    tests = []
    for entry in json.loads(listing)["tests"]:
        labels = next((each["value"] for each in entry.get("properties", []) if each["name"] == "LABELS"), [])
        tests.append(Test(entry["name"], frozenset(labels)))
    return tests


def run(tree, filters, log, budget, parallel, progress=None):
    """Runs the selected tests; every one of them is in the answer, also those that a spent budget left out."""
    tests = {test.name: test for test in known(tree, filters)}
    if not tests:
        return []
    junit = os.path.abspath(log) + ".xml"
    if os.path.exists(junit):
        os.remove(junit)
    started = []

    def note(line):
        match = STARTED.match(line)
        if match:
            started.append(match.group(1))
            if progress is not None:
                progress(len(started), len(tests))

    status = budgets.run(["ctest", "--test-dir", tree, "--output-on-failure", "--parallel", str(parallel),
                          "--output-junit", junit, *filters], budget, log, each_line=note)
    if os.path.exists(junit):
        read_junit(junit, tests)
        read_reasons(log, tests)
    elif status is None:
        read_passed(log, tests)
    return list(tests.values())


def read_junit(path, tests):
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        test = tests.get(case.get("name"))
        if test is None:
            continue
        test.seconds = float(case.get("time", 0))
        test.output = case.findtext("system-out") or ""
        skipped = case.find("skipped")
        # ctest reports a missing program and a failed fixture as skipped, too.
        if skipped is not None and skipped.get("message", "").startswith("SKIP_"):
            test.status = "skipped"
        elif case.get("status") == "run":
            test.status = "passed"
        else:
            test.status = "failed"


REASON = re.compile(r"^\s*\d+ - (\S+) \((.+)\)$")


def read_reasons(log, tests):
    """Adds to each failed test's output why ctest counts it as failed, for example SEGFAULT or Timeout."""
    with open(log, encoding="utf-8", errors="replace") as lines:
        for line in lines:
            match = REASON.match(line)
            if match and match.group(1) in tests and tests[match.group(1)].status == "failed":
                tests[match.group(1)].output += f"\nctest: {match.group(2)}"


PASSED = re.compile(r"Test\s+#\d+: (\S+) \.+\s+Passed\s+([0-9.]+) sec")


def read_passed(log, tests):
    """Reads the log of a ctest that the budget ended, which writes no JUnit file."""
    with open(log, encoding="utf-8", errors="replace") as lines:
        for line in lines:
            match = PASSED.search(line)
            if match and match.group(1) in tests:
                test = tests[match.group(1)]
                test.status, test.seconds = "passed", float(match.group(2))


def only(names):
    """Returns the ctest options that select exactly these tests."""
    return ["-R", "^(" + "|".join(re.sub(r"([][.*+?^$()\\])", r"\\\1", name) for name in names) + ")$"]
