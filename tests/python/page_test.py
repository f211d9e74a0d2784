"""The page for users of Sionna RT: its code runs, and its results are those that it states."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rayloc
from conftest import BIN, MEETING_ROOM, ROOT
from snippets import blocks

PAGE = ROOT / "python/FROM_SIONNA_RT.md"


@pytest.fixture(scope="module")
def said(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The variables that the ten blocks leave behind."""
    codes = blocks(PAGE)
    assert len(codes) == 10
    folder = tmp_path_factory.mktemp("page")
    (folder / "tests").symlink_to(ROOT / "tests")
    names: dict[str, Any] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("PATH", f"{BIN}{os.pathsep}{os.environ['PATH']}")
        for code in codes:
            exec(compile(code, str(PAGE), "exec"), names)
    names["folder"] = folder
    return names


def test_the_channels_of_the_page_are_one(said: dict[str, Any]) -> None:
    """Impulse response, frequency response and taps are of the same paths, as Sionna RT defines them."""
    a, tau, h = said["a"], said["tau"], said["h"]
    offset = said["grid"].frequencies - said["scene"].frequency
    assert np.allclose(np.exp(-2j * np.pi * offset[:, None] * tau) @ a, h, rtol=1e-9)
    # The taps of a band, summed over many, are the response in its middle.
    far = np.sinc(np.arange(-4000, 4000)[:, None] - 40e6 * tau) @ a
    assert abs(far.sum() - a.sum()) < 2e-3 * np.abs(a).sum()
    assert np.array_equal(said["taps"], (np.sinc(np.arange(-4000, 4000)[:, None] - 40e6 * tau) @ a)[4000:4016])


def test_what_the_page_traces_is_what_it_names(said: dict[str, Any]) -> None:
    paths, links = said["paths"], said["links"]
    assert 4 in paths.interactions and 8 not in paths.interactions  # refraction
    assert len(links) == 1 and len(links[0]) == 2 and 8 in links[0][0].interactions  # diffraction
    distance = np.subtract(said["rx"][1].position, said["rx"][0].position)
    assert np.linalg.norm(distance) == pytest.approx(0.5 * 299_792_458.0 / 5.18e9)
    assert said["wood"] == said["scene"].radio_materials["wood"]["relative_permittivity"] > 1.0
    assert np.hypot(*(said["loudest"][:2] - np.array(said["tx"].position[:2]))) < 0.5


def test_the_step_of_the_page_goes_down(said: dict[str, Any]) -> None:
    step = said["step"]
    after = rayloc.cfr(rayloc.trace(step.scene, step.tx, step.rx, 3, True), said["grid"])
    assert (np.abs(after) ** 2).sum() < (np.abs(said["h"]) ** 2).sum()


def test_the_picture_of_the_page_is_one(said: dict[str, Any]) -> None:
    picture: Path = said["folder"] / "room.svg"
    assert "<svg" in picture.read_text()
    assert (MEETING_ROOM / "site.toml").exists()
