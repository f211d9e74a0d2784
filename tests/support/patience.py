"""The deadlines of the tests, scaled to the machine: tests/support/patience.h for Python."""

from __future__ import annotations

import os


def _factor() -> float:
    """$RAYLOC_PATIENCE, a number of at least 1; 1 where it is not stated or is no such number."""
    try:
        stated = float(os.environ.get("RAYLOC_PATIENCE", "1"))
    except ValueError:
        return 1.0
    return stated if 1.0 <= stated <= 1000.0 else 1.0


FACTOR = _factor()


def patient(seconds: float) -> float:
    """The deadline of a wait that succeeds unless something is wrong. Durations that a test is about
    (a time-out of the product, a silence) are not scaled."""
    return seconds * FACTOR


PATIENCE = patient(60.0)
