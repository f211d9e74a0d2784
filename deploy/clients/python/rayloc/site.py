"""A site as the localizer models it: its scene, the antennas of its access points, its transmitters."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import NamedTuple, Optional, Union

from rayloc.needs import explained

try:
    from rayloc._engine import OfdmGrid, Receiver, Scene, Transmitter
    from rayloc._engine import load_site as _load
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["Site", "SiteTransmitter", "load_site"]


class SiteTransmitter(NamedTuple):
    """A transmitter that the site lists.

    Shapes: none. Units: metres. Frame: the world of the site. Errors: none.
    Source: daemon/site/model/site.h.
    """

    name: str
    """For people; may be empty."""
    antenna: Optional[Transmitter]
    """Antenna of a fixed transmitter; None for a device."""
    height: float
    """Height of a device [m]."""
    height_sigma: float
    """Standard deviation of that height [m]; 0: it is exact."""
    constant_power: bool
    """True if the power of the device never changes."""


class Site(NamedTuple):
    """A site, with the corrections of its calibration.

    Shapes: none.
    Units: metres, Hz, radians.
    Frame: the world of the site, right-handed, z up.
    Errors: none.
    Source: daemon/site/model/room_model.h, engine/room/room_model.h.
    """

    name: str
    """The name in site.toml."""
    directory: Path
    """The folder of site.toml."""
    scene: Scene
    """The scene, for `trace`; a calibrated site has the fitted surfaces and materials."""
    grid: OfdmGrid
    """The active tones, for `cfr`."""
    access_points: dict[str, list[Receiver]]
    """By id: one Receiver per antenna, in the order of `rx_chains`."""
    rx_chains: dict[str, list[int]]
    """By id: the receive chain of each antenna (`core` of site.toml)."""
    transmitters: dict[str, SiteTransmitter]
    """By address."""
    depth: int
    """Reflections of the paths that the localizer traces, `max_depth` of `trace`."""
    transmission: bool
    """True if these paths also go through objects."""
    calibration: str
    """Hash of the calibration; empty: the site is not calibrated."""

    @property
    def is_calibrated(self) -> bool:
        """True if the site has a calibration."""
        return bool(self.calibration)


def load_site(site: Union[str, PathLike[str]]) -> Site:
    """Reads a site and its calibration.

        site = rayloc.load_site("office")
        paths = rayloc.trace(site.scene, rayloc.Transmitter((1, 1, 1)), site.access_points["ap1"])

    Args:
        site: a directory with site.toml, or such a file.

    Shapes: none. Units: metres, Hz, radians. Frame: the world of the site.
    Errors: Error names the file, line and column.
    Source: daemon/site/model/site.h, daemon/site/model/room_model.h.
    """
    values = _load(site)
    transmitters = {mac: SiteTransmitter(**one) for mac, one in values.pop("transmitters").items()}
    return Site(transmitters=transmitters, **values)
