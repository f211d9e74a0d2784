"""`rayloc predict`: what it writes is one and the same."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
from conftest import BIN, MEETING_ROOM, ROOT, program


def test_picture_csv_and_arrays_are_of_what_is_printed(tmp_path: Path) -> None:
    png, svg, csv, npz = (tmp_path / f"room.{end}" for end in ("png", "svg", "csv", "npz"))
    said = program(
        "predict", MEETING_ROOM, "--access-points", "ap1", "--step", "0.8", "--draws", "2",
        "--out", png, svg, csv, npz,
    )  # fmt: skip
    assert png.read_bytes().startswith(b"\x89PNG")
    assert "predicted error" in svg.read_text()
    rows = np.loadtxt(csv, delimiter=",", skiprows=1)
    with np.load(npz) as arrays:
        position, error, estimate = (arrays[name] for name in ("position", "error", "estimate"))
    assert len(rows) == len(position) and error.shape == (len(position), 2)
    found = np.isfinite(error)
    distance = np.hypot(*(estimate - position[:, None])[found][:, :2].T)
    assert np.allclose(distance, error[found])
    assert np.allclose(rows[:, 4], (error > 0.5).mean(axis=1), atol=1e-3)
    median = re.search(r"median ([\d.]+) m", said)
    assert median is not None
    assert np.isclose(float(median[1]), np.sort(error, axis=None)[(error.size - 1) // 2], atol=6e-4)


def test_a_prediction_is_what_recordings_of_such_a_room_give() -> None:
    """With the same draws, a few places are enough to show that both use the same room."""
    done = subprocess.run(
        [sys.executable, ROOT / "tests/bench/forecast", BIN.parent, MEETING_ROOM, "--access-points", "ap1",
         "--step", "0.8", "--draws", "1", "--seed", "3", "--recorded-seed", "3"],
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    _, _, bursts, predicted, recorded, ratio, *_ = (cell.strip() for cell in done.stdout.split("|"))
    assert int(bursts) >= 12
    assert float(predicted.split()[0]) > 0.0 and float(recorded.split()[0]) > 0.0
    assert 0.8 < float(ratio.split()[0]) < 1.25, done.stdout


def test_what_cannot_be_is_refused_at_once(tmp_path: Path) -> None:
    def refused(*words: object) -> str:
        command = [str(BIN / "rayloc"), "predict", str(MEETING_ROOM), *map(str, words)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 64, done.stderr
        return done.stderr

    assert "'ap9'" in refused("--access-points", "ap9")
    assert ".npz" in refused("--out", tmp_path / "room.txt")
    assert "20, 40, 80 or 160" in refused("--bandwidth", "30")


def test_proposals_are_in_order() -> None:
    said = program(
        "predict", MEETING_ROOM, "--access-points", "ap1", "--step", "1.2", "--draws", "1", "--propose"
    )
    shares = [float(share) for share in re.findall(r"^ *([\d.]+) %  +[\d.]+ m ", said, re.M)]
    assert len(shares) == 7 and shares == sorted(shares)
    assert "as it is" in said
