"""The commands of deploy/clients/README.md for GeoJSON and an omlox hub, against a live raylocd."""

from __future__ import annotations

import json
import math
import os
import subprocess
from pathlib import Path
from typing import Iterator

import pytest
from fake_hub import FakeHub
from processes import PATIENCE, PROGRAMS, Daemon, blocks, eventually

import rayloc

LATITUDE, LONGITUDE = 49.87, 8.65  # by make_site.py


@pytest.fixture
def daemon(tmp_path: Path) -> Iterator[Daemon]:
    with Daemon(tmp_path) as running:
        yield running


def start(contains: str, daemon: Daemon, replaced: dict[str, str]) -> subprocess.Popen[str]:
    """The README's command that contains this, on another endpoint."""
    (command,) = [each for each in blocks("deploy/clients/README.md", "sh") if contains in each]
    replaced = {
        "rayloc sub ": f"rayloc sub --endpoint {daemon.endpoint} ",
        "build/dev/python": os.environ["RAYLOC_PYTHON"],
        **replaced,
    }
    for before, after in replaced.items():
        command = command.replace(before, after)
    # A session of its own: a pipe has two processes to end.
    words = ["bash", "-c", command]
    return subprocess.Popen(
        words, env=PROGRAMS, stdout=subprocess.PIPE, text=True, start_new_session=True
    )


def end(process: subprocess.Popen[str]) -> None:
    os.killpg(process.pid, 9)
    process.wait()
    assert process.stdout is not None
    process.stdout.close()


def metres_per_degree() -> tuple[float, float]:
    """North and east, from the radii of curvature of WGS 84."""
    flat = 1 / 298.257223563
    squared = flat * (2 - flat)
    w2 = 1 - squared * math.sin(math.radians(LATITUDE)) ** 2
    meridian = 6_378_137.0 * (1 - squared) / w2**1.5
    across = 6_378_137.0 / math.sqrt(w2) * math.cos(math.radians(LATITUDE))
    return math.radians(meridian), math.radians(across)


def test_geojson_places_the_device_on_the_earth(daemon: Daemon) -> None:
    with rayloc.Subscriber(daemon.endpoint, topics=["v1/location/"]) as messages:
        assert messages.receive(PATIENCE) is not None  # from here on it misses nothing
        process = start("--format geojson", daemon, {})
        try:
            assert process.stdout is not None
            features = [json.loads(process.stdout.readline()) for _ in range(20)]
        finally:
            end(process)
        said = {}
        while not all(feature["id"] in said for feature in features):
            message = messages.receive(PATIENCE)
            assert message is not None and message.location is not None
            said[message.location.event_id] = message.location
    north, east = metres_per_degree()
    compared = 0
    for feature in features:
        location = said[feature["id"]]
        assert feature["type"] == "Feature"
        assert (feature["geometry"] is not None) == location.HasField("position")
        if location.HasField("position"):
            longitude, latitude, _ = feature["geometry"]["coordinates"]
            assert (longitude - LONGITUDE) * east == pytest.approx(location.position.x, abs=1e-3)
            assert (latitude - LATITUDE) * north == pytest.approx(location.position.y, abs=1e-3)
            compared += 1
    assert compared > 0


def test_an_omlox_hub_gets_the_device(daemon: Daemon) -> None:
    hub = FakeHub()
    process = start("--format omlox", daemon, {"http://127.0.0.1:8081/v2": hub.url})
    try:
        assert eventually(lambda: len(hub.puts) >= 2)
        path, body, _ = hub.puts[-1]
        assert path == f"/v2/providers/{body['provider_id']}/location"
        assert body["provider_id"] == "02524CFFFE000001"
        assert (body["crs"], body["source"]) == ("EPSG:4326", "meeting_room")
    finally:
        end(process)
        hub.close()
