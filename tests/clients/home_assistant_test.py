"""The messages to Home Assistant about the messages of raylocd."""

from __future__ import annotations

import json
import re
from typing import Optional

import pytest
from discovery_schema import assert_documented

from rayloc.bridges.home_assistant import (
    HomeAssistant,
    Publication,
    Setting,
    object_id_of,
)
from rayloc.bridges.place_name import renaming_of, state_of_zone, zone_of_state
from rayloc.message import Message
from rayloc.v1.envelope_pb2 import Envelope
from rayloc.v1.location_pb2 import LOCATION_KIND_FILTERED, LOCATION_KIND_SNAPSHOT
from rayloc.v1.target_pb2 import (
    TARGET_KIND_DEVICE,
    TARGET_KIND_PERSON,
    TRACK_STATE_COASTING,
    TRACK_STATE_CONFIRMED,
    TRACK_STATE_LOST,
    TRACK_STATE_TENTATIVE,
)

MAC = "02:52:4c:00:00:01"
STATE = f"rayloc/my%20office/{MAC}"
NODE = "rayloc_my_20office"


def located(
    x: Optional[float] = 1.25,
    zones: Optional[dict[str, float]] = None,
    person: int = 0,
    state: int = TRACK_STATE_CONFIRMED,
) -> Message:
    envelope = Envelope(epoch=1, sequence=1)
    location = envelope.location
    location.kind = LOCATION_KIND_FILTERED
    location.track_state = state  # type: ignore[assignment]
    location.target.kind = TARGET_KIND_PERSON if person else TARGET_KIND_DEVICE
    if person:
        location.target.track = person
    else:
        location.target.mac = MAC
    if x is not None:
        location.position.x, location.position.y, location.position.z = x, 2.0, 1.0
        location.accuracy_m = 0.5
    for zone, probability in (zones or {}).items():
        location.zones.add(zone=zone, probability=probability)
    name = f"person-{person}" if person else MAC
    return Message(f"v1/location/my%20office/{name}/", envelope)


def zone(name: str, *inside: str) -> Message:
    """An event of that zone, after which these are in it."""
    envelope = Envelope(epoch=1, sequence=1)
    envelope.zone.zone = name
    envelope.zone.target.mac = MAC
    for each in inside:
        if each.startswith("person-"):
            envelope.zone.inside.add(track=int(each[7:]))
        else:
            envelope.zone.inside.add(mac=each)
    return Message(f"v1/zone/my%20office/{name}/", envelope)


def heartbeat(epoch: int = 1, restarted: bool = False) -> Message:
    envelope = Envelope(epoch=epoch, sequence=1)
    envelope.heartbeat.epoch = epoch
    return Message("v1/heartbeat/my%20office/", envelope, restarted=restarted)


def lost(person: int = 0) -> Message:
    envelope = Envelope(epoch=1, sequence=2)
    envelope.track.state = TRACK_STATE_LOST
    if person:
        envelope.track.target.track = person
    else:
        envelope.track.target.mac = MAC
    return Message("v1/track/my%20office/", envelope)


def states(publications: list[Publication]) -> list[dict[str, object]]:
    return [json.loads(each.payload) for each in publications if each.topic == STATE and each.payload]


def places(publications: list[Publication]) -> list[str]:
    return [each.payload for each in publications if each.topic == f"{STATE}/place"]


def announced(publications: list[Publication]) -> list[Publication]:
    return [each for each in publications if each.topic.endswith("/config")]


def test_a_target_is_announced_once_and_its_topics_and_templates_fit_its_state() -> None:
    subject = HomeAssistant(Setting())
    first = subject.on_message(located(), 0.0)
    configurations = {p.topic: json.loads(p.payload) for p in first if p.topic.endswith("/config")}
    components = sorted(topic.split("/")[1] for topic in configurations)
    assert components == ["device_tracker", "sensor", "sensor", "sensor", "sensor"]
    assert all(p.retain for p in first)
    (state,) = states(first)
    assert (state["place"], state["x"], state["accuracy_m"]) == ("home", 1.25, 0.5)
    unique = set()
    for topic, configuration in configurations.items():
        # <prefix>/<component>/<node>/<object>/config, of the characters that are allowed.
        assert re.fullmatch(r"homeassistant/[a-z_]+/[\w-]+/[\w-]+/config", topic)
        assert_documented(topic.split("/")[1], configuration)
        if "value_template" in configuration:
            assert configuration["state_topic"] == STATE
            (key,) = re.findall(r"^\{\{ value_json\.(\w+) \}\}$", configuration["value_template"])
            assert key in state
        else:
            assert configuration["state_topic"] == f"{STATE}/place"
        unique.add(configuration["unique_id"])
        assert configuration["device"]["identifiers"] == [f"{NODE}_02-52-4c-00-00-01"]
        topics = [each["topic"] for each in configuration["availability"]]
        assert topics == ["rayloc/status", "rayloc/my%20office/status"]
    assert len(unique) == 5
    again = subject.on_message(located(x=1.5), 5.0)
    assert [p.topic for p in again] == [STATE]


def test_a_target_is_told_of_at_most_once_an_interval_and_then_with_what_is_newest() -> None:
    subject = HomeAssistant(Setting(interval=1.0))
    subject.on_message(located(x=1.0), 0.0)
    for i in range(1, 10):
        assert subject.on_message(located(x=1.0 + i), 0.1 * i) == []
    assert states(subject.on_time(0.95, stale=False)) == []
    (state,) = states(subject.on_time(1.05, stale=False))
    assert state["x"] == 10.0
    assert subject.on_time(3.0, stale=False) == []


def test_the_place_is_the_zone_that_it_is_in_by_its_events() -> None:
    subject = HomeAssistant(Setting(interval=0.0))

    def place(message: Message) -> object:
        told = states(subject.on_message(message, 0.0))
        return told[-1]["place"] if told else None

    probable = {"desk": 0.6, "door": 0.3}
    assert place(located(zones=probable)) == "home"  # probable, but no event of entry yet
    assert place(zone("desk", MAC)) == "desk"  # at once, without an estimate
    assert place(zone("desk", "person-4", MAC)) is None  # nothing new about it
    assert place(located(zones={"desk": 0.4})) == "desk"  # improbable, but no event of departure yet
    assert place(zone("door", MAC)) == "desk"  # the likelier of two zones
    assert place(located(zones={"desk": 0.2, "door": 0.5})) == "door"
    assert place(zone("door")) == "desk"
    assert place(zone("desk", "person-4")) == "home"
    assert subject.on_message(located(person=4), 0.0)[-1].payload == "desk"


def test_zones_begin_anew_with_raylocd_and_a_lost_track_is_in_none() -> None:
    subject = HomeAssistant(Setting(interval=0.0))
    subject.on_message(zone("desk", MAC), 0.0)
    (state,) = states(subject.on_message(located(), 0.0))
    assert state["place"] == "desk"
    subject.on_message(lost(), 0.1)
    assert states(subject.on_message(zone("door", MAC), 0.2)) == []
    subject.on_message(heartbeat(epoch=2, restarted=True), 0.3)
    (state,) = states(subject.on_message(located(), 0.4))
    assert state["place"] == "home"


def test_what_is_not_believed_yet_is_not_announced() -> None:
    subject = HomeAssistant(Setting(interval=0.0))
    for i in range(3):
        assert subject.on_message(located(state=TRACK_STATE_TENTATIVE), 0.1 * i) == []
        assert subject.on_message(located(person=2, state=TRACK_STATE_TENTATIVE), 0.1 * i) == []
    assert subject.on_message(located(state=TRACK_STATE_LOST), 0.5) == []
    assert subject.on_message(lost(), 0.5) == []
    for state in (TRACK_STATE_CONFIRMED, TRACK_STATE_COASTING):
        assert len(announced(HomeAssistant(Setting()).on_message(located(state=state), 1.0))) == 5
    # A lost track that is announced returns only once it is confirmed again.
    subject.on_message(located(), 1.0)
    (away,) = states(subject.on_message(located(state=TRACK_STATE_LOST), 2.0))
    assert away["place"] == "not_home"
    assert subject.on_message(located(state=TRACK_STATE_TENTATIVE), 3.0) == []
    (back,) = states(subject.on_message(located(), 4.0))
    assert back["place"] == "home"


def test_where_it_was_before_we_came_is_not_where_it_is() -> None:
    message = located()
    old = Message(message.topic, message.envelope, from_snapshot=True)
    assert HomeAssistant(Setting()).on_message(old, 0.0) == []


def test_without_a_position_there_are_no_coordinates() -> None:
    (state,) = states(HomeAssistant(Setting()).on_message(located(x=None), 0.0))
    assert (state["place"], state["x"], state["accuracy_m"]) == ("not_home", None, None)


def test_snapshots_are_not_told() -> None:
    message = located()
    message.envelope.location.kind = LOCATION_KIND_SNAPSHOT
    assert HomeAssistant(Setting()).on_message(message, 0.0) == []


def test_a_lost_device_is_away_at_once_and_a_lost_person_is_taken_back() -> None:
    subject = HomeAssistant(Setting())
    subject.on_message(located(), 0.0)
    (state,) = states(subject.on_message(lost(), 0.1))
    assert (state["place"], state["x"]) == ("not_home", None)

    first = subject.on_message(located(person=3), 0.2)
    gone = subject.on_message(lost(person=3), 0.3)
    assert gone == [Publication(p.topic, "") for p in first]  # nothing stays in the broker
    assert subject.on_message(lost(person=3), 0.4) == []


def test_a_raylocd_that_was_started_again_has_lost_every_track() -> None:
    subject = HomeAssistant(Setting())
    subject.on_message(located(), 0.0)
    first = subject.on_message(located(person=3), 0.0)
    assert subject.on_message(heartbeat(), 0.1) == []

    ended = subject.on_message(heartbeat(epoch=2, restarted=True), 0.2)
    (state,) = states(ended)
    assert (state["place"], state["x"], state["accuracy_m"]) == ("not_home", None, None)
    assert [p for p in ended if not p.payload] == [Publication(p.topic, "") for p in first]
    assert [s["place"] for s in states(subject.announce())] == ["not_home"]
    assert not any("person" in p.topic for p in subject.announce())


def test_who_is_located_at_a_new_start_is_told_of_anew() -> None:
    subject = HomeAssistant(Setting())
    first = subject.on_message(located(person=1), 0.0)
    message = located(person=1)
    again = subject.on_message(Message(message.topic, message.envelope, restarted=True), 0.1)
    # The number is the same, the person need not be: taken back first, announced afterwards.
    assert again == [Publication(p.topic, "") for p in first] + first


def test_who_is_silent_is_away_though_nobody_said_so() -> None:
    subject = HomeAssistant(Setting(silent=60.0, forget=600.0))
    subject.on_message(located(), 0.0)
    first = subject.on_message(located(person=3), 0.0)
    subject.on_time(0.1, stale=False)
    assert subject.on_time(59.0, stale=False) == []
    told = subject.on_time(61.0, stale=False)
    assert [s["place"] for s in states(told)] == ["not_home"]
    assert [p.topic for p in told if not p.payload] == [p.topic for p in first]
    assert subject.on_time(62.0, stale=False) == []  # once
    (back,) = states(subject.on_message(located(), 70.0))
    assert back["place"] == "home"


def test_a_device_that_is_not_heard_for_long_is_forgotten() -> None:
    subject = HomeAssistant(Setting(forget=60.0))
    first = subject.on_message(located(), 0.0)
    assert [p for p in subject.on_time(59.0, stale=True) if not p.payload] == []
    assert subject.on_time(61.0, stale=True) == [Publication(p.topic, "") for p in first]
    assert [p.topic for p in subject.announce()] == ["rayloc/status", "rayloc/my%20office/status"]


def kept_of_an_earlier_run(person: int = 0) -> list[Publication]:
    return HomeAssistant(Setting()).on_message(located(person=person), 0.0)


def adopting(setting: Setting, now: float = 0.0) -> HomeAssistant:
    """A bridge that has received a heartbeat of raylocd, and the retained messages of the broker."""
    subject = HomeAssistant(setting)
    subject.on_message(heartbeat(), now)
    for each in kept_of_an_earlier_run():
        subject.adopt(each.topic, each.payload, now)
    subject.on_time(now, stale=False)
    return subject


def test_what_an_earlier_run_announced_is_taken_back_by_the_next() -> None:
    subject = adopting(Setting(silent=60.0, forget=600.0))
    (state,) = states(subject.on_time(61.0, stale=False))
    assert (state["place"], state["x"]) == ("not_home", None)
    assert subject.on_time(599.0, stale=False) == []
    gone = subject.on_time(601.0, stale=False)
    assert gone == [Publication(p.topic, "") for p in kept_of_an_earlier_run()]
    assert [p.topic for p in subject.announce()] == ["rayloc/status", "rayloc/my%20office/status"]


def test_what_an_earlier_run_announced_is_announced_anew_when_it_is_located() -> None:
    subject = adopting(Setting(forget=600.0))
    message = located()
    message.envelope.location.target.name = "tag of the forklift"
    told = subject.on_message(message, 1.0)
    names = {json.loads(p.payload)["device"]["name"] for p in announced(told)}
    assert names == {"tag of the forklift"}
    assert [s["place"] for s in states(told)] == ["home"]
    for each in kept_of_an_earlier_run():  # the broker sends retained messages again on the next connection
        subject.adopt(each.topic, each.payload, 500.0)
    assert len(announced(subject.on_time(602.0, stale=False))) == 5  # since it was located, not since then


@pytest.mark.parametrize(
    "setting",
    [
        Setting(base="elsewhere", forget=1.0),
        Setting(prefix="elsewhere", forget=1.0),
        Setting(targets=("02:52:4c:00:00:02",), forget=1.0),
    ],
)
def test_what_another_bridge_announced_is_left_alone(setting: Setting) -> None:
    subject = adopting(setting)
    assert subject.on_time(2.0, stale=False) == []


def test_what_was_announced_of_other_sites_or_by_others_is_left_alone() -> None:
    subject = HomeAssistant(Setting(forget=1.0))
    (first, *_) = kept_of_an_earlier_run()
    subject.adopt(first.topic, first.payload, 0.0)  # before raylocd has reported the name of its site
    subject.on_message(heartbeat(), 0.0)
    subject.adopt(first.topic, first.payload.replace("my%20office", "lab"), 0.0)
    topic = f"homeassistant/sensor/{NODE}/x/config"
    for payload in ("", "no JSON", "[1]", '{"state_topic": 1}', '{"state_topic": "rayloc/x"}'):
        subject.adopt(topic, payload, 0.0)
    subject.adopt(topic, first.payload, 0.0)  # our words at a topic that is not ours
    subject.on_time(0.0, stale=False)
    assert subject.on_time(2.0, stale=False) == []


def test_the_site_is_available_as_long_as_raylocd_is_heard() -> None:
    subject = HomeAssistant(Setting())
    subject.on_message(located(), 0.0)
    status = "rayloc/my%20office/status"
    ours = Publication("rayloc/status", "online")
    assert subject.on_time(0.1, stale=False) == [Publication(status, "online"), ours]
    assert subject.on_time(0.2, stale=False) == []
    assert subject.on_time(9.0, stale=True) == [Publication(status, "offline")]


def test_a_home_assistant_that_begins_is_told_everything() -> None:
    subject = HomeAssistant(Setting())
    first = subject.on_message(located(), 0.0)
    online = subject.on_time(0.1, stale=False)
    assert sorted(p.topic for p in subject.announce()) == sorted(p.topic for p in first + online)


def test_ids_have_only_what_discovery_allows_and_stay_different() -> None:
    ids = [object_id_of(text) for text in ("02:52", "a b", "a_b", "a/b", "büro")]
    assert ids == ["02-52", "a_20b", "a_5fb", "a_2fb", "b_c3_bcro"]


def test_field_a_device_in_a_zone_has_a_topic_with_the_bare_name() -> None:
    subject = HomeAssistant(Setting(interval=0.0))
    first = subject.on_message(located(), 0.0)
    (tracker,) = (json.loads(p.payload) for p in announced(first) if "/device_tracker/" in p.topic)
    # The payload itself becomes the state: nothing may be left to a template.
    assert "value_template" not in tracker and tracker["state_topic"] == f"{STATE}/place"
    assert tracker["json_attributes_topic"] == STATE
    assert places(first) == ["home"]
    assert places(subject.on_message(zone("Büro {{ 1 }}", MAC), 0.1)) == ["Büro {{ 1 }}"]
    assert places(subject.on_message(located(x=2.0), 0.2)) == []  # unchanged: no further state
    assert places(subject.announce()) == ["Büro {{ 1 }}"]
    assert places(subject.on_message(lost(), 0.3)) == ["not_home"]


def test_field_zones_of_home_assistant_are_in_the_attributes() -> None:
    subject = HomeAssistant(Setting(interval=0.0))
    subject.on_message(zone("Meeting room", MAC), 0.0)
    subject.on_message(zone("desk", MAC), 0.0)
    (state,) = states(subject.on_message(located(zones={"desk": 0.9}), 0.0))
    assert state["in_zones"] == ["zone.home", "zone.desk", "zone.meeting_room"]
    (away,) = states(subject.on_message(lost(), 0.1))
    assert away["in_zones"] == []
    (nowhere,) = states(subject.on_message(located(x=None), 0.2))
    assert nowhere["in_zones"] == []
    assert not {"latitude", "longitude", "gps_accuracy"} & state.keys()  # positions on the earth are not published


OWN = ["home", "Home", " not_home", "Not Home", "NOT-HOME", "None", "unknown ", "Unavailable", "away", "", " "]


@pytest.mark.parametrize("name", OWN)
def test_field_a_zone_that_is_named_as_a_state_of_home_assistant_is_renamed(name: str) -> None:
    subject = HomeAssistant(Setting(interval=0.0))
    subject.on_message(located(), 0.0)
    (place,) = places(subject.on_message(zone(name, MAC), 0.1))
    assert place.startswith(f"{name.strip()} (zone)".strip())
    (notice,) = subject.take_notices()
    assert repr(name) in notice and "site.toml" in notice and repr(place) in notice
    subject.on_message(zone(name), 0.2)
    assert subject.take_notices() == []  # once


def test_field_names_of_zones_are_states_and_stay_different() -> None:
    names = ["desk", " desk", "de\nsk", "home", "Home", "home (zone)", "x" * 255, "x" * 256, "x" * 257]
    names += ["会议室", "a/b+#", "\N{ZERO WIDTH SPACE}home", "ｈｏｍｅ", "", "(zone)"]
    found = [state_of_zone(name) for name in names]
    assert len(set(found)) == len(names)
    assert all(0 < len(state) <= 255 and state == state.strip() for state in found)
    assert not {state.casefold() for state in found} & {each.strip().casefold() for each in OWN}
    for name in ("desk", "x" * 255, "会议室", "Homework", "home office", "a/b+#", "Büro 1"):
        assert state_of_zone(name) == name and renaming_of(name) is None


def test_field_a_zone_is_named_by_its_entity_id_where_that_can_be_derived() -> None:
    names = ["Meeting Room", "R&D", "Büro", "1,000", "会议室", "Straße", "!"]
    found = ["zone.meeting_room", "zone.r_d", "zone.buro", "zone.1000", "会议室", "Straße", "!"]
    assert [zone_of_state(name) for name in names] == found


def test_field_a_state_has_no_number_that_is_none() -> None:
    (state,) = states(HomeAssistant(Setting()).on_message(located(x=float("nan")), 0.0))
    assert state["x"] is None and state["y"] == 2.0


def test_field_the_bridge_is_available_only_with_something_to_carry() -> None:
    subject = HomeAssistant(Setting())
    assert subject.on_time(0.0, stale=True) == [] and subject.announce() == []
    subject.on_message(heartbeat(), 0.1)
    assert Publication("rayloc/status", "online") in subject.on_time(0.2, stale=False)


def test_field_a_person_of_a_run_that_crashed_is_taken_back() -> None:
    subject = HomeAssistant(Setting(silent=60.0))
    subject.on_message(heartbeat(), 0.0)
    kept = kept_of_an_earlier_run(person=3)
    for each in announced(kept):
        subject.adopt(each.topic, each.payload, 0.0)
    gone = [p for p in subject.on_time(61.0, stale=False) if not p.payload]
    assert gone == [Publication(p.topic, "") for p in kept]


def test_field_what_a_bridge_before_this_one_announced_is_adopted() -> None:
    """Its tracker had the state and its template; both are replaced when the device is located."""
    subject = HomeAssistant(Setting(forget=60.0))
    subject.on_message(heartbeat(), 0.0)
    topic = f"homeassistant/device_tracker/{NODE}/02-52-4c-00-00-01_place/config"
    before = json.dumps(
        {"state_topic": STATE, "value_template": "{{ value_json.place }}", "device": {"name": "x"}}
    )
    with_attributes = before.replace("{", f'{{"json_attributes_topic": "{STATE}", ', 1)
    for payload in (with_attributes, before):
        subject.adopt(topic, payload, 0.0)
    assert topic in [p.topic for p in subject.on_time(61.0, stale=False) if not p.payload]


def test_field_a_device_that_gets_a_name_is_announced_with_it() -> None:
    subject = HomeAssistant(Setting())
    subject.on_message(located(), 0.0)
    message = located()
    message.envelope.location.target.name = "forklift"
    names = {json.loads(p.payload)["device"]["name"] for p in announced(subject.on_message(message, 5.0))}
    assert names == {"forklift"}
    assert announced(subject.on_message(message, 6.0)) == []
