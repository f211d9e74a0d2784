"""Through real sockets: the daemon's own publisher at 10,000 messages a second, and a seeded gap.

Asserted is that everything sent arrives, once and in order. At which rate it was sent and received
says more of who else uses the machine, so it is printed and left to the reader: on an idle one both
are the 10,000 a second that were asked for."""

from __future__ import annotations

import asyncio
import threading
import time
from collections import defaultdict
from typing import Iterable, Iterator

import pytest
import zmq
from envelopes import HEARTBEAT, TOPIC, heartbeat, location
from processes import PATIENCE, BurstPublisher

import rayloc

MESSAGES = 20_000
RATE = 10_000
DEVICES = 20
SUBSCRIPTIONS = 2  # locations, heartbeats


def expect_all(received: Iterable[rayloc.Message], sent: int, from_the_first: bool = True) -> None:
    """Every sequence of every topic, once and in order, up to the last."""
    by_topic: dict[str, list[int]] = defaultdict(list)
    for message in received:
        if message.kind == "location":
            by_topic[message.topic].append(message.envelope.sequence)
    assert len(by_topic) == DEVICES
    for numbers in by_topic.values():
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
        assert (numbers[0] == 1) == from_the_first
    assert sum(numbers[-1] for numbers in by_topic.values()) == sent


def take(messages: rayloc.Subscriber, count: int) -> list[rayloc.Message]:
    taken: list[rayloc.Message] = []
    while len(taken) < count:
        message = messages.receive(PATIENCE)
        assert message is not None, "nothing came for a minute"
        taken.append(message)
    return taken


def until_goodbye(messages: rayloc.Subscriber) -> Iterator[rayloc.Message]:
    while True:
        message = messages.receive(PATIENCE)
        assert message is not None, "nothing came for a minute"
        yield message
        if message.kind == "goodbye":
            return


def test_ten_thousand_messages_a_second_without_loss(capsys: pytest.CaptureFixture[str]) -> None:
    with BurstPublisher(MESSAGES, RATE, SUBSCRIPTIONS) as publisher:
        topics = ["v1/location/", HEARTBEAT]
        with rayloc.Subscriber(publisher.endpoint, topics=topics) as messages:
            begin = time.monotonic()
            received = list(until_goodbye(messages))
            seconds = time.monotonic() - begin
            assert messages.lost == messages.malformed == 0
        sent, sending = publisher.stop()
        assert sent == MESSAGES
        expect_all(received, sent)
    with capsys.disabled():
        print(f"\nSubscriber: {sent} sent at {sent / sending:.0f}/s, received at {sent / seconds:.0f}/s")


def test_asyncio_takes_ten_thousand_a_second_and_lets_others_run(
    capsys: pytest.CaptureFixture[str],
) -> None:
    async def receive(endpoint: str) -> tuple[list[rayloc.Message], int, float]:
        received = []
        turns = 0

        async def other_work() -> None:
            nonlocal turns
            while True:
                turns += 1
                await asyncio.sleep(0.01)

        other = asyncio.create_task(other_work())
        begin = time.monotonic()
        topics = ["v1/location/", HEARTBEAT]
        async with rayloc.AsyncSubscriber(endpoint, topics=topics) as messages:
            async for message in messages:
                received.append(message)
                if message.kind == "goodbye":
                    break
            assert messages.lost == messages.malformed == 0
        other.cancel()
        return received, turns, time.monotonic() - begin

    with BurstPublisher(MESSAGES, RATE, SUBSCRIPTIONS) as publisher:
        received, turns, seconds = asyncio.run(receive(publisher.endpoint))
        sent, sending = publisher.stop()
        assert sent == MESSAGES
        expect_all(received, sent)
        assert turns > 10
    with capsys.disabled():
        print(f"\nAsyncSubscriber: {sent} sent at {sent / sending:.0f}/s, received at {sent / seconds:.0f}/s")


def test_who_joins_under_load_gets_every_sequence_once() -> None:
    with BurstPublisher(0, RATE, 0) as publisher:
        topics = ["v1/location/", HEARTBEAT]
        with rayloc.Subscriber(publisher.endpoint, topics=topics) as early:
            take(early, 500)  # from here on every topic has been spoken of
        joined = [
            rayloc.Subscriber(publisher.endpoint, snapshot=publisher.snapshot, topics=topics)
            for _ in range(4)
        ]
        received = [take(subscriber, 2000) for subscriber in joined]
        sent, _ = publisher.stop()
        for subscriber, messages in zip(joined, received):
            messages.extend(until_goodbye(subscriber))
            told = [m.topic for m in messages if m.from_snapshot]
            assert len(set(told)) == len(told) == DEVICES + 1
            expect_all(messages, sent, from_the_first=False)
            assert subscriber.lost == 0
            subscriber.close()


def test_a_seeded_gap_is_found() -> None:
    context = zmq.Context()
    publisher = context.socket(zmq.XPUB)
    port = publisher.bind_to_random_port("tcp://127.0.0.1")
    with rayloc.Subscriber(f"tcp://127.0.0.1:{port}") as messages:
        assert publisher.poll(PATIENCE * 1000) and publisher.recv() == b"\x01v1/"
        assert publisher.poll(PATIENCE * 1000) and publisher.recv() == b"\x01" + b"v1/heartbeat/"
        now = time.time()
        for message in (
            location(1),
            location(2),
            location(7),
            heartbeat(1, named={TOPIC: 9}, sent=now),
        ):
            publisher.send_multipart(message)
        gaps: list[rayloc.Gap] = []
        for _ in range(4):
            received = messages.receive(PATIENCE)
            assert received is not None
            gaps.extend(received.gaps)
        assert gaps == [rayloc.Gap(TOPIC, 4), rayloc.Gap(TOPIC, 2)]
        assert messages.lost == 6
        assert not messages.stale
    publisher.close(linger=0)
    context.term()


def test_a_snapshot_that_nobody_answers_is_an_error_with_what_to_do() -> None:
    with BurstPublisher(0, 1000, 0) as publisher:
        nobody = "ipc:///nonexistent/snapshot"
        with rayloc.Subscriber(publisher.endpoint, snapshot=nobody, patience=0.2) as messages:
            with pytest.raises(rayloc.NoSnapshot, match=r"\[publish\] snapshot"):
                for _ in messages:
                    pytest.fail("a message without the snapshot before it")


def test_an_endpoint_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="tcp://ADDRESS:PORT"):
        rayloc.Subscriber("localhost")


def test_waiting_ends_in_time_and_from_outside() -> None:
    with rayloc.Subscriber("ipc:///nonexistent/publish") as messages:
        assert messages.receive(0.0) is None
        assert messages.receive(0.01) is None
        assert messages.stale
        thread = threading.Thread(target=lambda: messages.receive(0.1))
        thread.start()
        thread.join(PATIENCE)
        assert not thread.is_alive()
