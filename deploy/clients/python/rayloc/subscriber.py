"""Subscriber: receives what raylocd publishes.

    import rayloc

    with rayloc.Subscriber("tcp://127.0.0.1:5560", topics=["v1/location/"]) as messages:
        for message in messages:
            print(message.topic, message.kind)
"""

from __future__ import annotations

import time
from types import TracebackType
from typing import Iterator, Optional, Type

import zmq

from rayloc.connection import Connection
from rayloc.message import Message


class Subscriber(Connection):
    def receive(self, timeout: Optional[float] = None) -> Optional[Message]:
        """The next message; None when none came for `timeout` seconds, None waits for ever.
        NoSnapshot when one was requested and no answer comes."""
        ready = self._stream.ready
        deadline = None if timeout is None else time.monotonic() + timeout
        while not ready:
            self._drain()
            if ready:
                break
            wait = self._wait(deadline)
            if wait <= 0:
                return None
            self._poller.poll(int(wait * 1000) + 1)
        return ready.popleft()

    def __iter__(self) -> Iterator[Message]:
        while True:
            message = self.receive()
            if message is not None:
                yield message

    def close(self) -> None:
        self._close()

    def __enter__(self) -> Subscriber:
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    @property
    def _poller(self) -> zmq.Poller:
        poller = zmq.Poller()
        poller.register(self._live, zmq.POLLIN)
        poller.register(self._asked, zmq.POLLIN)
        return poller
