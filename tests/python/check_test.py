"""A failed assumption of the engine raises an exception, and the interpreter continues."""

from __future__ import annotations

import pytest
import rayloc
import rayloc._engine as native


def test_a_failed_check_raises() -> None:
    for _ in range(2):
        with pytest.raises(rayloc.Error, match="check failed: holds; this is a bug in RayLoc") as caught:
            native.check(False)
        assert caught.value.kind == "internal"
        native.check(True)
