"""Rooms as built, random walks on their free floor, heights of a hand."""
from __future__ import annotations

import json
import math
import random
import tomllib
from pathlib import Path

RATE_HZ = 10  # frames
HEIGHT_M, HEIGHT_SIGMA_M = 1.2, 0.3
WALL_M, BESIDE_M = 0.25, 0.08
NOT_IN_THE_WAY = ("floor", "ceiling", "wall", "door", "window", "chair", "duct", "whiteboard")

Place = tuple[float, float]


class Room:
    """The free floor of a room as built."""

    def __init__(self, folder: Path) -> None:
        self.site = tomllib.loads((folder / "site.toml").read_text())
        objects = json.loads((folder / "truth/day2/scene.json").read_text())["objects"]
        self.bounds = [(low + WALL_M, high - WALL_M) for low, high in (self.site["bounds"][axis] for axis in "xy")]
        self.boxes, self.doors = [], []
        for one in objects:
            (x, y, z), (a, b, c) = one["centre"], one["size"]
            if one["name"].startswith("door"):
                self.doors.append(self.inside((x, y)))
            if one["name"].startswith(NOT_IN_THE_WAY) or z + c / 2 < 0.3 or z - c / 2 > 1.9:
                continue
            self.boxes.append((x, y, a / 2 + BESIDE_M, b / 2 + BESIDE_M))

    def inside(self, place: Place) -> Place:
        return tuple(min(max(v, low), high) for v, (low, high) in zip(place, self.bounds))  # type: ignore[return-value]

    def is_free(self, x: float, y: float) -> bool:
        return (all(low <= v <= high for v, (low, high) in zip((x, y), self.bounds))
                and not any(abs(x - bx) < a and abs(y - by) < b for bx, by, a, b in self.boxes))

    def is_open(self, one: Place, other: Place) -> bool:
        steps = max(1, math.ceil(math.dist(one, other) / 0.03))
        return all(self.is_free(*(p + (q - p) * n / steps for p, q in zip(one, other))) for n in range(steps + 1))

    def drawn(self, draw: random.Random) -> Place:
        while True:
            place = tuple(draw.uniform(*bound) for bound in self.bounds)
            if self.is_free(*place):
                return place  # type: ignore[return-value]

    def near(self, draw: random.Random, seat: Place, radius: float) -> Place:
        while True:
            place = (draw.uniform(-radius, radius), draw.uniform(-radius, radius))
            if math.hypot(*place) <= radius and self.is_free(seat[0] + place[0], seat[1] + place[1]):
                return (seat[0] + place[0], seat[1] + place[1])

    def walk(self, draw: random.Random, begin: Place, seconds: float) -> list[Place]:
        """Places at RATE_HZ, the first at `begin`: straight stretches at 0.5 to 1.1 m/s, corners rounded."""
        steps = round(seconds * RATE_HZ)
        places, heading = [begin], draw.uniform(0.0, 2.0 * math.pi)
        while len(places) <= steps:
            x, y = places[-1]
            turn, length, speed = draw.gauss(0.0, 0.9), draw.uniform(0.5, 3.0), draw.uniform(0.5, 1.1)
            for attempt in range(200):
                angle, far = heading + turn, length * 0.97**attempt
                end = (x + far * math.cos(angle), y + far * math.sin(angle))
                if self.is_open((x, y), end):
                    break
                turn = draw.uniform(-math.pi, math.pi)
            else:
                end = (x, y)
            heading += turn
            count = max(1, round(math.dist((x, y), end) / speed * RATE_HZ))
            places += [(x + (end[0] - x) * n / count, y + (end[1] - y) * n / count) for n in range(1, count + 1)]
        places = places[:steps + 1]
        rounded = []
        for n in range(len(places)):
            reach = min(2, n, len(places) - 1 - n)
            part = places[n - reach:n + reach + 1]
            mean = (sum(p[0] for p in part) / len(part), sum(p[1] for p in part) / len(part))
            rounded.append(mean if self.is_free(*mean) else places[n])
        return rounded


def heights(draw: random.Random, count: int) -> list[float]:
    """Smooth over 2 s."""
    waves = [(draw.gauss(0.0, 0.5), draw.uniform(0.0, 2.0 * math.pi)) for _ in range(24)]
    scale = HEIGHT_SIGMA_M * math.sqrt(2.0 / len(waves))
    return [min(max(HEIGHT_M + scale * sum(math.cos(w * n / RATE_HZ + p) for w, p in waves), 0.3), 2.1)
            for n in range(count)]
