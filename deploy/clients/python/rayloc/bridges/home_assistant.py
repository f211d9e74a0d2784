"""Maps messages of raylocd to those of Home Assistant's MQTT discovery; a pure mapping.

Each target becomes a device with a tracker, whose state is the zone it is in, else "home" while it is
located and "not_home" afterwards, and sensors for that place and for x, y and accuracy in the site's own
metres. The occupants of a zone are those of its last event, as in all clients. Only the tracker's estimates
(FILTERED) are passed on, each target's at most once per `interval`, and only of confirmed tracks: a phone
that passes by would leave its entities behind.
A track has ended when raylocd states so, when raylocd was started again (one that was killed could not
state it), and when nothing came of it for `silent`: the message was lost on the way.

Everything is kept by the broker: Home Assistant subscribes to the state some time after the discovery
message, and at each start of its own. Targets that an earlier run of the bridge left there are adopted:
announced anew when they are located, else ended after `silent` and taken back after `forget`, or a person at
its end, since its number is never used again.

Topics: PREFIX/COMPONENT/rayloc_SITE/TARGET_WHAT/config (discovery), BASE/SITE/TARGET (state, JSON),
BASE/SITE/TARGET/place (the place alone: Home Assistant takes a tracker's zone from the payload as it is,
without a template), BASE/SITE/status (raylocd), BASE/status (this bridge, as soon as it
received anything of raylocd).

From Home Assistant 2027.1 on the state topic of a tracker is announced to be ignored, and `in_zones` in its
attributes to take its place: a list of zones of Home Assistant, from whose sizes it derives the state. Both
are there. From 2026.6 on the list also decides in which zone a person counts.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass, field
from typing import AbstractSet, Optional, Sequence
from urllib.parse import unquote

from rayloc.bridges.place_name import HOME, NOT_HOME, renaming_of, state_of_zone, zone_of_state
from rayloc.message import Message, name_of
from rayloc.v1.location_pb2 import LOCATION_KIND_FILTERED, Location
from rayloc.v1.target_pb2 import (
    TARGET_KIND_PERSON,
    TRACK_STATE_COASTING,
    TRACK_STATE_CONFIRMED,
    TRACK_STATE_LOST,
    Target,
)

ONLINE, OFFLINE = "online", "offline"
BELIEVED = (TRACK_STATE_CONFIRMED, TRACK_STATE_COASTING)
PERSON = "Person"
COMPONENTS = ("device_tracker", "sensor")  # components that discovery announces
SENSORS = {"x": "X", "y": "Y", "accuracy_m": "Accuracy"}


@dataclass(frozen=True)
class Publication:
    """One message to publish; an empty payload removes the announcement on that topic."""

    topic: str
    payload: str
    retain: bool = True


@dataclass(frozen=True)
class Setting:
    prefix: str = "homeassistant"
    base: str = "rayloc"
    interval: float = 1.0  # [s] between two states of one target
    silent: float = 60.0  # [s]; raylocd drops a track after 5 s and publishes it until then
    forget: float = 86_400.0  # [s] after which a silent device is removed
    targets: tuple[str, ...] = ()  # the only targets that are announced; all, if empty


@dataclass
class _Known:
    """A target that was announced to Home Assistant."""

    topic: str  # topic of its state
    node: str
    object_id: str
    label: str
    is_person: bool
    heard_at: float
    has_track: bool = True
    is_adopted: bool = False  # announced by an earlier run, perhaps under another name
    told_at: float = float("-inf")
    location: Optional[Location] = None  # the last accepted one
    state: dict[str, object] = field(default_factory=dict)
    waits: bool = False  # `state` is newer than the published one
    place: str = ""  # the published place

    @property
    def place_topic(self) -> str:
        return f"{self.topic}/place"

    def configurations(self, setting: Setting) -> dict[str, dict[str, object]]:
        """By topic of discovery."""
        site_topic = self.topic.rsplit("/", 1)[0]
        device = {
            "identifiers": [f"{self.node}_{self.object_id}"],
            "name": self.label,
            "manufacturer": "RayLoc",
            "model": PERSON if self.is_person else "Wi-Fi device",
        }
        common: dict[str, object] = {
            "availability": [
                {"topic": f"{setting.base}/status"},
                {"topic": f"{site_topic}/status"},
            ],
            "availability_mode": "all",
            "device": device,
            "origin": {"name": "RayLoc"},
        }
        found: dict[str, dict[str, object]] = {
            self._discovery(setting, "device_tracker", "place"): {
                **common,
                "name": "Place",
                "unique_id": f"{self.node}_{self.object_id}_place",
                "state_topic": self.place_topic,
                "json_attributes_topic": self.topic,
                "source_type": "router",
            },
            # From 2027.1 on the tracker's state is a zone of Home Assistant; this sensor keeps the site's zone.
            self._discovery(setting, "sensor", "zone"): {
                **common,
                "name": "Zone",
                "unique_id": f"{self.node}_{self.object_id}_zone",
                "state_topic": self.place_topic,
            },
        }
        for key, name in SENSORS.items():
            found[self._discovery(setting, "sensor", key)] = {
                **common,
                "name": name,
                "unique_id": f"{self.node}_{self.object_id}_{key}",
                "state_topic": self.topic,
                "value_template": f"{{{{ value_json.{key} }}}}",
                "unit_of_measurement": "m",
                "device_class": "distance",
                "state_class": "measurement",
            }
        return found

    def _discovery(self, setting: Setting, component: str, what: str) -> str:
        return f"{setting.prefix}/{component}/{self.node}/{self.object_id}_{what}/config"


class HomeAssistant:
    """Messages in, publications out. Times are the caller's, monotonic [s]."""

    def __init__(self, setting: Setting) -> None:
        self._setting = setting
        self._known: dict[str, _Known] = {}  # by state topic
        self._sites: dict[str, str] = {}  # status topic -> "online" or "offline"
        # Occupants of a zone, by the topic part of its site and by its name.
        self._inside: dict[tuple[str, str], AbstractSet[str]] = {}
        self._is_online = False  # no message of raylocd has arrived yet
        self._renamed: set[str] = set()  # zones for which a notice was given
        self._notices: list[str] = []

    def take_notices(self) -> list[str]:
        """Changes that the user should make; each once."""
        notices, self._notices = self._notices, []
        return notices

    def on_message(self, message: Message, now: float) -> list[Publication]:
        self._sites.setdefault(f"{self._setting.base}/{message.topic.split('/')[2]}/status", "")
        out: list[Publication] = []
        if message.restarted:
            self._inside.clear()
            for before in list(self._known.values()):
                out += self._on_lost(before, now)
        location = message.location
        if location is not None:
            # Messages published before this bridge connected may be outdated.
            if location.kind == LOCATION_KIND_FILTERED and not message.from_snapshot:
                out += self._on_location(message, location, now)
        elif message.kind == "zone":
            out += self._on_zone(message, now)
        elif message.kind == "track" and message.envelope.track.state == TRACK_STATE_LOST:
            known = self._known.get(self._state_topic(message))
            if known is not None:
                out += self._on_lost(known, now)
        return out

    def on_time(self, now: float, stale: bool) -> list[Publication]:
        """Messages that are due by time. `stale`: heartbeats of raylocd are missing."""
        status = OFFLINE if stale else ONLINE
        changed = [topic for topic, before in self._sites.items() if before != status]
        self._sites.update(dict.fromkeys(changed, status))
        out = [Publication(topic, status) for topic in changed]
        # Until then, the entities that an earlier run announced may show outdated states.
        if self._sites and not self._is_online:
            self._is_online = True
            out.append(self._online())
        for known in list(self._known.values()):
            out += self._tell(known, now)
            unheard = now - known.heard_at
            if unheard > self._setting.forget:
                out += self._take_back(known)
            elif unheard > self._setting.silent:
                out += self._on_lost(known, now)
        return out

    def adopt(self, topic: str, payload: str, now: float) -> None:
        """Takes over a discovery message that the broker has kept. Announcements of others, and of a
        bridge of another site, base or choice of targets, are not changed: they remove them themselves."""
        try:
            configuration = json.loads(payload)
            state_topic = configuration["state_topic"]  # for a tracker it is the place
            state_topic = str(configuration.get("json_attributes_topic", state_topic))
            state_topic = state_topic.removesuffix("/place")
            label = str(configuration["device"]["name"])
            is_person = configuration["device"].get("model") == PERSON
            base, site, target = state_topic.rsplit("/", 2)
        except (ValueError, KeyError, TypeError, AttributeError):
            return
        targets = self._setting.targets
        if f"{base}/{site}/status" not in self._sites or (targets and target not in targets):
            return
        node, object_id = f"rayloc_{object_id_of(unquote(site))}", object_id_of(target)
        found = _Known(state_topic, node, object_id, label, is_person, now, is_adopted=True)
        if topic in found.configurations(self._setting):
            self._known.setdefault(state_topic, found)

    def announce(self) -> list[Publication]:
        """Everything anew: to a broker that was connected to, or to a Home Assistant that began."""
        out = [self._online()] if self._is_online else []
        out += [Publication(topic, status) for topic, status in self._sites.items() if status]
        for known in self._known.values():
            out += self._configure(known)
            if known.state:
                known.place = ""
                out += self._publish(known)
        return out

    def _online(self) -> Publication:
        return Publication(f"{self._setting.base}/status", ONLINE)

    def _state_topic(self, message: Message) -> str:
        # As in raylocd's topics: no character in it has a meaning in MQTT.
        site = message.topic.split("/")[2]
        return f"{self._setting.base}/{site}/{message.target}"

    def _on_location(self, message: Message, location: Location, now: float) -> list[Publication]:
        topic = self._state_topic(message)
        known = self._known.get(topic)
        out: list[Publication] = []
        if location.track_state == TRACK_STATE_LOST:
            return [] if known is None else self._on_lost(known, now)
        if location.track_state not in BELIEVED:
            return []
        label = label_of(location.target, message.target)
        is_renamed = known is not None and not known.is_person and known.label != label
        if known is None or known.is_adopted or is_renamed:
            known = _Known(
                topic,
                node=f"rayloc_{object_id_of(message.site)}",
                object_id=object_id_of(message.target),
                label=label,
                is_person=location.target.kind == TARGET_KIND_PERSON,
                heard_at=now,
            )
            self._known[topic] = known
            out += self._configure(known)
        known.heard_at = now
        known.has_track = True
        known.location = location
        return out + self._place(known, now)

    def _on_zone(self, message: Message, now: float) -> list[Publication]:
        event, site = message.envelope.zone, message.topic.split("/")[2]
        inside = frozenset(name_of(target) for target in event.inside)
        before = self._inside.get((site, event.zone), frozenset())
        self._inside[site, event.zone] = inside
        if event.zone not in self._renamed:
            self._renamed.add(event.zone)
            notice = renaming_of(event.zone)
            self._notices += [] if notice is None else [notice]
        out: list[Publication] = []
        for target in inside ^ before:
            known = self._known.get(f"{self._setting.base}/{site}/{target}")
            if known is not None and known.has_track and known.location is not None:
                out += self._place(known, now)
        return out

    def _place(self, known: _Known, now: float) -> list[Publication]:
        """The messages of its current place."""
        assert known.location is not None
        site, target = known.topic.rsplit("/", 2)[1:]
        zones = [zone for (of, zone), who in self._inside.items() if of == site and target in who]
        known.state = state_of(known.location, zones)
        known.waits = True
        return self._tell(known, now)

    def _on_lost(self, known: _Known, now: float) -> list[Publication]:
        if known.is_person:  # its number is never reused
            return self._take_back(known)
        if not known.has_track:
            return []
        known.has_track = False
        known.location = None
        known.state = away_after(known.state)
        known.waits, known.told_at = True, float("-inf")
        return self._tell(known, now)

    def _tell(self, known: _Known, now: float) -> list[Publication]:
        if not known.waits or now - known.told_at < self._setting.interval:
            return []
        known.waits, known.told_at = False, now
        return self._publish(known)

    def _publish(self, known: _Known) -> list[Publication]:
        """The place only when it is another one: Home Assistant records each message as a state."""
        out = [Publication(known.topic, json.dumps(known.state))]
        place = str(known.state["place"])
        if place != known.place:
            known.place = place
            out.append(Publication(known.place_topic, place))
        return out

    def _configure(self, known: _Known) -> list[Publication]:
        found = known.configurations(self._setting)
        return [Publication(topic, json.dumps(config)) for topic, config in found.items()]

    def _take_back(self, known: _Known) -> list[Publication]:
        """The entities first: they should not see their state become empty."""
        del self._known[known.topic]
        topics = [*known.configurations(self._setting), known.topic, known.place_topic]
        return [Publication(topic, "") for topic in topics]


def state_of(location: Location, zones: Sequence[str]) -> dict[str, object]:
    """`zones`: those that it is in. Absent is null, as it is absent from the message: never 0."""
    has_position = location.HasField("position")
    where = location.position
    probability = {zone.zone: zone.probability for zone in location.zones}
    likeliest = sorted(zones, key=lambda zone: probability.get(zone, 0.0), reverse=True)
    states = [state_of_zone(zone) for zone in likeliest]
    inside = [f"zone.{HOME}", *map(zone_of_state, states)]
    confidence = location.accuracy_confidence if location.HasField("accuracy_confidence") else None
    return {
        "place": (states or [HOME])[0] if has_position else NOT_HOME,
        "in_zones": list(dict.fromkeys(inside)) if has_position else [],
        "x": rounded(where.x) if has_position else None,
        "y": rounded(where.y) if has_position else None,
        "z": rounded(where.z) if has_position else None,
        "accuracy_m": rounded(location.accuracy_m) if location.HasField("accuracy_m") else None,
        "accuracy_confidence": confidence,
        "zones": {zone: rounded(each) for zone, each in probability.items()},
        "time": location.time.ToJsonString(),
    }


def away_after(state: dict[str, object]) -> dict[str, object]:
    """`time` stays: it is when it was located last."""
    nowhere = dict.fromkeys(("x", "y", "z", "accuracy_m", "accuracy_confidence"))
    return {**state, "place": NOT_HOME, "in_zones": [], **nowhere, "zones": {}}


def rounded(value: float) -> Optional[float]:
    """JSON, and so Home Assistant, has no NaN and no infinity."""
    return round(value, 3) if math.isfinite(value) else None


def label_of(target: Target, identity: str) -> str:
    return target.name.strip() or (f"Wi-Fi {identity}" if target.mac else identity)


def object_id_of(text: str) -> str:
    """The text in characters that a topic of discovery may have: "02:52" -> "02-52", "a b" -> "a_20b"."""

    def encode(match: re.Match[str]) -> str:
        return "".join(f"_{byte:02x}" for byte in match[0].encode())

    return re.sub(r"[^A-Za-z0-9-]", encode, text.replace(":", "-"))

