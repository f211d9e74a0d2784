"""Messages as raylocd makes them, for tests that need no daemon."""

from __future__ import annotations

from typing import Optional

from rayloc.v1.envelope_pb2 import Envelope
from rayloc.v1.snapshot_pb2 import SnapshotReply

TOPIC = "v1/location/office/02:00:00:00:00:10/"
HEARTBEAT = "v1/heartbeat/office/"


def location(sequence: int, epoch: int = 7, mac: str = "02:00:00:00:00:10") -> list[bytes]:
    envelope = Envelope(epoch=epoch, sequence=sequence)
    envelope.location.target.mac = mac
    envelope.location.position.x = float(sequence)
    return frames(f"v1/location/office/{mac}/", envelope)


def person(sequence: int, track: int) -> list[bytes]:
    envelope = Envelope(epoch=7, sequence=sequence)
    envelope.location.target.track = track
    envelope.location.position.x = float(sequence)
    return frames(f"v1/location/office/person-{track}/", envelope)


def heartbeat(
    sequence: int,
    epoch: int = 7,
    named: Optional[dict[str, int]] = None,
    sent: float = 1000.0,
    goodbye: bool = False,
) -> list[bytes]:
    envelope = Envelope(epoch=epoch, sequence=sequence)
    envelope.sent.FromNanoseconds(round(sent * 1e9))
    heartbeats, goodbyes = envelope.heartbeat.topic_classes, envelope.goodbye.topic_classes
    of_locations = (goodbyes if goodbye else heartbeats).add(prefix="v1/location/office/")
    for topic, last in (named or {}).items():
        of_locations.last_sequences.add(topic=topic, sequence=last)
    return frames(HEARTBEAT, envelope)


def frames(topic: str, envelope: Envelope) -> list[bytes]:
    data: bytes = envelope.SerializeToString()
    return [topic.encode(), data]


def snapshot(epoch: int, *messages: list[bytes]) -> bytes:
    reply = SnapshotReply(epoch=epoch)
    for topic, data in messages:
        reply.topics.append(topic.decode())
        reply.envelopes.append(Envelope.FromString(data))
    answer: bytes = reply.SerializeToString()
    return answer
