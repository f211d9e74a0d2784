"""Common parts of bridges that subscribe: command line, subscription and signals."""

from __future__ import annotations

import argparse
import signal
import threading
from pathlib import Path
from typing import Optional, Sequence

from rayloc.options import Curve
from rayloc.subscriber import Subscriber

ENDPOINT, SNAPSHOT = "tcp://127.0.0.1:5560", "tcp://127.0.0.1:5561"  # raylocd's defaults


def add_source(parser: argparse.ArgumentParser) -> None:
    """Adds the arguments of the subscription; call check_source() after they are parsed."""
    add = parser.add_argument
    add("--endpoint", default=ENDPOINT, help="where raylocd publishes")
    add("--target", action="append", default=[], help="only this target; may be repeated")
    add("--server-key", type=Path, help="file with the public key of a raylocd with CURVE")
    add("--key", type=Path, help="file with our own secret key, by `rayloc keygen`")


def usual_snapshot(arguments: argparse.Namespace) -> Optional[str]:
    """The snapshot endpoint of the raylocd of this machine, if --endpoint is its default."""
    return SNAPSHOT if arguments.endpoint == ENDPOINT else None


def check_source(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> None:
    if (arguments.server_key is None) != (arguments.key is None):
        parser.error("--server-key and --key need each other")


def subscribe(
    arguments: argparse.Namespace, topics: Sequence[str], snapshot: Optional[str] = None
) -> Subscriber:
    curve = None
    if arguments.server_key is not None:
        curve = Curve.read(arguments.server_key, arguments.key)
    return Subscriber(
        arguments.endpoint, topics=topics, targets=arguments.target, snapshot=snapshot, curve=curve
    )


def until_signalled() -> threading.Event:
    """Is set by SIGTERM and SIGINT."""
    stopping = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopping.set())
    return stopping
