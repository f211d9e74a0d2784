"""Locations of Wi-Fi devices and people, as raylocd publishes them.

    import rayloc

    with rayloc.Subscriber("tcp://127.0.0.1:5560") as messages:
        for message in messages:
            print(message.topic, message.kind)

The engine is here as well, with arrays of numpy (python/README.md of the source tree):

    scene = rayloc.load_scene("room.xml")
    paths = rayloc.trace(scene, rayloc.Transmitter((1, 1, 1)), rayloc.Receiver((3, 2, 1.5)))
    h = rayloc.cfr(paths, rayloc.OfdmGrid.of(5.19e9))

`Subscriber` is for ordinary code, `AsyncSubscriber` for asyncio; both take the arguments of
`rayloc.connection.Connection` and count lost messages (`lost`) and restarts of the daemon
(`restarts`); `stale` is true once its heartbeats are missing. The messages themselves are the classes of
`rayloc.v1`, generated from proto/rayloc/v1.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from rayloc.needs import explained

if TYPE_CHECKING:
    from rayloc.calibrating import calibrate
    from rayloc.localizing import Localizer, LocationEstimate
    from rayloc.recording import Frames, read_frames
    from rayloc.site import Site, SiteTransmitter, load_site
    from rayloc.simulating import Simulation, simulate
    from rayloc.studying import Evaluation, StudiedCondition, Study, evaluate, experiment
    from rayloc.tracing import (
        Derivatives,
        DiffuseDensity,
        Error,
        Link,
        OfdmGrid,
        Paths,
        RadioMap,
        Receiver,
        ReceiverTracer,
        Scene,
        Tracer,
        Transmitter,
        cfr,
        changed,
        gradient,
        load_scene,
        parameter_names,
        radio_map,
        trace,
    )

try:
    from rayloc.asynchronous import AsyncSubscriber
    from rayloc.connection import NoSnapshot
    from rayloc.message import Gap, Message
    from rayloc.options import Curve
    from rayloc.subscriber import Subscriber
except ModuleNotFoundError as error:
    raise explained(error) from None

# Names of the engine; its module and numpy are loaded when the first of them is used, because
# subscribers need neither.
_ENGINE = {
    "calibrate": "calibrating",
    "Localizer": "localizing",
    "LocationEstimate": "localizing",
    "Frames": "recording",
    "read_frames": "recording",
    "Site": "site",
    "SiteTransmitter": "site",
    "load_site": "site",
    "Simulation": "simulating",
    "simulate": "simulating",
    "Evaluation": "studying",
    "StudiedCondition": "studying",
    "Study": "studying",
    "evaluate": "studying",
    "experiment": "studying",
    "Derivatives": "tracing",
    "DiffuseDensity": "tracing",
    "Error": "tracing",
    "Link": "tracing",
    "OfdmGrid": "tracing",
    "Paths": "tracing",
    "RadioMap": "tracing",
    "Receiver": "tracing",
    "ReceiverTracer": "tracing",
    "Scene": "tracing",
    "Tracer": "tracing",
    "Transmitter": "tracing",
    "cfr": "tracing",
    "changed": "tracing",
    "gradient": "tracing",
    "load_scene": "tracing",
    "parameter_names": "tracing",
    "radio_map": "tracing",
    "trace": "tracing",
}

__all__ = [
    "AsyncSubscriber",
    "Curve",
    "Derivatives",
    "DiffuseDensity",
    "Error",
    "Evaluation",
    "Frames",
    "Gap",
    "Link",
    "Localizer",
    "LocationEstimate",
    "Message",
    "NoSnapshot",
    "OfdmGrid",
    "Paths",
    "RadioMap",
    "Receiver",
    "ReceiverTracer",
    "Scene",
    "Simulation",
    "Site",
    "SiteTransmitter",
    "StudiedCondition",
    "Study",
    "Subscriber",
    "Tracer",
    "Transmitter",
    "calibrate",
    "cfr",
    "changed",
    "evaluate",
    "experiment",
    "gradient",
    "load_scene",
    "load_site",
    "parameter_names",
    "radio_map",
    "read_frames",
    "simulate",
    "trace",
]


def __getattr__(name: str) -> Any:
    if name not in _ENGINE:
        raise AttributeError(f"module 'rayloc' has no attribute {name!r}")
    return getattr(importlib.import_module(f"rayloc.{_ENGINE[name]}"), name)


def __dir__() -> list[str]:
    return __all__
