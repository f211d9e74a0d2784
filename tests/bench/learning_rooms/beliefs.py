"""What a replay learned of receive chains and when, against the rotations that the simulator made.

A burst is a dictionary: `learning`, the access points whose chains are being learned, each with its progress;
`error_m`, the error of its last measured position, and `inside`, whether the 95 % region contains the device (both
None without one).

A belief is a state of one access point's chains that the replay accepts as learned ("state" in the table):

    seconds             from the begin of the walk
    error_deg           largest error of a phase then, from whole degrees
    stated_deg          largest stated deviation of a phase then
    withdrawn_after     bursts until the access point is learned anew; None: not withdrawn
    error_at_end_deg    largest error of a phase at the end of the walk; None: withdrawn before
    at_end_deg          the same by core: `error` with its sign, and the `stated` deviation
"""
from __future__ import annotations

import csv
import json
import math
import re
from datetime import datetime
from pathlib import Path
from typing import Any

RATE_HZ = 20
BURST_S = 0.2
LEARNED = re.compile(r"access point (\S+): its chains are learned, rotated [^:]*: (.*) against core (\d+)")
ROTATION = re.compile(r"core (\d+) by (-?\d+) degrees \+- (\d+)")
LEARNING = re.compile(r"learning the chains of (\w+): (\d+)([^;]*)")

Row = dict[str, Any]
Phases = dict[str, dict[int, float]]  # degrees, by access point and core
Truth = list[tuple[float, float, float]]  # time [s], x, y [m], at RATE_HZ


def read_truth(file: Path) -> Truth:
    with file.open() as text:
        return [(float(row["t"]), float(row["x"]), float(row["y"])) for row in csv.DictReader(text)]


def true_place(truth: Truth, time: float) -> tuple[float, float]:
    at = min(max((time - truth[0][0]) * RATE_HZ, 0.0), len(truth) - 1.0)
    low = min(int(at), len(truth) - 2)
    share = at - low
    (_, ax, ay), (_, bx, by) = truth[low], truth[low + 1]
    return ax + share * (bx - ax), ay + share * (by - ay)


def read_bursts(file: Path, truth: Truth) -> list[Row]:
    """All bursts of a walk, from the estimates of a replay."""
    count = math.ceil((truth[-1][0] - truth[0][0] + 0.5 / RATE_HZ) / BURST_S)
    bursts: list[Row] = [{"learning": None, "error_m": None, "inside": None} for _ in range(count)]
    for line in file.read_text().splitlines():
        location = json.loads(line)
        time = datetime.fromisoformat(location["time"]).timestamp()
        number = int((time - truth[0][0] + 0.25 / RATE_HZ) / BURST_S)  # a frame's time is rounded
        if not 0 <= number < count:
            continue
        burst, quality = bursts[number], location["quality"]
        texts = "; ".join([*quality.get("warnings", []), quality.get("no_fix_reason", "")])
        burst["learning"] = {ap: counted + rest for ap, counted, rest in LEARNING.findall(texts)}
        if location["mode"] in ("FIX_MODE_2D", "FIX_MODE_3D"):
            position = location["position"]["x"], location["position"]["y"]
            burst["error_m"] = math.dist(position, true_place(truth, time))
            burst["inside"] = burst["error_m"] <= location["accuracy_m"] if "accuracy_m" in location else None
    before: dict[str, str] = {}
    for burst in bursts:  # a burst without a record has the state of the one before
        before = burst["learning"] = before if burst["learning"] is None else burst["learning"]
    return bursts


def error_deg(degrees: float) -> float:
    return math.remainder(degrees, 360.0)


def learned_times(bursts: list[Row], ap: str) -> list[tuple[int, int | None]]:
    """The first burst of each time that an access point is learned, and the one that withdraws it."""
    is_learning = [ap in burst["learning"] for burst in bursts]
    begins = [n for n in range(1, len(bursts)) if is_learning[n - 1] and not is_learning[n]]
    return [(n, next((m for m in range(n, len(bursts)) if is_learning[m]), None)) for n in begins]


def read_beliefs(notices: str, rotated: Phases, bursts: list[Row]) -> list[Row]:
    """All beliefs of a replay, in order, from its notices; without what they are at the end."""
    times = {ap: learned_times(bursts, ap) for ap in rotated}
    beliefs = []
    for ap, rotations, reference in LEARNED.findall(notices):
        errors = [
            error_deg(float(by) - rotated[ap][int(core)] + rotated[ap][int(reference)])
            for core, by, _ in ROTATION.findall(rotations)
        ]
        begin, end = times[ap].pop(0) if times[ap] else (None, None)  # learned by the last burst: no begin
        beliefs.append({
            "ap": ap,
            "seconds": None if begin is None else round(begin * BURST_S, 1),
            "error_deg": round(max(map(abs, errors)), 1),
            "stated_deg": max(int(sigma) for _, _, sigma in ROTATION.findall(rotations)),
            "withdrawn_after": None if begin is None or end is None else end - begin,
            "error_at_end_deg": None,
            "at_end_deg": None,
        })
    return beliefs


def phases_at_end(file: Path, rotated: Phases) -> dict[str, dict[int, Row]]:
    """`at_end_deg` of each access point whose chains are learned, from a chain file."""
    result = {}
    for state in json.loads(file.read_text())["access_points"] if file.exists() else []:
        if state["chains"] != "learned":
            continue
        made = rotated[state["id"]]
        phases = {
            core: math.degrees(math.atan2(imaginary, real))
            for core, (real, imaginary) in zip(state["cores"], state["factor"])
        }
        first, *others = state["cores"]
        sigmas = dict(zip(state["cores"], state["phase_sigma_rad"]))
        result[state["id"]] = {
            core: {
                "error": round(error_deg(phases[core] - phases[first] - made[core] + made[first]), 1),
                "stated": round(math.degrees(sigmas[core]), 1),
            }
            for core in others
        }
    return result


def add_ends(beliefs: list[Row], ends: dict[str, dict[int, Row]]) -> None:
    """Adds the phases at the end to the last belief of each access point, unless it was withdrawn."""
    last = {belief["ap"]: belief for belief in beliefs}
    for ap, belief in last.items():
        if belief["withdrawn_after"] is None and ap in ends:
            belief["at_end_deg"] = ends[ap]
            belief["error_at_end_deg"] = max(abs(one["error"]) for one in ends[ap].values())


def learning_ends(bursts: list[Row], beliefs: list[Row], ids: list[str]) -> int:
    """The first burst at which all access points are learned; the number of bursts if there is none."""
    first: dict[str, float] = {}
    for one in beliefs:
        if one["seconds"] is not None:
            first.setdefault(one["ap"], one["seconds"])
    if set(first) != set(ids):
        return len(bursts)
    begin = round(max(first.values()) / BURST_S)
    return next((n for n in range(begin, len(bursts)) if not bursts[n]["learning"]), len(bursts))


def located(bursts: list[Row]) -> Row:
    errors = [burst["error_m"] for burst in bursts if burst["error_m"] is not None]
    stated = [burst["inside"] for burst in bursts if burst["inside"] is not None]
    return {
        "bursts": len(bursts), "fixes": len(errors), "stated": len(stated), "inside": sum(stated),
        "errors_m": [round(error, 3) for error in errors],
    }
