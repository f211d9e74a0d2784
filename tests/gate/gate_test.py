"""The gate's verdicts over a small ctest tree with real processes: flakes, defects, endless waits, a spent budget."""
import datetime
import pathlib

import pytest

import flakes
import gate as gates
import touched

# Fails at its first run and passes at every later one.
FLAKE = 'test -e "$0.ran" || { touch "$0.ran"; echo "seed 17"; exit 1; }'


@pytest.fixture
def tree(tmp_path):
    """Returns a function that writes a tree with these tests, {name: (label, shell text)}, and returns its gate."""
    def make(tests, budget=60, skip="", **options):
        lines = []
        for name, (label, text) in tests.items():
            script = tmp_path / f"{name}.sh"
            script.write_text(text)
            lines.append(f'add_test({name} /bin/sh "{script}")')
            lines.append(f'set_tests_properties({name} PROPERTIES LABELS "{label}" TIMEOUT 2)')
            if name == skip:
                lines.append(f"set_tests_properties({name} PROPERTIES SKIP_RETURN_CODE 77)")
        (tmp_path / "dev").mkdir()
        (tmp_path / "dev" / "CTestTestfile.cmake").write_text("\n".join(lines))
        arguments = ["--budget", str(budget)] + [f"--{name}" for name, value in options.items() if value]
        return gates.Gate(gates.parse(arguments), build=tmp_path)
    return make


def verdict(gate, capsys):
    gate.test("contract", "dev", 1, "-LE", "^(none)$")
    status = gate.finish()
    return status, capsys.readouterr().out


def test_options(capsys):
    options = gates.parse(["--all", "-L", "package", "-E", "container"])
    assert options.all and options.filters == ["-E", "container", "-L", "package"]
    for unknown in (["--tidy-all"], ["--fuzz", "60"], ["-LE", "nightly"]):
        with pytest.raises(SystemExit) as refused:
            gates.parse(unknown)
        assert refused.value.code == 2
        assert unknown[-1] in capsys.readouterr().err


def test_all_pass(tree, capsys):
    status, out = verdict(tree({"a": ("realtime", "exit 0"), "b": ("unit", "exit 77")}, skip="b"), capsys)
    assert status == 0
    assert "SKIPPED b" in out
    assert "1 passed, 0 failed, 1 skipped" in out


def test_a_missing_program_is_a_failure(tree, capsys, tmp_path):
    gate = tree({"a": ("unit", "exit 0")})
    with open(tmp_path / "dev" / "CTestTestfile.cmake", "a", encoding="utf-8") as out:
        out.write("\nadd_test(b /nonexistent/program)\n")
    status, out = verdict(gate, capsys)
    assert status == 1
    assert "FAILED b" in out


def test_a_flake_in_real_time_is_reported_and_does_not_decide(tree, capsys, tmp_path):
    status, out = verdict(tree({"a": ("unit", "exit 0"), "b": ("realtime;contract", FLAKE)}), capsys)
    assert status == 0
    assert "FLAKY b, load " in out and "seed 17" in out
    assert "2 passed, 0 failed, 0 skipped" in out
    assert "\tb\t" in (tmp_path / "flaky.tsv").read_text()


def test_a_unit_test_is_never_repeated(tree, capsys):
    status, out = verdict(tree({"a": ("unit", FLAKE)}), capsys)
    assert status == 1
    assert "FAILED a" in out and "FLAKY" not in out


def test_four_failures_are_not_repeated(tree, capsys):
    status, out = verdict(tree({name: ("realtime", FLAKE) for name in "abcd"}), capsys)
    assert status == 1
    assert out.count("\nFAILED ") == 4


@pytest.mark.parametrize("text", [
    "echo 'WARNING: ThreadSanitizer: data race'",
    "echo 'ERROR: LeakSanitizer: detected memory leaks'",
    "echo 'raylocd: ended by signal 11'",
    "echo '12 received, 11 counted: unaccounted'",
    "kill -SEGV $$",
    "kill -ABRT $$",
])
def test_a_defect_is_not_repeated(tree, capsys, text):
    status, out = verdict(tree({"a": ("realtime", f'test -e "$0.ran" || {{ touch "$0.ran"; {text}; exit 1; }}')}),
                          capsys)
    assert status == 1
    assert "FAILED a" in out and "FLAKY" not in out


def test_an_endless_wait_is_red_and_named(tree, capsys):
    status, out = verdict(tree({"a": ("realtime", "exec sleep 1000")}), capsys)
    assert status == 1
    assert "FAILED a" in out


def test_a_spent_budget_names_what_did_not_run(tree, capsys):
    status, out = verdict(tree({"a": ("unit", "exit 0"), "b": ("unit", "exec sleep 1.9"), "c": ("unit", "exit 0")},
                               budget=1), capsys)
    assert status == 1
    assert "NOT RUN (2): b c" in out
    assert "1 passed" in out


def test_a_red_group_stops_what_comes_after_it(tree, capsys):
    gate = tree({"a": ("unit", "exit 1")})
    gate.test("dev", "dev", 1)
    gate.step("later", "touch", "never")
    assert gate.finish() == 1
    assert "NOT RUN (1): later" in capsys.readouterr().out


def test_a_nightly_run_goes_on(tree, capsys):
    gate = tree({"a": ("unit", "exit 1")}, all=True)
    gate.test("dev", "dev", 1)
    gate.step("later", "true")
    assert gate.finish() == 1
    assert "later: done" in capsys.readouterr().out


def test_a_test_in_quarantine_does_not_decide(tree, capsys):
    gate = tree({"a": ("unit", "exit 0"), "b": ("unit", "exit 1")})
    gate.quarantine = {"b": "a reason"}
    status, out = verdict(gate, capsys)
    assert status == 0
    assert "QUARANTINED b" in out


def test_no_test_is_no_success(tree, capsys):
    gate = tree({"a": ("unit", "exit 0")})
    gate.test("contract", "dev", 1, "-L", "^absent$")
    assert gate.finish() == 1


TODAY = datetime.date(2026, 11, 29)


def quarantine(tmp_path, text):
    path = tmp_path / "quarantine.txt"
    path.write_text(text)
    return flakes.read_quarantine(path, TODAY)


def test_quarantine_is_read(tmp_path):
    assert quarantine(tmp_path, "# comment\nA.B | slow disk | 2026-11-15\n") == {"A.B": "slow disk"}


@pytest.mark.parametrize("text, complaint", [
    ("A.B | reason | 2026-11-14\n", ":1: A.B"),
    ("A.B | reason | 2026-11-30\n", ":1: A.B"),
    ("\nA.B | 2026-11-29\n", ":2: expected"),
    ("A.B | reason | soon\n", ":1: 'soon'"),
    ("".join(f"A.{i} | reason | 2026-11-29\n" for i in range(6)), ":6: at most 5"),
])
def test_quarantine_expires_and_is_short(tmp_path, text, complaint):
    with pytest.raises(flakes.QuarantineError, match=complaint):
        quarantine(tmp_path, text)


@pytest.mark.parametrize("names, labels", [
    (["engine/trace/a.cpp", "daemon/cli/verbs/b.h", "README.md"], {"engine", "daemon/cli/verbs"}),
    (["tests/daemon/live/http/a_test.cpp"], {"daemon/live/http"}),
    (["daemon/base/observer.h"], {"daemon"}),
    (["cmake/RaylocTests.cmake"], None),
    (["daemon/CMakeLists.txt"], None),
    ([], set()),
])
def test_the_folders_that_a_change_touches(names, labels):
    assert touched.rooms(names) == labels


def test_a_room_without_tests_selects_those_around_it(tmp_path):
    (tmp_path / "tests/daemon/live/http").mkdir(parents=True)
    assert touched.selector(tmp_path, "daemon/live/http") == "daemon/live/http(/.*)?"
    assert touched.selector(tmp_path, "daemon/live/log") == "daemon/live(/.*)?"
    assert touched.selector(tmp_path, "daemon/base/arrays") == "daemon(/.*)?"


def test_the_checked_in_quarantine_is_valid():
    flakes.read_quarantine(pathlib.Path(__file__).parents[1] / "quarantine.txt")
