"""Simulated recordings from Python: the bytes of `rayloc simulate`, progress, and its end by an exception."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import rayloc
from conftest import MEETING_ROOM, program


@pytest.fixture
def points(tmp_path: Path) -> Path:
    file = tmp_path / "points.csv"
    file.write_text("t_start,t_end,x,y,z\n10,11,1,1,1\n20,21,1.5,1.2,1\n")
    return file


def test_the_bytes_are_those_of_the_command_line(points: Path, tmp_path: Path) -> None:
    expected, made = tmp_path / "expected.pcap", tmp_path / "made.pcap"
    words = ["--points", points, "--seed", 3, "--frames", 4, "--tilt-deg", 20, "--quiet"]
    truth = json.loads(program("simulate", MEETING_ROOM, *words, "--out", f"ap1={expected}"))
    shares: list[tuple[float, str]] = []
    found = rayloc.simulate(
        MEETING_ROOM,
        points,
        {"ap1": made},
        seed=3,
        frames=4,
        tilt_deg=20,
        truth=tmp_path / "truth.csv",
        progress=lambda share, access_point: shares.append((share, access_point)),
    )
    assert made.read_bytes() == expected.read_bytes()
    for one in (truth, found.truth):
        one["access_points"][0].pop("file")
    assert found.truth == truth and found.notes == [] and found.version
    assert shares == [(0.5, "ap1"), (1.0, "ap1")]
    assert (tmp_path / "truth.csv").read_text().startswith("t_start,t_end,x,y,z")
    assert len(rayloc.read_frames({"ap1": made}, site=MEETING_ROOM).csi) == 8


def test_an_exception_of_the_progress_ends_it(points: Path, tmp_path: Path) -> None:
    def stop(share: float, access_point: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        rayloc.simulate(MEETING_ROOM, points, {"ap1": tmp_path / "a.pcap"}, progress=stop)


def test_wrong_input_is_an_error(points: Path, tmp_path: Path) -> None:
    out = {"ap1": tmp_path / "a.pcap"}
    with pytest.raises(ValueError, match="depth is 9"):
        rayloc.simulate(MEETING_ROOM, points, out, depth=9)
    with pytest.raises(ValueError, match="tilt_deg is nan"):
        rayloc.simulate(MEETING_ROOM, points, out, tilt_deg=float("nan"))
    with pytest.raises(ValueError, match="no device"):
        rayloc.simulate(MEETING_ROOM, points, out, person=True, tilt_deg=3)
    with pytest.raises(ValueError, match="model_error"):
        rayloc.simulate(MEETING_ROOM, points, out, model_error=True, depth=2)
    with pytest.raises(ValueError, match="no recording"):
        rayloc.simulate(MEETING_ROOM, points, {})
    with pytest.raises(rayloc.Error, match="ap9"):
        rayloc.simulate(MEETING_ROOM, points, {"ap9": tmp_path / "a.pcap"})
    points.write_text("t_start,t_end,x,y,z\n10,11,1,1\n")
    with pytest.raises(rayloc.Error, match="points.csv:2"):
        rayloc.simulate(MEETING_ROOM, points, out)
    assert not (tmp_path / "a.pcap").exists()
