#!/usr/bin/python3
"""Runs the code cells of a notebook, one after the other, in one namespace.

    notebook.py FILE...            prints what differs from the outputs that the file has
    notebook.py --write FILE...    puts the outputs into the file

Jupyter's own runner (Debian's python3-nbclient) brings a kernel, a message queue and thirty packages
to do the same with cells that print text.
"""

from __future__ import annotations

import contextlib
import io
import json
import sys
from pathlib import Path
from typing import Any


def run(notebook: dict[str, Any]) -> list[str]:
    """The output of each code cell."""
    namespace: dict[str, Any] = {"__name__": "__main__"}
    printed: list[str] = []
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile("".join(cell["source"]), "<cell>", "exec"), namespace)
            printed.append(out.getvalue())
    return printed


def stated(notebook: dict[str, Any]) -> list[str]:
    """The output of each code cell that the file states."""
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    return ["".join("".join(output["text"]) for output in cell["outputs"]) for cell in cells]


def write(file: Path, notebook: dict[str, Any], printed: list[str]) -> None:
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    for number, (cell, text) in enumerate(zip(cells, printed)):
        cell["execution_count"] = number + 1
        stream = {"name": "stdout", "output_type": "stream", "text": text.splitlines(keepends=True)}
        cell["outputs"] = [stream] if text else []
    file.write_text(json.dumps(notebook, indent=1) + "\n")


def main() -> int:
    differ = 0
    rewrite = sys.argv[1:2] == ["--write"]
    for name in sys.argv[2 if rewrite else 1 :]:
        file = Path(name)
        notebook = json.loads(file.read_text())
        printed = run(notebook)
        if rewrite:
            write(file, notebook, printed)
        for number, (now, then) in enumerate(zip(printed, stated(notebook))):
            if now != then:
                print(f"{name}, cell {number + 1}: it says\n{then}and prints\n{now}")
                differ = 1
    return differ


if __name__ == "__main__":
    sys.exit(main())
