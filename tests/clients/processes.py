"""Programs of this build as real processes, at endpoints of their own. No test leaves one
behind, and none waits for a time it hopes is enough."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from typing import Callable, Optional

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))

from patience import PATIENCE as PATIENCE, patient as patient  # noqa: E402

BIN = Path(os.environ["RAYLOC_BIN"])
ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "tests/data/sites/meeting_room"
CALIBRATED = Path(os.environ["RAYLOC_SITE"])  # by make_site.py
PROGRAMS = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}  # an environment with ours
ACCESS_POINTS = ("ap2",)


def eventually(condition: Callable[[], bool], patience: float = PATIENCE) -> bool:
    deadline = time.monotonic() + patience
    while not condition():
        if time.monotonic() > deadline:
            return condition()
        time.sleep(0.02)
    return True


def free_port() -> int:
    """A UDP port that is free on this machine."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def all_blocks(readme: str) -> list[tuple[str, str]]:
    """The blocks of code in a file of the checkout, each with its language; "" if none is stated."""
    text = (ROOT / readme).read_text()
    return re.findall(r"^ *```(\w*)\n(.*?)^ *```$", text, re.M | re.S)


def blocks(readme: str, language: str) -> list[str]:
    return [text for said, text in all_blocks(readme) if said == language]


class BurstPublisher:
    """tests/clients/burst_publisher.cpp."""

    def __init__(self, messages: int, rate: int, subscriptions: int) -> None:
        self.process = subprocess.Popen(
            [str(BIN / "burst_publisher"), str(messages), str(rate), str(subscriptions)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.endpoint, self.snapshot = self._line().split()

    def stop(self) -> tuple[int, float]:
        """Locations sent, and in how many seconds."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        sent, seconds = self._line().split()
        assert self.process.wait(PATIENCE) == 0
        return int(sent), float(seconds)

    def __enter__(self) -> BurstPublisher:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout):
            assert pipe is not None
            pipe.close()

    def _line(self) -> str:
        assert self.process.stdout is not None
        return self.process.stdout.readline()


class Daemon:
    """raylocd that reads the bundled recordings of a device at the pace they were recorded (102 s)
    and publishes in `folder`."""

    def __init__(self, folder: Path, site: Path = CALIBRATED) -> None:
        self.endpoint = f"ipc://{folder}/publish"
        self.snapshot = f"ipc://{folder}/snapshot"
        self.log = folder / "raylocd.log"
        self._process: Optional[subprocess.Popen[bytes]] = None
        self.configuration = folder / "raylocd.toml"
        sources = "".join(
            f'[[source]]\nkind = "pcap"\naccess_point = "{ap}"\nspeed = 1\n'
            f'file = "{SITE}/device_los-{ap}.pcap.gz"\n'
            for ap in ACCESS_POINTS
        )
        self.configuration.write_text(
            f'[site]\ndirectory = "{site}"\n{sources}[http]\nenabled = false\n'
            f'[publish]\nendpoint = "{self.endpoint}"\nsnapshot = "{self.snapshot}"\n'
        )

    def hear_nobody(self) -> None:
        """From the next start on, a port without a sender replaces the recordings."""
        before, sources = self.configuration.read_text().split("[[source]]", 1)
        after = sources[sources.index("[http]") :]
        silent = f'kind = "udp"\naccess_point = "{ACCESS_POINTS[0]}"\n'
        silent += f'listen = "127.0.0.1:{free_port()}"\n'
        self.configuration.write_text(f"{before}[[source]]\n{silent}{after}")

    def start(self) -> None:
        with self.log.open("ab") as log:
            self._process = subprocess.Popen(
                [str(BIN / "raylocd"), "--config", str(self.configuration)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
            )

    def stop(self, number: signal.Signals = signal.SIGTERM) -> int:
        assert self._process is not None
        self._process.send_signal(number)
        return self._process.wait(PATIENCE)

    def __enter__(self) -> Daemon:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._process is not None and self._process.poll() is None:
            self._process.kill()
            self._process.wait()
