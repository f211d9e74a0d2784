"""How to subscribe."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Sequence, Union


@dataclass(frozen=True)
class Curve:
    """Keys of an encrypted connection, 40 characters of Z85 each: the daemon's public key, and
    this subscriber's secret one, whose public half the daemon must list under [curve] allow."""

    server_key: str
    secret_key: str

    @staticmethod
    def read(server_key: Union[str, Path], secret_key: Union[str, Path]) -> Curve:
        """Reads files of `rayloc keygen`: the public key of the daemon, as it was printed, and the
        secret key of this subscriber. OSError or ValueError when one cannot be used."""
        return Curve(_read_key(Path(server_key)), _read_key(Path(secret_key)))


def _read_key(file: Path) -> str:
    line = (file.read_text().splitlines() or [""])[0].strip()
    if len(line) != 40:
        raise ValueError(f"{file}: its first line is no key of 40 characters; see `rayloc keygen`")
    return line


@dataclass(frozen=True)
class Options:
    """As the arguments of Subscriber."""

    topics: tuple[str, ...]
    targets: frozenset[str]
    snapshot: bool  # request one at the start
    stale_after: float  # [s]
    patience: float  # [s]


def make_options(
    topics: Sequence[str],
    targets: Sequence[str],
    snapshot: bool,
    stale_after: float,
    patience: float,
) -> Options:
    """ValueError or TypeError for what cannot be meant."""
    for name, value in (("topics", topics), ("targets", targets)):
        if isinstance(value, str):
            raise TypeError(f"{name}: a list of texts is needed, not the text {value!r}")
    if not topics:
        raise ValueError('topics: empty; write ["v1/"] for all')
    if stale_after <= 0 or patience <= 0:
        raise ValueError("stale_after and patience: seconds above 0 are needed")
    return Options(tuple(topics), frozenset(targets), snapshot, stale_after, patience)
