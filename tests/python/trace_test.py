"""Paths, channels and gradients from Python: the reference channels, and the bits of C++."""

from __future__ import annotations

import gc
import json
import resource
import threading
import time
from typing import Any

import numpy as np
import pytest
import rayloc
from conftest import MEETING_ROOM, golden, program

TX = (0.412, 1.037, 1.519)
RX = (-1.45, 1.13, 2.25)
GRID = rayloc.OfdmGrid.of(5.19e9)
EVERYTHING = [
    "tx", "rx", "tx_orientation", "rx_orientation", "tx_array_turn", "rx_array_turn",
    "tx_gain", "rx_gain", "table", "offset.table", "eps_r.wood", "sigma.wood", "thickness.wood",
]  # fmt: skip


def link(room: rayloc.Scene, **options: Any) -> rayloc.Paths:
    return rayloc.trace(
        room,
        rayloc.Transmitter(TX, (0.1, 0.2, 0.3)),
        rayloc.Receiver(RX, (-0.65, 0.0, 0.0)),
        **options,
    )


def told(*words: object) -> dict[str, Any]:
    """The output of the program in C++ for the same link, with all digits."""
    answer: dict[str, Any] = json.loads(
        program(
            "trace", MEETING_ROOM / "scene.xml", "--frequency", "5.18e9", "--tx", "0.412,1.037,1.519",
            "--rx", "-1.45,1.13,2.25", "--orientation-tx", "0.1,0.2,0.3", "--orientation-rx=-0.65,0,0",
            "--json", *words,
        )  # fmt: skip
    )
    return answer


def complex_of(pairs: list[list[float]]) -> np.ndarray[Any, np.dtype[np.complex128]]:
    return np.array([complex(*pair) for pair in pairs])


@pytest.mark.parametrize("element", [0, 1, 2])
def test_paths_are_those_of_the_reference_channels(room: rayloc.Scene, element: int) -> None:
    reference = golden("meeting_room")
    turn = tuple(reference["transmitter"]["orientation"])
    tx = rayloc.Transmitter(reference["transmitter"]["elements"][element], turn)
    for expected in reference["links"]:
        if expected["tx_element"] != element:
            continue
        rx = rayloc.Receiver(reference["receivers"][expected["rx"]])
        paths = rayloc.trace(room, tx, rx, max_depth=3)
        assert len(paths) == len(expected["paths"])
        ours, theirs = np.argsort(paths.tau), np.argsort([one["tau"] for one in expected["paths"]])
        assert np.allclose(
            paths.tau[ours], [expected["paths"][i]["tau"] for i in theirs], rtol=1e-12, atol=0
        )
        h = rayloc.cfr(paths, rayloc.OfdmGrid(5.18e9 - 20e6, 312_500.0, range(128)))
        wanted = complex_of(expected["cfr"])
        assert np.abs(h - wanted).max() <= 1e-8 * np.abs(wanted).max()


@pytest.mark.parametrize("words, options", [((), {}), (("--transmission",), {"refraction": True})])
def test_every_number_has_the_bits_of_cpp(
    room: rayloc.Scene, words: tuple[str, ...], options: dict[str, Any]
) -> None:
    expected = told("--cfr", "5.19e9,312500,128", "--gradient", "power:" + ",".join(EVERYTHING), *words)
    paths = link(room, **options)
    assert paths.tau.tolist() == [path["tau"] for path in expected["paths"]]
    assert paths.a.tolist() == [complex(*path["a"]) for path in expected["paths"]]
    angles = np.stack([paths.theta_t, paths.phi_t, paths.theta_r, paths.phi_r], axis=1)
    assert angles.tolist() == [path["angles"] for path in expected["paths"]]
    for i, path in enumerate(expected["paths"]):
        count = len(path["objects"])
        assert [room.objects[k] for k in paths.objects[:count, i]] == path["objects"]
        assert paths.vertices[:count, i].tolist() == path["vertices"]
        assert np.all(paths.interactions[count:, i] == 0)
        letters = "".join({1: "R", 4: "T", 16: "S"}[k] for k in paths.interactions[:count, i])
        assert letters == path["kinds"]
    h = rayloc.cfr(paths, GRID)
    assert h.tolist() == [complex(*pair) for pair in expected["cfr"]]
    names, gradient = rayloc.gradient(paths, GRID, 2 * h, EVERYTHING)
    assert dict(zip(names, gradient.tolist())) == expected["gradient"]


def test_derivatives_of_the_channel_are_those_of_its_differences(room: rayloc.Scene) -> None:
    start = rayloc.Link(room, rayloc.Transmitter(TX), rayloc.Receiver(RX))
    names = ["tx.0", "rx.2", "object.table.2", "eps_r.wood", "tx_gain"]

    def h(at: rayloc.Link) -> np.ndarray[Any, np.dtype[np.complex128]]:
        return at.gain * rayloc.cfr(rayloc.trace(at.scene, at.tx, at.rx), GRID)

    rows = rayloc.trace(start.scene, start.tx, start.rx).derivatives(names).cfr(GRID)
    for i, name in enumerate(names):
        step = 1e-5
        ahead, behind = (h(rayloc.changed(start, [name], [by])) for by in (step, -step))
        assert np.allclose((ahead - behind) / (2 * step), rows[i], rtol=0, atol=1e-5 * np.abs(rows[i]).max())


def test_arrays_are_views_that_outlive_their_link(room: rayloc.Scene) -> None:
    paths = link(room)
    a, tau, arrival = paths.a, paths.tau, paths.arrival
    wanted = [array.copy() for array in (a, tau, arrival)]
    del paths
    gc.collect()
    for _ in range(20):
        link(room, max_depth=2)  # would take the memory, if it were free
    for array, copy in zip([a, tau, arrival], wanted):
        assert not array.flags.owndata and not array.flags.writeable
        assert np.array_equal(array, copy)
    derivatives = link(room).derivatives(["rx"])
    assert not derivatives.a.flags.owndata and derivatives.a.shape == (len(a), 3)


def test_many_links_at_once_are_the_same_as_one_after_the_other(room: rayloc.Scene) -> None:
    tx = [rayloc.Transmitter((x, 0.1, 1.2)) for x in (-1.0, -0.3, 0.4)]
    rx = [rayloc.Receiver(RX), rayloc.Receiver((1.4, 1.0, 1.9))]
    together = rayloc.trace(room, tx, rx, max_depth=2)
    for t, one in enumerate(tx):
        for r, other in enumerate(rx):
            alone = rayloc.trace(room, one, other, max_depth=2)
            assert np.array_equal(together[t][r].a, alone.a)
            assert np.array_equal(together[t][r].tau, alone.tau)
    kept = rayloc.Tracer(room, max_depth=2).at(rx[0])
    assert np.array_equal(kept.trace(tx[1]).a, together[1][0].a)


def test_threads_trace_without_the_lock_of_python(room: rayloc.Scene) -> None:
    """While one thread is in the engine another runs Python: the counter moves meanwhile."""
    inside = threading.Event()
    done = threading.Event()

    def traces() -> None:
        inside.set()
        rayloc.trace(room, [rayloc.Transmitter(TX)] * 40, [rayloc.Receiver(RX)] * 4, refraction=True)
        done.set()

    thread = threading.Thread(target=traces)
    thread.start()
    inside.wait()
    turns = 0
    while not done.is_set():
        time.sleep(0.001)
        turns += 1
    thread.join()
    assert turns > 3


def test_ten_thousand_traces_need_no_more_memory_than_a_thousand(room: rayloc.Scene) -> None:
    """By the greatest memory that the process ever had."""
    at_rx = rayloc.Tracer(room, max_depth=1).at(rayloc.Receiver(RX))

    def traces(count: int) -> int:
        for i in range(count):
            paths = at_rx.trace(rayloc.Transmitter((0.4, 0.001 * (i % 900), 1.2)))
            rayloc.cfr(paths, GRID)
            paths.derivatives(["rx"]).a.sum()
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # [kB]

    after_warming = traces(1000)
    assert traces(9000) - after_warming < 4096


def test_errors_have_the_words_of_the_command_line(room: rayloc.Scene, tmp_path: Any) -> None:
    broken = tmp_path / "broken.xml"
    broken.write_text("<scene><shape type='teapot' id='a'/></scene>")
    with pytest.raises(rayloc.Error, match=r"broken.xml:1:\d+: .*teapot") as caught:
        rayloc.load_scene(broken)
    assert caught.value.kind == "bad_input"
    assert isinstance(caught.value, ValueError)
    with pytest.raises(rayloc.Error, match="no-\ufffd.xml does not exist"):
        rayloc.load_scene(tmp_path / "no-\udcff.xml")  # a byte that is no UTF-8
    with pytest.raises(rayloc.Error, match="no material 'wod'.*wood"):
        link(room).derivatives(["eps_r.wod"])
    with pytest.raises(rayloc.Error, match="same point"):
        rayloc.trace(room, rayloc.Transmitter(RX), rayloc.Receiver(RX))
    with pytest.raises(rayloc.Error, match="finite"):
        rayloc.Transmitter((float("nan"), 0, 0))
    with pytest.raises(rayloc.Error, match="max_depth"):
        rayloc.Tracer(room, max_depth=-1)
    with pytest.raises(rayloc.Error, match="one value a tone"):
        rayloc.gradient(link(room), GRID, np.ones(3, complex), ["rx"])


def test_a_link_without_paths_has_empty_arrays(room: rayloc.Scene) -> None:
    paths = rayloc.trace(room, rayloc.Transmitter((50, 50, 50)), rayloc.Receiver(RX), max_depth=0)
    assert len(paths) == 0 and paths.a.shape == (0,) and paths.arrival.shape == (0, 3)
    assert not rayloc.cfr(paths, GRID).any()
    assert paths.derivatives(["rx"]).tau.shape == (0, 3)


def test_npz_of_the_command_line_is_what_python_has(room: rayloc.Scene, tmp_path: Any) -> None:
    file = tmp_path / "link.npz"
    told_nothing = program(
        "trace", MEETING_ROOM / "scene.xml", "--frequency", "5.18e9", "--tx", "0.4,1,1.5",
        "--rx", "-1.4,1.05,1.2", "--cfr", "5.19e9,312500,128", "--gradient", "power:rx", "--out", file,
    )  # fmt: skip
    assert told_nothing == ""
    paths = rayloc.trace(room, rayloc.Transmitter((0.4, 1, 1.5)), rayloc.Receiver((-1.4, 1.05, 1.2)))
    with np.load(file) as arrays:
        assert np.array_equal(arrays["a"], paths.a)
        assert np.array_equal(arrays["tau"], paths.tau)
        assert np.array_equal(arrays["objects"], paths.objects)
        assert np.array_equal(arrays["vertices"], paths.vertices, equal_nan=True)
        assert np.array_equal(arrays["cfr"], rayloc.cfr(paths, GRID))
        assert np.array_equal(arrays["frequencies"], GRID.frequencies)
        assert arrays["gradient_names"].tolist() == [b"rx.0", b"rx.1", b"rx.2"]
        assert arrays["frequency"].item() == 5.18e9
        assert [name.decode() for name in arrays["object_names"]] == room.objects
