#!/usr/bin/env python3
"""Cuts the reference channels down to what the tests need.

usage: extract.py GOLDENS [--all-links]

GOLDENS: the folder with derived_goldens.json and sionna_<room>.json. Writes room_cases.json,
meeting_room.json and corridor.json beside this script: paths with at most MAX_ORDER reflections,
their double-precision values only. See README.md for the origin.
"""
import json
import os
import sys

MAX_ORDER = 2
HERE = os.path.dirname(os.path.abspath(__file__))
# (receiver, transmitter element) kept of each furnished room: every receiver at the middle element,
# the outer elements at a few.
FEW = (0, 3, 7, 11)


def load(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as fh:
        return json.load(fh)


def save(name, doc):
    text = json.dumps(doc, separators=(",", ":"))
    for key in ('{"seq"', '{"objects"', '{"position"', '{"rx"', '{"material"'):
        text = text.replace(key, "\n" + key)
    with open(os.path.join(HERE, name), "w", encoding="utf-8") as fh:
        fh.write(text + "\n")


def room_cases(folder):
    doc = load(folder, "derived_goldens.json")
    out = {k: doc[k] for k in ("frequency", "itu_p2040_3", "slab")}
    out["cases"] = {}
    for name, case in doc["cases"].items():
        elements = []
        for element in case["elements"]:
            kept = {"position": element["position"], "counts": element["counts"][: MAX_ORDER + 1]}
            if "paths" in element:
                kept["paths"] = [p for p in element["paths"] if len(p["seq"]) <= MAX_ORDER]
                elements.append(kept)
        out["cases"][name] = dict(case, elements=elements)
    return out


def furnished(folder, name, all_links):
    doc = load(folder, name)
    out = {k: doc[k] for k in ("frequency", "pattern", "polarization", "materials", "transmitter",
                               "receivers")}
    out["links"] = []
    for link in doc["links"]:
        if not (all_links or link["tx_element"] == 1 or link["rx"] in FEW):
            continue
        paths = [{k: p[k] for k in ("objects", "vertices", "tau", "a", "angles")}
                 for p in link["paths"] if len(p["kinds"]) <= MAX_ORDER]
        out["links"].append({"rx": link["rx"], "tx_element": link["tx_element"], "paths": paths})
    return out


def main():
    folder, all_links = sys.argv[1], "--all-links" in sys.argv
    save("room_cases.json", room_cases(folder))
    for room in ("meeting_room", "corridor"):
        save(room + ".json", furnished(folder, "sionna_" + room + ".json", all_links))


if __name__ == "__main__":
    main()
