"""Calibrations and experiments that end early: by Ctrl-C, and by the death of the process that started them."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Callable

from conftest import MEETING_ROOM, ROOT
from patience import patient

PROGRAM = """
import sys, rayloc
site, out = sys.argv[1:]
captures = [f"ap{i}={site}/calibration-ap{i}.pcap.gz" for i in (1, 2, 3)]
try:
    rayloc.calibrate(site, captures, f"{site}/calibration.csv", out)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
# The first condition takes a moment, the second minutes.
EXPERIMENT = f"""
name = "Interrupted"
[defaults]
room = "{ROOT / 'deploy/experiments/rooms/meeting_room.toml'}"
[[study]]
name = "short"
method = "centre"
spots = 1
survey_points = 5
[[study]]
name = "long"
method = "rayloc"
spots = 2000
repeats = 20
"""
EXPERIMENT_PROGRAM = """
import sys, rayloc
file, out = sys.argv[1:]
try:
    rayloc.experiment(file, out, progress=lambda share, text: print(share, flush=True))
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
PATIENCE = patient(240.0)


def processes_of(out: Path) -> list[int]:
    found = subprocess.run(["pgrep", "-f", str(out)], capture_output=True, text=True)
    return [int(number) for number in found.stdout.split()]


def end(numbers: list[int]) -> None:
    for number in numbers:
        with contextlib.suppress(ProcessLookupError):
            os.kill(number, signal.SIGKILL)


def wait_until(what: Callable[[], object], seconds: float) -> bool:
    deadline = time.monotonic() + seconds
    while not what():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.05)
    return True


def in_the_engine(out: Path, parent: int) -> bool:
    """True if the process of the calibration has loaded the engine."""
    maps = [Path(f"/proc/{number}/maps") for number in processes_of(out) if number != parent]
    with contextlib.suppress(OSError):
        return any("/_engine." in file.read_text() for file in maps)
    return False


def test_a_calibration_does_not_outlive_who_asked_for_it(tmp_path: Path) -> None:
    out = tmp_path / "out"
    checkpoint = out / "calibration.checkpoint.json"
    with subprocess.Popen([sys.executable, "-c", PROGRAM, str(MEETING_ROOM), str(out)]) as process:
        try:
            # Past what it does at the start; it would go on for long.
            assert wait_until(lambda: checkpoint.exists() or process.poll() is not None, PATIENCE)
            assert in_the_engine(out, process.pid), "the calibration ended"
            process.kill()
            process.wait(PATIENCE)
            assert wait_until(lambda: not processes_of(out), PATIENCE), "a process is left behind"
            assert checkpoint.exists(), "it went on to its end"
        finally:
            end(processes_of(out))


def test_a_process_whose_parent_is_gone_is_told_so() -> None:
    program = "import sys; from rayloc import _engine; print(_engine.end_with_parent(int(sys.argv[1])))"
    for parent, answer in ((os.getpid(), "True\n"), (1 << 22, "False\n")):  # above all numbers
        said = subprocess.run([sys.executable, "-c", program, str(parent)], stdout=subprocess.PIPE, text=True)
        assert said.stdout == answer


def test_ctrl_c_ends_a_calibration_and_leaves_its_last_state(tmp_path: Path) -> None:
    out = tmp_path / "out"
    checkpoint = out / "calibration.checkpoint.json"
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(MEETING_ROOM), str(out)], stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert wait_until(lambda: checkpoint.exists() or process.poll() is not None, PATIENCE)
            assert process.poll() is None, "it ended before it had a state to keep"
            # Else the search at the end would find nothing whatever is left.
            assert set(processes_of(out)) - {process.pid}, "the calibration itself is not found"
            os.kill(process.pid, signal.SIGINT)
            assert process.stdout is not None
            assert process.stdout.readline() == "interrupted\n"
            process.wait(PATIENCE)
            # One that was killed may take a moment to go.
            assert wait_until(lambda: not processes_of(out), PATIENCE), "a process is left behind"
        finally:
            end(processes_of(out))
    # A calibration that comes to its end leaves none.
    assert checkpoint.stat().st_size > 0


def start_experiment(folder: Path) -> subprocess.Popen[str]:
    file = folder / "study.toml"
    file.write_text(EXPERIMENT)
    words = [sys.executable, "-c", EXPERIMENT_PROGRAM, str(file), str(folder / "out")]
    return subprocess.Popen(words, stdout=subprocess.PIPE, text=True)


def in_the_second_condition(process: subprocess.Popen[str], out: Path) -> bool:
    """Waits for it. True if the experiment runs, as a process besides the one that waits."""
    assert process.stdout is not None
    shares = [float(process.stdout.readline()) for _ in range(2)]
    return shares == [0.0, 0.5] and bool(set(processes_of(out)) - {process.pid})


def test_ctrl_c_ends_an_experiment_and_leaves_its_conditions(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with start_experiment(tmp_path) as process:
        try:
            assert in_the_second_condition(process, out)
            os.kill(process.pid, signal.SIGINT)
            assert process.stdout is not None
            assert process.stdout.readline() == "interrupted\n"
            process.wait(PATIENCE)
            assert wait_until(lambda: not processes_of(out), PATIENCE), "a process is left behind"
        finally:
            end(processes_of(out))
    assert len(list((out / "conditions").glob("*.json"))) == 1
    assert not (out / "report.json").exists()


def test_an_experiment_does_not_outlive_its_process(tmp_path: Path) -> None:
    out = tmp_path / "out"
    with start_experiment(tmp_path) as process:
        try:
            assert in_the_second_condition(process, out)
            process.kill()
            process.wait(PATIENCE)
            assert wait_until(lambda: not processes_of(out), PATIENCE), "a process is left behind"
        finally:
            end(processes_of(out))
    assert len(list((out / "conditions").glob("*.json"))) == 1
