"""rayloc to Home Assistant over MQTT.

    python3 -m rayloc.bridges.mqtt --mqtt 127.0.0.1:1883

Needs Debian's python3-paho-mqtt. Ends with SIGTERM or SIGINT; reconnects to both sides by itself.
"""

from __future__ import annotations

import argparse
import queue
import re
import sys
import threading
import time
from pathlib import Path
from typing import Any, Iterable, Optional

from rayloc.needs import explained

try:
    import paho.mqtt.client
except ModuleNotFoundError as error:
    if __name__ != "__main__":
        raise explained(error) from None
    print(f"rayloc.bridges.mqtt: {explained(error)}", file=sys.stderr)
    sys.exit(78)  # its unit does not retry that

from rayloc.bridges.home_assistant import (
    COMPONENTS,
    OFFLINE,
    ONLINE,
    HomeAssistant,
    Publication,
    Setting,
)
from rayloc.bridges.program import (
    add_source,
    check_source,
    subscribe,
    until_signalled,
    usual_snapshot,
)
from rayloc.connection import NoSnapshot
from rayloc.subscriber import Subscriber

TOPICS = ["v1/location/", "v1/track/", "v1/zone/", "v1/heartbeat/"]
BIRTH = "homeassistant/status"
LOOK = 0.2  # [s] between checks for publications that are due without a message


class Broker:
    """The MQTT side: a will, a flag for when everything is to be announced anew, and what the broker
    has kept of our announcements (topic, payload)."""

    def __init__(self, arguments: argparse.Namespace, setting: Setting) -> None:
        self.must_announce = threading.Event()
        self.kept: queue.SimpleQueue[tuple[str, str]] = queue.SimpleQueue()
        self._status = f"{setting.base}/status"
        self._state = OFFLINE  # of this bridge, until the first message arrives
        # Home Assistant's birth message does not move with its discovery prefix.
        self._births = {f"{setting.prefix}/status", BIRTH}
        self._discovery = [f"{setting.prefix}/{each}/+/+/config" for each in COMPONENTS]
        self._client = paho.mqtt.client.Client(client_id=arguments.client_id or setting.base)
        if arguments.username is not None:
            password = _first_line(arguments.password_file)
            self._client.username_pw_set(arguments.username, password)
        if arguments.ca_file is not None:
            self._client.tls_set(ca_certs=arguments.ca_file)
        self._client.will_set(self._status, OFFLINE, qos=1, retain=True)
        self._client.reconnect_delay_set(min_delay=1, max_delay=30)
        self._client.on_connect = self._on_connect
        self._client.on_disconnect = self._on_disconnect
        self._client.on_message = self._on_message
        host, _, port = arguments.mqtt.rpartition(":")
        self._client.connect_async(host, int(port), keepalive=30)
        self._client.loop_start()

    def publish(self, publications: Iterable[Publication]) -> None:
        # Without a connection nothing is queued: the next connection announces everything again.
        for each in publications:
            if each.topic == self._status:
                self._state = each.payload
            if self._client.is_connected():
                self._client.publish(each.topic, each.payload, qos=1, retain=each.retain)

    def close(self) -> None:
        if self._client.is_connected():
            self._client.publish(self._status, OFFLINE, qos=1, retain=True).wait_for_publish(5.0)
        self._client.disconnect()
        self._client.loop_stop()

    def _on_connect(self, client: paho.mqtt.client.Client, _: Any, __: Any, code: int) -> None:
        if code != 0:
            say(f"the broker refuses: {paho.mqtt.client.connack_string(code)}")
            return
        say("connected to the broker")
        client.publish(self._status, self._state, qos=1, retain=True)
        client.subscribe([(topic, 1) for topic in [*self._births, *self._discovery]])
        self.must_announce.set()

    def _on_disconnect(self, _: Any, __: Any, code: int) -> None:
        if code != 0:
            say("the broker is gone; trying again")

    def _on_message(self, _: Any, __: Any, message: paho.mqtt.client.MQTTMessage) -> None:
        if message.topic in self._births:
            if message.payload == ONLINE.encode():
                self.must_announce.set()
        elif message.retain and "/rayloc_" in message.topic:  # retained, not just published
            self.kept.put((message.topic, message.payload.decode(errors="replace")))


def say(text: str) -> None:
    print(f"rayloc.bridges.mqtt: {text}", file=sys.stderr, flush=True)


def _first_line(file: Optional[Path]) -> Optional[str]:
    return None if file is None else (file.read_text().splitlines() or [""])[0]


def run(arguments: argparse.Namespace) -> None:
    setting = Setting(
        prefix=arguments.prefix,
        base=arguments.base,
        interval=arguments.interval,
        forget=arguments.forget,
        targets=tuple(arguments.target),
    )
    bridge = HomeAssistant(setting)
    stopping = until_signalled()
    snapshot = arguments.snapshot or usual_snapshot(arguments)
    messages = subscribe(arguments, TOPICS, snapshot)
    broker = Broker(arguments, setting)
    try:
        try:
            carry(messages, bridge, broker, stopping)
        except NoSnapshot as error:
            say(f"{error} The occupants of a zone are known from its next event on.")
            messages.close()
            messages = subscribe(arguments, TOPICS)
            carry(messages, bridge, broker, stopping)
    finally:
        messages.close()
    broker.close()


def carry(
    messages: Subscriber, bridge: HomeAssistant, broker: Broker, stopping: threading.Event
) -> None:
    looked = 0.0
    while not stopping.is_set():
        message = messages.receive(LOOK)
        now = time.monotonic()
        if broker.must_announce.is_set():
            broker.must_announce.clear()
            broker.publish(bridge.announce())
        if message is not None:
            for gap in message.gaps:
                say(f"lost {gap.lost} messages of {gap.topic}")
            broker.publish(bridge.on_message(message, now))
            for notice in bridge.take_notices():
                say(notice)
            while not broker.kept.empty():  # the preceding message identifies the site
                bridge.adopt(*broker.kept.get(), now)
        if now - looked >= LOOK:
            looked = now
            broker.publish(bridge.on_time(now, messages.stale))


def parse(words: Optional[list[str]] = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="rayloc.bridges.mqtt", description="raylocd's locations for Home Assistant, over MQTT"
    )
    add_source(parser)
    add = parser.add_argument
    snapshot = "endpoint of raylocd's snapshots; default: that of the raylocd of this machine"
    add("--snapshot", help=snapshot)
    add("--mqtt", default="127.0.0.1:1883", metavar="HOST:PORT", help="the broker")
    add("--username", help="at the broker")
    add("--password-file", type=Path, help="its first line is the password")
    add("--ca-file", help="TLS, with these certificates of authorities (PEM)")
    add("--client-id", help="at the broker; the same as --base by default")
    add("--prefix", default="homeassistant", help="Home Assistant's discovery prefix")
    add("--base", default="rayloc", help="first part of our own topics, another for each bridge")
    add("--interval", type=float, default=1.0, help="seconds between two states of a target")
    add("--forget", type=float, default=86_400.0, help="seconds until a silent device is removed")
    arguments = parser.parse_args(words)
    host, _, port = arguments.mqtt.rpartition(":")
    if not host or not port.isdigit():
        parser.error(f"--mqtt: HOST:PORT is needed, not {arguments.mqtt!r}")
    for option in ("prefix", "base"):
        topic = getattr(arguments, option)
        if not topic or re.search(r"[+#\x00-\x1f\x7f]|^[/$]|/$", topic):
            parser.error(f"--{option}: {topic!r} is no part of a topic: write it without + and #, and no / at an end")
    check_source(parser, arguments)
    return arguments


if __name__ == "__main__":
    try:
        run(parse())
    except (OSError, ValueError) as error:
        say(str(error))
        sys.exit(78)
