"""Rooms drawn at random: outline, materials, furniture and access points.

    drawn_room(seed, number)     the same room for the same two numbers; no two rooms alike

One room in five has the shape of an L, one in six is a corridor, the others are rectangles. A piece of furniture for
which no free place is found is left out.
"""
from __future__ import annotations

import math
import random as random_module

from room import AccessPoint, Box, Piece, Point, Room
from walks import CELL_M, Cell, floor_cells, walkable

THICKNESS_M = {  # least, greatest: every face is one slab
    "concrete": (0.1, 0.25), "brick": (0.1, 0.2), "plasterboard": (0.0125, 0.03), "ceiling_board": (0.012, 0.02),
    "wood": (0.015, 0.04), "chipboard": (0.016, 0.03), "glass": (0.004, 0.008), "metal": (0.001, 0.003),
}
PLACES = 60  # that are tried for a piece of furniture
MOST_COVERED, LEAST_WALKABLE = 0.35, 0.12  # shares of the floor
PIECES = {  # name: sizes (x, y), bottom, top, materials; a top of its own thickness is a sheet on legs
    "table": ((0.9, 2.0), (0.6, 1.0), 0.72, 0.75, ("wood", "chipboard", "glass")),
    "cabinet": ((0.6, 1.4), (0.35, 0.6), 0.0, (0.8, 2.0), ("metal", "wood", "chipboard")),
    "shelf": ((0.8, 1.6), (0.25, 0.4), 0.0, (1.0, 2.0), ("wood", "chipboard", "metal")),
    "crate": ((0.35, 0.6), (0.3, 0.5), 0.0, (0.3, 0.8), ("metal", "wood", "chipboard")),
}


def draw_outline(random: random_module.Random) -> tuple[str, list[Point]]:
    kind = random.choices(("rectangle", "corridor", "L"), (0.63, 0.17, 0.2))[0]
    if kind == "corridor":
        x, y = random.uniform(6.0, 14.0), random.uniform(1.6, 2.4)
    else:
        x = math.exp(random.uniform(math.log(3.2), math.log(8.5)))
        y = x * random.uniform(0.6, 1.0)
    outline = [(0.0, 0.0), (x, 0.0), (x, y), (0.0, y)]
    if kind == "L":
        x, y = max(x, 4.5), max(y, 4.0)
        cut_x, cut_y = x * random.uniform(0.3, 0.5), y * random.uniform(0.3, 0.5)
        outline = [(0.0, 0.0), (x, 0.0), (x, y - cut_y), (x - cut_x, y - cut_y), (x - cut_x, y), (0.0, y)]
    if random.random() < 0.5:  # mirrored, or along y
        outline = [(x - px, py) for px, py in outline]
    if random.random() < 0.5:
        outline = [(py, px) for px, py in outline]
    return kind, [(round(px, 4), round(py, 4)) for px, py in outline]


def draw_openings(random: random_module.Random, room: Room) -> None:
    """A door, and windows in up to two other walls."""
    walls = [n for n, (a, b) in enumerate(room.walls()) if math.dist(a, b) > 1.5]
    random.shuffle(walls)
    for n, wall in enumerate(walls[:random.randint(1, 3)]):
        length = math.dist(*room.walls()[wall])
        width = random.uniform(0.8, 1.0) if n == 0 else random.uniform(0.7, min(2.4, length - 0.5))
        high = random.uniform(1.95, 2.1) if n == 0 else random.uniform(0.9, 1.3)
        middle = high / 2 + 0.02 if n == 0 else random.uniform(1.4, room.height - 0.1 - high / 2)
        along = random.uniform(0.15 + width / 2, length - 0.15 - width / 2)
        name, material = ("door", random.choice(("wood", "glass"))) if n == 0 else (f"window{n}", "glass")
        room.openings.append(
            f'[[opening]]\nname = "{name}"\nwall = "wall_{wall + 1}"\ncentre = [{along:.4f}, {middle:.4f}]\n'
            f'size = [{width:.4f}, {high:.4f}]\nmaterial = "{material}"\n'
        )


def chair(random: random_module.Random, number: int) -> Piece:
    yaw, material = random.uniform(-180, 180), random.choice(("wood", "chipboard"))
    back = (0.19 * math.sin(math.radians(yaw)), -0.19 * math.cos(math.radians(yaw)))
    boxes = [
        Box(f"chair{number}_seat", material, (0.0, 0.0, 0.45), (0.42, 0.42, 0.04), yaw),
        Box(f"chair{number}_back", material, (*back, 0.68), (0.42, 0.04, 0.42), yaw),
    ]
    return Piece(boxes, (0.31, 0.31), 0.89)


def piece(random: random_module.Random, kind: str, number: int, most_high: float) -> Piece:
    if kind == "chair":
        return chair(random, number)
    wide, deep, bottom, top, materials = PIECES[kind]
    x, y = random.uniform(*wide), random.uniform(*deep)
    high = top if isinstance(top, float) else random.uniform(top[0], min(top[1], most_high))
    yaw = random.choice((0, 90)) + (random.uniform(-15, 15) if kind in ("table", "crate") else 0.0)
    c, s = abs(math.cos(math.radians(yaw))), abs(math.sin(math.radians(yaw)))
    lift = 0.005 if bottom == 0 else 0.0  # no face coincides with the floor
    box = Box(
        f"{kind}{number}", random.choice(materials), (0.0, 0.0, (bottom + high) / 2 + lift),
        (x, y, high - bottom), yaw,
    )
    return Piece([box], ((c * x + s * y) / 2, (s * x + c * y) / 2), high)


def place(random: random_module.Random, room: Room, floor: dict[Cell, Point], made: Piece) -> None:
    """Adds the piece to the room, unless no place is found that leaves enough of the floor to a walk."""
    covered = sum(4 * one.half[0] * one.half[1] for one in [*room.pieces, made])
    for _ in range(PLACES):
        made.centre = room.some_place(random)
        if covered > MOST_COVERED * room.area() or not room.is_free(made):
            continue
        room.pieces.append(made)
        if len(walkable(room, floor)) * CELL_M**2 > LEAST_WALKABLE * room.area():
            return
        room.pieces.pop()


def furnish(random: random_module.Random, room: Room) -> None:
    """More in a larger room."""
    by_area = room.area() / 15.0
    kinds = ["table"] * random.randint(1, 1 + round(by_area)) + ["cabinet"] * random.randint(0, 1 + round(by_area))
    kinds += ["shelf"] * random.randint(0, 2) + ["chair"] * random.randint(2, 4) + ["crate"] * random.randint(0, 2)
    floor = floor_cells(room)
    for number, kind in enumerate(kinds):
        place(random, room, floor, piece(random, kind, number, room.height - 0.3))


def mount(random: random_module.Random, room: Room) -> None:
    """Three access points high on walls, each facing some place of the room, no two within a metre."""
    walls = room.walls()
    while len(room.access_points) < 3:
        (ax, ay), (bx, by) = random.choices(walls, [math.dist(a, b) for a, b in walls])[0]
        length = math.dist((ax, ay), (bx, by))
        along, off = random.uniform(0.05, 0.95), random.uniform(0.15, 0.45) * random.choice((-1, 1))
        x = ax + along * (bx - ax) - off * (by - ay) / length
        y = ay + along * (by - ay) + off * (bx - ax) / length
        near = any(math.dist((x, y), one.position[:2]) < 1.0 for one in room.access_points)
        tall = any(one.top > 1.5 and one.is_near((x, y), 0.25) for one in room.pieces)
        if near or tall or not room.has_space((x, y), (0.12, 0.12)):
            continue
        target = room.some_place(random)
        yaw = math.degrees(math.atan2(target[1] - y, target[0] - x))
        pitch = random.choice((0.0, random.uniform(0.0, 12.0)))
        z = random.uniform(1.85, min(2.5, room.height - 0.2))
        room.access_points.append(AccessPoint((x, y, z), yaw, pitch))


def drawn_room(seed: int, number: int) -> Room:
    random = random_module.Random(f"{seed} room {number}")
    kind, outline = draw_outline(random)
    thickness = {name: random.uniform(*both) for name, both in THICKNESS_M.items()}
    sides = ("plasterboard", "plasterboard", "brick", "concrete")
    materials = {
        "floor": random.choice(("concrete", "concrete", "wood")),
        "ceiling": random.choice(("ceiling_board", "ceiling_board", "concrete")),
        "walls": random.choice(sides),
    }
    for n in range(len(outline)):
        if random.random() < 0.3:
            materials[f"wall_{n + 1}"] = random.choice(sides)
    room = Room(number, kind, outline, random.uniform(2.4, 3.2), materials, thickness)
    draw_openings(random, room)
    furnish(random, room)
    mount(random, room)
    return room
