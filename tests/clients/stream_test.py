"""The messages and losses that a subscriber reports, without sockets."""

from __future__ import annotations

from typing import Sequence

import pytest
from envelopes import HEARTBEAT, TOPIC, heartbeat, location, snapshot

from rayloc.message import Gap, Message
from rayloc.options import make_options
from rayloc.stream import MAX_TOPICS, Stream
from rayloc.v1.snapshot_pb2 import SnapshotRequest


def stream(
    snapshot: bool = False, topics: Sequence[str] = ("v1/",), targets: Sequence[str] = ()
) -> Stream:
    return Stream(make_options(topics, targets, snapshot, stale_after=5.0, patience=10.0))


def feed(subject: Stream, *messages: list[bytes], at: float = 1000.0) -> None:
    for message in messages:
        subject.feed(message, monotonic=at)


def taken(subject: Stream) -> list[Message]:
    messages = list(subject.ready)
    subject.ready.clear()
    return messages


def sequences(subject: Stream) -> list[tuple[str, int]]:
    return [(m.kind, m.envelope.sequence) for m in taken(subject)]


def test_a_skipped_sequence_is_a_loss_and_comes_with_the_next_message() -> None:
    subject = stream()
    feed(subject, location(4), location(5), location(9))
    assert [m.gaps for m in taken(subject)] == [(), (), (Gap(TOPIC, 3),)]
    assert subject.lost == 3


def test_the_first_message_of_a_topic_and_a_topic_begun_anew_are_no_loss() -> None:
    subject = stream()
    feed(subject, location(17), location(1), location(2), location(40, mac="02:00:00:00:00:11"))
    assert subject.lost == 0
    assert len(taken(subject)) == 4


def test_a_heartbeat_tells_the_loss_on_a_topic_that_fell_silent_and_tells_it_once() -> None:
    subject = stream()
    feed(subject, location(1), heartbeat(1, named={TOPIC: 4}), heartbeat(2, named={TOPIC: 4}))
    assert subject.lost == 3
    feed(subject, location(5))
    assert subject.lost == 3


def test_a_goodbye_tells_losses_as_well() -> None:
    subject = stream()
    feed(subject, location(1), heartbeat(1, named={TOPIC: 2}, goodbye=True))
    assert subject.lost == 1


def test_a_topic_never_seen_has_lost_nothing() -> None:
    subject = stream(topics=["v1/location/office/02:00:00:00:00:10/"])
    feed(subject, heartbeat(1, named={"v1/location/office/02:00:00:00:00:11/": 9}))
    assert subject.lost == 0


def test_a_new_epoch_is_a_restart_and_no_loss() -> None:
    subject = stream()
    feed(subject, location(1), location(50, epoch=8), location(52, epoch=8))
    assert [m.restarted for m in taken(subject)] == [False, True, False]
    assert (subject.restarts, subject.lost, subject.epoch) == (1, 1, 8)


def test_only_wanted_topics_are_handed_out_but_heartbeats_are_heard() -> None:
    subject = stream(topics=["v1/location/"])
    assert subject.subscriptions() == [b"v1/location/", b"v1/heartbeat/"]
    feed(subject, heartbeat(1), location(1))
    assert sequences(subject) == [("location", 1)]
    assert not subject.stale(1000.0)


def test_targets_leave_out_the_others_and_count_their_losses() -> None:
    subject = stream(targets=["02:00:00:00:00:11"])
    feed(subject, location(1), location(3), location(1, mac="02:00:00:00:00:11"), heartbeat(1))
    assert sequences(subject) == [("location", 1), ("heartbeat", 1)]
    assert subject.lost == 1


def test_what_the_snapshot_told_is_not_told_again() -> None:
    subject = stream(snapshot=True)
    feed(subject, location(3), location(4))
    assert subject.take_request() is None  # the subscriptions may not have arrived
    feed(subject, heartbeat(8), location(5))
    request = subject.take_request()
    assert request is not None and "v1/" in SnapshotRequest.FromString(request).prefixes
    assert taken(subject) == []
    feed(subject, location(6))
    subject.feed_snapshot(snapshot(7, heartbeat(8), location(5)))
    messages = taken(subject)
    assert [(m.envelope.sequence, m.from_snapshot) for m in messages] == [
        (8, True),
        (5, True),
        (6, False),
    ]
    feed(subject, location(7))
    assert sequences(subject) == [("location", 7)]
    assert subject.lost == 0


def test_a_snapshot_newer_than_what_comes_is_waited_for() -> None:
    subject = stream(snapshot=True)
    feed(subject, heartbeat(1))
    subject.feed_snapshot(snapshot(7, heartbeat(2), location(5)))
    taken(subject)
    feed(subject, location(4), location(5), heartbeat(2), location(6), heartbeat(3))
    assert sequences(subject) == [("location", 6), ("heartbeat", 3)]
    # All messages of the snapshot have passed: 1 now belongs to a topic that the daemon had forgotten.
    feed(subject, location(1))
    assert sequences(subject) == [("location", 1)]


def test_a_loss_right_behind_the_snapshot_is_seen() -> None:
    subject = stream(snapshot=True)
    feed(subject, heartbeat(1))
    subject.feed_snapshot(snapshot(7, heartbeat(1), location(5)))
    feed(subject, location(8))
    assert subject.lost == 2


def test_after_a_restart_the_snapshot_is_asked_for_again() -> None:
    subject = stream(snapshot=True)
    feed(subject, heartbeat(1))
    assert subject.take_request() is not None
    subject.feed_snapshot(snapshot(7, heartbeat(1)))
    feed(subject, location(3, epoch=8), heartbeat(1, epoch=8))
    assert subject.take_request() is not None
    subject.feed_snapshot(snapshot(7, location(90)))  # a late answer of the one before
    assert sequences(subject) == [("heartbeat", 1)]
    subject.feed_snapshot(snapshot(8, location(3, epoch=8), location(9, epoch=8, mac="aa")))
    messages = taken(subject)
    assert [(m.envelope.epoch, m.envelope.sequence) for m in messages] == [(8, 3), (8, 9), (8, 1)]
    assert [m.restarted for m in messages] == [True, False, False]
    assert (subject.restarts, subject.lost) == (1, 0)


def test_a_daemon_that_dies_before_it_answers_costs_no_message() -> None:
    subject = stream(snapshot=True)
    feed(subject, location(1), heartbeat(1))
    feed(subject, location(1, epoch=8), heartbeat(1, epoch=8))
    assert not subject.joined
    subject.feed_snapshot(snapshot(8, location(1, epoch=8)))
    assert subject.joined
    epochs = [(m.envelope.epoch, m.kind) for m in taken(subject)]
    assert epochs == [(7, "location"), (7, "heartbeat"), (8, "location"), (8, "heartbeat")]
    assert subject.lost == 0


def test_an_answer_that_does_not_come_is_overdue() -> None:
    subject = stream(snapshot=True)
    assert not subject.overdue(99.0)  # no message from a daemon yet: no answer is due
    feed(subject, heartbeat(1), at=100.0)
    assert not subject.overdue(109.0)
    assert subject.overdue(110.5)
    subject.go_live()
    assert sequences(subject) == [("heartbeat", 1)]
    assert not subject.overdue(200.0)


def test_without_a_heartbeat_the_snapshot_is_overdue_as_well_and_what_waits_is_bounded() -> None:
    subject = stream(snapshot=True)
    assert not subject.overdue(99.0)
    for i in range(100):
        feed(subject, location(1 + i), at=100.0 + 0.1 * i)
    assert subject.take_request() is None
    assert not subject.overdue(109.9)
    assert subject.overdue(110.1)
    subject.go_live()
    assert len(taken(subject)) == 100
    assert subject._early == []
    feed(subject, location(101), at=110.2)
    assert sequences(subject) == [("location", 101)]


@pytest.mark.parametrize("ahead", [-3600.0, 0.0, 3600.0])
def test_the_clocks_of_the_two_machines_need_not_agree(ahead: float) -> None:
    subject = stream()
    for i in range(3):
        feed(subject, heartbeat(1 + i, sent=10_000.0 + ahead + i), at=100.0 + i)
        assert not subject.stale(100.0 + i)
    feed(subject, heartbeat(4, sent=10_000.0 + ahead + 3), at=109.0)  # six seconds longer than those
    assert subject.stale(109.0)
    feed(subject, heartbeat(5, sent=10_000.0 + ahead + 9.5), at=110.0)
    assert not subject.stale(110.0)


def test_a_clock_that_is_set_is_no_delay_and_nor_is_that_of_another_start() -> None:
    subject = stream()
    feed(subject, heartbeat(1, sent=10_000.0), at=100.0)
    feed(subject, heartbeat(2, sent=9_001.0), at=101.0)  # set back
    assert not subject.stale(101.0)
    feed(subject, heartbeat(3, sent=20_002.0), at=102.0)  # set forward
    assert not subject.stale(102.0)
    feed(subject, heartbeat(1, sent=20_003.5, epoch=8), at=113.0)
    assert not subject.stale(113.0)


def test_stale_is_silence_an_old_heartbeat_or_a_goodbye() -> None:
    subject = stream()
    assert subject.stale(1000.0)  # no message yet
    feed(subject, heartbeat(1))
    assert not subject.stale(1004.0)
    assert subject.stale(1005.5)
    feed(subject, heartbeat(2, sent=1000.0), at=1006.0)  # six seconds on its way
    assert subject.stale(1006.0)
    feed(subject, heartbeat(3, sent=1007.0), at=1007.0)
    assert not subject.stale(1007.0)
    feed(subject, heartbeat(4, sent=1008.0, goodbye=True), at=1008.0)
    assert subject.stale(1008.0)


def test_what_is_no_message_is_counted_and_skipped() -> None:
    subject = stream()
    feed(subject, [b"v1/"], [b"v1/location/x/", b"\xff\xff"], [b"\xff", b""], location(1))
    assert subject.malformed == 3
    assert sequences(subject) == [("location", 1)]


def test_memory_of_topics_is_bounded_and_the_busy_ones_stay() -> None:
    subject = stream()
    feed(subject, location(1))
    for device in range(MAX_TOPICS + 10):
        feed(subject, location(1, mac=f"m{device}"))
        if device % 1000 == 0:
            feed(subject, location(2 + device // 1000))
        subject.ready.clear()
    assert len(subject._last) == MAX_TOPICS
    feed(subject, location(100))
    assert subject.lost == 100 - (2 + MAX_TOPICS // 1000) - 1


@pytest.mark.parametrize("kind", ["mac", "hashed_mac", "track"])
def test_a_target_is_named_as_in_its_topic(kind: str) -> None:
    subject = stream()
    feed(subject, location(1), heartbeat(1))
    about, not_about = taken(subject)
    target = about.envelope.location.target
    target.ClearField("mac")
    setattr(target, kind, 12 if kind == "track" else "0c")
    assert about.target == ("person-12" if kind == "track" else "0c")
    assert not_about.target == ""
    assert (about.site, not_about.topic) == ("office", HEARTBEAT)


def test_options_that_cannot_be_meant_are_refused() -> None:
    with pytest.raises(TypeError, match="topics"):
        make_options("v1/", (), False, 5.0, 10.0)
    with pytest.raises(ValueError, match="topics"):
        make_options((), (), False, 5.0, 10.0)
    with pytest.raises(ValueError, match="stale_after"):
        make_options(("v1/",), (), False, 0.0, 10.0)
