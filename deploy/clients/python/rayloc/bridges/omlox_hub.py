"""omlox Locations to an omlox hub.

    ... | python3 -m rayloc.bridges.omlox_hub --hub http://HUB/v2

Reads omlox Locations from standard input, one a line, and puts the newest of each provider to
URL/providers/PROVIDER_ID/location, at most once per `--interval`. A location that the hub does not
accept is replaced by the newest one at the next attempt. Ends with its input; reports the result of each line.
"""

from __future__ import annotations

import argparse
import json
import sys
import threading
import urllib.error
import urllib.request
from pathlib import Path
from typing import Iterable, Optional
from urllib.parse import quote

TIMEOUT = 10.0  # [s] for one answer of the hub


class Newest:
    """The newest location of each provider, from one thread to another. Lines read = taken +
    replaced + malformed + those that wait."""

    def __init__(self) -> None:
        self.read = self.taken = self.replaced = self.malformed = 0
        self._lock = threading.Lock()
        self._waiting: dict[str, bytes] = {}

    def add(self, line: bytes) -> None:
        provider = provider_of(line)
        with self._lock:
            self.read += 1
            if provider is None:
                self.malformed += 1
                return
            self.replaced += provider in self._waiting
            self._waiting[provider] = line

    def take(self) -> dict[str, bytes]:
        with self._lock:
            waiting, self._waiting = self._waiting, {}
            self.taken += len(waiting)
            return waiting

    def give_back(self, provider: str, line: bytes) -> None:
        """The hub did not take it; a newer one replaces it."""
        with self._lock:
            self.taken -= 1
            if provider in self._waiting:
                self.replaced += 1
            else:
                self._waiting[provider] = line


def provider_of(line: bytes) -> Optional[str]:
    try:
        location = json.loads(line)
    except ValueError:
        return None
    provider = location.get("provider_id") if isinstance(location, dict) else None
    return provider if isinstance(provider, str) and provider else None


class Hub:
    def __init__(self, url: str, token: Optional[str]) -> None:
        self._url = url.rstrip("/")
        self._headers = {"Content-Type": "application/json"}
        if token is not None:
            self._headers["Authorization"] = f"Bearer {token}"

    def put(self, provider: str, location: bytes) -> Optional[str]:
        """Why it did not take it, in words."""
        url = f"{self._url}/providers/{quote(provider, safe='')}/location"
        request = urllib.request.Request(url, location, self._headers, method="PUT")
        try:
            with urllib.request.urlopen(request, timeout=TIMEOUT):
                return None
        except urllib.error.HTTPError as error:
            return f"{url}: {error.code} {error.reason}"
        except OSError as error:
            return f"{url}: {error}"


def say(text: str) -> None:
    print(f"rayloc.bridges.omlox_hub: {text}", file=sys.stderr, flush=True)


def send(newest: Newest, hub: Hub, before: Optional[str]) -> Optional[str]:
    """Sends the waiting locations. Returns the last error, and reports it if it differs from `before`."""
    trouble = None
    for provider, location in newest.take().items():
        refused = hub.put(provider, location)
        if refused is not None:
            trouble = refused
            newest.give_back(provider, location)
    if trouble is not None and before is None:
        say(f"{trouble}; trying again")
    elif trouble is None and before is not None:
        say("the hub takes locations again")
    return trouble


def run(lines: Iterable[bytes], hub: Hub, interval: float) -> int:
    newest = Newest()
    ended = threading.Event()

    def read() -> None:
        for line in lines:
            newest.add(line.rstrip(b"\r\n"))
        ended.set()

    threading.Thread(target=read, daemon=True).start()
    trouble: Optional[str] = None
    while not ended.wait(interval):
        trouble = send(newest, hub, trouble)
    trouble = send(newest, hub, trouble)
    waiting = newest.read - newest.taken - newest.replaced - newest.malformed
    say(
        f"{newest.read} lines: {newest.taken} sent, {newest.replaced} replaced by newer ones,"
        f" {newest.malformed} were no Location, {waiting} not taken by the hub"
    )
    return 69 if waiting else 0


def parse(words: Optional[list[str]] = None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="rayloc.bridges.omlox_hub", description="omlox Locations from standard input to a hub"
    )
    add = parser.add_argument
    add("--hub", required=True, metavar="URL", help="for example http://127.0.0.1:8081/v2")
    add("--token-file", type=Path, help="its first line is the bearer token")
    add("--interval", type=float, default=1.0, help="seconds between two of one provider")
    arguments = parser.parse_args(words)
    if not arguments.hub.startswith(("http://", "https://")):
        parser.error(f"--hub: http://... or https://... is needed, not {arguments.hub!r}")
    return arguments


def main() -> int:
    arguments = parse()
    token = None
    if arguments.token_file is not None:
        token = (arguments.token_file.read_text().splitlines() or [""])[0]
    return run(sys.stdin.buffer, Hub(arguments.hub, token), arguments.interval)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
    except OSError as error:
        say(str(error))
        sys.exit(78)
