"""The package as a whole: its types, its version, that pip makes the same of it as CMake, and that it
is at the place of installation that the READMEs state. (The Debian package: tests/package/debian.)"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from processes import blocks

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ROOT / "deploy/clients/python"
STAGED = Path(os.environ["RAYLOC_PYTHON"])  # where CMake has put it together
# Files that need the native module, which pip does not make, or torch (tests/python).
NATIVE = {"autograd", "calibrating", "localizing", "recording", "simulating", "site", "studying", "tracing"}
PATHS = f"{STAGED}:{ROOT}/tests/clients:{ROOT}/tests/clients/stubs:{ROOT}/tests/support"


def run(*words: object, **variables: str) -> str:
    done = subprocess.run(
        [str(word) for word in words],
        env={**os.environ, **variables},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=SOURCES,
    )
    assert done.returncode == 0, done.stdout
    return done.stdout


@pytest.fixture(scope="module")
def mypy(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The words of its command, with what it keeps from one call to the next."""
    cache = str(tmp_path_factory.mktemp("mypy"))
    configuration = str(SOURCES / "pyproject.toml")
    words = ["--strict", "--cache-dir", cache, "--config-file", configuration]
    return [sys.executable, "-m", "mypy", *words]


def test_mypy_finds_nothing_under_strict(mypy: list[str]) -> None:
    run(*mypy, "-p", "rayloc", MYPYPATH=PATHS)
    programs = [*SOURCES.glob("examples/*.py"), *ROOT.glob("tests/clients/*.py")]
    run(*mypy, *programs, MYPYPATH=PATHS)


def test_mypy_would_find_a_wrong_type(mypy: list[str], tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.py"
    wrong.write_text(
        "import rayloc\n"
        "for message in rayloc.Subscriber():\n"
        "    if message.location is not None:\n"
        "        print(message.location.position.nowhere)\n"
    )
    environment = {**os.environ, "MYPYPATH": PATHS}
    done = subprocess.run([*mypy, str(wrong)], env=environment, capture_output=True, text=True)
    assert '"Point" has no attribute "nowhere"' in done.stdout, done.stdout
    assert "Found 1 error" in done.stdout


def test_pip_as_the_readme_has_it_makes_the_same_package_as_cmake(tmp_path: Path) -> None:
    copy = tmp_path / "deploy/clients/python"  # setuptools writes beside its sources
    copy.parent.mkdir(parents=True)
    run("cp", "-r", SOURCES, copy)
    run("cp", "-r", ROOT / "proto", tmp_path / "proto")
    (commands,) = [each for each in blocks("deploy/clients/README.md", "sh") if "pip" in each]
    # Its dependencies are Debian's packages, wherever the tests run.
    run("env", "-C", tmp_path, "bash", "-euc", commands, PIP_NO_INDEX="1")
    installed = imported_from(tmp_path / "VENV/bin/python", tmp_path)
    assert installed.is_relative_to(tmp_path / "VENV")
    assert contents(installed) == contents(STAGED / "rayloc")
    script = "import rayloc; rayloc.load_scene"
    words = [str(tmp_path / "VENV/bin/python"), "-c", script]
    environment = {**os.environ, "PYTHONPATH": ""}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, cwd=tmp_path)
    assert "rayloc._engine is missing: the engine is a native module" in done.stderr


def test_cmake_installs_it_where_the_readme_says(tmp_path: Path) -> None:
    readme = (ROOT / "deploy/clients/README.md").read_text()
    (words,) = re.findall(r"`(cmake --install BUILD [^`]*)`", readme)
    command = words.replace("BUILD", os.environ["RAYLOC_BUILD"]).replace("PREFIX", str(tmp_path))
    (folder,) = re.findall(r"the Python package into `([^`]*)`", readme)
    run(*command.split())
    installed = imported_from(Path(sys.executable), tmp_path, PYTHONPATH=str(tmp_path / folder))
    assert installed == tmp_path / folder / "rayloc"
    assert contents(installed) == contents(STAGED / "rayloc")


def imported_from(python: Path, folder: Path, **variables: str) -> Path:
    """Where that Python, run in that folder, has the whole package from."""
    modules = ", ".join(
        ".".join(file.relative_to(STAGED).with_suffix("").parts)
        for file in sorted(STAGED.glob("rayloc/**/*.py"))
        if file.name != "__init__.py" and file.stem not in NATIVE
    )
    environment = {"PYTHONPATH": "", **variables}
    script = f"import {modules}; print(rayloc.__file__)"
    return Path(run("env", "-C", folder, python, "-c", script, **environment).strip()).parent


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*.py*")
        if "__pycache__" not in file.parts
    }


def test_it_has_the_version_of_the_whole() -> None:
    whole = re.search(r"project\(rayloc VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())
    own = re.search(r'^version = "(.*)"', (SOURCES / "pyproject.toml").read_text(), re.M)
    assert whole is not None and own is not None
    assert own[1] == whole[1]
