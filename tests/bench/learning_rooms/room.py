"""A room: outline, openings, furniture and access points, and its text for `rayloc scene room`.

Lengths are metres, angles degrees; x and y start at a corner of the box around the outline.
"""
from __future__ import annotations

import copy
import math
import random as random_module
from dataclasses import dataclass, field

Point = tuple[float, float]

MARGIN_M, APART_M = 0.03, 0.04  # furniture to walls, and to other furniture: more than a stated plan is off


@dataclass
class Box:
    name: str
    material: str
    centre: tuple[float, float, float]  # x and y from the centre of the piece
    size: tuple[float, float, float]
    yaw: float = 0.0

    def text(self, shift: Point) -> str:
        x, y, z = self.centre
        return (
            f'[[box]]\nname = "{self.name}"\nmaterial = "{self.material}"\n'
            f"centre = [{x + shift[0]:.4f}, {y + shift[1]:.4f}, {z:.4f}]\n"
            f"size = [{', '.join(f'{one:.4f}' for one in self.size)}]\nyaw_deg = {self.yaw:.3f}\n"
        )


@dataclass
class Piece:
    """Furniture that is placed as one: its boxes, and the rectangle along the axes that contains them."""

    boxes: list[Box]
    half: Point  # along x and y
    top: float
    centre: Point = (0.0, 0.0)
    shift: Point = (0.0, 0.0)  # error of its place in a stated plan

    def text(self) -> str:
        at = self.centre[0] + self.shift[0], self.centre[1] + self.shift[1]
        return "\n".join(box.text(at) for box in self.boxes)

    def is_near(self, point: Point, distance: float) -> bool:
        """Within the rectangle, widened by `distance`."""
        return all(abs(point[i] - self.centre[i]) < self.half[i] + distance for i in (0, 1))


@dataclass
class AccessPoint:
    position: tuple[float, float, float]
    yaw: float
    pitch: float

    def text(self, number: int) -> str:
        antennas = "".join(
            f"[[access_point.antenna]]\ncore = {core}\noffset = [0, {y}, 0]\n"
            for core, y in ((2, -0.089), (0, 0), (3, 0.089))
        )
        return (
            f'[[access_point]]\nid = "ap{number}"\n'
            f"position = [{', '.join(f'{one:.4f}' for one in self.position)}]\n"
            f"yaw_deg = {self.yaw:.3f}\npitch_deg = {self.pitch:.3f}\n"
            f'pattern = "half_wave_dipole"\n{antennas}'
        )


@dataclass
class Room:
    number: int
    kind: str
    outline: list[Point]
    height: float
    materials: dict[str, str]  # by key of the plan
    thickness: dict[str, float]  # by material
    openings: list[str] = field(default_factory=list)
    pieces: list[Piece] = field(default_factory=list)
    access_points: list[AccessPoint] = field(default_factory=list)

    def walls(self) -> list[tuple[Point, Point]]:
        return list(zip(self.outline, self.outline[1:] + self.outline[:1]))

    def area(self) -> float:
        return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in self.walls())) / 2

    def contains(self, point: Point) -> bool:
        x, y = point
        inside = False
        for (ax, ay), (bx, by) in self.walls():
            if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
                inside = not inside
        return inside

    def has_space(self, centre: Point, half: Point) -> bool:
        """A rectangle lies within the outline: its corners do, and no corner of the outline lies in it."""
        x, y = centre
        corners = [(x + sx * half[0], y + sy * half[1]) for sx in (-1, 1) for sy in (-1, 1)]
        return all(map(self.contains, corners)) and not any(
            abs(cx - x) < half[0] and abs(cy - y) < half[1] for cx, cy in self.outline
        )

    def is_free(self, piece: Piece) -> bool:
        """The piece lies within the outline and apart from all others."""
        return self.has_space(piece.centre, (piece.half[0] + MARGIN_M, piece.half[1] + MARGIN_M)) and not any(
            all(abs(piece.centre[i] - one.centre[i]) < piece.half[i] + one.half[i] + APART_M for i in (0, 1))
            for one in self.pieces
        )

    def some_place(self, random: random_module.Random) -> Point:
        (low_x, high_x), (low_y, high_y) = ((min(axis), max(axis)) for axis in zip(*self.outline))
        while True:
            point = random.uniform(low_x, high_x), random.uniform(low_y, high_y)
            if self.contains(point):
                return point

    def plan(self, access_points: int) -> str:
        corners = ", ".join(f"[{x:.4f}, {y:.4f}]" for x, y in self.outline)
        used = set(self.materials.values()) | {box.material for one in self.pieces for box in one.boxes}
        used |= {material for material in self.thickness if f'"{material}"' in "".join(self.openings)}
        parts = [f'name = "room{self.number}"\noutline = [{corners}]\nheight = {self.height:.4f}\n']
        parts += [f'{key} = "{material}"\n' for key, material in self.materials.items()]
        parts += self.openings
        parts += [one.text() for one in self.pieces]
        parts += [
            f"[materials.{name}]\nthickness_m = {thick:.4f}\n"
            for name, thick in self.thickness.items() if name in used
        ]
        parts += [one.text(i + 1) for i, one in enumerate(self.access_points[:access_points])]
        return "\n".join(parts)

    def stated(self, random: random_module.Random, scale: float) -> Room:
        """The room with the errors of a plan: those that a complete calibration leaves, times `scale`."""
        def error(sigma: float) -> float:
            return scale * sigma * max(-2.5, min(2.5, random.gauss(0, 1)))

        other = copy.deepcopy(self)
        moved = [{value: error(0.0015) for value in sorted({one[i] for one in self.outline})} for i in (0, 1)]
        other.outline = [(x + moved[0][x], y + moved[1][y]) for x, y in self.outline]
        other.height += error(0.0015)
        for piece in other.pieces:
            piece.shift = (error(0.002), error(0.002))
        for one in other.access_points:
            x, y, z = one.position
            one.position = (x + error(0.001), y + error(0.001), z + error(0.0025))
            one.yaw += error(0.15)
        return other
