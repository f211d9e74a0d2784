"""Long computations in a separate process, which reports its progress and can be ended at any time.

No thread of C++ can be ended from outside. A process can, and the files that it has written remain.
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from typing import IO, Callable, Optional

Progress = Callable[[float, str], None]

# Seconds in which the process may end by itself, within the second that Ctrl-C may take.
PATIENCE = 0.7


def no_progress(share: float, text: str) -> None:
    """The callback of a caller who has none."""
    del share, text


def start(code: str, *arguments: str, reads: bool, reports: bool) -> subprocess.Popen[str]:
    """Starts Python with `code` in a separate session. A terminal sends Ctrl-C only to this process,
    which ends the child (`end`). `reads`: standard input is a pipe; `reports`: standard error, too."""
    return subprocess.Popen(
        [sys.executable, "-c", code, *arguments],
        stdin=subprocess.PIPE if reads else subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE if reports else None,
        text=True,
        errors="replace",
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)},
    )


def follow(lines: IO[str], progress: Optional[Progress], other: Callable[[str], object]) -> None:
    """Reports lines "progress SHARE TEXT" until the child closes its standard error; `other` takes the rest."""
    for line in lines:
        word, _, rest = line.rstrip("\n").partition(" ")
        share, _, text = rest.partition(" ")
        try:
            value = float(share) if word == "progress" else None
        except ValueError:  # a message that begins with this word
            value = None
        if value is None:
            other(line)
        elif progress is not None:
            progress(value, text)


def end(child: subprocess.Popen[str]) -> None:
    """Asks the child to end, and kills it if it does not."""
    child.send_signal(signal.SIGINT)
    try:
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(PATIENCE)
    finally:  # also at a second Ctrl-C
        child.kill()
