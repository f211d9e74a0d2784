"""Input of a wrong shape, type or value raises an exception that names it, and never ends the interpreter."""

from __future__ import annotations

from typing import Any, Callable

import numpy as np
import pytest
import rayloc
from conftest import MEETING_ROOM

TX: Any = rayloc.Transmitter((0.4, 1.0, 1.5))
RX: Any = rayloc.Receiver((-1.4, 1.05, 1.2))
GRID = rayloc.OfdmGrid.of(5.19e9, count=16)
NAN = float("nan")
Call = Callable[[Any], object]


def paths(room: Any) -> Any:
    return rayloc.trace(room, TX, RX)


def gradient(room: Any, adjoint: Any, names: Any = ("rx",)) -> object:
    return rayloc.gradient(paths(room), GRID, adjoint, names)


def changed(room: Any, by: Any) -> object:
    return rayloc.changed(rayloc.Link(room, TX, RX), ["tx.0"], by)


WRONG: list[tuple[str, Call, type[Exception], str]] = [
    # Shapes.
    ("adjoint too short", lambda room: gradient(room, np.ones(3, complex)), rayloc.Error, "one value a tone"),
    ("adjoint of two axes", lambda room: gradient(room, np.ones((16, 1), complex)), rayloc.Error, "one value a tone"),
    ("change of two axes", lambda room: changed(room, [[1.0]]), rayloc.Error, "one value for each"),
    ("position of two numbers", lambda room: rayloc.Receiver((1.0, 2.0)), TypeError, "incompatible"),
    ("bounds of one corner", lambda room: rayloc.radio_map(room, TX, bounds=((0, 0),)), TypeError, "incompatible"),
    # Types.
    ("adjoint of text", lambda room: gradient(room, np.array(["a"] * 16)), TypeError, "incompatible"),
    ("adjoint of objects", lambda room: gradient(room, np.array([object()] * 16)), TypeError, "incompatible"),
    ("names in one text", lambda room: gradient(room, np.ones(16), "rx"), TypeError, "incompatible"),
    ("change by text", lambda room: changed(room, ["a"]), ValueError, "float"),
    ("change by a complex number", lambda room: changed(room, [1j]), TypeError, "complex"),
    ("depth with a fraction", lambda room: rayloc.trace(room, TX, RX, max_depth=1.5), TypeError, "incompatible"),  # type: ignore[call-overload]
    ("no antenna", lambda room: rayloc.trace(room, [TX, None], RX), TypeError, "incompatible"),  # type: ignore[list-item]
    ("no scene", lambda room: rayloc.trace("room.xml", TX, RX), TypeError, "incompatible"),  # type: ignore[call-overload]
    ("tones with fractions", lambda room: rayloc.OfdmGrid(5e9, 1e5, [0.5]), TypeError, "incompatible"),  # type: ignore[list-item]
    ("no grid", lambda room: rayloc.cfr(paths(room), "5e9"), TypeError, "incompatible"),  # type: ignore[arg-type]
    # Values.
    ("adjoint not finite", lambda room: gradient(room, np.full(16, NAN + 0j)), rayloc.Error, "not finite"),
    ("change not finite", lambda room: changed(room, [NAN]), rayloc.Error, "not finite"),
    ("change to no material", lambda room: rayloc.changed(rayloc.Link(room, TX, RX), ["thickness.wood"], [-5]), rayloc.Error, "thickness"),
    ("material unknown", lambda room: gradient(room, np.ones(16), ["eps_r.unobtanium"]), rayloc.Error, "no material 'unobtanium'.*wood"),
    ("object unknown", lambda room: room.vertices("teapot"), rayloc.Error, "no object 'teapot'"),
    ("softness not finite", lambda room: rayloc.trace(room, TX, RX, softness=NAN), rayloc.Error, "softness"),
    ("position not finite", lambda room: rayloc.Transmitter((NAN, 0, 0)), rayloc.Error, "finite"),
    ("orientation not finite", lambda room: rayloc.Transmitter((0, 0, 0), (np.inf, 0, 0)), rayloc.Error, "finite"),
    ("pattern unknown", lambda room: rayloc.Transmitter((0, 0, 0), pattern="dish"), rayloc.Error, "'dish'"),
    ("polarization unknown", lambda room: rayloc.Receiver((0, 0, 0), polarization="X"), rayloc.Error, "'X'"),
    ("centre not finite", lambda room: rayloc.OfdmGrid(NAN, 1e5, [0]), rayloc.Error, "finite"),
    ("tones that descend", lambda room: rayloc.OfdmGrid(5e9, 1e5, [1, 0]), rayloc.Error, "ascends"),
    ("frequency not finite", lambda room: rayloc.load_scene(MEETING_ROOM / "scene.xml", NAN), rayloc.Error, "frequency"),
    ("map height not finite", lambda room: rayloc.radio_map(room, TX, height=NAN), rayloc.Error, "height"),
    ("no diffuse paths", lambda room: paths(room).diffuse(), rayloc.Error, "diffuse_reflection"),
    ("site absent", lambda room: rayloc.Localizer("/absent"), rayloc.Error, "/absent/site.toml"),
    ("seed below 0", lambda room: rayloc.calibrate(MEETING_ROOM, [], "a.csv", "/absent/out", seed=-1), ValueError, "seed"),
    ("holdout not finite", lambda room: rayloc.calibrate(MEETING_ROOM, [], "a.csv", "/absent/out", holdout=NAN), ValueError, "holdout"),
    ("offset not finite", lambda room: rayloc.evaluate("a", "b", time_offset=NAN), ValueError, "time_offset"),
]  # fmt: skip


@pytest.mark.parametrize("call, kind, text", [one[1:] for one in WRONG], ids=[one[0] for one in WRONG])
def test_it_raises(room: rayloc.Scene, call: Call, kind: type[Exception], text: str) -> None:
    with pytest.raises(kind, match=text):
        call(room)
