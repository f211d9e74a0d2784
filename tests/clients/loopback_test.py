"""Through real sockets: the daemon's own publisher at 10,000 messages a second, and a seeded gap.

Asserted is that everything sent arrives, once and in order, though far fewer may wait in the client than
are sent: a client that is too slow loses the rest. Lower rates are tried where others take the processor
from the client. How much of the processor it takes depends on the machine, and is printed."""

from __future__ import annotations

import asyncio
import threading
import time
from collections import defaultdict
from dataclasses import dataclass, field
from typing import Callable, Iterable, Iterator

import pytest
import zmq
from envelopes import HEARTBEAT, TOPIC, heartbeat, location
from processes import PATIENCE, BurstPublisher, patient

import rayloc

RATE = 10_000
RATES = (RATE, RATE // 2, RATE // 4)
SECONDS = 6  # at each rate
WAITING = 5_000  # messages that may wait for the client: a slow one loses the rest
LOCATIONS = "v1/location/"
SILENCE = patient(10.0)  # [s] after which a goodbye that was lost is not waited for any more
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
        assert message is not None, "nothing came"
        taken.append(message)
    return taken


def until_goodbye(messages: rayloc.Subscriber) -> Iterator[rayloc.Message]:
    while True:
        message = messages.receive(PATIENCE)
        assert message is not None, "nothing came"
        yield message
        if message.kind == "goodbye":
            return


@dataclass
class Taken:
    """The messages that a client received of a burst, and their cost."""

    received: list[rayloc.Message] = field(default_factory=list)
    lost: int = 0
    malformed: int = 0
    seconds: float = 0.0
    processor: float = 0.0  # [s]
    turns: int = 0  # of others in the event loop


def expect_without_loss(name: str, capsys: pytest.CaptureFixture[str], take_all: Callable[[str], Taken]) -> Taken:
    """`take_all`: subscribes there and takes what comes until the goodbye, or until nothing does."""
    for rate in RATES:
        with BurstPublisher(rate * SECONDS, rate, SUBSCRIPTIONS) as publisher:
            taken = take_all(publisher.endpoint)
            sent, sending = publisher.stop()
        assert sent == rate * SECONDS
        with capsys.disabled():
            print(
                f"\n{name}: {sent} sent at {sent / sending:.0f}/s, received at {sent / taken.seconds:.0f}/s,"
                f" {sent / taken.processor:.0f} per second of processor, {taken.lost} lost"
            )
        assert taken.malformed == 0
        if taken.lost == 0:
            break
    assert taken.lost == 0
    expect_all(taken.received, sent)
    return taken


def test_ten_thousand_messages_a_second_without_loss(capsys: pytest.CaptureFixture[str]) -> None:
    def take_all(endpoint: str) -> Taken:
        taken = Taken()
        topics = [LOCATIONS, HEARTBEAT]
        with rayloc.Subscriber(endpoint, topics=topics, high_water_mark=WAITING) as messages:
            begin, processor = time.monotonic(), time.process_time()
            while message := messages.receive(SILENCE):
                taken.received.append(message)
                if message.kind == "goodbye":
                    break
            taken.processor = time.process_time() - processor
            taken.seconds = time.monotonic() - begin
            taken.lost, taken.malformed = messages.lost, messages.malformed
        return taken

    expect_without_loss("Subscriber", capsys, take_all)


def test_asyncio_takes_ten_thousand_a_second_and_lets_others_run(
    capsys: pytest.CaptureFixture[str],
) -> None:
    async def receive(endpoint: str) -> Taken:
        taken = Taken()

        async def other_work() -> None:
            while True:
                taken.turns += 1
                await asyncio.sleep(0.01)

        other = asyncio.create_task(other_work())
        topics = [LOCATIONS, HEARTBEAT]
        async with rayloc.AsyncSubscriber(
            endpoint, topics=topics, high_water_mark=WAITING
        ) as messages:
            begin, processor = time.monotonic(), time.process_time()
            while message := await messages.receive(SILENCE):
                taken.received.append(message)
                if message.kind == "goodbye":
                    break
            taken.processor = time.process_time() - processor
            taken.seconds = time.monotonic() - begin
            taken.lost, taken.malformed = messages.lost, messages.malformed
        other.cancel()
        return taken

    taken = expect_without_loss("AsyncSubscriber", capsys, lambda endpoint: asyncio.run(receive(endpoint)))
    assert taken.turns > 10


def test_who_is_too_slow_knows_how_much_was_lost() -> None:
    with BurstPublisher(0, RATE, 2 * SUBSCRIPTIONS) as publisher:
        topics = [LOCATIONS, HEARTBEAT]
        with rayloc.Subscriber(publisher.endpoint, topics=topics) as other, rayloc.Subscriber(
            publisher.endpoint, topics=topics, high_water_mark=100
        ) as messages:
            received = take(messages, 1000)
            take(other, 50_000)  # more than waits here, in the kernel and at the publisher
            received += take(messages, 25_000)  # up to date again
            sent, _ = publisher.stop()
            received += until_goodbye(messages)
    lost = sum(gap.lost for message in received for gap in message.gaps if gap.topic.startswith(LOCATIONS))
    came = sum(message.kind == "location" for message in received)
    assert lost > 0 and came + lost == sent, (came, lost, sent)


def test_who_joins_under_load_gets_every_sequence_once() -> None:
    with BurstPublisher(0, RATE, 0) as publisher:
        topics = [LOCATIONS, HEARTBEAT]
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
