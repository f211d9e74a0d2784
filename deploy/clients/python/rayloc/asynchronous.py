"""AsyncSubscriber: Subscriber for asyncio.

    import asyncio

    import rayloc

    async def main() -> None:
        async with rayloc.AsyncSubscriber("tcp://127.0.0.1:5560") as messages:
            async for message in messages:
                print(message.topic, message.kind)

    asyncio.run(main())
"""

from __future__ import annotations

import asyncio
import time
from types import TracebackType
from typing import AsyncIterator, Optional, Type

import zmq
import zmq.asyncio

from rayloc.connection import BATCH, Connection
from rayloc.message import Message


class AsyncSubscriber(Connection):
    _without_pause = 0

    async def receive(self, timeout: Optional[float] = None) -> Optional[Message]:
        """As Subscriber.receive()."""
        ready = self._stream.ready
        deadline = None if timeout is None else time.monotonic() + timeout
        while not ready:
            self._drain()
            if ready:
                break
            wait = self._wait(deadline)
            if wait <= 0:
                return None
            self._without_pause = 0
            await self._arrival(wait)
        self._without_pause += 1
        if self._without_pause >= BATCH:  # a busy stream must not block other tasks of the loop
            self._without_pause = 0
            await asyncio.sleep(0)
        return ready.popleft()

    async def __aiter__(self) -> AsyncIterator[Message]:
        while True:
            message = await self.receive()
            if message is not None:
                yield message

    def close(self) -> None:
        self._close()

    async def __aenter__(self) -> AsyncSubscriber:
        return self

    async def __aexit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None:
        self.close()

    async def _arrival(self, seconds: float) -> None:
        poller = zmq.asyncio.Poller()
        poller.register(self._live, zmq.POLLIN)
        poller.register(self._asked, zmq.POLLIN)
        await poller.poll(int(seconds * 1000) + 1)
