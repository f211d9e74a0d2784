"""Localization of a burst of frames, and the calibration that it needs."""

from __future__ import annotations

from os import PathLike
from typing import Optional, Union

from rayloc.needs import explained

try:
    import numpy as np
    from numpy.typing import NDArray

    from rayloc._engine import FrameTable, LocationEstimate, NativeLocalizer
    from rayloc.recording import Frames
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["LocationEstimate", "Localizer"]


class Localizer:
    """Locates a device that sent a burst of frames, received by any number of access points.

    Args:
        site: a directory with site.toml; access points without calibration are left out.
        cache: keeps the traced paths for the next time, as raylocd does.

    Making one traces the room, which takes seconds; `locate` takes milliseconds.

    Shapes: `cells` (x, y, 3); `log_likelihood` (x, y).
    Units: metres.
    Frame: the world of the site, right-handed, z up.
    Errors: Error for a site that cannot be read or modelled, for frames of several transmitters, and
        for frames that were read without the site; TypeError for an argument that is no Frames.
    Source: engine/localize/localizer.h; METHODS B2, B3, B7.
    """

    def __init__(self, site: Union[str, PathLike[str]], cache: bool = True) -> None:
        self._native = NativeLocalizer(site, cache)
        self.cells: NDArray[np.float64] = self._native.cells

    @property
    def access_points(self) -> list[str]:
        """Access points of the site, in its order."""
        return self._native.access_points

    def locate(
        self, frames: Frames, likelihood_exponent: Optional[float] = None
    ) -> LocationEstimate:
        """The estimate of frames of one transmitter; None: the exponent of the calibration."""
        return self._native.locate(_table(frames), likelihood_exponent)

    def log_likelihood(self, frames: Frames) -> NDArray[np.float64]:
        """Log-likelihood of each cell, (x, y), relative to the null model of a device anywhere; not tempered."""
        return self._native.log_likelihood(_table(frames))


def _table(frames: Frames) -> FrameTable:
    if not isinstance(frames, Frames):
        raise TypeError(f"frames of read_frames(captures, site=...) are needed, not {type(frames).__name__}")
    return frames._table
