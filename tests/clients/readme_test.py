"""The commands of the front page and of the page on running, as they are there."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

from processes import (
    BIN,
    PATIENCE,
    PROGRAMS,
    ROOT,
    SITE,
    Daemon,
    all_blocks,
    blocks,
    eventually,
    free_port,
)

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


OPERATING = "deploy/OPERATING.md"
# Every block of both pages by what only it contains, and who runs it. tests/run runs them all.
RUN_BY = {
    "deploy/quickstart": "tests/e2e/quickstart_test.sh",
    "rayloc scene room": "test_the_readme_makes_a_room_of_a_few_lines",
    "rayloc scene check": "test_the_readme_makes_a_room_of_a_few_lines",
    "--plan --plan-points": "test_the_readme_goes_from_a_plan_of_points_to_their_frames",
    "rayloc survey": "test_the_readme_goes_from_a_plan_of_points_to_their_frames",
    "rayloc calibrate SITE --capture": "test_the_readme_goes_from_a_survey_to_locations",
    "rayloc evaluate": "test_the_readme_goes_from_a_survey_to_locations",
    "import rayloc": "tests/clients/examples_test.py",
    "[[site]]": "test_several_sites_are_configured_as_the_page_says",
    "[[zone]]": "test_zones_have_events_and_places_on_the_earth_as_the_page_says",
}
ACCESS_POINTS = ("ap1", "ap2", "ap3")


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
    """Its standard output; it ends with status 0."""
    process = start(script, folder)
    output, words = process.communicate(timeout=10 * PATIENCE)
    assert process.returncode == 0, words
    return output


def test_every_block_of_the_readme_is_run_by_some_test() -> None:
    found = all_blocks("README.md") + all_blocks(OPERATING)
    for _, block in found:
        assert len([name for name in RUN_BY if name in block]) == 1, block
    assert len(found) == len(RUN_BY)
    for runner in RUN_BY.values():
        assert runner in globals() or (ROOT / runner).is_file(), runner


def test_the_readmes_name_the_verbs_that_there_are() -> None:
    done = subprocess.run([str(BIN / "rayloc"), "--help"], stdout=subprocess.PIPE, text=True)
    listed = done.stdout.split("Subcommands:")[1]
    verbs = set(re.findall(r"^  ([a-z-]+)  ", listed, re.M))
    page = (ROOT / OPERATING).read_text()
    table = [line for line in page.splitlines() if line.startswith("| `rayloc ")]
    of_rows = re.findall(r"`rayloc ([a-z-]+)", "\n".join(line.split("|")[1] for line in table))
    assert set(of_rows) == verbs
    ours = [ROOT / "README.md", ROOT / OPERATING]
    for folder in ("capture", "daemon", "deploy", "engine", "proto", "tests"):
        found = list((ROOT / folder).glob("**/README.md"))
        assert found, folder
        ours += found
    for file in ours:
        named = re.findall(r"(?:`|^ *)rayloc ([a-z-]+)", file.read_text(), re.M)
        assert set(named) <= verbs, file


def test_the_readme_makes_a_room_of_a_few_lines(tmp_path: Path) -> None:
    (tmp_path / "office.toml").write_text(OFFICE)
    run(block_with("rayloc scene room"), tmp_path)
    with (tmp_path / "SITE" / "site.toml").open("a") as site:
        site.write(ACCESS_POINT)
    assert "office" in run(block_with("rayloc scene check"), tmp_path)


def test_the_readme_goes_from_a_plan_of_points_to_their_frames(tmp_path: Path) -> None:
    (tmp_path / "SITE").symlink_to(SITE)
    run(block_with("--plan --plan-points"), tmp_path)
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
    """As in the README, with a fit of the room, to every fourth point of the survey."""
    calibrate = block_with("rayloc calibrate SITE --capture")
    offline, live = block_with("rayloc evaluate").split("raylocd --config")
    for name, file in {
        "SITE": "",
        "a.pcap": "calibration-ap1.pcap.gz",
        "b.pcap": "calibration-ap2.pcap.gz",
        "walk1.pcap": "device_los-ap1.pcap.gz",
        "walk2.pcap": "device_los-ap2.pcap.gz",
        "truth.csv": "device_los.csv",
    }.items():
        (tmp_path / name).symlink_to(SITE / file)
    header, *points = (SITE / "calibration.csv").read_text().splitlines(keepends=True)
    (tmp_path / "points.csv").write_text(header + "".join(points[::4]))
    assert "median" in run(f"{calibrate}\n{offline}", tmp_path)
    with Daemon(tmp_path, tmp_path / "CALIBRATED") as daemon:  # raylocd --config raylocd.toml
        assert live.split()[0] == daemon.configuration.name
        with rayloc.Subscriber(daemon.endpoint) as messages:
            assert messages.receive(PATIENCE) is not None


def inline(beginning: str) -> str:
    """The command within a sentence of the page on running."""
    command: str
    (command,) = re.findall(rf"`({re.escape(beginning)}[^`]*)`", (ROOT / OPERATING).read_text())
    return command


def test_several_sites_are_configured_as_the_page_says(tmp_path: Path) -> None:
    (block,) = [each for each in blocks(OPERATING, "") if "[[site]]" in each]
    for name in ("office", "hall"):
        block = block.replace(f"/etc/raylocd/{name}", str(SITE))
    (tmp_path / "raylocd.toml").write_text(
        block + 'access_point = "ap1"\n[[source]]\nsite = "hall"\nurl = "udp:0.0.0.0:5501"\n'
        'access_point = "ap1"\n'
    )
    run("rayloc check-config raylocd.toml", tmp_path)


def test_zones_have_events_and_places_on_the_earth_as_the_page_says(tmp_path: Path) -> None:
    (block,) = blocks(OPERATING, "toml")
    zone, georeference = block.split("[georeference]")
    site = tmp_path / "SITE"
    captures = " ".join(f"{ap}={SITE}/calibration-{ap}.pcap.gz" for ap in ACCESS_POINTS)
    points = f"--points {SITE}/calibration.csv"
    run(f"rayloc calibrate {SITE} --gains-only --capture {captures} {points} --out SITE", tmp_path)
    unzoned = (site / "site.toml").read_text()

    def with_text(text: str) -> None:
        (site / "site.toml").write_text(f"{unzoned}\n{text}")

    files = " ".join(f"{ap}={SITE}/device_los-{ap}.pcap.gz" for ap in ACCESS_POINTS)
    replay = inline("rayloc replay SITE FILE --zone-events").replace("FILE", files)

    def events() -> bytes:
        run(f"{replay} --out locations.jsonl", tmp_path)
        return (tmp_path / "zones.jsonl").read_bytes()

    with_text(block)
    first = events()
    kinds = {json.loads(line)["kind"] for line in first.splitlines()}
    assert kinds >= {"ZONE_EVENT_KIND_ENTERED", "ZONE_EVENT_KIND_LEFT"}
    # Optional keys are stated with their defaults: omitting them changes nothing, other values would.
    may_be_left_out = re.findall(r"^(?:enter|leave|dwell)_.*\n", zone, re.M)
    assert len(may_be_left_out) == 5
    short = zone
    for line in may_be_left_out:
        short = short.replace(line, "")
    with_text(short)
    assert events() == first
    with_text(short + "enter_after_s = 0.0\n")
    assert events() != first

    with_text(block)
    run(inline("rayloc scene show SITE"), tmp_path)
    assert ">desk</text>" in (tmp_path / "room.svg").read_text()
    with Daemon(tmp_path, site) as daemon:
        assert "warning" not in run(f"rayloc check-config {daemon.configuration} 2>&1", tmp_path)
        sub = f"rayloc sub --endpoint {daemon.endpoint} --format geojson --count 1"
        longitude, latitude, altitude = json.loads(run(sub, tmp_path))["geometry"]["coordinates"]
    stated = {key: float(value) for key, value in re.findall(r"(\w+) = ([\d.]+)", georeference)}
    assert abs(latitude - stated["latitude"]) < 1e-4  # 11 m: the room
    assert abs(longitude - stated["longitude"]) < 1e-4
    assert 0.0 < altitude - stated["altitude_m"] < 2.7
