"""The C++ package as others use it: installed, found by CMake from a project of its own (the
example), and run against a real raylocd that dies and comes back."""

from __future__ import annotations

import os
import re
import signal
import subprocess
from pathlib import Path

import pytest
from curve_test import Server
from envelopes import heartbeat, location, snapshot
from processes import PATIENCE, ROOT, Daemon, eventually

EXAMPLE = ROOT / "deploy/clients/cpp/examples"


def run(*words: object) -> None:
    done = subprocess.run(
        [str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert done.returncode == 0, done.stdout


@pytest.fixture(scope="module")
def subscribe(tmp_path_factory: pytest.TempPathFactory) -> Path:
    prefix = tmp_path_factory.mktemp("prefix")
    build = tmp_path_factory.mktemp("build")
    run("cmake", "--install", os.environ["RAYLOC_BUILD"], "--prefix", prefix, "--component", "clients")
    run("cmake", "-S", EXAMPLE, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", build)
    for header in prefix.rglob("*.h"):
        text = header.read_text()
        assert not re.search(r'# *include ["<](daemon|engine|tl|zmq|proto)\b', text), header
    return build / "subscribe"


def test_an_installed_client_survives_a_crash_of_the_daemon(
    subscribe: Path, tmp_path: Path
) -> None:
    out = tmp_path / "out"

    def says(pattern: str) -> bool:
        return eventually(lambda: re.search(pattern, out.read_text(), re.M) is not None)

    place = r"^02:52:4c:00:00:01 -?[\d.]+ -?[\d.]+"
    with Daemon(tmp_path) as daemon, out.open("wb") as file:
        words = [str(subscribe), daemon.endpoint, daemon.snapshot]
        client = subprocess.Popen(words, stdout=file, stderr=file)
        try:
            assert says(place + " lost=0 restarts=0$"), out.read_text()
            daemon.stop(signal.SIGKILL)
            assert says("^stale lost=0 restarts=0$"), out.read_text()
            daemon.start()
            assert says(place + " lost=0 restarts=1$"), out.read_text()
            assert client.poll() is None
        finally:
            client.kill()
            client.wait()


def test_an_encrypted_daemon_is_understood_with_keys_alone(subscribe: Path, tmp_path: Path) -> None:
    server = Server(tmp_path)
    for name in ("own.secret", "stranger"):
        (tmp_path / name).chmod(0o600)
    places = [server.endpoint, server.snapshot, str(tmp_path / "server.public")]
    out = tmp_path / "out"
    with out.open("wb") as file:
        listed, stranger = (
            subprocess.Popen([str(subscribe), *places, str(tmp_path / key)], stdout=file, stderr=file)
            for key in ("own.secret", "stranger")
        )
        try:
            sequence = 0

            def answered() -> bool:
                nonlocal sequence
                sequence += 1
                server.publisher.send_multipart(heartbeat(sequence))
                if server.router.poll(50):
                    identity, _ = server.router.recv_multipart()
                    told = snapshot(7, heartbeat(sequence), location(4))
                    server.router.send_multipart([identity, told])
                return "02:00:00:00:00:10 4 " in out.read_text()

            assert eventually(answered), out.read_text()
            server.publisher.send_multipart(location(5))
            assert eventually(lambda: "02:00:00:00:00:10 5 " in out.read_text()), out.read_text()
            assert eventually(lambda: server.refused > 0)
        finally:
            for client in (listed, stranger):
                client.kill()
                client.wait()
            server.close()


def test_what_cannot_work_says_what_to_do(subscribe: Path) -> None:
    words = [str(subscribe), "localhost:5560"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode != 0
    assert "std::invalid_argument" in done.stderr and "write tcp://ADDRESS:PORT" in done.stderr
