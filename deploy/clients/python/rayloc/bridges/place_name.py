"""Names of zones as states and as zones of Home Assistant.

Home Assistant keeps some words for itself as states and takes at most 255 characters. A zone that is named
otherwise in site.toml gets another name here, and two zones never the same one.
"""

from __future__ import annotations

import hashlib
import re
import unicodedata
from typing import Optional

HOME, NOT_HOME = "home", "not_home"
LONGEST = 255  # maximum number of characters of a state
# States of a tracker, of any entity and of no value; "away" is the term for not_home in its pages.
OWN_STATES = frozenset({"", HOME, NOT_HOME, "away", "unknown", "unavailable", "none"})
SUFFIX = "(zone)"


def state_of_zone(zone: str) -> str:
    """The zone's name, unless Home Assistant would take it for something else or not at all."""
    clean = "".join(" " if unicodedata.category(each) == "Cc" else each for each in zone).strip()
    state = f"{clean} {SUFFIX}".strip() if _is_own(clean) else clean
    if clean == zone and len(state) <= LONGEST:
        return state
    # Different names may have become equal: the digest uses the name in site.toml.
    digest = hashlib.sha256(zone.encode(errors="replace")).hexdigest()[:8]
    return f"{state[: LONGEST - 9].strip()} {digest}"


def renaming_of(zone: str) -> Optional[str]:
    """Why state_of_zone() is another name; None if it is the same."""
    state = state_of_zone(zone)
    if state == zone:
        return None
    reason = "its name begins or ends with a blank or has a control character"
    if len(zone) > LONGEST:
        reason = f"its name has {len(zone)} characters, and a state has at most {LONGEST}"
    elif _is_own(zone.strip()):
        reason = "its name is one of Home Assistant's own states"
    return f"zone {_short(zone)!r} becomes {_short(state)!r} in Home Assistant: {reason}; rename it in site.toml"


def zone_of_state(state: str) -> str:
    """The key by which Home Assistant finds its own zone: the entity id that it gave to a zone of that name, or
    the name itself where that id cannot be derived (it transliterates other scripts)."""
    decomposed = unicodedata.normalize("NFKD", state)
    letters = "".join(each for each in decomposed if not unicodedata.combining(each)).lower()
    if not letters.isascii():
        return state
    digits = re.sub(r"(?<=\d),(?=\d)", "", letters)
    slug = re.sub(r"[^a-z0-9]+", "_", digits).strip("_")
    return f"zone.{slug}" if slug else state


def _is_own(name: str) -> bool:
    """In any case, with blanks or hyphens, invisible characters and a suffix of ours or not."""
    visible = "".join(each for each in name if unicodedata.category(each) != "Cf")
    words = unicodedata.normalize("NFKC", visible).casefold()
    while words.rstrip().endswith(SUFFIX):
        words = words.rstrip()[: -len(SUFFIX)]
    return re.sub(r"[\s_-]+", "_", words).strip("_") in OWN_STATES


def _short(text: str) -> str:
    return text if len(text) <= 60 else f"{text[:40]}...{text[-15:]}"
