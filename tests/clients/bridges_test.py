"""The bridges as programs: a real raylocd on one side, a real broker on the other."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from pathlib import Path

from broker import Broker, Listener
from processes import CALIBRATED, PATIENCE, ROOT, Daemon, eventually

MAC = "02:52:4c:00:00:01"
STATE = f"rayloc/meeting_room/{MAC}"
TRACKER = "homeassistant/device_tracker/rayloc_meeting_5froom/02-52-4c-00-00-01_place/config"


class Bridge:
    """The command of deploy/clients/README.md, on other ports."""

    def __init__(self, daemon: Daemon, broker: Broker, options: str = "") -> None:
        readme = (ROOT / "deploy/clients/README.md").read_text()
        (command,) = re.findall(r"^PYTHONPATH=.*rayloc\.bridges\.mqtt.*$", readme, re.M)
        command = command.replace("build/dev/python", os.environ["RAYLOC_PYTHON"])
        command = command.replace("127.0.0.1:1883", f"127.0.0.1:{broker.port}")
        assert str(broker.port) in command
        command += f" --endpoint {daemon.endpoint} --interval 0.2 {options}"
        variables, words = command.split(" ", 1)
        self.process = subprocess.Popen(
            ["bash", "-c", f"{variables} exec {words}"], stderr=subprocess.PIPE
        )

    def stop(self, number: signal.Signals) -> int:
        self.process.send_signal(number)
        return self.process.wait(PATIENCE)

    def __enter__(self) -> Bridge:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        assert self.process.stderr is not None
        self.process.stderr.close()


def test_home_assistant_sees_a_device_and_who_is_alive(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Listener(broker) as home:
        with Bridge(daemon, broker) as bridge:
            assert home.hears("rayloc/status", "online")
            assert home.hears("rayloc/meeting_room/status", "online")
            assert eventually(lambda: STATE in home.last and TRACKER in home.last), home.last
            configuration = json.loads(home.last[TRACKER])
            assert configuration["state_topic"] == f"{STATE}/place"
            assert home.hears(f"{STATE}/place", "home")
            assert eventually(lambda: '"place": "home"' in home.last[STATE])
            state = json.loads(home.last[STATE])
            assert 0.0 < state["x"] < 4.0 and 0.0 < state["y"] < 4.0 and state["accuracy_m"] > 0.0

            # Home Assistant restarts: the bridge announces everything again.
            with home.lock:
                del home.last[TRACKER]
            home.client.publish("homeassistant/status", "online")
            assert eventually(lambda: TRACKER in home.last)

            # raylocd stops and restarts.
            assert daemon.stop() == 0
            assert home.hears("rayloc/meeting_room/status", "offline")
            daemon.start()
            assert home.hears("rayloc/meeting_room/status", "online")

            # The bridge crashes: the broker publishes its will.
            assert home.last["rayloc/status"] == "online"
            assert bridge.stop(signal.SIGKILL) == -signal.SIGKILL
            assert home.hears("rayloc/status", "offline")

        with Bridge(daemon, broker) as bridge:
            assert home.hears("rayloc/status", "online")
            assert bridge.stop(signal.SIGTERM) == 0
            assert home.hears("rayloc/status", "offline")


def test_field_a_zone_named_home_is_renamed_with_a_notice(tmp_path: Path) -> None:
    site = tmp_path / "site"
    shutil.copytree(CALIBRATED, site)
    with (site / "site.toml").open("a") as out:
        out.write('\n[[zone]]\nname = "Home"\npolygon = [[-9, -9], [9, -9], [9, 9], [-9, 9]]\n')
    with Broker(tmp_path) as broker, Daemon(tmp_path, site) as daemon, Listener(broker) as home:
        with Bridge(daemon, broker) as bridge:
            assert home.hears(f"{STATE}/place", "Home (zone)")
            assert "zone.home_zone" in json.loads(home.last[STATE])["in_zones"]
            assert bridge.stop(signal.SIGTERM) == 0
            assert bridge.process.stderr is not None
            said = bridge.process.stderr.read().decode()
    assert "'Home'" in said and "'Home (zone)'" in said and "site.toml" in said


def test_field_a_bridge_without_raylocd_is_not_available(tmp_path: Path) -> None:
    """The state that an earlier run left would appear to be current."""
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Listener(broker) as home:
        home.client.publish("rayloc/status", "online", qos=1, retain=True)
        assert home.hears("rayloc/status", "online")
        daemon.stop(signal.SIGKILL)
        with Bridge(daemon, broker):
            assert home.hears("rayloc/status", "offline")
            daemon.start()
            assert home.hears("rayloc/status", "online")


def test_field_bridges_at_one_broker_and_other_prefixes_are_announced_again(tmp_path: Path) -> None:
    other = TRACKER.replace("homeassistant/", "home/")
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Listener(broker) as home:
        with Bridge(daemon, broker) as first, Bridge(daemon, broker, "--base o --prefix home") as second:
            assert eventually(lambda: {TRACKER, other} <= home.last.keys()), home.last
            with home.lock:
                del home.last[TRACKER], home.last[other]
            home.client.publish("homeassistant/status", "online")  # wherever discovery is
            assert eventually(lambda: {TRACKER, other} <= home.last.keys())
            for bridge in (first, second):
                assert bridge.stop(signal.SIGTERM) == 0
                assert bridge.process.stderr is not None
                # With one client id they would end each other's connection.
                assert bridge.process.stderr.read().count(b"connected to the broker") == 1


def test_who_was_located_before_a_crash_of_raylocd_is_away_after_it(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Listener(broker) as home:
        with Bridge(daemon, broker):
            assert eventually(lambda: '"place": "home"' in home.last.get(STATE, "")), home.last
            assert daemon.stop(signal.SIGKILL) == -signal.SIGKILL  # publishes no loss of its tracks
            daemon.hear_nobody()
            daemon.start()
            assert eventually(lambda: '"place": "not_home"' in home.last[STATE])


def test_what_it_announced_is_kept_for_a_home_assistant_that_comes_late(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Bridge(daemon, broker):
        with Listener(broker) as early:
            assert eventually(lambda: TRACKER in early.last)
        with Listener(broker) as late:
            assert eventually(lambda: TRACKER in late.last)
            assert late.hears("rayloc/status", "online")


def test_what_an_earlier_run_announced_is_taken_back(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Listener(broker) as home:
        with Bridge(daemon, broker) as first:
            assert eventually(lambda: TRACKER in home.last)
            assert first.stop(signal.SIGTERM) == 0
        daemon.stop()
        daemon.hear_nobody()
        daemon.start()
        with Bridge(daemon, broker, "--forget 1"):
            assert home.hears(TRACKER, "")
            assert home.hears(f"{STATE}/place", "")  # the last of all
        with Listener(broker) as late:
            assert late.hears("rayloc/status", "offline")  # retained: received upon subscription
            assert late.last.keys() == {"rayloc/status", "rayloc/meeting_room/status"}


def test_a_broker_that_restarts_is_told_everything_again(tmp_path: Path) -> None:
    with Broker(tmp_path) as broker, Daemon(tmp_path) as daemon, Bridge(daemon, broker):
        with Listener(broker) as before:
            assert eventually(lambda: TRACKER in before.last)
        broker.stop()
        broker.start()
        assert eventually(broker._answers)
        with Listener(broker) as after:
            assert after.hears("rayloc/status", "online")
            assert eventually(lambda: TRACKER in after.last)


def test_wrong_arguments_are_refused_with_what_is_needed() -> None:
    for words, said in (
        (["--mqtt", "localhost"], "HOST:PORT is needed"),
        (["--base", "home/#"], "--base: 'home/#'"),
        (["--prefix", "/homeassistant"], "--prefix: '/homeassistant'"),
        (["--key", "x"], "--server-key and --key need each other"),
        (["--server-key", "/nonexistent", "--key", "/nonexistent"], "/nonexistent"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "rayloc.bridges.mqtt", *words], capture_output=True, text=True
        )
        assert done.returncode != 0 and said in done.stderr


def test_ros_2_is_told_where_a_device_is(tmp_path: Path) -> None:
    readme = (ROOT / "deploy/clients/README.md").read_text()
    (command,) = re.findall(r"^PYTHONPATH=.*rayloc\.bridges\.ros2.*$", readme, re.M)
    command = command.replace("build/dev/python", os.environ["RAYLOC_PYTHON"])
    variables, words = command.split(" ", 1)
    with Daemon(tmp_path) as daemon:
        bridge = subprocess.Popen(
            ["bash", "-c", f"{variables} exec {words} --endpoint {daemon.endpoint}"],
            stdout=subprocess.PIPE,
        )
        try:
            assert bridge.stdout is not None
            advertised, published = (json.loads(bridge.stdout.readline()) for _ in range(2))
            bridge.send_signal(signal.SIGTERM)
            bridge.stdout.read()
            assert bridge.wait(PATIENCE) == 0
        finally:
            bridge.kill()
            bridge.wait()
    assert advertised["op"] == "advertise" and advertised["topic"] == published["topic"]
    assert published["msg"]["header"]["stamp"]["sec"] > 1_700_000_000
