"""Locations as geometry_msgs/PoseWithCovarianceStamped of ROS 2, in rosbridge's JSON.

    python3 -m rayloc.bridges.ros2

Prints one operation of the rosbridge protocol (v2.0) a line: `advertise` for each target with its
first location, `publish` for each of its locations, `unadvertise` when its track is lost. A WebSocket
client sends each line as a message to rosbridge_server. ROS itself is neither needed nor used here.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
from typing import Any, Iterator, Optional

from rayloc.bridges.program import add_source, check_source, subscribe, until_signalled
from rayloc.message import Message
from rayloc.v1.location_pb2 import LOCATION_KIND_FILTERED, LOCATION_KIND_SNAPSHOT, Location
from rayloc.v1.target_pb2 import TRACK_STATE_LOST

TYPE = "geometry_msgs/msg/PoseWithCovarianceStamped"
KINDS = {"filtered": LOCATION_KIND_FILTERED, "snapshot": LOCATION_KIND_SNAPSHOT}
# [rad^2], of each angle: the orientation of a target is unknown.
UNKNOWN = 1e6
LOOK = 0.2  # [s] until a signal is noticed

Operation = dict[str, Any]


def pose_with_covariance_stamped(location: Location, frame_id: str) -> Optional[Operation]:
    """The message; None for a location without a position. Metres in the site's frame, z up, as
    REP 103 wants it. The covariance is over x, y, z and the angles about these axes, row by row;
    unknown entries have the variance UNKNOWN."""
    if not location.HasField("position"):
        return None
    covariance = [0.0] * 36
    known = len(location.position_covariance) == 9
    for row in range(3):
        for column in range(3):
            value = location.position_covariance[3 * row + column] if known else 0.0
            covariance[6 * row + column] = value
        if not known:
            covariance[7 * row] = UNKNOWN
        covariance[7 * (row + 3)] = UNKNOWN
    point = location.position
    return {
        "header": {
            "stamp": {"sec": location.time.seconds, "nanosec": location.time.nanos},
            "frame_id": frame_id,
        },
        "pose": {
            "pose": {
                "position": {"x": point.x, "y": point.y, "z": point.z},
                "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
            },
            "covariance": covariance,
        },
    }


def topic_of(base: str, target: str) -> str:
    """A name that ROS 2 allows: letters, digits and underscores, none of them first a digit."""
    return f"{base}/t_{re.sub('[^A-Za-z0-9]', '_', target)}/pose"


class Ros2:
    """Messages in, operations out."""

    def __init__(self, base: str, frame_id: str, kind: str) -> None:
        self._base, self._frame_id, self._kind = base, frame_id, KINDS[kind]
        self._advertised: set[str] = set()

    def on_message(self, message: Message) -> Iterator[Operation]:
        location = message.location
        if location is None or location.kind != self._kind:
            return
        topic = topic_of(self._base, message.target)
        pose = pose_with_covariance_stamped(location, self._frame_id)
        if pose is not None and all(map(math.isfinite, pose["pose"]["covariance"])):
            if topic not in self._advertised:
                self._advertised.add(topic)
                yield {"op": "advertise", "topic": topic, "type": TYPE}
            yield {"op": "publish", "topic": topic, "msg": pose}
        if location.track_state == TRACK_STATE_LOST and topic in self._advertised:
            self._advertised.remove(topic)
            yield {"op": "unadvertise", "topic": topic}


def run(arguments: argparse.Namespace) -> None:
    bridge = Ros2(arguments.base, arguments.frame, arguments.kind)
    stopping = until_signalled()
    with subscribe(arguments, ["v1/location/"]) as messages:
        while not stopping.is_set():
            message = messages.receive(LOOK)
            if message is None:
                continue
            for gap in message.gaps:
                say(f"lost {gap.lost} messages of {gap.topic}")
            for operation in bridge.on_message(message):
                print(json.dumps(operation), flush=True)


def say(text: str) -> None:
    print(f"rayloc.bridges.ros2: {text}", file=sys.stderr, flush=True)


def parse(words: Optional[list[str]] = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="rayloc.bridges.ros2",
        description="raylocd's locations as PoseWithCovarianceStamped of ROS 2: one operation of"
        " the rosbridge protocol a line",
    )
    add_source(parser)
    add = parser.add_argument
    add("--kind", choices=sorted(KINDS), default="filtered", help="kind of locations")
    add("--frame", default="map", help="frame_id of the site's coordinates")
    add("--base", default="/rayloc", help="prefix of the topics")
    arguments = parser.parse_args(words)
    if not re.fullmatch(r"(/[A-Za-z][A-Za-z0-9_]*)+", arguments.base):
        parser.error(f"--base: a name of ROS as /rayloc is needed, not {arguments.base!r}")
    check_source(parser, arguments)
    return arguments


if __name__ == "__main__":
    try:
        run(parse())
    except BrokenPipeError:
        sys.stderr.close()  # the reader has closed the pipe
        sys.exit(0)
    except (OSError, ValueError) as error:
        say(str(error))
        sys.exit(78)
