"""Walks between the furniture of a room, on a grid of cells."""
from __future__ import annotations

import math
import random as random_module
from collections import deque

from room import Point, Room

Cell = tuple[int, int]

CELL_M = 0.15
CLEAR_M = 0.3  # from a walking device to furniture and walls
SPEEDS_M_S = (0.4, 1.2)
REST_S = 1.5  # at most
SMOOTHED_S = 0.4  # to each side


def floor_cells(room: Room) -> dict[Cell, Point]:
    """The cells that are clear of the walls."""
    columns, rows = (int(max(axis) / CELL_M) for axis in zip(*room.outline))
    cells = {(i, j): (i * CELL_M, j * CELL_M) for i in range(columns + 1) for j in range(rows + 1)}
    return {cell: place for cell, place in cells.items() if room.has_space(place, (CLEAR_M, CLEAR_M))}


def walkable(room: Room, floor: dict[Cell, Point]) -> dict[Cell, Point]:
    """The largest connected part of the floor that is clear of the furniture."""
    free = {
        cell: place for cell, place in floor.items() if not any(one.is_near(place, CLEAR_M) for one in room.pieces)
    }
    largest: set[Cell] = set()
    left = dict.fromkeys(free)
    while left:
        part = set(steps_from(next(iter(left)), free))
        largest = max(largest, part, key=len)
        left = dict.fromkeys(cell for cell in left if cell not in part)
    return {cell: free[cell] for cell in sorted(largest)}


def steps_from(start: Cell, cells: dict[Cell, Point]) -> dict[Cell, Cell]:
    """For each cell that can be reached the one before it on the shortest way."""
    before = {start: start}
    waiting = deque([start])
    while waiting:
        i, j = waiting.popleft()
        for step in ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)):
            cell = (i + step[0], j + step[1])
            if cell in cells and cell not in before:
                before[cell] = (i, j)
                waiting.append(cell)
    return before


def shortest_way(start: Cell, end: Cell, cells: dict[Cell, Point]) -> list[Cell]:
    before = steps_from(start, cells)
    way = [end]
    while way[-1] != start:
        way.append(before[way[-1]])
    return way[::-1]


def line(start: Point, end: Point, step: float) -> list[Point]:
    """Places at most about a step apart, without the start."""
    count = max(1, round(math.dist(start, end) / step))
    return [
        (start[0] + (end[0] - start[0]) * n / count, start[1] + (end[1] - start[1]) * n / count)
        for n in range(1, count + 1)
    ]


def smoothed(track: list[Point], reach: int) -> list[Point]:
    """The mean over `reach` frames to each side: corners become curves within the clearance."""
    result = []
    for n in range(len(track)):
        part = track[max(0, n - reach):n + reach + 1]
        result.append((sum(x for x, _ in part) / len(part), sum(y for _, y in part) / len(part)))
    return result


def walk(room: Room, random: random_module.Random, seconds: float, rate: float) -> list[Point]:
    """Places (x, y), one a frame: from cell to cell by the shortest way, smoothed, with short rests."""
    cells = walkable(room, floor_cells(room))
    names = list(cells)
    at = random.choice(names)
    track = [cells[at]]
    frames = int(seconds * rate)
    while len(track) < frames:
        to = random.choice(names)
        step = random.uniform(*SPEEDS_M_S) / rate
        for cell in shortest_way(at, to, cells)[1:]:
            track += line(track[-1], cells[cell], step)
        track += [track[-1]] * random.randrange(int(REST_S * rate))
        at = to
    return smoothed(track, int(SMOOTHED_S * rate))[:frames]
