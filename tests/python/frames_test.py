"""Recordings as arrays, and a place from them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rayloc
from conftest import MEETING_ROOM, program

WALK = {name: MEETING_ROOM / f"walk-{name}.pcap.gz" for name in ("ap1", "ap2", "ap3")}


def test_values_are_those_that_the_program_prints() -> None:
    file = WALK["ap2"]
    lines = [json.loads(line) for line in program("frames", "--values", file).splitlines()]
    frames = rayloc.read_frames(file)
    assert len(frames) == len(lines) - 1  # the last is the summary
    place = {tone: i for i, tone in enumerate(frames.tone_index.tolist())}
    for i, line in enumerate(lines[:-1]):
        cores = np.searchsorted(frames.cores, line["cores"])
        tones = [place[tone] for tone in line["tone_index"]]
        wanted = np.array(line["csi"], np.float32)[:, 0]  # the first stream
        assert np.array_equal(frames.csi[i][np.ix_(cores, tones)], wanted[..., 0] + 1j * wanted[..., 1])
        assert frames.mask[i].sum() == len(cores) * len(tones)
        header = frames.headers[i]
        assert header["transmitter"].decode() == line["transmitter"]
        assert header["sequence_control"] == line["sequence_control"]
        assert header["bandwidth_mhz"] == line["bandwidth_mhz"]
        assert header["complete"] == line["complete"]
        assert str(header["time"]).startswith(line["time"].rstrip("Z"))
        assert frames.power_dbm[i][cores].tolist() == line["power_dbm"]
    assert not frames.csi[~frames.mask].any()


def test_npz_of_the_command_line_is_what_python_has(tmp_path: Path) -> None:
    file = tmp_path / "walk.npz"
    program("frames", f"ap1={WALK['ap1']}", f"ap2={WALK['ap2']}", "--out", file)
    frames = rayloc.read_frames({name: WALK[name] for name in ("ap1", "ap2")})
    with np.load(file) as arrays:
        for name in ("csi", "mask", "headers", "cores", "tone_index"):
            assert np.array_equal(arrays[name], getattr(frames, name)), name
        assert np.array_equal(arrays["power_dbm"], frames.power_dbm, equal_nan=True)
        assert [name.decode() for name in arrays["access_points"]] == frames.access_points


def test_frames_are_chosen_by_what_their_headers_say() -> None:
    frames = rayloc.read_frames(WALK, site=MEETING_ROOM)
    assert frames.access_points == ["ap1", "ap2", "ap3"]
    device = frames.of(frames.transmitters[0])
    assert set(device.headers["transmitter"]) == {frames.transmitters[0].encode()}
    early = device.where(device.headers["time"] < device.headers["time"].min() + np.timedelta64(1, "s"))
    assert 0 < len(early) < len(device) <= len(frames)
    with pytest.raises(KeyError, match="has no frames"):
        frames.of("00:00:00:00:00:00")


def test_what_is_no_mask_of_the_frames_is_refused() -> None:
    frames = rayloc.read_frames(WALK["ap1"])
    numbers: Any = np.arange(len(frames))
    with pytest.raises(ValueError, match="booleans, one a frame"):
        frames.where(numbers)
    for shape in ((len(frames) - 1,), (len(frames) + 1,), (len(frames), 1)):
        with pytest.raises(ValueError, match="booleans, one a frame"):
            frames.where(np.zeros(shape, bool))
    assert len(frames.where(np.ones(len(frames), bool))) == len(frames)


def test_what_is_no_recording_is_said_with_the_words_of_the_command_line(tmp_path: Path) -> None:
    file = tmp_path / "no.pcap"
    file.write_text("no capture at all, but long enough for a header")
    with pytest.raises(rayloc.Error, match="no.pcap"):
        rayloc.read_frames(file)
    with pytest.raises(rayloc.Error, match="there is no wire format 'axcsi'"):
        rayloc.read_frames(WALK["ap1"], format="axcsi")
    with pytest.raises(rayloc.Error, match="format"):
        rayloc.read_frames(WALK, site=MEETING_ROOM, format="axcsi-v4")
    with pytest.raises(rayloc.Error, match="ap9"):
        rayloc.read_frames({"ap9": WALK["ap1"]}, site=MEETING_ROOM)


@pytest.fixture(scope="module")
def calibrated(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """By chain gains alone, from Python: seconds."""
    out = tmp_path_factory.mktemp("site") / "calibrated"
    points = out.parent / "points.csv"
    lines = (MEETING_ROOM / "calibration.csv").read_text().splitlines(keepends=True)
    points.write_text("".join([lines[0], *lines[3::3]]))
    reported: list[tuple[float, str]] = []
    explains = rayloc.calibrate(
        MEETING_ROOM,
        [f"{name}={MEETING_ROOM}/calibration-{name}.pcap.gz" for name in WALK],
        points,
        out,
        method="gains-only",
        force=True,
        progress=lambda share, part: reported.append((share, part)),
    )
    assert explains in (True, False)
    assert reported and all(0.0 <= share <= 1.0 and part for share, part in reported)
    assert (out / "site.toml").is_file()
    return out


def test_an_exception_of_the_progress_ends_a_calibration(tmp_path: Path) -> None:
    def stop(share: float, part: str) -> None:
        raise LookupError(part)

    captures = [f"ap1={MEETING_ROOM}/calibration-ap1.pcap.gz"]
    with pytest.raises(LookupError):
        rayloc.calibrate(
            MEETING_ROOM, captures, MEETING_ROOM / "calibration.csv", tmp_path / "out", progress=stop
        )


def test_a_calibrated_site_locates_as_the_program_does(calibrated: Path, tmp_path: Path) -> None:
    frames = rayloc.read_frames(
        {name: MEETING_ROOM / f"device_los-{name}.pcap.gz" for name in WALK}, site=calibrated
    )
    device = frames.of("02:52:4c:00:00:01")
    begin = device.headers["time"].min()
    spot = device.where(device.headers["time"] < begin + np.timedelta64(100, "ms"))
    localizer = rayloc.Localizer(calibrated)
    estimate = localizer.locate(spot)
    assert estimate.position is not None, estimate.reason
    truth = np.loadtxt(MEETING_ROOM / "device_los.csv", delimiter=",", skiprows=1)[0, 2:4]
    assert np.hypot(*(estimate.position[:2] - truth)) < 1.0  # chain gains alone
    assert estimate.covariance.shape == (3, 3)
    assert np.all(np.linalg.eigvalsh(estimate.covariance) >= -1e-12)
    weights = [weight for _, _, weight in estimate.hypotheses]
    assert sum(weights) + estimate.residual_probability == pytest.approx(1.0)
    map_of_room = localizer.log_likelihood(spot)
    assert map_of_room.shape == localizer.cells.shape[:2]
    assert not np.isnan(map_of_room).any()


def test_frames_that_do_not_fit_the_localizer_are_refused(calibrated: Path) -> None:
    localizer = rayloc.Localizer(calibrated)
    with pytest.raises(rayloc.Error, match="read_frames"):
        localizer.locate(rayloc.read_frames(WALK["ap1"]))
    file: Any = WALK["ap1"]
    with pytest.raises(TypeError, match="read_frames"):
        localizer.locate(file)
    with pytest.raises(TypeError, match="read_frames"):
        localizer.log_likelihood(file)
    everything = rayloc.read_frames(WALK, site=calibrated)
    with pytest.raises(rayloc.Error, match="no frame"):
        localizer.locate(everything.where(np.zeros(len(everything), bool)))


def test_a_bad_survey_is_an_error_with_the_row(tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("t_start,t_end,x,y,z\n1,2,90,0,1\n")
    with pytest.raises(rayloc.Error, match="points.csv:2"):
        rayloc.calibrate(MEETING_ROOM, [f"ap1={WALK['ap1']}"], points, tmp_path / "out")
    with pytest.raises(ValueError, match="holdout"):
        rayloc.calibrate(MEETING_ROOM, [], points, tmp_path / "out", holdout=2.0)
