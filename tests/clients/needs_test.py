"""Without a Python package that they need, the client and the bridges name the Debian package that has it."""

from __future__ import annotations

import subprocess
import sys

import pytest

BRIDGES = ("mqtt", "omlox_hub", "ros2")
BLOCKED = """
import runpy, sys
sys.modules[{missing!r}] = None
sys.argv = [{bridge!r}, "--help"]
runpy.run_module({bridge!r}, run_name="__main__")
"""


def without(missing: str, bridge: str) -> subprocess.CompletedProcess[str]:
    program = BLOCKED.format(missing=missing, bridge=f"rayloc.bridges.{bridge}")
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)


@pytest.mark.parametrize("bridge", BRIDGES)
@pytest.mark.parametrize(
    "missing, package",
    [("zmq", "python3-zmq"), ("google.protobuf", "python3-protobuf"), ("rayloc.v1", "python3-rayloc")],
)
def test_field_bridges_name_the_package_of_what_all_need(missing: str, package: str, bridge: str) -> None:
    done = without(missing, bridge)
    assert done.returncode != 0
    assert f"{package}" in done.stderr.splitlines()[-1], done.stderr


def test_field_the_bridge_to_mqtt_names_its_package_and_is_not_started_again() -> None:
    done = without("paho", "mqtt")
    assert done.returncode == 78
    assert "install Debian's python3-paho-mqtt" in done.stderr
    assert len(done.stderr.splitlines()) == 1, done.stderr


def test_field_what_is_there_is_not_complained_about() -> None:
    for bridge in BRIDGES:
        done = without("no_such_package", bridge)
        assert done.returncode == 0, done.stderr
        assert "usage: " in done.stdout
