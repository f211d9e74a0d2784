"""The ray tracer: scenes, paths, channels and gradients as arrays of numpy.

    import rayloc

    scene = rayloc.load_scene("room.xml")
    paths = rayloc.trace(scene, rayloc.Transmitter((1, 1, 1)), rayloc.Receiver((3, 2, 1.5)))
    h = rayloc.cfr(paths, rayloc.OfdmGrid.of(5.19e9))
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Sequence, Union, overload

from rayloc.needs import explained

try:
    import numpy as np
    from numpy.typing import NDArray

    from rayloc._engine import (
        Derivatives,
        DiffuseDensity,
        Error,
        OfdmGrid,
        Paths,
        Receiver,
        ReceiverTracer,
        Scene,
        Tracer,
        Transmitter,
        changed_link,
        load_scene,
        parameter_names,
        radio_maps,
    )
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = [
    "Derivatives",
    "DiffuseDensity",
    "Error",
    "Link",
    "OfdmGrid",
    "Paths",
    "RadioMap",
    "Receiver",
    "ReceiverTracer",
    "Scene",
    "Tracer",
    "Transmitter",
    "cfr",
    "changed",
    "gradient",
    "load_scene",
    "parameter_names",
    "radio_map",
    "trace",
]

Transmitters = Union[Transmitter, Sequence[Transmitter]]
Receivers = Union[Receiver, Sequence[Receiver]]


class Link(NamedTuple):
    """A scene and the two ends of a link, with an amplitude factor of the antennas.

    Shapes: none. Units: `gain` 1. Frame: world of the scene.
    Errors: none.
    Source: engine/trace/link_change.h.
    """

    scene: Scene
    tx: Transmitter
    rx: Receiver
    gain: float = 1.0


class RadioMap(NamedTuple):
    """The received signal of antennas over a room, cell by cell.

    Path gain adds the powers of the paths, as Sionna RT's does: the mean over a wavelength or two,
    not the fading within it. `strongest` is the number of the antenna with the highest path gain,
    -1 where none has a path.

    Shapes: `path_gain`, `delay_spread` and `path_count` (tx, y, x), `strongest` (y, x),
        `cell_centers` (y, x, 3).
    Units: `path_gain` received over sent power, 0 without a path; `delay_spread` seconds, root mean
        square, NaN without a path; `cell_centers` metres.
    Frame: world of the scene, right-handed, z up; cells lie along x and y.
    Errors: none.
    Source: engine/room/radio_map.h.
    """

    path_gain: NDArray[np.float64]
    delay_spread: NDArray[np.float64]
    path_count: NDArray[np.uint32]
    strongest: NDArray[np.int64]
    cell_centers: NDArray[np.float64]


@overload
def trace(
    scene: Scene,
    tx: Transmitter,
    rx: Receiver,
    max_depth: int = ...,
    refraction: bool = ...,
    softness: float = ...,
    diffraction: int = ...,
    diffuse_reflection: bool = ...,
) -> Paths: ...
@overload
def trace(
    scene: Scene,
    tx: Sequence[Transmitter],
    rx: Receivers,
    max_depth: int = ...,
    refraction: bool = ...,
    softness: float = ...,
    diffraction: int = ...,
    diffuse_reflection: bool = ...,
) -> list[list[Paths]]: ...
@overload
def trace(
    scene: Scene,
    tx: Transmitter,
    rx: Sequence[Receiver],
    max_depth: int = ...,
    refraction: bool = ...,
    softness: float = ...,
    diffraction: int = ...,
    diffuse_reflection: bool = ...,
) -> list[list[Paths]]: ...
def trace(
    scene: Scene,
    tx: Transmitters,
    rx: Receivers,
    max_depth: int = 3,
    refraction: bool = False,
    softness: float = 0.0,
    diffraction: int = 0,
    diffuse_reflection: bool = False,
) -> Union[Paths, list[list[Paths]]]:
    """All paths between antennas.

    Args:
        scene: a scene of load_scene.
        tx: a Transmitter, or several.
        rx: a Receiver, or several.
        max_depth: most interactions of a path, 0 to 16.
        refraction: also straight through objects; each face that is crossed counts.
        softness: distance from its edge over which a face begins to act [m]; 0 is hard.
        diffraction: also round one edge, which counts (1 or True), or up to two in a row (2); not
            with softness.
        diffuse_reflection: rough materials reflect less; Paths.diffuse() has the scattered echoes.

    Returns:
        The Paths of the link. With several of either a list [tx][rx] of them, traced on all cores
        without the lock of Python.

    Shapes: as Paths has them. Units: metres, seconds, radians.
    Frame: world of the scene, right-handed, z up.
    Errors: Error for an argument out of its range, where both ends are the same point, and for
        diffuse_reflection where no material of the scene scatters.
    Source: engine/trace/path_tracer.h. Keep a `Tracer` for many links of a receiver.
    """
    tracer = Tracer(scene, max_depth, refraction, softness, diffraction, diffuse_reflection)
    if isinstance(tx, Transmitter) and isinstance(rx, Receiver):
        return tracer.trace(tx, rx)
    return tracer.trace_all(
        [tx] if isinstance(tx, Transmitter) else tx, [rx] if isinstance(rx, Receiver) else rx
    )


def radio_map(
    scene: Scene,
    tx: Transmitters,
    cell_size: float = 0.1,
    height: Optional[float] = None,
    bounds: Optional[Sequence[Sequence[float]]] = None,
    max_depth: int = 3,
    refraction: bool = False,
    diffraction: int = 0,
) -> RadioMap:
    """The received signal of antennas over a room, as `rayloc scene map` has it.

    Args:
        scene: a scene of load_scene.
        tx: a Transmitter, or several that are compared.
        cell_size: side of a cell [m].
        height: height of the devices, world [m]; None: 1.2 m above the lowest point of the scene.
        bounds: ((x, y), (x, y)), least and greatest corner [m]; None: those of the scene.
        max_depth: as of trace.
        refraction: as of trace.
        diffraction: as of trace.

    Returns:
        A RadioMap, computed on all cores without the lock of Python. The device in every cell is
        isotropic and vertically polarized. Every cell is traced exactly at its middle, without
        samples: nothing is random.

    Shapes: as RadioMap has them. Units: metres, seconds; gains 1.
    Frame: world of the scene, right-handed, z up.
    Errors: Error for an argument out of its range, for bounds that are no rectangle, and for more
        than 4,000,000 cells.
    Source: engine/room/radio_map.h.
    """
    tracer = Tracer(scene, max_depth, refraction, 0.0, diffraction)
    antennas = [tx] if isinstance(tx, Transmitter) else tx
    return RadioMap(*radio_maps(tracer, antennas, cell_size, height, bounds))


def cfr(paths: Paths, grid: OfdmGrid) -> NDArray[np.complex128]:
    """The channel of a link: h(f) = sum a exp(-2j pi f tau), f absolute.

    Args:
        paths: the Paths of trace.
        grid: the tones.

    Returns:
        The frequency response; the caller may write into it.

    Shapes: (tones,). Units: amplitude, 1 / 1. Frame: none; time factor exp(+j w t).
    Errors: none.
    Source: engine/trace/paths.h, engine/trace/cfr_kernel.h.
    """
    return paths.cfr(grid)


def gradient(
    paths: Paths,
    grid: OfdmGrid,
    csi_adjoint: NDArray[np.complex128],
    parameters: Sequence[str],
) -> tuple[list[str], NDArray[np.float64]]:
    """Derivatives of a real loss L of the channel by numbers of the link.

    Args:
        paths: the Paths of trace.
        grid: the tones.
        csi_adjoint: g with dL = Re sum conj(g) dh; for L = sum |h|^2 it is 2 h.
        parameters: names of `parameter_names`.

    Returns:
        The name of each derivative ("rx" becomes "rx.0", "rx.1", "rx.2"), and the derivatives.

    Shapes: csi_adjoint (tones,); the derivatives (parameters,).
    Units: unit of L per metre, radian, S/m, or 1 of gains and eps_r.
    Frame: world, right-handed, z up.
    Errors: Error for a name that the scene has not, for a parameter without derivative, and for an
        adjoint that is not one finite value a tone.
    Source: engine/trace/path_derivatives.h. The bits are those of the engine in C++.
    """
    derivatives = paths.derivatives(parameters)
    return derivatives.names, derivatives.loss_gradient(grid, csi_adjoint)


def changed(link: Link, parameters: Sequence[str], by: Sequence[float]) -> Link:
    """A link with some of its numbers changed, for the next step of a descent.

    Args:
        link: the link to change; it stays as it is.
        parameters: names of single numbers, as `gradient` returns them.
        by: number that is added to each.

    Returns:
        The changed link, to be traced anew.

    Shapes: by (parameters,). Units: metres, radians, S/m, or 1 of gains and eps_r.
    Frame: world; offsets along the normals of their surfaces.
    Errors: Error where there are not as many values as parameters, where one is not finite, and
        where the result is no scene.
    Source: engine/trace/link_change.h.
    """
    scene, tx, rx, gain = changed_link(
        link.scene, link.tx, link.rx, parameters, np.asarray(by, dtype=np.float64)
    )
    return Link(scene, tx, rx, link.gain * gain)
