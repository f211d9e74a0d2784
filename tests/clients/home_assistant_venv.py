"""A virtual environment with a release of Home Assistant from PyPI, in the build; kept for the next run."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Iterator, Optional

import pytest

# Release, and the least Python that it takes. The first is of before `in_zones`, the second has it in its own
# trackers, though not yet in those of MQTT.
RELEASES = {"2025.4.4": (3, 13, 0), "2026.11.0": (3, 14, 2)}
MQTT_NEEDS = ("mqtt", "hassio")  # integrations that MQTT imports
FOLDER = Path(os.environ["RAYLOC_BUILD"]) / "home_assistant"
_lacking: dict[str, str] = {}  # why a release cannot be had, so that one test alone waits for the registry


def python_of(release: str) -> Path:
    """Skips the test where there is no Python for that release or no registry to have it from."""
    folder = FOLDER / release
    python, ready = folder / "bin/python", folder / "ready"
    if ready.exists():
        return python
    if release in _lacking:
        pytest.skip(_lacking[release])
    base = _interpreter(RELEASES[release])
    if base is None:
        least = ".".join(map(str, RELEASES[release]))
        pytest.skip(f"Home Assistant {release} needs Python {least}; name one in RAYLOC_HOME_ASSISTANT_PYTHON")
    shutil.rmtree(folder, ignore_errors=True)
    _run(release, str(base), "-m", "venv", str(folder))
    _install(release, python, f"homeassistant=={release}")
    (components,) = folder.glob("lib/python3*/site-packages/homeassistant/components")
    manifests = [json.loads((components / each / "manifest.json").read_text()) for each in MQTT_NEEDS]
    _install(release, python, *(need for each in manifests for need in each.get("requirements", ())))
    ready.touch()
    return python


def _install(release: str, python: Path, *packages: str) -> None:
    if packages:
        _run(release, str(python), "-m", "pip", "install", "-q", "--no-compile", *packages)


def _run(release: str, *words: str) -> None:
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        _lacking[release] = f"Home Assistant {release} could not be installed: {last}"
        pytest.skip(_lacking[release])


def _interpreter(least: tuple[int, int, int]) -> Optional[Path]:
    """An interpreter of the same minor version, since older releases do not take newer ones."""
    for path in _interpreters():
        program = "import sys; print(*sys.version_info[:3])"
        done = subprocess.run([path, "-c", program], capture_output=True, text=True)
        if done.returncode == 0:
            version = tuple(map(int, done.stdout.split()))
            if version[:2] == least[:2] and version >= least:
                return path
    return None


def _interpreters() -> Iterator[Path]:
    named = os.environ.get("RAYLOC_HOME_ASSISTANT_PYTHON", "")
    yield from (Path(each) for each in named.split(":") if each)
    for _, minor, _ in RELEASES.values():
        found = shutil.which(f"python3.{minor}")
        if found is not None:
            yield Path(found)
    yield from sorted(Path.home().glob(".pyenv/versions/3.*/bin/python"))
