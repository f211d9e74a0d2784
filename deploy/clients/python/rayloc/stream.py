"""Stream: the rules of the messages, without a socket and without a clock of its own.

Feed it what arrives and take from `ready`. It merges the snapshot, counts losses, notices restarts
and the time of the daemon's last heartbeat (proto/rayloc/v1/envelope.proto, snapshot.proto).
"""

from __future__ import annotations

from collections import deque
from typing import Optional

from google.protobuf.message import DecodeError

from rayloc.message import Gap, Message, body_of, sent_at, target_of
from rayloc.options import Options
from rayloc.v1.envelope_pb2 import Envelope
from rayloc.v1.snapshot_pb2 import SnapshotReply, SnapshotRequest

HEARTBEATS = "v1/heartbeat/"
# raylocd numbers 4096 topics at a time; changing addresses produce more of them here.
MAX_TOPICS = 16_384


class Stream:
    def __init__(self, options: Options) -> None:
        self.ready: deque[Message] = deque()
        self.lost = 0
        self.restarts = 0
        self.malformed = 0
        self.epoch: Optional[int] = None
        self.joined = not options.snapshot  # at least once
        self._options = options
        self._joining = options.snapshot
        self._asking = False  # true once the daemon has our subscriptions, so that no message is missed
        self._joining_since: Optional[float] = None  # arrival of the first message that waits for the snapshot
        self._early: list[tuple[str, Envelope]] = []  # received before the snapshot
        self._told: dict[str, int] = {}  # sequences in the snapshot
        self._last: dict[str, int] = {}  # longest unused first
        self._gaps: list[Gap] = []  # not yet delivered
        self._restarted = False
        self._heard_at: Optional[float] = None  # last heartbeat; None also after a goodbye
        self._sent_at = 0.0  # send time of the last heartbeat, by the daemon's clock
        self._late_by = 0.0  # delay of the last heartbeat relative to the fastest
        # Offset from that clock to ours, which need not agree, for the fastest heartbeat since the daemon was
        # started or its clock was set back.
        self._least_delay: Optional[float] = None

    def subscriptions(self) -> list[bytes]:
        """Topics to subscribe to, in this order: heartbeats last, so that the first one proves that
        the publisher has all the others."""
        topics = [topic for topic in self._options.topics if topic != HEARTBEATS]
        return [topic.encode() for topic in [*topics, HEARTBEATS]]

    def feed(self, frames: list[bytes], monotonic: float) -> None:
        """Takes the frames of one ZeroMQ message, and the time of its arrival [s]."""
        parsed = _parse(frames)
        if parsed is None:
            self.malformed += 1
            return
        topic, envelope = parsed
        if self.epoch is not None and envelope.epoch != self.epoch:
            self._restart()
        self.epoch = envelope.epoch
        is_heartbeat = topic.startswith(HEARTBEATS)
        if is_heartbeat:
            self._hear(envelope, monotonic)
        if not self._joining:
            self._accept(topic, envelope)
            return
        self._early.append((topic, envelope))
        if self._joining_since is None:
            self._joining_since = monotonic
        self._asking = self._asking or is_heartbeat

    def take_request(self) -> Optional[bytes]:
        """The request for a snapshot, when one is due: once with each heartbeat until an answer has
        come, for a request may go to a daemon that just ends."""
        if not self._asking:
            return None
        self._asking = False
        # Heartbeats are requested, too: they show when all messages in the snapshot have passed.
        topics = [*self._options.topics, HEARTBEATS]
        request: bytes = SnapshotRequest(prefixes=topics).SerializeToString()
        return request

    def feed_snapshot(self, data: bytes) -> None:
        """The daemon's answer; discarded when it is not of the daemon's last start."""
        try:
            reply = SnapshotReply.FromString(data)
        except DecodeError:
            self.malformed += 1
            return
        if not self._joining or reply.epoch != self.epoch:
            return
        for topic, envelope in zip(reply.topics, reply.envelopes):
            self._told[topic] = self._last[topic] = envelope.sequence
            self._hand_out(topic, envelope, from_snapshot=True)
        self.go_live()

    def overdue(self, monotonic: float) -> bool:
        """Messages wait for the snapshot for longer than patience allows, because no answer or no
        heartbeat came. Without messages, nothing is overdue."""
        since = self._joining_since
        return since is not None and monotonic - since > self._options.patience

    def go_live(self) -> None:
        """Ends the wait for a snapshot, with one or without."""
        self._joining = self._asking = False
        self._joining_since = None
        self.joined = True
        early, self._early = self._early, []
        for topic, envelope in early:
            self._accept(topic, envelope)

    def stale(self, monotonic: float) -> bool:
        limit = self._options.stale_after
        if self._heard_at is None:
            return True
        return monotonic - self._heard_at > limit or self._late_by > limit

    def _hear(self, envelope: Envelope, monotonic: float) -> None:
        self._heard_at = None if body_of(envelope) == "goodbye" else monotonic
        before, self._sent_at = self._sent_at, sent_at(envelope)
        delay = monotonic - self._sent_at
        if self._least_delay is None or self._sent_at < before:
            self._least_delay = delay
        self._least_delay = min(self._least_delay, delay)
        self._late_by = delay - self._least_delay

    def _restart(self) -> None:
        if self._early:  # from the previous daemon: its snapshot will not arrive
            joined = self.joined
            self.go_live()
            self.joined = joined
        self._least_delay = None
        self.restarts += 1
        self._restarted = True
        self._last.clear()
        self._told.clear()
        self._joining = self._options.snapshot

    def _accept(self, topic: str, envelope: Envelope) -> None:
        told = self._told.get(topic)
        if told is not None:
            if envelope.sequence <= told:
                return
            if topic.startswith(HEARTBEATS):
                self._told.clear()  # sent after the snapshot was made
        self._count_losses(topic, envelope)
        self._hand_out(topic, envelope, from_snapshot=False)

    def _count_losses(self, topic: str, envelope: Envelope) -> None:
        last = self._last.pop(topic, None)
        if last is not None and envelope.sequence > last + 1:
            self._add_gap(topic, envelope.sequence - last - 1)
        self._last[topic] = envelope.sequence
        if len(self._last) > MAX_TOPICS:
            self._last.pop(next(iter(self._last)))
        if not topic.startswith(HEARTBEATS):
            return
        # Heartbeats list the busy topics, so that a loss is detected without a later message.
        for classes in (envelope.heartbeat.topic_classes, envelope.goodbye.topic_classes):
            for named in (named for each in classes for named in each.last_sequences):
                seen = self._last.get(named.topic)
                if seen is not None and named.topic != topic and named.sequence > seen:
                    self._add_gap(named.topic, named.sequence - seen)
                    self._last[named.topic] = named.sequence

    def _add_gap(self, topic: str, lost: int) -> None:
        self.lost += lost
        self._gaps.append(Gap(topic, lost))

    def _hand_out(self, topic: str, envelope: Envelope, from_snapshot: bool) -> None:
        if not topic.startswith(self._options.topics):
            return
        if self._options.targets:
            target = target_of(envelope)
            if target and target not in self._options.targets:
                return
        gaps, self._gaps = tuple(self._gaps), []
        self.ready.append(Message(topic, envelope, gaps, self._restarted, from_snapshot))
        self._restarted = False


def _parse(frames: list[bytes]) -> Optional[tuple[str, Envelope]]:
    if len(frames) != 2:
        return None
    try:
        return frames[0].decode(), Envelope.FromString(frames[1])
    except (DecodeError, UnicodeDecodeError):
        return None
