"""Message: the result of a subscriber, with the losses that were found before it."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Optional
from urllib.parse import unquote

from rayloc.v1.envelope_pb2 import Envelope
from rayloc.v1.location_pb2 import Location
from rayloc.v1.target_pb2 import Target


@dataclass(frozen=True)
class Gap:
    """Messages of one topic that were published and never came."""

    topic: str
    lost: int


@dataclass(frozen=True)
class Message:
    """One published message. `restarted`: the first one after a new start of the daemon.
    `from_snapshot`: it was published before this subscriber connected."""

    topic: str
    envelope: Envelope
    gaps: tuple[Gap, ...] = ()
    restarted: bool = False
    from_snapshot: bool = False

    @property
    def kind(self) -> str:
        """ "location", "track", "zone", "source", "heartbeat", "csi", "goodbye" or "compared" (an
        estimate of a method that is compared with the site's own); "" when a later version of
        raylocd sent a message that this one cannot read."""
        return body_of(self.envelope)

    @property
    def site(self) -> str:
        parts = self.topic.split("/")
        return unquote(parts[2]) if len(parts) > 2 else ""

    @property
    def location(self) -> Optional[Location]:
        return self.envelope.location if self.kind == "location" else None

    @property
    def target(self) -> str:
        """Address, hashed address or "person-N", as in the topic; "" when the message is not
        about a target."""
        return target_of(self.envelope)

    def age(self) -> float:
        """Seconds since the daemon sent it, by this machine's clock and the daemon's."""
        return time.time() - sent_at(self.envelope)


def sent_at(envelope: Envelope) -> float:
    """Seconds since 1970."""
    seconds: float = envelope.sent.seconds + envelope.sent.nanos * 1e-9
    return seconds


def body_of(envelope: Envelope) -> str:
    body: Optional[str] = envelope.WhichOneof("body")
    return body or ""


def target_of(envelope: Envelope) -> str:
    kind = body_of(envelope)
    target: Target
    if kind == "location":
        target = envelope.location.target
    elif kind == "compared":
        target = envelope.compared.target
    elif kind == "track":
        target = envelope.track.target
    elif kind == "zone":
        target = envelope.zone.target
    else:
        return ""
    return name_of(target)


def name_of(target: Target) -> str:
    """As in the topics."""
    if target.mac or target.hashed_mac:
        return target.mac or target.hashed_mac
    return f"person-{target.track}" if target.HasField("track") else ""
