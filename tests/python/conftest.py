"""Fixtures and data that the tests of the engine's module share."""

from __future__ import annotations

import gzip
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import rayloc

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))  # patience

ROOT = Path(__file__).resolve().parents[2]
BIN = Path(os.environ["RAYLOC_BIN"])
DATA = ROOT / "tests/data"
MEETING_ROOM = DATA / "sites/meeting_room"


def golden(name: str) -> dict[str, Any]:
    with gzip.open(DATA / f"goldens/{name}.json.gz", "rt") as file:
        values: dict[str, Any] = json.load(file)
    return values


def program(*words: object) -> str:
    done = subprocess.run(
        [str(BIN / "rayloc"), *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="session")
def room() -> rayloc.Scene:
    """The furnished meeting room at the carrier of the reference channels."""
    return rayloc.load_scene(MEETING_ROOM / "scene.xml", 5.18e9)
