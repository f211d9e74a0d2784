"""The whole package and these tests under mypy --strict; skipped where mypy is not installed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
STAGED = os.environ["RAYLOC_PYTHON"]


@pytest.fixture(scope="module")
def mypy(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    pytest.importorskip("mypy", reason="mypy is not installed")
    configuration = str(ROOT / "deploy/clients/python/pyproject.toml")
    cache = str(tmp_path_factory.mktemp("mypy"))
    return [sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, "--config-file", configuration]


def run(words: list[str]) -> subprocess.CompletedProcess[str]:
    paths = f"{STAGED}:{ROOT}/tests/python:{ROOT}/tests/support:{ROOT}/tests/clients/stubs"
    return subprocess.run(words, env={**os.environ, "MYPYPATH": paths}, capture_output=True, text=True)


def test_mypy_finds_nothing_under_strict(mypy: list[str]) -> None:
    engine = ("tracing", "site", "recording", "localizing", "calibrating", "simulating", "studying")
    modules = ("_engine", *engine, "autograd")
    words = [word for module in modules for word in ("-m", f"rayloc.{module}")]
    done = run([*mypy, *words])
    assert done.returncode == 0, done.stdout
    done = run([*mypy, *map(str, sorted((ROOT / "tests/python").glob("*.py")))])
    assert done.returncode == 0, done.stdout


def test_mypy_would_find_a_wrong_type(mypy: list[str], tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.py"
    wrong.write_text(
        "import rayloc\n"
        "scene = rayloc.load_scene('x.xml')\n"
        "paths = rayloc.trace(scene, rayloc.Transmitter((1, 1, 1)), rayloc.Receiver((2, 2, 2)))\n"
        "print(paths.nowhere, rayloc.cfr(scene, rayloc.OfdmGrid.of(5e9)))\n"
    )
    done = run([*mypy, str(wrong)])
    assert '"Paths" has no attribute "nowhere"' in done.stdout, done.stdout
    assert "Found 2 errors" in done.stdout, done.stdout
