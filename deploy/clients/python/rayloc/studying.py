"""Reports in one line: how far estimates are from the truth, and studies on simulated captures."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import sys
from os import PathLike
from pathlib import Path
from typing import Any, Callable, NamedTuple, Optional, Sequence, Union

from rayloc import child
from rayloc.needs import explained

try:
    import numpy as np
    from numpy.typing import NDArray

    import rayloc._engine as _engine
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["Evaluation", "StudiedCondition", "Study", "evaluate", "experiment"]

# Becomes the program, and ends when the process that started it is killed.
LAUNCHER = """
import os, signal, sys
from rayloc import _engine
if not _engine.end_with_parent(int(sys.argv[1])):
    sys.exit("the process that started this experiment has ended")
signal.signal(signal.SIGPIPE, signal.SIG_DFL)
os.execv(sys.argv[2], sys.argv[2:])
"""

# Kind of an Error by exit status, as in daemon/base/exit_status.h.
KINDS = {64: "usage", 65: "bad_input", 69: "unavailable", 70: "internal", 78: "configuration"}


class Evaluation(NamedTuple):
    """Result of `evaluate`: a row a point of the truth.

    Shapes: `time`, `error`, `best_of_5`, `room_centre_error` (points,); `truth`, `position`
        (points, 3).
    Units: seconds of the Unix epoch; metres. An error is horizontal, and infinite where the point
        was missed; `position` is NaN there.
    Frame: the world of the site.
    Errors: none.
    Source: daemon/lab/evaluate/comparison.h.
    """

    statistics: dict[str, Any]
    """The keys of `rayloc evaluate --json`; None: infinite, or not stated."""
    time: NDArray[np.float64]
    """When the point begins."""
    truth: NDArray[np.float64]
    """Where the target was."""
    position: NDArray[np.float64]
    """Where it was estimated."""
    error: NDArray[np.float64]
    """Horizontal distance of the two."""
    best_of_5: NDArray[np.float64]
    """The same of the nearest of the five heaviest hypotheses."""
    room_centre_error: NDArray[np.float64]
    """The error of always answering the room's centre; empty without a site."""
    version: str
    """Version of RayLoc."""
    calibration: str
    """Calibration of the site; empty: none was given, or it is not calibrated."""
    seed: int
    """Seed of the bootstrap of the intervals."""


class StudiedCondition(NamedTuple):
    """One setting of a study, and its result.

    Shapes: `error` (points,), by layout, spot and repeat.
    Units: metres, horizontal; infinite where the point was missed.
    Frame: none.
    Errors: none; `refusal` is set for a method that is out of its domain.
    Source: daemon/lab/experiment/condition.h.
    """

    values: dict[str, str]
    """By key of the experiment's file."""
    statistics: dict[str, Any]
    """The keys of `rayloc evaluate --json`."""
    error: NDArray[np.float64]
    """Error of every point."""
    refusal: str
    """Why the method locates nothing here; empty: it does."""


class Study(NamedTuple):
    """One study of an experiment.

    Shapes: none. Units: metres. Frame: none. Errors: none.
    Source: daemon/lab/experiment/experiment_file.h.
    """

    name: str
    """As the file has it."""
    claim: str
    """Expected result, as the file states it."""
    conditions: list[StudiedCondition]
    """In the order of the file."""
    version: str
    """Version of RayLoc."""
    seed: int
    """Seed of all random draws."""


def evaluate(
    estimates: Union[str, PathLike[str]],
    truth: Union[str, PathLike[str]],
    *,
    kind: str = "device",
    estimate: str = "snapshot",
    target: str = "",
    time_offset: float = 0.0,
    site: Union[str, PathLike[str]] = "",
    plots: Union[str, PathLike[str]] = "",
    force: bool = False,
    progress: Optional[Callable[[float, str], None]] = None,
) -> Evaluation:
    """Compares estimates with surveyed truth, as `rayloc evaluate` does.

    Args:
        estimates: output of `rayloc replay` or `rayloc sub`: JSON lines or protobuf.
        truth: csv: t_start,t_end,x,y,z per spot or t,x,y,z per instant.
        kind: "device" or "person".
        estimate: "snapshot" or "filtered".
        target: only this one: its address, or person-N.
        time_offset: added to the times of the truth [s].
        site: for the control by the room's centre, the map and the calibration's name.
        plots: folder for cdf.svg, coverage.svg, reliability.svg and, with a site, map.svg.
        force: also into a folder that is not empty.
        progress: called with the share done, 0 to 1, and the step that begins. An exception that it
            raises, or Ctrl-C, ends the evaluation before that step.

    Shapes: as of Evaluation.
    Units: metres, seconds.
    Frame: the world of the site.
    Errors: Error names the file and line, and the mismatch.
    Source: daemon/lab/evaluate/comparison.h.
    """
    if kind not in ("device", "person"):
        raise ValueError(f"there is no kind {kind!r}: device or person")
    if estimate not in ("snapshot", "filtered"):
        raise ValueError(f"there is no estimate {estimate!r}: snapshot or filtered")
    if not math.isfinite(time_offset):
        raise ValueError("time_offset is a finite number of seconds")
    statistics, calibration, seed, arrays = _engine.evaluate(
        {
            "estimates": os.fspath(estimates),
            "truth": os.fspath(truth),
            "person": kind == "person",
            "filtered": estimate == "filtered",
            "target": target,
            "time_offset": float(time_offset),
            "site": os.fspath(site),
            "plots": os.fspath(plots),
            "force": force,
        },
        progress if progress is not None else child.no_progress,
    )
    return Evaluation(
        statistics=json.loads(statistics),
        version=_engine.version(),
        calibration=calibration,
        seed=seed,
        **arrays,
    )


def experiment(
    file: Union[str, PathLike[str]],
    out: Union[str, PathLike[str]],
    *,
    studies: Sequence[str] = (),
    resume: bool = False,
    force: bool = False,
    progress: Optional[Callable[[float, str], None]] = None,
) -> list[Study]:
    """Runs studies on simulated captures, by the program `rayloc experiment`.

    Args:
        file: the experiment, TOML (`rayloc experiment --help`).
        out: folder for report.html, report.json, report.csv and errors.csv.
        studies: names of those to run; none: all.
        resume: continues a run in `out`; completed conditions are not run again.
        force: also into a folder that is not empty.
        progress: called with the share of all conditions, 0 to 1, at the start and after each
            condition, and a text such as "boxes: 3 of 10, median 0.212 m". An exception that it
            raises ends the experiment as Ctrl-C does. None: a terminal shows the progress.

    Ctrl-C ends it within a second and raises KeyboardInterrupt; `out` then holds the conditions
    that are done, from which resume=True continues. It also ends when this process is killed.

    Shapes: as of StudiedCondition.
    Units: metres.
    Frame: none.
    Errors: Error has the text of the program; FileNotFoundError names the package.
    Source: daemon/lab/experiment/run_experiment.h.
    """
    program = _program()
    words = ["experiment", os.fspath(file), "--out", os.fspath(out), "--progress"]
    for name in studies:
        words += ["--study", name]
    words += ["--resume"] if resume else []
    words += ["--force"] if force else []
    version = subprocess.run([program, "--version"], stdout=subprocess.PIPE, text=True, check=True)
    if progress is None and sys.stderr.isatty():
        sys.stderr.write(_run([program, *words], _show))
    else:
        _run([program, *words, "--quiet"], progress)
    report = json.loads((Path(out) / "report.json").read_text())
    errors = _errors_of(Path(out) / "errors.csv")
    return [
        Study(
            name=study["name"],
            claim=study["claim"],
            conditions=[
                StudiedCondition(
                    one["values"], one["statistics"], errors.get((s, c), np.array([])), one.get("refused", "")
                )
                for c, one in enumerate(study["conditions"], 1)
            ],
            version=version.stdout.split()[-1],
            seed=report["seed"],
        )
        for s, study in enumerate(report["studies"], 1)
    ]


def _run(words: Sequence[str], progress: Optional[child.Progress]) -> str:
    """Runs the program, and returns what it writes to standard error beside the progress."""
    written: list[str] = []
    with child.start(LAUNCHER, str(os.getpid()), *words, reads=False, reports=True) as process:
        assert process.stderr is not None
        try:
            child.follow(process.stderr, progress, written.append)
            process.communicate()
        except BaseException:
            child.end(process)
            raise
    text = "".join(written)
    if process.returncode != 0:
        error = _engine.Error(text.strip() or f"rayloc experiment ended with {process.returncode}")
        error.kind = KINDS.get(process.returncode, "internal")
        raise error
    return text


def _show(share: float, text: str) -> None:
    """On the terminal, as the program does: one line, which stays when its study is done."""
    del share
    done = re.search(r": (\d+) of \1, median [^:]*$", text)
    sys.stderr.write(f"\r\033[K{text}" + ("\n" if done else ""))
    sys.stderr.flush()


def _program() -> str:
    """The program of the build that this package belongs to, else the installed one."""
    built = Path(_engine.__file__).resolve().parents[2] / "bin" / "rayloc"
    found = str(built) if os.access(built, os.X_OK) else shutil.which("rayloc")
    if found is None:
        raise FileNotFoundError("rayloc.experiment runs the program rayloc: apt install raylocd")
    return found


def _errors_of(file: Path) -> dict[tuple[int, int], NDArray[np.float64]]:
    """By number of study and condition; infinite where the point was missed."""
    errors: dict[tuple[int, int], list[float]] = {}
    for line in file.read_text().splitlines()[1:]:
        study, condition, _, error = line.split(",")
        errors.setdefault((int(study), int(condition)), []).append(float(error or "inf"))
    return {key: np.array(values) for key, values in errors.items()}
