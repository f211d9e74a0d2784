"""Evaluations and experiments from Python: the numbers of `rayloc evaluate` and `rayloc experiment`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import rayloc
from conftest import MEETING_ROOM, ROOT, program

STUDY = f"""
name = "Controls"
seed = 7
[defaults]
room = "{ROOT / 'deploy/experiments/rooms/meeting_room.toml'}"
spots = 2
survey_points = 5
[[study]]
name = "who answers the middle"
claim = "nobody learns from it"
method = ["centre", "witraj"]
kind = "person"
[[study]]
name = "another"
method = "centre"
"""


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    """0.3 m off at the first spot, without a fix at the second, nothing at the third."""
    estimates = tmp_path / "estimates.jsonl"
    snapshot: dict[str, object] = {
        "kind": "LOCATION_KIND_SNAPSHOT",
        "target": {"kind": "TARGET_KIND_DEVICE", "mac": "a"},
    }
    found: dict[str, object] = {
        "time": "1970-01-01T00:00:10.5Z",
        "mode": "FIX_MODE_2D",
        "position": {"x": 1.3, "y": 2, "z": 1},
        "position_covariance": [1, 0, 0, 0, 1, 0, 0, 0, 1],
    }
    missed: dict[str, object] = {"time": "1970-01-01T00:00:20.5Z", "mode": "FIX_MODE_NO_FIX"}
    both: list[dict[str, object]] = [{**snapshot, **found}, {**snapshot, **missed}]
    lines = [json.dumps(one) for one in both]
    estimates.write_text("\n".join(lines) + "\n")
    truth = tmp_path / "truth.csv"
    truth.write_text("t_start,t_end,x,y,z\n10,11,1,2,1\n20,21,1,2,1\n30,31,1,2,1\n")
    return estimates, truth


def test_an_evaluation_is_that_of_the_command_line(files: tuple[Path, Path], tmp_path: Path) -> None:
    estimates, truth = files
    told = ["--estimates", estimates, "--truth", truth, "--site", MEETING_ROOM]
    expected = json.loads(program("evaluate", *told, "--json"))
    plots = tmp_path / "plots"
    found = rayloc.evaluate(estimates, truth, site=MEETING_ROOM, plots=plots)
    assert found.statistics == expected
    assert found.seed == 1 and found.version and found.calibration == ""
    np.testing.assert_allclose(found.error, [0.3, np.inf, np.inf])
    np.testing.assert_array_equal(found.time, [10.0, 20.0, 30.0])
    np.testing.assert_array_equal(found.truth, [[1.0, 2.0, 1.0]] * 3)
    np.testing.assert_array_equal(found.position[0, :2], [1.3, 2.0])
    assert np.isnan(found.position[1:]).all()
    assert found.room_centre_error.shape == (3,)
    assert sorted(path.name for path in plots.iterdir()) == [
        "cdf.svg",
        "coverage.svg",
        "map.svg",
        "reliability.svg",
    ]
    with pytest.raises(rayloc.Error, match="not empty"):
        rayloc.evaluate(estimates, truth, plots=plots)


def test_an_evaluation_reports_its_steps(files: tuple[Path, Path], tmp_path: Path) -> None:
    steps: list[tuple[float, str]] = []
    rayloc.evaluate(
        *files, plots=tmp_path / "plots", progress=lambda share, step: steps.append((share, step))
    )
    assert steps == [(0.0, "reading"), (0.5, "statistics of 3 points"), (0.8, "plots"), (1.0, "done")]

    def stop(share: float, step: str) -> None:
        if step == "plots":
            raise LookupError(step)

    with pytest.raises(LookupError, match="plots"):
        rayloc.evaluate(*files, plots=tmp_path / "none", progress=stop)
    assert not (tmp_path / "none").exists()


def test_what_does_not_match_is_an_error(files: tuple[Path, Path], tmp_path: Path) -> None:
    estimates, truth = files
    with pytest.raises(rayloc.Error, match="none of 2 estimates is a snapshot of a person"):
        rayloc.evaluate(estimates, truth, kind="person")
    with pytest.raises(rayloc.Error, match="no estimate lies in the times of the truth"):
        rayloc.evaluate(estimates, truth, time_offset=1000.0)
    with pytest.raises(ValueError, match="there is no kind 'robot'"):
        rayloc.evaluate(estimates, truth, kind="robot")
    with pytest.raises(rayloc.Error, match="absent.csv"):
        rayloc.evaluate(estimates, tmp_path / "absent.csv")


def test_an_experiment_is_that_of_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(STUDY)
    program("experiment", file, "--out", tmp_path / "expected", "--quiet")
    found = rayloc.experiment(file, tmp_path / "found")
    for name in ("report.json", "report.csv", "report.html", "errors.csv"):
        assert (tmp_path / "found" / name).read_bytes() == (tmp_path / "expected" / name).read_bytes()
    first, another = found
    assert first.claim == "nobody learns from it" and first.seed == another.seed == 7
    centre, refused = first.conditions
    assert centre.values["method"] == "centre" and centre.refusal == ""
    assert np.median(centre.error) == pytest.approx(centre.statistics["median_m"])
    assert "witraj" in refused.refusal
    only = rayloc.experiment(file, tmp_path / "found", studies=["another"], resume=True)
    assert [study.name for study in only] == ["another"]
    np.testing.assert_array_equal(only[0].conditions[0].error, another.conditions[0].error)


def test_an_experiment_reports_its_progress(tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(STUDY)
    reported: list[tuple[float, str]] = []
    rayloc.experiment(
        file, tmp_path / "out", progress=lambda share, text: reported.append((share, text))
    )
    shares = [share for share, _ in reported]
    assert shares == [0.0, 0.333, 0.667, 1.0]  # three decimal places
    assert reported[0][1] == "0 of 3 conditions"
    assert reported[1][1].startswith("who answers the middle: 1 of 2, median ")
    assert reported[3][1].startswith("another: 1 of 1, median ")


@pytest.mark.parametrize("kind", [LookupError, KeyboardInterrupt])
def test_an_exception_of_the_progress_ends_an_experiment(kind: type[BaseException], tmp_path: Path) -> None:
    """It leaves the conditions that are done, and `resume` does not run them again."""
    file, out = tmp_path / "study.toml", tmp_path / "out"
    file.write_text(STUDY)

    def stop(share: float, text: str) -> None:
        if share > 0.0:
            raise kind(text)

    with pytest.raises(kind, match="1 of 2"):
        rayloc.experiment(file, out, progress=stop)
    done = sorted((out / "conditions").glob("*.json"))
    assert done
    before = [one.stat().st_mtime_ns for one in done]
    first, another = rayloc.experiment(file, out, resume=True)
    assert [one.stat().st_mtime_ns for one in done] == before
    assert len(first.conditions) == 2 and len(another.conditions) == 1


def test_what_the_program_refuses_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "study.toml"
    file.write_text(STUDY)
    with pytest.raises(rayloc.Error, match="the file has no such study") as caught:
        rayloc.experiment(file, tmp_path / "other", studies=["none"])
    assert caught.value.kind == "usage"
    file.write_text(STUDY.replace("spots", "sports"))
    with pytest.raises(rayloc.Error, match="sports") as caught:
        rayloc.experiment(file, tmp_path / "other", progress=lambda share, text: None)
    assert caught.value.kind == "configuration"
