"""Home Assistant's own core with its MQTT integration, and every state that it writes as a line of JSON.

    PYTHON_OF_HOME_ASSISTANT home_assistant_core.py CONFIGURATION PORT RELEASE

Runs in the virtual environment of home_assistant_release_test.py, not in ours. RELEASE `installed` is as it is
installed; `announced` follows what is announced for MQTT trackers in 2027.1 (home-assistant/core, pull request
172660): state_topic is ignored, and `in_zones` in the attributes names the tracker's zones by entity id, object
id or name. Ends when its standard input does. Each line of it is a list of
names, answered by the object ids that Home Assistant derives from them.
"""

from __future__ import annotations

import asyncio
import json
import logging
import sys
from pathlib import Path
from typing import Any

from homeassistant import bootstrap, config_entries, core, loader  # type: ignore[import]
from homeassistant.components.mqtt import device_tracker as platform  # type: ignore[import]
from homeassistant.util import slugify  # type: ignore[import]
from homeassistant.setup import async_setup_component  # type: ignore[import]

# Smaller than home, as a room in a house is.
ZONES = [("Home", 100), ("desk", 2), ("Meeting room", 5)]


def announce() -> None:
    tracker = platform.MqttDeviceTracker
    before = tracker._process_update_extra_state_attributes

    def process(self: Any, attributes: dict[str, Any]) -> None:
        wanted = set(attributes.pop("in_zones", ()))
        zones = self.hass.states.async_all("zone")
        self._attr_in_zones = [
            zone.entity_id
            for zone in zones
            if wanted & {zone.entity_id, zone.object_id, zone.name}
        ]
        before(self, attributes)

    tracker._process_update_extra_state_attributes = process
    tracker._prepare_subscribe_topics = lambda self: None


def write(kind: str, **found: Any) -> None:
    print(json.dumps({"kind": kind, **found}, default=str), flush=True)


class Reports(logging.Handler):
    """The messages that a user would find in the log."""

    def emit(self, record: logging.LogRecord) -> None:
        write("log", level=record.levelname, logger=record.name, text=self.format(record))


def on_state(event: Any) -> None:
    state = event.data["new_state"]
    found = {} if state is None else {"state": state.state, "attributes": dict(state.attributes)}
    write("state", entity_id=event.data["entity_id"], **found)


def seed(configuration: Path, port: int) -> None:
    """The MQTT integration as a user has set it up."""
    entry = {
        "entry_id": "broker",
        "domain": "mqtt",
        "title": "broker",
        "data": {"broker": "127.0.0.1", "port": port},
        "options": {},
        "version": 1,
        "minor_version": 1,
        "source": "user",
        "unique_id": None,
        "disabled_by": None,
        "pref_disable_new_entities": False,
        "pref_disable_polling": False,
        "created_at": "2025-01-01T00:00:00+00:00",
        "modified_at": "2025-01-01T00:00:00+00:00",
        "discovery_keys": {},
        "subentries": [],
    }
    stored = {"key": "core.config_entries", "version": 1, "minor_version": 5, "data": {"entries": [entry]}}
    (configuration / ".storage").mkdir(parents=True, exist_ok=True)
    (configuration / ".storage/core.config_entries").write_text(json.dumps(stored))
    (configuration / "configuration.yaml").touch()


async def run(configuration: Path, port: int) -> None:
    seed(configuration, port)
    hass = core.HomeAssistant(str(configuration))
    hass.config.skip_pip = True
    loader.async_setup(hass)
    hass.config_entries = config_entries.ConfigEntries(hass, {})
    await loader.async_get_custom_components(hass)
    await bootstrap.async_load_base_functionality(hass)
    hass.bus.async_listen("state_changed", core.callback(on_state))
    zones = [
        {"name": name, "latitude": 52.0, "longitude": 4.0, "radius": radius} for name, radius in ZONES
    ]
    assert await async_setup_component(hass, "homeassistant", {})
    assert await async_setup_component(hass, "zone", {"zone": zones})
    hass.config.components.update({"http", "file_upload"})  # needed by its dialogues alone
    assert await async_setup_component(hass, "mqtt", {})
    await hass.async_start()
    write("started")
    while line := await asyncio.get_running_loop().run_in_executor(None, sys.stdin.readline):
        write("slugs", slugs=[slugify(name) for name in json.loads(line)])
    await hass.async_stop(force=True)


if __name__ == "__main__":
    logging.basicConfig(level=logging.WARNING, handlers=[Reports()])
    if sys.argv[3] == "announced":
        announce()
    asyncio.run(run(Path(sys.argv[1]), int(sys.argv[2])))
