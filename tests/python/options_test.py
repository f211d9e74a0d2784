"""Diffraction, rough surfaces and radio maps from Python: the numbers of the program in C++."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rayloc
from conftest import MEETING_ROOM, program

SCENE = MEETING_ROOM / "scene.xml"
TX = (0.412, 1.037, 0.519)  # below the table, so that edges matter
RX = (-1.45, 1.13, 2.25)
GRID = rayloc.OfdmGrid.of(5.19e9, count=16)
ROUGH = """<scene version="3.0.0"><bsdf type="itu-radio-material" id="mat-wall">
<string name="type" value="concrete"/><float name="scattering_coefficient" value="0.4"/></bsdf>
<shape type="cube" id="room"><transform name="to_world"><scale x="2" y="1.5" z="1.25"/>
<translate x="2" y="1.5" z="1.25"/></transform><ref id="mat-wall" name="bsdf"/></shape></scene>"""
IN_ROUGH = (rayloc.Transmitter((1, 1, 1)), rayloc.Receiver((3, 2, 1.5)))


@pytest.fixture(scope="module")
def rough(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("rough") / "rough.xml"
    file.write_text(ROUGH)
    return file


def told(*words: object) -> dict[str, Any]:
    answer: dict[str, Any] = json.loads(program("trace", *words, "--json"))
    return answer


def assert_same(paths: rayloc.Paths, expected: dict[str, Any]) -> None:
    assert paths.tau.tolist() == [path["tau"] for path in expected["paths"]]
    assert paths.a.tolist() == [complex(*path["a"]) for path in expected["paths"]]


@pytest.mark.parametrize("edges,flags", [(1, ()), (2, ("--double-diffraction",))])
def test_edges_are_those_of_the_program_and_have_derivatives(
    room: rayloc.Scene, edges: int, flags: tuple[str, ...]
) -> None:
    names = ["tx.0", "rx.2", "eps_r.wood"]
    expected = told(
        SCENE, "--frequency", "5.18e9", "--tx", "0.412,1.037,0.519", "--rx=-1.45,1.13,2.25", "--depth", "2",
        "--diffraction", *flags, "--cfr", "5.19e9,312500,16", "--gradient", "power:" + ",".join(names),
    )  # fmt: skip
    tx, rx = rayloc.Transmitter(TX), rayloc.Receiver(RX)
    paths = rayloc.trace(room, tx, rx, max_depth=2, diffraction=edges)
    assert_same(paths, expected)
    letters = {1: "R", 8: "D"}
    kinds = ["".join(letters[kind] for kind in path if kind) for path in paths.interactions.T.tolist()]
    assert kinds == [path["kinds"] for path in expected["paths"]]
    assert any("D" * edges in kind for kind in kinds)
    assert len(paths) > len(rayloc.trace(room, tx, rx, max_depth=2, diffraction=edges - 1))
    h = rayloc.cfr(paths, GRID)
    found, gradient = rayloc.gradient(paths, GRID, 2 * h, names)
    assert dict(zip(found, gradient.tolist())) == expected["gradient"]
    together = rayloc.trace(room, [tx], rx, max_depth=2, diffraction=edges)
    assert np.array_equal(together[0][0].a, paths.a)


def test_what_rough_surfaces_scatter_is_what_the_program_prints(rough: Path) -> None:
    ends = ("--tx", "1,1,1", "--rx", "3,2,1.5", "--diffuse", "--diffuse-reflections", "1")
    gradient = ("--cfr", "5.18e9,312500,16", "--gradient", "power:scattering.wall")
    expected = told(rough, *ends, *gradient)
    scene = rayloc.load_scene(rough)
    paths = rayloc.trace(scene, *IN_ROUGH, diffuse_reflection=True)
    assert_same(paths, expected)
    found = paths.diffuse(reflections=1)
    wanted = expected["diffuse"]
    assert found.total_power == wanted["power"]
    assert found.mean_delay == wanted["mean_delay"] and found.delay_spread == wanted["delay_spread"]
    bins = found.profile(wanted["first"], wanted["step"], len(wanted["profile"]))
    assert bins.tolist() == wanted["profile"]
    grid = rayloc.OfdmGrid.of(5.18e9, count=16)
    names, by = rayloc.gradient(paths, grid, 2 * rayloc.cfr(paths, grid), ["scattering.wall"])
    assert dict(zip(names, by.tolist())) == expected["gradient"]


def test_echoes_are_views_of_where_they_come_from(rough: Path) -> None:
    tx, rx = IN_ROUGH
    paths = rayloc.trace(rayloc.load_scene(rough), tx, rx, diffuse_reflection=True)
    echoes = paths.diffuse()
    power, tau, vertices = echoes.power, echoes.tau, echoes.vertices
    assert len(echoes) == len(power) > 100 and vertices.shape == (len(power), 3)
    assert not power.flags.owndata and not power.flags.writeable
    assert power.sum() == pytest.approx(echoes.total_power) and echoes.error < 0.05 * echoes.total_power
    # Once scattered: the way is that from the one end over the point to the other.
    out, back = vertices - np.array(tx.position), vertices - np.array(rx.position)
    length = np.linalg.norm(out, axis=1) + np.linalg.norm(back, axis=1)
    assert np.allclose(tau, length / 299_792_458.0, rtol=1e-12)
    assert np.allclose(echoes.departure, out / np.linalg.norm(out, axis=1)[:, None])
    assert np.allclose(echoes.arrival, back / np.linalg.norm(back, axis=1)[:, None])
    # Scattered power is not reflected: 1 - S^2 of the power of each reflection is left.
    smooth = rayloc.trace(rayloc.load_scene(rough), tx, rx)
    depth = (smooth.interactions > 0).sum(axis=0)
    assert np.allclose(np.abs(paths.a) ** 2, (1 - 0.4**2) ** depth * np.abs(smooth.a) ** 2, rtol=1e-9)


def test_options_that_do_not_go_together_are_refused(room: rayloc.Scene, rough: Path) -> None:
    tx, rx = rayloc.Transmitter(TX), rayloc.Receiver(RX)
    with pytest.raises(rayloc.Error, match="hard edges only"):
        rayloc.trace(room, tx, rx, softness=0.1, diffraction=True)
    with pytest.raises(rayloc.Error, match="1 .or True. or 2 edges"):
        rayloc.trace(room, tx, rx, diffraction=3)
    with pytest.raises(rayloc.Error, match="no material of the scene scatters"):
        rayloc.trace(room, tx, rx, diffuse_reflection=True)
    with pytest.raises(rayloc.Error, match="diffuse_reflection=True"):
        rayloc.trace(room, tx, rx).diffuse()
    paths = rayloc.trace(rayloc.load_scene(rough), *IN_ROUGH, diffuse_reflection=True)
    with pytest.raises(rayloc.Error, match="0 to 2"):
        paths.diffuse(reflections=3)
    with pytest.raises(rayloc.Error, match="step"):
        paths.diffuse().profile(0.0, 0.0, 10)


def test_a_radio_map_is_that_of_scene_map(room: rayloc.Scene, tmp_path: Path) -> None:
    out = tmp_path / "map"
    program(
        "scene", "map", SCENE, "--frequency", "5.18e9", "--antenna", "0.4,1,1.5", "--antenna=-1.4,1.05,1.2",
        "--step", "0.4", "--height", "1", "--depth", "1", "--transmission", "--out", out,
    )  # fmt: skip
    antennas = [rayloc.Transmitter((0.4, 1, 1.5)), rayloc.Transmitter((-1.4, 1.05, 1.2))]
    found = rayloc.radio_map(room, antennas, cell_size=0.4, height=1.0, max_depth=1, refraction=True)
    with np.load(out / "radio-map.npz") as arrays:
        for name in ("path_gain", "delay_spread", "path_count", "strongest"):
            assert np.array_equal(arrays[name], getattr(found, name), equal_nan=name == "delay_spread")
        assert np.array_equal(arrays["x"], found.cell_centers[0, :, 0])
        assert np.array_equal(arrays["y"], found.cell_centers[:, 0, 1])
    assert found.path_gain.shape == (2, *found.strongest.shape)
    # A cell is the sum over the paths to its middle.
    place = tuple(found.cell_centers[1, 2])
    paths = rayloc.trace(
        room, rayloc.Transmitter(place), rayloc.Receiver((0.4, 1, 1.5)), max_depth=1, refraction=True
    )
    assert found.path_gain[0, 1, 2] == pytest.approx((np.abs(paths.a) ** 2).sum(), rel=1e-12)


def test_what_is_no_radio_map_is_refused(room: rayloc.Scene) -> None:
    antenna = rayloc.Transmitter(TX)
    part = rayloc.radio_map(room, antenna, 0.5, bounds=((0, 0), (1, 1)), max_depth=0)
    assert part.path_gain.shape == (1, 2, 2) and part.cell_centers[0, 0, :2].tolist() == [0.25, 0.25]
    cases: list[dict[str, Any]] = [{"cell_size": 0.0}, {"cell_size": 1e-5}, {"height": float("nan")}]
    for wrong in cases:
        with pytest.raises(rayloc.Error, match="radio_map"):
            rayloc.radio_map(room, antenna, **wrong)
    with pytest.raises(rayloc.Error, match="bounds"):
        rayloc.radio_map(room, antenna, bounds=((1, 0), (0, 1)))
    with pytest.raises(rayloc.Error):  # a strip without an area has cells as well
        rayloc.radio_map(room, antenna, 0.1, bounds=((0, 0), (0, 1e7)))
    with pytest.raises(rayloc.Error, match="at least one"):
        rayloc.radio_map(room, [])
