"""The bridge's messages in Home Assistant itself: a release's own core and MQTT integration at a real broker.

Each test runs with each release that this machine can have. No release has the change that is announced for
2027.1 yet; `announced` is the newest one with that change made as the announcement states it.
"""

from __future__ import annotations

import json
import subprocess
import threading
from pathlib import Path
from typing import Any, Iterator, Optional

import pytest
from broker import Broker
from home_assistant_test import MAC, heartbeat, located, lost, zone
from home_assistant_venv import RELEASES, python_of
from processes import PATIENCE, eventually

from rayloc.bridges import mqtt
from rayloc.bridges.home_assistant import HomeAssistant, Setting
from rayloc.bridges.place_name import state_of_zone, zone_of_state
from rayloc.message import Message

NEWEST = max(RELEASES, key=lambda release: RELEASES[release])
SLUG = MAC.replace(":", "_")
TRACKER = f"device_tracker.wi_fi_{SLUG}_place"
ZONE = f"sensor.wi_fi_{SLUG}_zone"
X = f"sensor.wi_fi_{SLUG}_x"


class Core:
    """home_assistant_core.py, and the last state of each entity."""

    def __init__(self, python: Path, folder: Path, port: int, release: str) -> None:
        self.states: dict[str, dict[str, Any]] = {}
        self.log: list[str] = []
        self.slugs: Optional[list[str]] = None
        self._is_started = False
        folder.mkdir(exist_ok=True)
        program = Path(__file__).with_name("home_assistant_core.py")
        environment = {"PATH": "/usr/bin:/bin", "HOME": str(folder)}
        self._process = subprocess.Popen(
            [str(python), str(program), str(folder), str(port), release],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )
        self._reader = threading.Thread(target=self._read)
        self._reader.start()
        assert eventually(lambda: self._is_started or self._process.poll() is not None)
        assert self._is_started, self.log

    def state(self, entity: str) -> Optional[str]:
        found: Optional[str] = self.states.get(entity, {}).get("state")
        return found

    def attributes(self, entity: str) -> dict[str, Any]:
        found: dict[str, Any] = self.states[entity]["attributes"]
        return found

    def becomes(self, entity: str, state: Optional[str]) -> bool:
        return eventually(lambda: self.state(entity) == state)

    def slugs_of(self, names: list[str]) -> list[str]:
        assert self._process.stdin is not None
        print(json.dumps(names), file=self._process.stdin, flush=True)
        assert eventually(lambda: self.slugs is not None)
        assert self.slugs is not None
        return self.slugs

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            found = json.loads(line)
            if found["kind"] == "state":
                self.states[found["entity_id"]] = found
            elif found["kind"] == "log":
                self.log.append(found["text"])
            elif found["kind"] == "slugs":
                self.slugs = found["slugs"]
            self._is_started = self._is_started or found["kind"] == "started"

    def __enter__(self) -> Core:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        try:
            self._process.wait(PATIENCE)
        finally:
            self._process.kill()
            self._process.wait()
            self._reader.join()
            self._process.stdout.close()


class Bridge:
    """The bridge without raylocd: what it would receive is given, and what time it is."""

    def __init__(self, port: int) -> None:
        self.mapping = HomeAssistant(Setting(interval=0.0))
        self.broker = mqtt.Broker(mqtt.parse(["--mqtt", f"127.0.0.1:{port}"]), Setting())
        assert self.broker.must_announce.wait(PATIENCE)
        self.receive(heartbeat())
        self.pass_to(0.0)

    def receive(self, message: Message) -> None:
        self.broker.publish(self.mapping.on_message(message, 0.0))

    def pass_to(self, now: float, stale: bool = False) -> None:
        self.broker.publish(self.mapping.on_time(now, stale))

    def close(self) -> None:
        self.broker.close()


class Home:
    def __init__(self, folder: Path, release: str, change: str) -> None:
        self.python = python_of(release)
        self.broker = Broker(folder)
        self.bridge = Bridge(self.broker.port)
        self._folder = folder / "home_assistant"
        self._change = change

    def core(self) -> Core:
        return Core(self.python, self._folder, self.broker.port, self._change)

    def close(self) -> None:
        self.bridge.close()
        self.broker.stop()


def opened(folder: Path, release: str, change: str) -> Iterator[Home]:
    home = Home(folder, release, change)
    yield home
    home.close()


@pytest.fixture(params=RELEASES)
def home(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Home]:
    yield from opened(tmp_path, request.param, "installed")


@pytest.fixture
def announced(tmp_path: Path) -> Iterator[Home]:
    yield from opened(tmp_path, NEWEST, "announced")


def test_field_a_device_in_a_zone_has_the_state_that_the_zone_is_named(home: Home) -> None:
    names = ["desk", "Meeting room", "büro/1+#", "会议室", '{"a": 1}', "{{ 1 }}", "x" * 255, "x" * 300]
    names += ["home", " Not Home ", "None", "Unknown", "unavailable", "away", "  "]
    bridge = home.bridge
    with home.core() as core:
        bridge.receive(located())
        assert core.becomes(TRACKER, "home"), core.log
        assert core.becomes(ZONE, "home") and core.becomes(X, "1.25")
        seen = set()
        for name in names:
            bridge.receive(zone(name, MAC))
            state = state_of_zone(name)
            assert core.becomes(TRACKER, state) and core.becomes(ZONE, state), (name, core.states[TRACKER])
            seen.add(state)
            bridge.receive(zone(name))
            assert core.becomes(TRACKER, "home") and core.becomes(ZONE, "home")
        assert len(seen) == len(names)
        bridge.receive(lost())
        assert core.becomes(TRACKER, "not_home") and core.becomes(X, "unknown")
        assert core.log == []


def test_field_a_home_assistant_that_comes_late_or_again_has_every_state(home: Home) -> None:
    bridge = home.bridge
    bridge.receive(zone("desk", MAC))
    bridge.receive(located())
    for _ in range(2):
        with home.core() as core:  # nothing is published any more
            assert core.becomes(TRACKER, "desk"), core.log
            assert core.becomes(ZONE, "desk") and core.becomes(X, "1.25")
            assert core.log == []


def test_field_entities_are_unavailable_without_raylocd_or_bridge_and_end_when_forgotten(home: Home) -> None:
    bridge = home.bridge
    bridge.receive(located())
    bridge.receive(located(person=3))
    with home.core() as core:
        assert core.becomes(TRACKER, "home") and core.becomes("device_tracker.person_3_place", "home")
        bridge.pass_to(1.0, stale=True)
        assert core.becomes(TRACKER, "unavailable") and core.becomes(X, "unavailable")
        bridge.pass_to(2.0)
        assert core.becomes(TRACKER, "home")
        bridge.receive(lost(person=3))
        assert core.becomes("device_tracker.person_3_place", None)
        bridge.pass_to(90_000.0)
        assert all(core.becomes(entity, None) for entity in (TRACKER, ZONE, X))
        assert core.log == []
    with home.core() as core:  # nor is anything kept
        assert TRACKER not in core.states


def test_field_devices_of_any_name_get_entities_of_their_own(home: Home) -> None:
    names = ["tag", "tag", "x" * 300, "Büro / 1", "会议室", "  ", "a\tb", "home"]
    with home.core() as core:
        for number, name in enumerate(names):
            message = located()
            target = message.envelope.location.target
            target.mac, target.name = f"02:00:00:00:00:{number:02x}", name
            home.bridge.receive(Message(f"v1/location/my%20office/{target.mac}/", message.envelope))

        def trackers() -> list[str]:
            return [each for each in list(core.states) if each.startswith("device_tracker.")]

        assert eventually(lambda: len(trackers()) == len(names)), trackers()
        assert all(core.becomes(each, "home") for each in trackers())
        assert core.log == []


def test_field_zones_are_named_by_the_object_ids_that_home_assistant_gives(home: Home) -> None:
    names = ["desk", "Meeting Room", "R&D", "Büro", "Café 1,000", "a--b", "Bob's", "1.5 m", "über_all", "ÅÄÖ"]
    with home.core() as core:
        assert [zone_of_state(name) for name in names] == [f"zone.{each}" for each in core.slugs_of(names)]


def test_field_a_tracker_of_2027_1_is_in_the_zones_of_home_assistant(announced: Home) -> None:
    bridge = announced.bridge
    with announced.core() as core:
        bridge.receive(located())
        assert core.becomes(TRACKER, "home"), core.log
        for name, entity in (("desk", "zone.desk"), ("Meeting room", "zone.meeting_room")):
            bridge.receive(zone(name, MAC))
            assert core.becomes(TRACKER, name)
            assert core.attributes(TRACKER)["in_zones"] == [entity, "zone.home"]
            bridge.receive(zone(name))
            assert core.becomes(TRACKER, "home")
        bridge.receive(zone("balcony", MAC))  # Home Assistant has no such zone; the sensor states ours
        assert core.becomes(ZONE, "balcony") and core.state(TRACKER) == "home"
        bridge.receive(lost())
        assert core.becomes(TRACKER, "not_home")
        assert core.attributes(TRACKER)["in_zones"] == []
        assert core.log == []
