"""A real mosquitto on a port of the kernel's choice, and a subscriber that keeps its messages."""

from __future__ import annotations

import socket
import subprocess
import threading
from pathlib import Path
from typing import Any

import paho.mqtt.client
from processes import PATIENCE, eventually


class Broker:
    def __init__(self, folder: Path) -> None:
        self._log = folder / "mosquitto.log"
        self._configuration = folder / "mosquitto.conf"
        for _ in range(10):  # another process may take the port before mosquitto does
            with socket.socket() as chosen:
                chosen.bind(("127.0.0.1", 0))
                self.port = int(chosen.getsockname()[1])
            self._configuration.write_text(
                f"listener {self.port} 127.0.0.1\nallow_anonymous true\nuser root\n"
            )
            self.start()
            if eventually(lambda: self._answers() or self._process.poll() is not None):
                if self._process.poll() is None:
                    return
        raise RuntimeError(self._log.read_text())

    def start(self) -> None:
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(
                ["/usr/sbin/mosquitto", "-c", str(self._configuration)], stdout=log, stderr=log
            )

    def stop(self) -> None:
        self._process.kill()
        self._process.wait()

    def _answers(self) -> bool:
        with socket.socket() as probe:
            return probe.connect_ex(("127.0.0.1", self.port)) == 0

    def __enter__(self) -> Broker:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()


class Listener:
    """As Home Assistant: everything that is published, the last payload and all by topic."""

    def __init__(self, broker: Broker) -> None:
        self.lock = threading.Lock()
        self.last: dict[str, str] = {}
        self.heard: list[tuple[str, str]] = []
        self._subscribed = threading.Event()
        self.client = paho.mqtt.client.Client()
        self.client.on_message = self._on_message
        self.client.on_subscribe = lambda *_: self._subscribed.set()
        self.client.connect("127.0.0.1", broker.port)
        self.client.loop_start()
        self.client.subscribe("#", qos=1)
        assert self._subscribed.wait(PATIENCE)

    def _on_message(self, _: Any, __: Any, message: paho.mqtt.client.MQTTMessage) -> None:
        with self.lock:
            self.last[message.topic] = message.payload.decode()
            self.heard.append((message.topic, message.payload.decode()))

    def hears(self, topic: str, payload: str) -> bool:
        """That it becomes the last one of the topic."""
        return eventually(lambda: self.last.get(topic) == payload)

    def __enter__(self) -> Listener:
        return self

    def __exit__(self, *_: object) -> None:
        self.client.disconnect()
        self.client.loop_stop()
