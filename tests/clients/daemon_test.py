"""The Python client against a real raylocd that dies and comes back."""

from __future__ import annotations

import asyncio
import signal
from pathlib import Path
from typing import Callable

from processes import PATIENCE, Daemon, eventually

import rayloc


def await_message(
    messages: rayloc.Subscriber, wanted: Callable[[rayloc.Message], bool]
) -> rayloc.Message:
    while True:
        message = messages.receive(PATIENCE)
        assert message is not None, "nothing came for a minute"
        if wanted(message):
            return message


def test_it_resumes_after_a_crash_and_a_restart(tmp_path: Path) -> None:
    with Daemon(tmp_path) as daemon:
        with rayloc.Subscriber(
            daemon.endpoint, snapshot=daemon.snapshot, stale_after=3.0
        ) as messages:
            first = await_message(messages, lambda m: m.location is not None)
            assert first.site == "meeting_room" and first.target == "02:52:4c:00:00:01"
            assert not messages.stale
            await_message(messages, lambda m: m.kind == "heartbeat")
            before = messages.epoch

            assert daemon.stop(signal.SIGKILL) == -signal.SIGKILL
            assert eventually(lambda: messages.receive(0.1) is None and messages.stale)
            daemon.start()
            again = await_message(messages, lambda m: m.restarted)
            assert again.envelope.epoch == messages.epoch != before
            assert again.from_snapshot  # published by the new process before the client reconnected
            located = await_message(messages, lambda m: m.location is not None)
            assert located.envelope.epoch == messages.epoch
            assert not messages.stale
            assert (messages.restarts, messages.lost, messages.malformed) == (1, 0, 0)

            assert daemon.stop() == 0
            await_message(messages, lambda m: m.kind == "goodbye")
            assert messages.stale and messages.lost == 0


def test_asyncio_resumes_as_well(tmp_path: Path) -> None:
    async def follow(daemon: Daemon) -> None:
        loop = asyncio.get_running_loop()
        async with rayloc.AsyncSubscriber(daemon.endpoint, snapshot=daemon.snapshot) as messages:
            assert await messages.receive(PATIENCE) is not None
            assert await loop.run_in_executor(None, daemon.stop) == 0
            daemon.start()
            async for message in messages:
                if message.restarted:
                    break
            assert (messages.restarts, messages.lost) == (1, 0)

    with Daemon(tmp_path) as daemon:
        asyncio.run(follow(daemon))
