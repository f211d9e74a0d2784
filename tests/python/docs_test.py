"""Every public name documents shapes, units, frames, errors and source, and has types."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest
import rayloc
import rayloc._engine as native
import rayloc.calibrating
import rayloc.localizing
import rayloc.recording
import rayloc.simulating
import rayloc.site
import rayloc.studying
import rayloc.tracing

MODULES = [
    rayloc.calibrating,
    rayloc.localizing,
    rayloc.recording,
    rayloc.simulating,
    rayloc.site,
    rayloc.studying,
    rayloc.tracing,
]
WORDS = ("Shapes:", "Units:", "Frame:", "Errors:", "Source:")
ROOT = Path(__file__).resolve().parents[2]
NAMES = [(module, name) for module in MODULES for name in module.__all__]


@pytest.mark.parametrize("module, name", NAMES, ids=[name for _, name in NAMES])
def test_it_is_documented(module: ModuleType, name: str) -> None:
    thing = getattr(module, name)
    text = inspect.getdoc(thing) or ""
    assert [word for word in WORDS if word not in text] == []
    source = text.split("Source:")[1]
    for path in [word.strip(",.;") for word in source.split() if "/" in word]:
        assert (ROOT / path).exists(), f"{path} is no file"
    if inspect.isfunction(thing):
        for argument in inspect.signature(thing).parameters:
            assert f"{argument}:" in text, f"{argument} is not documented"


def public_members() -> list[tuple[str, object]]:
    found: list[tuple[str, object]] = []
    for module, name in NAMES:
        thing = getattr(module, name)
        if inspect.isclass(thing) and not issubclass(thing, (Exception, tuple)):
            members = [(key, value) for key, value in vars(thing).items() if not key.startswith("_")]
            found += [(f"{name}.{key}", value) for key, value in members]
    return found


@pytest.mark.parametrize("name, member", public_members(), ids=lambda value: str(value)[:40])
def test_members_have_a_sentence(name: str, member: object) -> None:
    text = member.__func__.__doc__ if isinstance(member, staticmethod) else member.__doc__
    assert text and len(text.strip()) > 3, name


def test_the_package_offers_what_its_modules_have() -> None:
    offered = set(rayloc._ENGINE)
    assert offered == {name for module in MODULES for name in module.__all__}
    assert offered < set(rayloc.__all__) == set(dir(rayloc))
    assert rayloc.load_scene is rayloc.tracing.load_scene
    with pytest.raises(AttributeError, match="teapot"):
        rayloc.teapot


def test_stubs_have_the_names_of_the_module() -> None:
    pytest.importorskip("mypy", reason="mypy is not installed")
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "rayloc._engine", "--ignore-missing-stub", "--concise"],
        env={**os.environ, "MYPYPATH": os.environ["RAYLOC_PYTHON"]},
        capture_output=True,
        text=True,
    )
    wrong = [line for line in done.stdout.splitlines() if "is not present" in line]
    assert wrong == [] and "rror: not checking" not in done.stdout, done.stdout + done.stderr
    stub = (Path(os.environ["RAYLOC_PYTHON"]) / "rayloc/_engine.pyi").read_text()
    for name, thing in vars(native).items():
        if not name.startswith("_"):
            assert f"class {name}" in stub or f"def {name}(" in stub, name
        if inspect.isclass(thing):
            for key in vars(thing):
                if not key.startswith("_"):
                    assert f"def {key}(" in stub or f"{key}: " in stub, f"{name}.{key}"


@pytest.mark.parametrize("missing, package", [("numpy", "python3-numpy"), ("rayloc._engine", "PYTHONPATH=BUILD")])
def test_what_is_missing_is_named_with_its_package(missing: str, package: str) -> None:
    program = f"import sys; sys.modules[{missing!r}] = None; import rayloc; rayloc.load_scene"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode != 0
    assert package in done.stderr.splitlines()[-1], done.stderr


def test_who_only_subscribes_loads_no_engine() -> None:
    program = (
        "import sys, rayloc; rayloc.Subscriber;"
        "print('numpy' in sys.modules, 'rayloc._engine' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
