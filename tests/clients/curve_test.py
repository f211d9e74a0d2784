"""Encrypted subscriptions, with keys from files as `rayloc keygen` makes them, against a CURVE server
of ZeroMQ that lets in one client."""

from __future__ import annotations

from pathlib import Path
from typing import Iterator

import pytest
import zmq
import zmq.auth.thread
from envelopes import HEARTBEAT, heartbeat, location, snapshot
from processes import PATIENCE, eventually

import rayloc


class Server:
    """Publishes and answers for snapshots as raylocd does; keys are in `folder`."""

    def __init__(self, folder: Path) -> None:
        public, secret = zmq.curve_keypair()
        listed, own = zmq.curve_keypair()
        _, stranger = zmq.curve_keypair()
        for name, key in (("server.public", public), ("own.secret", own), ("stranger", stranger)):
            (folder / name).write_text(key.decode() + "\n")
        self.context = zmq.Context()
        self.guard = zmq.auth.thread.ThreadAuthenticator(self.context)
        self.guard.start()
        self.guard.configure_curve_callback(domain="*", credentials_provider=self)
        self.listed = listed
        self.refused = 0
        self.publisher = self.context.socket(zmq.XPUB)
        self.router = self.context.socket(zmq.ROUTER)
        ports = []
        for socket in (self.publisher, self.router):
            socket.curve_server = True
            socket.curve_publickey, socket.curve_secretkey = public, secret
            ports.append(socket.bind_to_random_port("tcp://127.0.0.1"))
        self.endpoint, self.snapshot = (f"tcp://127.0.0.1:{port}" for port in ports)

    def callback(self, _: object, key: bytes) -> bool:
        allowed = key == self.listed
        self.refused += not allowed
        return allowed

    def close(self) -> None:
        self.guard.stop()
        self.publisher.close(linger=0)
        self.router.close(linger=0)
        self.context.term()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Server]:
    running = Server(tmp_path)
    yield running
    running.close()


def test_a_listed_key_gets_snapshot_and_messages(server: Server, tmp_path: Path) -> None:
    curve = rayloc.Curve.read(tmp_path / "server.public", str(tmp_path / "own.secret"))
    with rayloc.Subscriber(server.endpoint, snapshot=server.snapshot, curve=curve) as messages:
        for topic in (b"v1/", HEARTBEAT.rsplit("office")[0].encode()):
            assert server.publisher.poll(int(PATIENCE) * 1000)
            assert server.publisher.recv() == b"\x01" + topic
        server.publisher.send_multipart(heartbeat(1))
        assert eventually(lambda: messages.receive(0.0) is None and server.router.poll(20) != 0)
        identity, _ = server.router.recv_multipart()
        server.router.send_multipart([identity, snapshot(7, heartbeat(1), location(4))])
        server.publisher.send_multipart(location(5))
        received = [messages.receive(PATIENCE) for _ in range(3)]
    assert [m.envelope.sequence for m in received if m is not None] == [1, 4, 5]


def test_a_stranger_and_one_without_keys_get_nothing(server: Server, tmp_path: Path) -> None:
    stranger = rayloc.Curve.read(tmp_path / "server.public", tmp_path / "stranger")
    with rayloc.Subscriber(server.endpoint, curve=stranger) as messages:
        assert eventually(lambda: messages.receive(0.05) is None and server.refused > 0)
        assert not server.publisher.poll(0)
    with rayloc.Subscriber(server.endpoint) as messages:
        assert messages.receive(0.2) is None
        assert not server.publisher.poll(0)


def test_a_file_without_a_key_is_refused(tmp_path: Path) -> None:
    (tmp_path / "empty").write_text("")
    with pytest.raises(ValueError, match="rayloc keygen"):
        rayloc.Curve.read(tmp_path / "empty", tmp_path / "empty")
    with pytest.raises(OSError, match="nowhere"):
        rayloc.Curve.read(tmp_path / "nowhere", tmp_path / "empty")
