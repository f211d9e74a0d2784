"""The bridge to an omlox hub: lines in, requests out."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Iterator

import pytest
from fake_hub import FakeHub
from processes import PATIENCE, eventually

from rayloc.bridges.omlox_hub import Hub, Newest, send

@pytest.fixture
def hub() -> Iterator[FakeHub]:
    fake = FakeHub()
    yield fake
    fake.close()


def line(provider: str, x: float) -> bytes:
    position = {"type": "Point", "coordinates": [x, 2.0, 1.0]}
    return json.dumps({"provider_id": provider, "position": position, "crs": "local"}).encode()


def test_the_newest_of_each_provider_is_put(hub: FakeHub) -> None:
    newest = Newest()
    for each in (line("a b/c", 1.0), line("p2", 5.0), line("a b/c", 2.0), b"{", b"[]", b'{"x":1}'):
        newest.add(each)
    assert send(newest, Hub(hub.url, None), None) is None
    assert [path for path, _, _ in hub.puts] == [
        "/v2/providers/a%20b%2Fc/location",
        "/v2/providers/p2/location",
    ]
    assert hub.puts[0][1] == json.loads(line("a b/c", 2.0))
    assert (newest.read, newest.taken, newest.replaced, newest.malformed) == (6, 2, 1, 3)


def test_what_the_hub_refuses_is_tried_again_with_what_is_newest_then(hub: FakeHub) -> None:
    newest = Newest()
    hub.status = 503
    newest.add(line("p1", 1.0))
    newest.add(line("p2", 1.0))
    trouble = send(newest, Hub(hub.url, None), None)
    assert trouble is not None and "503" in trouble
    newest.add(line("p2", 2.0))
    hub.status = 204
    assert send(newest, Hub(hub.url, None), trouble) is None
    assert sorted(str(body["position"]) for _, body, _ in hub.puts) == sorted(
        str(json.loads(line("", x))["position"]) for x in (1.0, 2.0)
    )
    assert (newest.read, newest.taken, newest.replaced) == (3, 2, 1)


def test_the_program_sends_while_lines_come_and_accounts_for_all_of_them(
    hub: FakeHub, tmp_path: Path
) -> None:
    (tmp_path / "token").write_text("secret\n")
    words = ["--hub", hub.url, "--interval", "0.05", "--token-file", str(tmp_path / "token")]
    bridge = subprocess.Popen(
        [sys.executable, "-m", "rayloc.bridges.omlox_hub", *words],
        stdin=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert bridge.stdin is not None
    bridge.stdin.write(line("p1", 1.0) + b"\n")
    bridge.stdin.flush()
    assert eventually(lambda: len(hub.puts) == 1)
    _, said = bridge.communicate(line("p1", 2.0) + b"\nnothing\n", timeout=PATIENCE)
    assert bridge.returncode == 0
    assert [authorization for _, _, authorization in hub.puts] == ["Bearer secret"] * 2
    assert b"3 lines: 2 sent, 0 replaced by newer ones, 1 were no Location, 0 not taken" in said


def test_a_hub_that_is_not_there_is_an_error_at_the_end(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "rayloc.bridges.omlox_hub", "--hub", "http://127.0.0.1:9/v2"]
    done = subprocess.run(words, input=line("p1", 1.0), capture_output=True, timeout=PATIENCE)
    assert done.returncode == 69
    assert b"1 not taken by the hub" in done.stderr
    done = subprocess.run([*words[:-1], "hub"], input=b"", capture_output=True, timeout=PATIENCE)
    assert done.returncode == 2 and b"http://..." in done.stderr
