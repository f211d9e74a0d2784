"""The messages for ROS 2: the mapping and the operations, without ROS and without a daemon."""

from __future__ import annotations

import json
from typing import Any, Optional

import pytest

from rayloc.bridges.ros2 import TYPE, UNKNOWN, Ros2, parse, pose_with_covariance_stamped, topic_of
from rayloc.message import Message
from rayloc.v1.envelope_pb2 import Envelope
from rayloc.v1.location_pb2 import LOCATION_KIND_FILTERED, LOCATION_KIND_SNAPSHOT
from rayloc.v1.target_pb2 import TRACK_STATE_CONFIRMED, TRACK_STATE_LOST

MAC = "02:52:4c:00:00:01"
TOPIC = "/rayloc/t_02_52_4c_00_00_01/pose"
COVARIANCE = [0.01, 0.002, 0.0, 0.002, 0.04, 0.0, 0.0, 0.0, 0.09]


def located(x: Optional[float] = 1.25, covariance: Optional[list[float]] = None) -> Message:
    envelope = Envelope(epoch=1, sequence=1)
    location = envelope.location
    location.kind = LOCATION_KIND_FILTERED
    location.track_state = TRACK_STATE_CONFIRMED
    location.target.mac = MAC
    location.time.FromNanoseconds(1_718_000_000_250_000_007)
    if x is not None:
        location.position.x, location.position.y, location.position.z = x, -2.0, 1.2
        location.position_covariance.extend(COVARIANCE if covariance is None else covariance)
    return Message(f"v1/location/office/{MAC}/", envelope)


def test_a_location_is_a_pose_with_covariance_stamped() -> None:
    pose = pose_with_covariance_stamped(located().envelope.location, "map")
    assert pose is not None
    # As `ros2 interface show geometry_msgs/msg/PoseWithCovarianceStamped` prints its fields.
    assert pose["header"] == {
        "stamp": {"sec": 1_718_000_000, "nanosec": 250_000_007},
        "frame_id": "map",
    }
    assert set(pose) == {"header", "pose"} and set(pose["pose"]) == {"pose", "covariance"}
    assert pose["pose"]["pose"] == {
        "position": {"x": 1.25, "y": -2.0, "z": 1.2},
        "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    }
    covariance = pose["pose"]["covariance"]
    assert len(covariance) == 36
    assert [covariance[6 * i + j] for i in range(3) for j in range(3)] == COVARIANCE
    assert [covariance[7 * i] for i in range(3, 6)] == [UNKNOWN] * 3
    assert sum(value != 0.0 for value in covariance) == 5 + 3
    assert covariance == [covariance[6 * (i % 6) + i // 6] for i in range(36)]  # symmetric


def test_what_is_not_known_is_not_made_up() -> None:
    assert pose_with_covariance_stamped(located(None).envelope.location, "map") is None
    pose = pose_with_covariance_stamped(located(covariance=[]).envelope.location, "map")
    assert pose is not None
    assert [pose["pose"]["covariance"][7 * i] for i in range(6)] == [UNKNOWN] * 6


def operations(bridge: Ros2, message: Message) -> list[dict[str, Any]]:
    found = list(bridge.on_message(message))
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    return found


def test_a_target_is_advertised_once_and_until_it_is_lost() -> None:
    bridge = Ros2("/rayloc", "map", "filtered")
    first = operations(bridge, located())
    assert first[0] == {"op": "advertise", "topic": TOPIC, "type": TYPE}
    assert [each["op"] for each in first] == ["advertise", "publish"]
    assert [each["op"] for each in operations(bridge, located(2.0))] == ["publish"]
    assert operations(bridge, located(None)) == []
    lost = located(3.0)
    lost.envelope.location.track_state = TRACK_STATE_LOST
    assert [each["op"] for each in operations(bridge, lost)] == ["publish", "unadvertise"]
    assert [each["op"] for each in operations(bridge, located())] == ["advertise", "publish"]


def test_only_the_kind_that_was_asked_for() -> None:
    snapshot = located()
    snapshot.envelope.location.kind = LOCATION_KIND_SNAPSHOT
    assert operations(Ros2("/rayloc", "map", "filtered"), snapshot) == []
    assert len(operations(Ros2("/rayloc", "map", "snapshot"), snapshot)) == 2
    heartbeat = Message("v1/heartbeat/office/", Envelope())
    assert operations(Ros2("/rayloc", "map", "filtered"), heartbeat) == []


def test_names_are_what_ros_allows(capsys: pytest.CaptureFixture[str]) -> None:
    assert topic_of("/a", "person-3") == "/a/t_person_3/pose"
    assert parse(["--base", "/room/people"]).base == "/room/people"
    for wrong in ("rayloc", "/", "/1a", "/a/", "/a b"):
        with pytest.raises(SystemExit):
            parse(["--base", wrong])
        assert "--base" in capsys.readouterr().err
