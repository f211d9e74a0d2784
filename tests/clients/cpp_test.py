"""The C++ package as others use it: installed, found by CMake from a project of its own (the
example), and run against a real raylocd that dies and comes back."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from curve_test import Server
from envelopes import heartbeat, location, person, snapshot
from processes import PATIENCE, ROOT, Daemon, eventually

EXAMPLE = ROOT / "deploy/clients/cpp/examples"


def run(*words: object) -> None:
    done = subprocess.run(
        [str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert done.returncode == 0, done.stdout


def example_of_the_header() -> str:
    """As a program; it reads from the endpoint that is its argument."""
    comment = (ROOT / "deploy/clients/cpp/rayloc/client.h").read_text().split("#pragma")[0]
    lines = re.findall(r"^//   (.*)$", comment, re.M)
    body = "\n".join(lines).replace("({.topics", "({.endpoint = argv[1], .topics")
    assert "argv[1]" in body
    return f"#include <rayloc/client.h>\n#include <iostream>\nint main(int, char** argv) {{\n{body}\n}}\n"


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the example, `subscribe`, and that of the header, `header`."""
    prefix = tmp_path_factory.mktemp("prefix")
    build = tmp_path_factory.mktemp("build")
    run("cmake", "--install", os.environ["RAYLOC_BUILD"], "--prefix", prefix, "--component", "clients")
    source = tmp_path_factory.mktemp("source")
    shutil.copytree(EXAMPLE, source, dirs_exist_ok=True)
    (source / "header.cpp").write_text(example_of_the_header())
    with (source / "CMakeLists.txt").open("a") as lists:
        lists.write("add_executable(header header.cpp)\ntarget_link_libraries(header rayloc::client)\n")
    run("cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}")
    run("cmake", "--build", build)
    for header in prefix.rglob("*.h"):
        text = header.read_text()
        assert not re.search(r'# *include ["<](daemon|engine|tl|zmq|proto)\b', text), header
    return build


@pytest.fixture
def subscribe(programs: Path) -> Path:
    return programs / "subscribe"


def test_the_example_of_the_header_shows_the_device(programs: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with Daemon(tmp_path) as daemon, out.open("wb") as file:
        client = subprocess.Popen([str(programs / "header"), daemon.endpoint], stdout=file)
        try:
            place = re.compile(r"^02:52:4c:00:00:01 -?[\d.]+$", re.M)
            assert eventually(lambda: place.search(out.read_text()) is not None), out.read_text()
        finally:
            client.kill()
            client.wait()


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
            server.publisher.send_multipart(person(1, track=12))
            assert eventually(lambda: "\nperson-12 1 " in out.read_text()), out.read_text()
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
