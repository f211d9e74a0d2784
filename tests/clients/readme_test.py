"""The commands of the README, as they stand there."""

from __future__ import annotations

import subprocess
from pathlib import Path

from processes import BIN, PATIENCE, PROGRAMS, SITE, Daemon, blocks, eventually, free_port

import rayloc

OFFICE = """name = "office"
size = [5.2, 3.4, 2.7]
floor = "concrete"
ceiling = "ceiling_board"
walls = "plasterboard"
[carrier]
channel = 36
bandwidth_mhz = 40
centre_hz = 5190000000
tones = 128
active = [[-58, -2], [2, 58]]
"""
ACCESS_POINT = """
[[access_point]]
id = "ap1"
position = [0.5, 0.5, 1.2]
pattern = "half_wave_dipole"
[[access_point.antenna]]
core = 0
offset = [0, 0, 0]
"""


def block_with(text: str) -> str:
    (block,) = [each for each in blocks("README.md", "") if text in each]
    return block.strip()


def start(script: str, folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        ["bash", "-c", f"set -eu\n{script}"],
        cwd=folder,
        env=PROGRAMS,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def run(script: str, folder: Path) -> str:
    """What it says on standard output; it ends well."""
    process = start(script, folder)
    output, words = process.communicate(timeout=10 * PATIENCE)
    assert process.returncode == 0, words
    return output


def test_the_readme_makes_a_room_of_a_few_lines(tmp_path: Path) -> None:
    (tmp_path / "office.toml").write_text(OFFICE)
    run(block_with("rayloc scene room"), tmp_path)
    with (tmp_path / "SITE" / "site.toml").open("a") as site:
        site.write(ACCESS_POINT)
    assert "office" in run(block_with("rayloc scene check"), tmp_path)


def test_the_readme_goes_from_a_plan_of_points_to_their_frames(tmp_path: Path) -> None:
    (tmp_path / "SITE").symlink_to(SITE)
    run(block_with("--plan --out"), tmp_path)
    assert (tmp_path / "plan.svg").is_file()
    survey = block_with("rayloc survey")
    senders = []
    for access_point, port in (("ap1", "5501"), ("ap2", "5502")):
        assert f"{access_point}=0.0.0.0:{port}" in survey
        free = free_port()
        survey = survey.replace(f"0.0.0.0:{port}", f"127.0.0.1:{free}")
        recording = SITE / f"device_los-{access_point}.pcap.gz"
        command = [str(BIN / "rayloc"), "send", str(recording), "--to", f"127.0.0.1:{free}"]
        command += ["--rate", "400", "--duration", "60"]
        senders.append(
            subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        )
    points = tmp_path / "points.csv"
    surveying = start(survey, tmp_path)
    try:
        assert surveying.stdin is not None
        surveying.stdin.write("\n")  # Enter: at the first planned point
        surveying.stdin.flush()
        assert eventually(lambda: points.is_file() and len(points.read_text().splitlines()) == 2)
        _, words = surveying.communicate("q\n", timeout=PATIENCE)
        assert surveying.returncode == 0, words
    finally:
        surveying.kill()
        surveying.wait()
        for sender in senders:
            sender.kill()
            sender.wait()
    (row,) = points.read_text().splitlines()[1:]
    first = (tmp_path / "plan.csv").read_text().splitlines()[1]
    assert [float(x) for x in row.split(",")[2:5]] == [float(x) for x in first.split(",")[:3]]
    assert (tmp_path / "a.pcap").stat().st_size > 24  # more than the header of the file
    assert (tmp_path / "b.pcap").stat().st_size > 24


def test_the_readme_goes_from_a_survey_to_locations(tmp_path: Path) -> None:
    """But for the room, which is left as it was planned: that takes seconds, not minutes."""
    calibrate = block_with("rayloc calibrate SITE --capture")
    offline, live = block_with("rayloc evaluate").split("raylocd --config")
    for name, file in {
        "SITE": "",
        "a.pcap": "calibration-ap1.pcap.gz",
        "b.pcap": "calibration-ap2.pcap.gz",
        "points.csv": "calibration.csv",
        "walk1.pcap": "device_los-ap1.pcap.gz",
        "walk2.pcap": "device_los-ap2.pcap.gz",
        "truth.csv": "device_los.csv",
    }.items():
        (tmp_path / name).symlink_to(SITE / file)
    assert "median" in run(f"{calibrate} --gains-only\n{offline}", tmp_path)
    with Daemon(tmp_path, tmp_path / "CALIBRATED") as daemon:  # raylocd --config raylocd.toml
        assert live.split()[0] == daemon.configuration.name
        with rayloc.Subscriber(daemon.endpoint) as messages:
            assert messages.receive(PATIENCE) is not None
