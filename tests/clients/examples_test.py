"""Every example of deploy/clients and every client snippet of the READMEs, as they are there,
against a live raylocd."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Callable, Iterator

import pytest
from processes import ROOT, Daemon, blocks, eventually

import rayloc.asynchronous
import rayloc.subscriber

EXAMPLES = ROOT / "deploy/clients/python/examples"
CLIENTS_README = "deploy/clients/README.md"
RAYLOC_PYTHON = Path(os.environ["RAYLOC_PYTHON"])
PLACE = re.compile(r"^02:52:4c:00:00:01 -?\d+\.\d\d -?\d+\.\d\d -?\d+\.\d\d$", re.M)
TABLE = re.compile(r"^\{'02:52:4c:00:00:01': \(-?\d+\.\d+, -?\d+\.\d+\)\} lost=0 stale=False$", re.M)
# The output that each example must print; an example without a line here fails.
PRINTS = {"subscribe.py": PLACE, "subscribe_async.py": TABLE}


@pytest.fixture
def daemon(tmp_path: Path) -> Iterator[Daemon]:
    with Daemon(tmp_path) as running:
        yield running


def expect_output(words: list[str], folder: Path, ready: Callable[[str], bool]) -> None:
    """Runs it until its output is as it should be, and then ends it."""
    out = folder / "out"
    with out.open("wb") as file:
        process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=file, stderr=file)
    try:
        eventually(lambda: ready(out.read_text()) or process.poll() is not None)
        assert ready(out.read_text()), out.read_text()
    finally:
        process.kill()
        process.wait()


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.*")), ids=lambda path: str(path.name))
def test_examples_show_the_device(example: Path, daemon: Daemon, tmp_path: Path) -> None:
    pattern = PRINTS[example.name]
    words = [sys.executable, str(example), daemon.endpoint]
    if example.name == "subscribe_async.py":
        words.append(daemon.snapshot)
    expect_output(words, tmp_path, lambda text: pattern.search(text) is not None)


def test_examples_are_short() -> None:
    for example in EXAMPLES.glob("*.*"):
        assert len(example.read_text().splitlines()) <= 25, example


def test_the_readme_subscribes_in_five_lines(daemon: Daemon, tmp_path: Path) -> None:
    (snippet,) = blocks("README.md", "python")
    assert len([line for line in snippet.splitlines() if line.strip()]) <= 5
    assert "tcp://127.0.0.1:5560" in snippet
    program = tmp_path / "snippet.py"
    program.write_text(snippet.replace("tcp://127.0.0.1:5560", daemon.endpoint))
    expect_output(
        [sys.executable, "-u", str(program)],
        tmp_path,
        lambda text: "02:52:4c:00:00:01 x: " in text and text.count("\ny: ") >= 3,
    )


@pytest.mark.parametrize("module", [rayloc, rayloc.subscriber, rayloc.asynchronous])
def test_the_examples_of_docstrings_show_the_device(
    module: ModuleType, daemon: Daemon, tmp_path: Path
) -> None:
    lines = (module.__doc__ or "").splitlines()
    indented = [line[4:] for line in lines if line.startswith("    ") or not line]
    example = "\n".join(indented).strip() + "\n"
    assert example.count("tcp://127.0.0.1:5560") == 1
    program = tmp_path / "example.py"
    program.write_text(example.replace("tcp://127.0.0.1:5560", daemon.endpoint))
    topic = "v1/location/meeting_room/02:52:4c:00:00:01/ location"
    expect_output(
        [sys.executable, "-u", str(program)], tmp_path, lambda text: text.count(topic) >= 2
    )


def test_the_command_of_the_clients_readme_shows_the_device(
    daemon: Daemon, tmp_path: Path
) -> None:
    # The others are run by bridges_test.py.
    command = next(each for each in blocks(CLIENTS_README, "sh") if "examples/subscribe.py" in each)
    script = command.replace("build/dev/python", str(RAYLOC_PYTHON)).rstrip()
    expect_output(
        ["env", "-C", str(ROOT), "bash", "-c", f"{script} {daemon.endpoint}"],
        tmp_path,
        lambda text: PLACE.search(text) is not None,
    )


def test_every_command_of_the_clients_readme_is_run_by_some_test() -> None:
    known = (
        "examples/subscribe.py",
        "-m venv",  # package_test.py
        "rayloc.bridges.mqtt",
        "rayloc.bridges.ros2",
        "--format geojson",
        "--format omlox",
    )
    for command in blocks(CLIENTS_README, "sh"):
        assert len([name for name in known if name in command]) == 1, command


def test_any_language_reads_the_messages_as_the_readme_of_proto_says(
    daemon: Daemon, tmp_path: Path
) -> None:
    (snippet,) = blocks("proto/README.md", "sh")
    script = snippet.replace("/tmp", str(tmp_path)).replace("tcp://127.0.0.1:5560", daemon.endpoint)
    assert daemon.endpoint in script and "-u -c" in script
    expect_output(
        ["env", "-C", str(ROOT), "bash", "-c", "exec 2>&1; " + script],
        tmp_path,
        lambda text: text.count("v1/location/meeting_room/02:52:4c:00:00:01/ x: ") >= 2,
    )
