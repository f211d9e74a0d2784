"""The documented MQTT discovery of Home Assistant (www.home-assistant.io/integrations/mqtt, device_tracker.mqtt,
sensor.mqtt), as far as the bridge announces it: keys, their kinds, and which of them exclude or need each other."""

from __future__ import annotations

from typing import Mapping

COMMON = {
    "availability": list,
    "availability_mode": str,
    "device": dict,
    "json_attributes_topic": str,
    "name": str,
    "origin": dict,
    "state_topic": str,
    "unique_id": str,
    "value_template": str,
}
KEYS: dict[str, dict[str, type]] = {
    "device_tracker": {**COMMON, "source_type": str},
    "sensor": {**COMMON, "device_class": str, "state_class": str, "unit_of_measurement": str},
}
WORDS = {
    "availability_mode": {"all", "any", "latest"},
    "source_type": {"bluetooth", "bluetooth_le", "gps", "router"},
    "device_class": {"distance"},
    "state_class": {"measurement", "total", "total_increasing"},
    "unit_of_measurement": {"m"},  # of a distance
}
DEVICE = {"identifiers", "connections", "name", "manufacturer", "model"}


def assert_documented(component: str, configuration: Mapping[str, object]) -> None:
    for key, value in configuration.items():
        assert isinstance(value, KEYS[component][key]), (key, value)
        assert key not in WORDS or value in WORDS[key], (key, value)
        if key.endswith("_topic"):
            assert_subscribable(value)
    assert configuration["unique_id"], "without it there is no device"
    device, origin = configuration["device"], configuration["origin"]
    assert isinstance(device, dict) and device.keys() <= DEVICE and device["identifiers"]
    assert isinstance(origin, dict) and origin["name"]
    availability = configuration["availability"]
    assert isinstance(availability, list)
    for each in availability:
        assert each.keys() <= {"topic", "value_template"}
        assert_subscribable(each["topic"])
    if component == "sensor":
        assert "state_topic" in configuration
    else:
        # Until 2026.12 the first is needed; from 2027.1 on only the second is announced to count.
        assert {"state_topic", "json_attributes_topic"} <= configuration.keys()


def assert_subscribable(topic: object) -> None:
    assert isinstance(topic, str) and 0 < len(topic.encode()) < 65_536
    assert not any(each in topic for each in "+#\0")
