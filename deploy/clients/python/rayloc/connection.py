"""Connection: the sockets of a subscriber, and the state that both kinds of subscribers report."""

from __future__ import annotations

import time
from typing import Optional, Sequence

import zmq

from rayloc.options import Curve, make_options
from rayloc.stream import Stream

# Maximum number of messages read at once, so that an event loop can run other tasks.
BATCH = 512
# Interval of the checks for an overdue snapshot [s].
LOOK = 0.5


class NoSnapshot(Exception):
    """The daemon sends, but no answer comes from the snapshot's endpoint."""


class Connection:
    """`endpoint`: where raylocd publishes. `snapshot`: its endpoint with the last message of each
    topic, for late subscribers; None: begin with the next message. `topics`: prefixes of the topics.
    `targets`: messages about a target only if it is one of these (address, hashed address or
    "person-N"); empty: all. `stale_after`: seconds without a heartbeat, or by which the last one was
    longer on its way than the quickest, after which the daemon counts as gone; the clocks of the two
    machines need not agree. `patience`: seconds to wait for the snapshot.
    `high_water_mark`: messages that may wait here for a slow program.

    Connecting succeeds also without a publisher: ZeroMQ connects, and connects again,
    by itself. One thread, or one event loop."""

    def __init__(
        self,
        endpoint: str = "tcp://127.0.0.1:5560",
        *,
        snapshot: Optional[str] = None,
        topics: Sequence[str] = ("v1/",),
        targets: Sequence[str] = (),
        stale_after: float = 5.0,
        patience: float = 10.0,
        high_water_mark: int = 100_000,
        curve: Optional[Curve] = None,
    ) -> None:
        options = make_options(topics, targets, snapshot is not None, stale_after, patience)
        self._snapshot_endpoint = snapshot
        self._stream = Stream(options)
        self._context = zmq.Context()
        self._live = self._context.socket(zmq.SUB)
        self._live.set_hwm(high_water_mark)
        self._asked = self._context.socket(zmq.DEALER)
        try:
            for topic in self._stream.subscriptions():
                self._live.setsockopt(zmq.SUBSCRIBE, topic)
            _connect(self._live, endpoint, curve)
            if snapshot is not None:
                _connect(self._asked, snapshot, curve)
        except BaseException:
            self._close()
            raise

    @property
    def lost(self) -> int:
        """Messages that were published to us and never came."""
        return self._stream.lost

    @property
    def restarts(self) -> int:
        """New starts of the daemon since we came."""
        return self._stream.restarts

    @property
    def malformed(self) -> int:
        """Number of received messages that are no message of raylocd."""
        return self._stream.malformed

    @property
    def epoch(self) -> Optional[int]:
        """Epoch of the daemon that sent last; None before the first message."""
        return self._stream.epoch

    @property
    def stale(self) -> bool:
        """No heartbeat for `stale_after` seconds, none yet, or the daemon sent its goodbye: the state
        is no longer, or not yet, current. Messages are read in receive()."""
        return self._stream.stale(time.monotonic())

    @staticmethod
    def _wait(deadline: Optional[float]) -> float:
        """Seconds until one looks again; none are left when `deadline` has passed."""
        return LOOK if deadline is None else min(LOOK, deadline - time.monotonic())

    def _drain(self) -> None:
        """Takes what has arrived, without waiting."""
        self._answer_stream()
        monotonic = time.monotonic()
        try:
            for _ in range(BATCH):
                self._stream.feed(self._live.recv_multipart(zmq.NOBLOCK), monotonic)
        except zmq.Again:
            pass
        self._answer_stream()

    def _answer_stream(self) -> None:
        """Asks for the snapshot when the stream wants one, and gives it what was answered."""
        if self._snapshot_endpoint is None:
            return
        request = self._stream.take_request()
        try:
            if request is not None:
                self._asked.send(request, zmq.NOBLOCK)
            while True:
                self._stream.feed_snapshot(self._asked.recv(zmq.NOBLOCK))
        except zmq.Again:
            pass
        if self._stream.overdue(time.monotonic()):
            if not self._stream.joined:
                raise NoSnapshot(
                    f"no snapshot from {self._snapshot_endpoint}; is raylocd's"
                    " [publish] snapshot there, and do its keys admit this subscriber?"
                )
            self._stream.go_live()  # after a restart: continue without a snapshot

    def _close(self) -> None:
        for socket in (self._live, self._asked):
            socket.close(linger=0)
        self._context.term()


def _connect(socket: zmq.Socket[bytes], endpoint: str, curve: Optional[Curve]) -> None:
    socket.setsockopt(zmq.LINGER, 0)
    socket.setsockopt(zmq.IPV6, 1)
    # A restarted daemon is found within a second; the connection to a daemon whose machine was
    # switched off is dropped after ten and then retried.
    socket.setsockopt(zmq.RECONNECT_IVL, 100)
    socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
    socket.setsockopt(zmq.HEARTBEAT_IVL, 2000)
    socket.setsockopt(zmq.HEARTBEAT_TIMEOUT, 10_000)
    if curve is not None:
        socket.setsockopt(zmq.CURVE_SERVERKEY, curve.server_key.encode())
        socket.setsockopt(zmq.CURVE_PUBLICKEY, zmq.curve_public(curve.secret_key.encode()))
        socket.setsockopt(zmq.CURVE_SECRETKEY, curve.secret_key.encode())
    try:
        socket.connect(endpoint)
    except zmq.ZMQError as error:
        raise ValueError(
            f"cannot connect to {endpoint!r}: {error}; write tcp://ADDRESS:PORT or ipc://PATH"
        ) from error
