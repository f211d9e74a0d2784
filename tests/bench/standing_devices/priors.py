"""Errors and regions of estimates, as published and with a prior on their hypotheses."""
from __future__ import annotations

import math
import random
from typing import Any, Callable

from rooms import Place, Room

MERGED_M = 0.3  # hypotheses that are one place

Row = dict[str, Any]
Outcome = tuple[int, float, float]  # spot, error [m], radius of the region of 95 % [m]


def place_of(point: Row) -> Place:
    return point.get("x", 0.0), point.get("y", 0.0)


def as_published(rows: list[Row]) -> list[Outcome]:
    return [(row["spot"], math.dist(place_of(row["location"]["position"]), row["true"]),
             row["location"].get("accuracy_m", math.inf)) for row in rows]


def best_of_five(rows: list[Row]) -> list[Outcome]:
    """The nearest hypothesis: the bound for all priors on hypotheses."""
    return [(row["spot"], min(math.dist(place_of(one["position"]), row["true"])
                              for one in row["location"]["hypotheses"]), math.inf) for row in rows]


def with_prior(rows: list[Row], prior: Callable[[Row, Place], float]) -> list[Outcome]:
    """The answer is the mean of the heaviest hypotheses within MERGED_M, the region holds 95 % of 400 draws."""
    result = []
    for row in rows:
        ones = row["location"]["hypotheses"]
        places = [place_of(one["position"]) for one in ones]
        weights = [one["weight"] * prior(row, place) + 1e-300 for one, place in zip(ones, places)]
        near = [[w if math.dist(p, q) < MERGED_M else 0.0 for q, w in zip(places, weights)] for p in places]
        best = max(near, key=sum)
        answer = tuple(sum(w * q[axis] for w, q in zip(best, places)) / sum(best) for axis in (0, 1))
        draw = random.Random(row["spot"])
        drawn = []
        for n in draw.choices(range(len(ones)), weights, k=400):
            spread = [math.sqrt(max(ones[n]["position_covariance"][k], 0.0)) for k in (0, 4)]
            drawn.append(math.dist(answer, [v + draw.gauss(0.0, s) for v, s in zip(places[n], spread)]))
        result.append((row["spot"], math.dist(answer, row["true"]), quantile(drawn, 0.95)))
    return result


def occupancy(rows: list[Row], share: float, width: float, area: float) -> Callable[[Row, Place], float]:
    """The filtered maps of all other spots' devices, `width` [m] wider, and a uniform remainder."""
    last = {row["spot"]: row for row in rows}

    def prior(row: Row, place: Place) -> float:
        density = 0.0
        for spot, other in last.items():
            for one in other["location"]["hypotheses"] if spot != row["spot"] else []:
                away = math.dist(place, place_of(one["position"])) / width
                density += one["weight"] * math.exp(-0.5 * away * away) / (2.0 * math.pi * width * width)
        return (1.0 - share) / area + share * density / max(1, len(last) - 1)

    return prior


def doors(room: Room, share: float, begin: float) -> Callable[[Row, Place], float]:
    """Within `begin` [m] of a door when it appeared, then at most 1 m/s away; with 1 - share anywhere."""
    area = math.prod(high - low for low, high in room.bounds)

    def prior(row: Row, place: Place) -> float:
        width = begin + 0.5 * row["age"]  # half of the fastest: walks bend
        away = min(math.dist(place, door) for door in room.doors) / width
        density = math.exp(-0.5 * away * away) / min(area, 2.0 * math.pi * width * width * len(room.doors))
        return (1.0 - share) / area + share * density

    return prior


def quantile(values: list[float], share: float) -> float:
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def figures(outcomes: list[Outcome]) -> dict[str, tuple[float, float, float]]:
    """Median, 90 %, shares below 0.5 m and in the region, median radius; each with its interval of 95 %."""
    spots: dict[int, list[Outcome]] = {}
    for one in outcomes:
        spots.setdefault(one[0], []).append(one)
    groups, draw = list(spots.values()), random.Random(1)

    def of(parts: list[list[Outcome]]) -> list[float]:
        ones = [one for part in parts for one in part]
        errors = [one[1] for one in ones]
        return [quantile(errors, 0.5), quantile(errors, 0.9), sum(e < 0.5 for e in errors) / len(ones),
                sum(one[1] <= one[2] for one in ones) / len(ones), quantile([one[2] for one in ones], 0.5)]

    drawn = [of(draw.choices(groups, k=len(groups))) for _ in range(400)]
    found = of(groups)
    return {name: (found[n], quantile([d[n] for d in drawn], 0.025), quantile([d[n] for d in drawn], 0.975))
            for n, name in enumerate(("median", "p90", "below", "region", "radius"))}


def table_line(name: str, outcomes: list[Outcome]) -> str:
    if not outcomes:
        return f"| {name} | - | | | | | |"
    found = figures(outcomes)
    metres = [f"{v:.2f} [{low:.2f}, {high:.2f}]" for v, low, high in (found["median"], found["p90"])]
    shares = [f"{100 * v:.0f} [{100 * low:.0f}, {100 * high:.0f}]"
              for v, low, high in (found["below"], found["region"])]
    radius = f"{found['radius'][0]:.2f}"
    if math.isinf(found["radius"][0]):  # without a region
        shares[1], radius = "-", "-"
    return f"| {name} | {len({one[0] for one in outcomes})} | " + " | ".join([*metres, *shares, radius]) + " |"
