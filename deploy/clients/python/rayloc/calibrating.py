"""The calibration of a site, in a separate process: a step of its fit can take longer than Ctrl-C may (`child`)."""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
from os import PathLike
from typing import Callable, Optional, Sequence, Union

from rayloc import child
from rayloc.needs import explained

try:
    from rayloc._engine import Error
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["calibrate"]

CHILD = """
import json, sys
from rayloc import _engine
if not _engine.end_with_parent(int(sys.argv[2])):
    sys.exit("the process that started this calibration has ended")
try:
    answer = {"explains": _engine.run_calibration(json.loads(sys.stdin.read()))}
except _engine.Error as error:
    answer = {"error": str(error), "kind": error.kind}
print(json.dumps(answer))
"""


def calibrate(
    site: Union[str, PathLike[str]],
    captures: Union[str, Sequence[str]],
    points: Union[str, PathLike[str]],
    out: Union[str, PathLike[str]],
    *,
    method: str = "joint",
    holdout: float = 0.2,
    survey_error: Optional[float] = None,
    seed: int = 1,
    resume: bool = False,
    force: bool = False,
    progress: Optional[Callable[[float, str], None]] = None,
) -> bool:
    """Calibrates a site by a survey, as `rayloc calibrate` does.

    Args:
        site: a directory with site.toml, as surveyed.
        captures: recordings of the survey, "AP=FILE".
        points: surveyed positions of the device, csv: t_start, t_end, x, y, z.
        out: folder to create: the calibrated site, with report.json and report.html.
        method: "joint", "paper" or "gains-only".
        holdout: share of the points kept for checking, 0 to 0.8.
        survey_error: standard deviation of the points along each axis [m]; None: the joint method
            finds it, the others assume 0.005.
        seed: seed of the draw of those points.
        resume: continues the calibration that was interrupted in `out`.
        force: also into a folder that is not empty, and what is no success.
        progress: called with the share of the current part, 0 to 1, and its description, such as
            "joint: 57 points, fit, step 12"; an exception that it raises ends the calibration as
            Ctrl-C does.

    Returns:
        True if the calibrated room explains the points that were held out. If it does not, the site
        was written with `force` only, and report.json states the reason.

    Ctrl-C ends it within a second and raises KeyboardInterrupt; `out` then holds the last good
    state, from which resume=True goes on. It ends as well, at once and with the same state, when
    this process is killed.

    Shapes: none. Units: metres, seconds. Frame: the world of the site.
    Errors: Error names the row of the points or the access point.
    Source: daemon/lab/calibrate/calibrate.h; METHODS B4.
    """
    if not 0.0 <= holdout <= 0.8:
        raise ValueError("holdout is a share of the points from 0 to 0.8")
    if survey_error is not None and not 0.0005 <= survey_error <= 0.1:
        raise ValueError("survey_error is from 0.0005 to 0.1 m")
    if not 0 <= seed < 2**64:
        raise ValueError("seed is from 0 to 2**64 - 1")
    if method not in ("joint", "paper", "gains-only"):
        raise ValueError(f"there is no method {method!r}: joint, paper or gains-only")
    if resume and method != "joint":
        raise ValueError("resume goes on with the joint method only")
    arguments = {
        "site": os.fspath(site),
        "captures": [captures] if isinstance(captures, str) else list(captures),
        "points": os.fspath(points),
        "out": os.fspath(out),
        "method": method,
        "holdout": holdout,
        "survey_error": survey_error,
        "seed": seed,
        "resume": resume,
        "force": force,
        "progress": progress is not None,
    }
    answer = json.loads(_answer_of_child(json.dumps(arguments), os.fspath(out), progress))
    if "error" in answer:
        error = Error(answer["error"])
        error.kind = answer["kind"]
        raise error
    return bool(answer["explains"])


def _answer_of_child(question: str, out: str, progress: Optional[child.Progress]) -> str:
    # The process does not read `out`; the argument identifies its calibration in a list of processes.
    with child.start(CHILD, out, str(os.getpid()), reads=True, reports=progress is not None) as process:
        try:
            if progress is not None:
                _follow(process, question, progress)
            answer, _ = process.communicate(question if progress is None else None)
        except BaseException:
            child.end(process)
            raise
    if process.returncode != 0:
        raise RuntimeError(f"the calibration ended with status {process.returncode}")
    return answer


def _follow(process: subprocess.Popen[str], question: str, progress: child.Progress) -> None:
    """Asks, and reports the progress until the child closes its standard error; its answer is short."""
    assert process.stdin is not None and process.stderr is not None
    with contextlib.suppress(BrokenPipeError):  # the child has ended; its status is checked
        process.stdin.write(question)
        process.stdin.close()
    process.stdin = None
    child.follow(process.stderr, progress, sys.stderr.write)
