"""Drawn rooms are valid and reproducible; beliefs are read and counted as documented. Nothing is simulated."""
from __future__ import annotations

import cmath
import json
import math
import random
import tomllib
from pathlib import Path
from typing import Any

import pytest

from beliefs import add_ends, learned_times, learning_ends, phases_at_end, read_beliefs, read_bursts
from drawn_rooms import drawn_room
from room import Room
from table import percent, quantile, table
from walks import CLEAR_M, SPEEDS_M_S, walk

COUNT = 40
RATE_HZ = 20
ROUNDING_M = 1e-4  # of numbers in a plan


@pytest.fixture(scope="module")
def rooms() -> list[Room]:
    return [drawn_room(1, number) for number in range(COUNT)]


def test_furniture_is_inside_and_apart(rooms: list[Room]) -> None:
    for room in rooms:
        assert room.pieces
        for n, one in enumerate(room.pieces):
            assert room.has_space(one.centre, one.half)
            assert one.top < room.height
            for other in room.pieces[:n]:
                apart = [abs(one.centre[i] - other.centre[i]) - one.half[i] - other.half[i] for i in (0, 1)]
                assert max(apart) > 0


def test_boxes_are_inside_their_pieces(rooms: list[Room]) -> None:
    for piece in (one for room in rooms for one in room.pieces):
        for box in piece.boxes:
            c, s = abs(math.cos(math.radians(box.yaw))), abs(math.sin(math.radians(box.yaw)))
            reach = (c * box.size[0] + s * box.size[1]) / 2, (s * box.size[0] + c * box.size[1]) / 2
            assert all(abs(box.centre[i]) + reach[i] <= piece.half[i] + ROUNDING_M for i in (0, 1))
            assert box.centre[2] - box.size[2] / 2 > 0


def test_access_points_are_inside_and_apart(rooms: list[Room]) -> None:
    for room in rooms:
        assert len(room.access_points) == 3
        for n, one in enumerate(room.access_points):
            assert room.contains(one.position[:2])
            assert 1.8 < one.position[2] < room.height
            assert not any(piece.top > 1.5 and piece.is_near(one.position[:2], 0.0) for piece in room.pieces)
            assert all(math.dist(one.position[:2], other.position[:2]) >= 1.0 for other in room.access_points[:n])


def test_openings_are_in_their_walls(rooms: list[Room]) -> None:
    for room in rooms:
        plan = tomllib.loads(room.plan(3))
        for opening in plan["opening"]:
            length = math.dist(*room.walls()[int(opening["wall"].removeprefix("wall_")) - 1])
            for centre, size, most in zip(opening["centre"], opening["size"], (length, room.height)):
                assert size / 2 < centre < most - size / 2


def test_no_two_rooms_are_alike(rooms: list[Room]) -> None:
    shapes = {(tuple(room.outline), round(room.height, 4)) for room in rooms}
    assert len(shapes) == COUNT
    assert {room.kind for room in rooms} == {"rectangle", "corridor", "L"}


def test_a_room_depends_on_seed_and_number_alone(rooms: list[Room]) -> None:
    for number in (0, 7):
        assert drawn_room(1, number) == rooms[number]
        assert drawn_room(2, number) != rooms[number]


def test_a_plan_has_the_stated_number_of_access_points(rooms: list[Room]) -> None:
    for count in (1, 3):
        assert [ap["id"] for ap in tomllib.loads(rooms[0].plan(count))["access_point"]] == ["ap1", "ap2", "ap3"][:count]


def test_a_stated_plan_is_off_by_millimetres(rooms: list[Room]) -> None:
    for room in rooms:
        stated = room.stated(random.Random("stated"), 1.0)
        assert stated.plan(3) != room.plan(3)
        for true, other in zip(room.access_points, stated.access_points):
            assert 0 < math.dist(true.position, other.position) < 0.01
        for a, b in zip(room.outline, stated.outline):
            assert math.dist(a, b) < 0.01


def test_a_walk_keeps_clear_of_walls_and_furniture(rooms: list[Room]) -> None:
    for room in rooms[:8]:
        places = walk(room, random.Random("walk"), 20, RATE_HZ)
        assert len(places) == 20 * RATE_HZ
        assert places == walk(room, random.Random("walk"), 20, RATE_HZ)
        for place in places:
            assert room.has_space(place, (CLEAR_M / 2, CLEAR_M / 2))
            assert not any(piece.is_near(place, CLEAR_M / 2) for piece in room.pieces)
        # A step between two cells is rounded to a whole number of frames.
        assert all(math.dist(a, b) < 1.5 * SPEEDS_M_S[1] / RATE_HZ for a, b in zip(places, places[1:]))


# Chains of two access points, rotated by the simulator [degrees]; core 2 is the reference.
ROTATED = {"ap1": {2: 10.0, 0: 100.0, 3: -150.0}, "ap2": {2: 0.0, 0: 20.0, 3: 30.0}}
NOTICE = ("replay: access point {}: its chains are learned, rotated since the calibration: "
          "core 0 by {} degrees +- 7, core 3 by {} degrees +- 9 against core 2\n")


def bursts_of(*learning: str) -> list[dict[str, Any]]:
    return [{"learning": {ap: "3 bursts" for ap in one.split()}, "error_m": None, "inside": None} for one in learning]


def test_times_of_beliefs() -> None:
    bursts = bursts_of("ap1 ap2", "ap1 ap2", "ap1", "", "ap2", "", "")
    assert learned_times(bursts, "ap1") == [(3, None)]
    assert learned_times(bursts, "ap2") == [(2, 4), (5, None)]
    notices = NOTICE.format("ap2", 20, 90) + NOTICE.format("ap1", 95, -165) + NOTICE.format("ap2", 21, 30)
    beliefs = read_beliefs(notices, ROTATED, bursts)
    assert [(one["ap"], one["seconds"], one["error_deg"], one["stated_deg"], one["withdrawn_after"])
            for one in beliefs] == [("ap2", 0.4, 60.0, 9, 2), ("ap1", 0.6, 5.0, 9, None), ("ap2", 1.0, 1.0, 9, None)]
    assert learning_ends(bursts, beliefs, ["ap1", "ap2"]) == 3
    assert learning_ends(bursts, beliefs[:1], ["ap1", "ap2"]) == len(bursts)


def test_a_frame_on_the_edge_is_of_the_later_burst(tmp_path: Path) -> None:
    truth = [(1718100000 + n / RATE_HZ, 0.05 * n, 0.0) for n in range(20)]
    file = tmp_path / "fixes.jsonl"
    file.write_text("".join(json.dumps({
        "time": f"2024-06-11T10:00:00.{milliseconds:03}Z", "mode": "FIX_MODE_2D", "position": {"x": x, "y": 0.0},
        "accuracy_m": 0.1, "quality": {},
    }) + "\n" for milliseconds, x in ((550, 0.55), (600, 0.85))))
    bursts = read_bursts(file, truth)
    assert [one["error_m"] is None for one in bursts] == [True, True, False, False, True]
    assert [one["inside"] for one in bursts] == [None, None, True, False, None]
    assert bursts[3]["error_m"] == pytest.approx(0.25)


def test_errors_at_the_end(tmp_path: Path) -> None:
    def state(ap: str, knowledge: str) -> dict[str, Any]:
        factors = [cmath.rect(1.0, math.radians(phase)) for phase in (0.0, 93.0, -168.0)]
        return {"id": ap, "chains": knowledge, "cores": [2, 0, 3], "factor": [[one.real, one.imag] for one in factors],
                "phase_sigma_rad": [0.0, math.radians(2.0), math.radians(4.0)]}

    file = tmp_path / "chains.json"
    file.write_text(json.dumps({"access_points": [state("ap1", "learned"), state("ap2", "learning")]}))
    ends = phases_at_end(file, ROTATED)
    assert ends == {"ap1": {0: {"error": 3.0, "stated": 2.0}, 3: {"error": -8.0, "stated": 4.0}}}
    beliefs: list[dict[str, Any]] = [
        {"ap": ap, "withdrawn_after": withdrawn, "error_at_end_deg": None, "at_end_deg": None}
        for ap, withdrawn in (("ap1", 5), ("ap1", None), ("ap2", 3))
    ]
    add_ends(beliefs, ends)
    assert [one["error_at_end_deg"] for one in beliefs] == [None, 8.0, None]
    assert beliefs[1]["at_end_deg"] == ends["ap1"]


def belief(ap: str, seconds: float, error: float = 5.0, at_end: float | None = 5.0,
           withdrawn: int | None = None) -> dict[str, Any]:
    return {"ap": ap, "seconds": seconds, "error_deg": error, "error_at_end_deg": at_end, "withdrawn_after": withdrawn}


def row(room: int, aps: int, *beliefs: dict[str, Any]) -> dict[str, Any]:
    part = {"bursts": 10, "fixes": 9, "stated": 8, "inside": 6, "errors_m": [0.1, 0.2, 0.4]}
    return {"room": room, "aps": aps, "cycle": 0, "half": ("choose", "judge")[room % 2], "beliefs": list(beliefs),
            "while_learning": part, "afterwards": part}


def cells_of(text: str, half: str, aps: str) -> list[str]:
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()]
    return next(line[2:] for line in lines if line[:2] == [half, aps])


def test_never_counts_as_infinite() -> None:
    rows = [row(1, 1, belief("ap1", 4.0)), row(3, 3, belief("ap1", 2.0), belief("ap2", 6.0), belief("ap3", 3.0)),
            row(5, 3, belief("ap1", 5.0), belief("ap3", 7.0))]
    pooled = cells_of(table(rows, 45.0), "judge", "1 or 3")
    assert pooled[:5] == ["3", "3", "4.0 s / 5.0 s", "6.0 s / never", "1"]
    assert cells_of(table(rows, 45.0), "judge", "1")[2:5] == ["4.0 s / 4.0 s", "4.0 s / 4.0 s", "0"]
    assert pooled[8:11] == ["90.0 % of 30", "75.0 % of 24", "0.200 m"]


def test_wrong_beliefs_and_their_withdrawals() -> None:
    rows = [row(0, 3, belief("ap1", 1.0, error=60.0, at_end=None, withdrawn=30), belief("ap1", 9.0),
                belief("ap2", 1.0, at_end=50.0), belief("ap3", 1.0, error=50.0, at_end=None, withdrawn=31))]
    assert cells_of(table(rows, 45.0), "choose", "3")[5:8] == ["75.0 % of 4", "1 of 3", "1"]
    assert cells_of(table(rows, 90.0), "choose", "3")[5:8] == ["0.0 % of 4", "0 of 0", "0"]


def test_failed_power_cycles_are_listed_and_not_counted() -> None:
    failed = {"room": 2, "aps": 1, "cycle": 0, "half": "choose", "failed": "rayloc calibrate ended with 1: no memory"}
    text = table([row(0, 1, belief("ap1", 4.0)), failed], 45.0)
    assert cells_of(text, "choose", "1")[:2] == ["1", "1"]
    assert "no memory" in text


def test_quantiles_are_values() -> None:
    assert [quantile([3.0, 1.0, 2.0, 4.0], share) for share in (0.5, 0.9)] == [2.0, 4.0]
    assert quantile(list(map(float, range(1, 21))), 0.9) == 18.0
    assert percent(0, 0) == "-"
