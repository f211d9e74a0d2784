"""Recordings of a simulated device or person, as the access points of a site would make them."""

from __future__ import annotations

import json
import os
from os import PathLike
from typing import Any, Callable, Mapping, NamedTuple, Optional, Union

from rayloc.child import no_progress
from rayloc.needs import explained

try:
    import rayloc._engine as _engine
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["Simulation", "simulate"]


class Simulation(NamedTuple):
    """Result of `simulate`.

    Shapes: none.
    Units: metres, dB, degrees, as the keys state.
    Frame: the world of the site.
    Errors: none.
    Source: daemon/lab/simulate/simulate_report.h.
    """

    truth: dict[str, Any]
    """The JSON of `rayloc simulate`: the seed, the chains, the impairments and the true points."""
    notes: list[str]
    """Points that no path reaches, and notes on the scene."""
    version: str
    """Version of RayLoc."""


def simulate(
    site: Union[str, PathLike[str]],
    points: Union[str, PathLike[str]],
    out: Mapping[str, Union[str, PathLike[str]]],
    *,
    seed: int = 0,
    frames: int = 10,
    transmitter: str = "",
    channels: str = "",
    impairments: Union[str, PathLike[str]] = "default",
    survey_error: float = 0.0,
    person: bool = False,
    depth: int = 3,
    transmission: bool = False,
    diffuse: bool = False,
    model_error: bool = False,
    height_sigma: float = 0.0,
    tilt_deg: float = 0.0,
    power_sigma_db: float = 0.0,
    second_day: Union[str, PathLike[str]] = "",
    truth: Union[str, PathLike[str]] = "",
    force: bool = False,
    progress: Optional[Callable[[float, str], None]] = None,
) -> Simulation:
    """Simulates recordings with the ray tracer, as `rayloc simulate` does; the bytes are the same.

    The simulation uses the propagation model of the localization: the recordings do not predict
    the accuracy in a real room.

    Args:
        site: a directory with site.toml; it may be calibrated.
        points: csv of positions: t_start,t_end,x,y,z per spot, or t,x,y,z along a walk.
        out: the pcap file to make, by access point.
        seed: of all random draws. Recordings of one seed share the chains of the receivers.
        frames: at each spot, 1 to 100000; a walk has one at each row.
        transmitter: its address or name; empty: the first device of the site.
        channels: channels over which the device hops, as "36-64"; empty: the site's.
        impairments: of the radio: "default", "none" or a TOML file.
        survey_error: standard deviation of the device from each point, along each axis [m].
        person: the points are those of a person without a device.
        depth: maximum number of reflections and transmissions of a path, 0 to 8.
        transmission: traces waves through objects.
        diffuse: adds single diffuse scattering by rough materials.
        model_error: draws channels from the model error of the site's calibration.
        height_sigma: standard deviation of the height of devices [m], up to 5.
        tilt_deg: largest angle of the antenna from upright, up to 180.
        power_sigma_db: standard deviation of the transmit power, up to 30.
        second_day: changes since the calibration: "default", a TOML file; empty: none.
        truth: csv file to write with the true positions, for `rayloc.evaluate`; empty: none.
        force: replaces files that exist.
        progress: called with the share done, 0 to 1, and the access point. An exception that it
            raises, or Ctrl-C, ends the simulation after the current point.

    Shapes: none. Units: as stated for each argument. Frame: the world of the site.
    Errors: Error names the file and the row; ValueError names the argument.
    Source: daemon/lab/simulate/simulate_recordings.h.
    """
    if person and (height_sigma or tilt_deg or power_sigma_db or model_error):
        raise ValueError("a person has no device: person excludes height_sigma, tilt_deg, power_sigma_db, model_error")
    if model_error and (depth != 3 or transmission or diffuse):
        raise ValueError("model_error has the paths of the calibration: it excludes depth, transmission, diffuse")
    _check("frames", frames, 1, 100_000)
    _check("survey_error", survey_error, 0.0, 10.0)
    _check("depth", depth, 0, 8)
    _check("height_sigma", height_sigma, 0.0, 5.0)
    _check("tilt_deg", tilt_deg, 0.0, 180.0)
    _check("power_sigma_db", power_sigma_db, 0.0, 30.0)
    _check("seed", seed, 0, 2**64 - 1)
    if not out:
        raise ValueError("out names no recording to make: {'ap1': 'ap1.pcap'}")
    text, notes = _engine.simulate(
        {
            "site": os.fspath(site),
            "points": os.fspath(points),
            "out": {name: os.fspath(file) for name, file in out.items()},
            "seed": seed,
            "frames": frames,
            "transmitter": transmitter,
            "channels": channels,
            "impairments": os.fspath(impairments),
            "survey_error": float(survey_error),
            "person": person,
            "depth": depth,
            "transmission": transmission,
            "diffuse": diffuse,
            "model_error": model_error,
            "height_sigma": float(height_sigma),
            "tilt_deg": float(tilt_deg),
            "power_sigma_db": float(power_sigma_db),
            "second_day": os.fspath(second_day),
            "truth": os.fspath(truth),
            "force": force,
        },
        progress if progress is not None else no_progress,
    )
    return Simulation(truth=json.loads(text), notes=notes, version=_engine.version())


def _check(name: str, value: float, low: float, high: float) -> None:
    """NaN is out of every range."""
    if not low <= value <= high:
        raise ValueError(f"{name} is {value}, but must be from {low:g} to {high:g}")
