"""Recordings of channel state information as arrays of numpy."""

from __future__ import annotations

from os import PathLike
from typing import Any, Mapping, Optional, Sequence, Union

from rayloc.needs import explained

try:
    import numpy as np
    from numpy.typing import NDArray

    from rayloc._engine import FrameTable, read_frame_table
except ModuleNotFoundError as error:
    raise explained(error) from None

__all__ = ["Frames", "read_frames"]

File = Union[str, "PathLike[str]"]


class Frames:
    """Frames of recordings: one array of all values, where it was measured, and headers.

    Made by `read_frames`. Values are 0 where nothing was measured, and have the scale of the access
    point's gain control; `power_dbm` has the level.

    Shapes: `csi` and `mask` (frames, cores, tones), `headers` (frames,), `power_dbm` (frames,
        cores), `cores` (cores,), `tone_index` (tones,).
    Units: times datetime64[ns] in UTC, `tone_spacing` hertz, `power_dbm` dBm.
    Frame: time factor exp(+j w t), tones ascending, rotations of 802.11 undone; the requested one of
        several spatial streams.
    Errors: `of` raises KeyError for a transmitter without frames, `where` ValueError for an argument
        that is no mask of these frames.
    Source: engine/channel/csi_frame.h, daemon/lab/recordings/frame_arrays.h.
    """

    def __init__(self, table: FrameTable, stream: int) -> None:
        self._table = table
        self._stream = stream
        arrays = table.arrays(stream)
        self.csi: NDArray[np.complex64] = arrays["csi"]
        self.mask: NDArray[np.bool_] = arrays["mask"]
        self.headers: NDArray[Any] = arrays["headers"]
        self.power_dbm: NDArray[np.float32] = arrays["power_dbm"]
        self.cores: NDArray[np.uint8] = arrays["cores"]
        self.tone_index: NDArray[np.int16] = arrays["tone_index"]

    @property
    def access_points(self) -> list[str]:
        """Names that the field `access_point` of the headers counts."""
        return self._table.access_points

    @property
    def notes(self) -> list[str]:
        """Notes on the recordings: gaps, clocks, rejected datagrams."""
        return self._table.notes

    @property
    def transmitters(self) -> list[str]:
        """Addresses, that of the most frames first."""
        names, counts = np.unique(self.headers["transmitter"], return_counts=True)
        return [names[i].decode() for i in np.argsort(-counts, kind="stable")]

    def where(self, chosen: NDArray[np.bool_]) -> Frames:
        """The frames for which `chosen`, (frames,), is true; ValueError for anything but that."""
        mask: NDArray[Any] = np.asarray(chosen)
        # Frame numbers, or a mask of other frames, would select unintended frames.
        if mask.dtype != np.dtype(bool) or mask.shape != (len(self),):
            raise ValueError(
                f"where: a mask of {len(self)} booleans, one a frame, is needed, not "
                f"{mask.dtype} of shape {mask.shape}"
            )
        numbers: list[int] = np.flatnonzero(mask).tolist()
        return Frames(self._table.taken(numbers), self._stream)

    def of(self, transmitter: str) -> Frames:
        """The frames of one transmitter, by its address."""
        found = self.headers["transmitter"] == transmitter.lower().encode()
        if not found.any():
            raise KeyError(f"{transmitter} has no frames; there are {', '.join(self.transmitters)}")
        return self.where(found)

    def __len__(self) -> int:
        return len(self._table)


def read_frames(
    captures: Union[File, Sequence[File], Mapping[str, File]],
    site: Optional[File] = None,
    format: str = "",
    stream: int = 0,
) -> Frames:
    """Reads the frames of recordings.

    Args:
        captures: a pcap or pcapng file (also .gz), several, or a mapping from the name of an access
            point to its file. A text "AP=FILE" is as on the command line.
        site: a directory with site.toml; its access points then count, as Localizer needs it.
        format: a wire format, such as "axcsi-v4"; "" recognises it. Not with site, which states it.
        stream: the spatial stream whose values are wanted.

    Returns:
        The frames of all recordings.

    Shapes: as Frames has them. Units: as Frames has them.
    Frame: as Frames has it.
    Errors: Error for a file that is no recording, and for an access point that the site has not.
    Source: capture/README.md, capture/WIRE_FORMATS.md.
    """
    words: list[str]
    if isinstance(captures, Mapping):
        words = [f"{name}={file}" for name, file in captures.items()]
    elif isinstance(captures, (str, PathLike)):
        words = [str(captures)]
    else:
        words = [str(file) for file in captures]
    if stream < 0:
        raise ValueError(f"stream is 0 or more, not {stream}")
    return Frames(read_frame_table(words, site, format), stream)
