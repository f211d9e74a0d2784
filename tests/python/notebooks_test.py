"""The notebooks run from top to bottom, and print the outputs that they state."""

from __future__ import annotations

import json
from pathlib import Path

import notebook
import pytest
from conftest import ROOT

FILES = sorted((ROOT / "deploy/clients/python/examples/notebooks").glob("*.ipynb"))


def test_there_are_three() -> None:
    assert [file.stem for file in FILES] == ["descend_a_loss", "read_a_capture", "trace_a_room"]


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.stem))
def test_it_prints_what_it_says(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    content = json.loads(file.read_text())
    assert content["nbformat"] == 4
    printed = notebook.run(content)
    assert "".join(printed) != ""
    assert printed == notebook.stated(content)


def test_a_cell_that_prints_something_else_is_found() -> None:
    cell = {"cell_type": "code", "source": ["print(2)"], "outputs": [{"text": ["1\n"]}]}
    wrong = {"cells": [cell]}
    assert notebook.run(wrong) == ["2\n"] != notebook.stated(wrong)
