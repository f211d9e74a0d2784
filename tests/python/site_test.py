"""A site from Python: its antennas, its scene, its transmitters, and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import rayloc
from conftest import MEETING_ROOM


def test_a_site_can_be_traced() -> None:
    site = rayloc.load_site(MEETING_ROOM)
    assert site.directory == MEETING_ROOM and not site.is_calibrated
    assert list(site.access_points) == ["ap1", "ap2", "ap3"]
    antennas = site.access_points["ap1"]
    assert len(antennas) == len(site.rx_chains["ap1"]) == 3
    spacing = np.diff([antenna.position for antenna in antennas], axis=0)
    np.testing.assert_allclose(np.linalg.norm(spacing, axis=1), 0.089, atol=1e-9)
    assert all(len(antenna.orientation) == 3 for antenna in antennas)
    fixed = [one for one in site.transmitters.values() if one.antenna is not None]
    assert len(fixed) == 1 and len(site.transmitters) > 1
    transmitter = fixed[0].antenna
    assert transmitter is not None
    paths = rayloc.trace(site.scene, transmitter, antennas[0], max_depth=site.depth)
    assert len(rayloc.cfr(paths, site.grid)) == len(site.grid.frequencies)
    distance = np.linalg.norm(np.subtract(transmitter.position, antennas[0].position))
    assert np.isclose(paths.tau.min() * 299792458.0, distance)


def test_the_scene_is_that_of_the_file() -> None:
    site = rayloc.load_site(MEETING_ROOM / "site.toml")
    scene = rayloc.load_scene(MEETING_ROOM / "scene.xml", site.scene.frequency)
    assert site.scene.objects == scene.objects
    np.testing.assert_array_equal(site.scene.bounds, scene.bounds)


def test_a_site_that_cannot_be_read_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(rayloc.Error, match="site.toml"):
        rayloc.load_site(tmp_path)
    (tmp_path / "site.toml").write_text('scene = "scene.xml"\nname = 3\n')
    with pytest.raises(rayloc.Error, match=r"site.toml:2:\d+"):
        rayloc.load_site(tmp_path)
