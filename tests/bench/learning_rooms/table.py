"""The Markdown table of rows: by half and number of access points."""
from __future__ import annotations

import math
import statistics
from typing import Any

HALVES = ("choose", "judge")
WITHDRAWN_IN = 30  # bursts: the aim
HEAD = (
    "half", "access points", "rooms", "power cycles", "first learned: median / 90 %", "all learned: median / 90 %",
    "not all learned", "wrong states", f"withdrawn within {WITHDRAWN_IN} bursts", "wrong at the end",
    "learning: bursts with a fix", "in the 95 % region", "median error",
    "afterwards: bursts with a fix", "in the 95 % region", "median error",
)

Row = dict[str, Any]


def first_seconds(row: Row) -> list[float]:
    """For each access point the time at which it was learned first; infinite: never."""
    first: dict[str, float] = {}
    for belief in row["beliefs"]:
        first.setdefault(belief["ap"], math.inf if belief["seconds"] is None else belief["seconds"])
    return [first.get(f"ap{n + 1}", math.inf) for n in range(row["aps"])]


def quantile(values: list[float], share: float) -> float:
    """The least value that so many do not exceed. Unlike an interpolation, it is defined with infinite ones."""
    return sorted(values)[math.ceil(share * len(values)) - 1]


def quantiles(values: list[float]) -> str:
    both = quantile(values, 0.5), quantile(values, 0.9)
    return " / ".join("never" if math.isinf(one) else f"{one:.1f} s" for one in both)


def percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} % of {whole}" if whole else "-"


def is_wrong_at_end(belief: Row, limit: float) -> bool:
    return belief["error_at_end_deg"] is not None and belief["error_at_end_deg"] > limit


def is_wrong(belief: Row, limit: float) -> bool:
    return belief["error_deg"] > limit or is_wrong_at_end(belief, limit)


def is_withdrawn_soon(belief: Row) -> bool:
    return belief["withdrawn_after"] is not None and belief["withdrawn_after"] <= WITHDRAWN_IN


def belief_cells(rows: list[Row], limit: float) -> list[str]:
    beliefs = [one for row in rows for one in row["beliefs"]]
    wrong = [one for one in beliefs if is_wrong(one, limit)]
    return [
        percent(len(wrong), len(beliefs)), f"{sum(map(is_withdrawn_soon, wrong))} of {len(wrong)}",
        str(sum(is_wrong_at_end(one, limit) for one in wrong)),
    ]


def position_cells(parts: list[Row]) -> list[str]:
    total = {key: sum(part[key] for part in parts) for key in ("bursts", "fixes", "stated", "inside")}
    errors = [error for part in parts for error in part["errors_m"]]
    return [
        percent(total["fixes"], total["bursts"]), percent(total["inside"], total["stated"]),
        f"{statistics.median(errors):.3f} m" if errors else "-",
    ]


def cells(rows: list[Row], limit: float) -> list[str]:
    times = [first_seconds(row) for row in rows]
    return [
        str(len({row["room"] for row in rows})), str(len(rows)),
        quantiles([min(one) for one in times]), quantiles([max(one) for one in times]),
        str(sum(math.isinf(max(one)) for one in times)), *belief_cells(rows, limit),
        *position_cells([row["while_learning"] for row in rows]),
        *position_cells([row["afterwards"] for row in rows]),
    ]


def line(words: list[str]) -> str:
    return "| " + " | ".join(words) + " |"


def table(rows: list[Row], limit: float) -> str:
    """An accepted state is wrong if a phase is off by more than `limit` [degrees]. Failed power cycles are listed below."""
    lines = [line(list(HEAD)), "|" + "---|" * len(HEAD)]
    for half in HALVES:
        for aps in ((1,), (3,), (1, 3)):
            group = [row for row in rows if row["half"] == half and row["aps"] in aps and "failed" not in row]
            if group:
                lines.append(line([half, " or ".join(map(str, aps)), *cells(group, limit)]))
    failed = [f"room {row['room']}, {row['aps']} access points, cycle {row['cycle']}: {row['failed']}"
              for row in rows if "failed" in row]
    if failed:
        lines += ["", f"{len(failed)} power cycles failed, which no line counts: " + "; ".join(failed)]
    return "\n".join(lines)
