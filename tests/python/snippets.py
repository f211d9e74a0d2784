"""The code of a page of Markdown, block by block."""

from __future__ import annotations

import re
from pathlib import Path


def blocks(page: Path) -> list[str]:
    return re.findall(r"^```python\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)
