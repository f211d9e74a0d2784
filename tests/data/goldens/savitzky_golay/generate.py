#!/usr/bin/env python3
"""Smoothed rows of complex noise by scipy.signal.savgol_filter, mode "interp".

usage: generate.py      (needs python3-scipy; writes smoothed.json.gz beside this script)
"""
import gzip
import json
import os

import numpy as np
from scipy.signal import savgol_filter

HERE = os.path.dirname(os.path.abspath(__file__))


def pairs(values):
    return [[v.real, v.imag] for v in values]


def main():
    random = np.random.default_rng(1)
    cases = []
    for size, window, order in [(57, 11, 3), (57, 11, 0), (114, 21, 2), (9, 9, 4), (30, 1, 0)]:
        row = random.normal(size=size) + 1j * random.normal(size=size)
        smooth = savgol_filter(row.real, window, order, mode="interp") + 1j * savgol_filter(
            row.imag, window, order, mode="interp")
        cases.append({"window": window, "order": order, "row": pairs(row), "smooth": pairs(smooth)})
    with gzip.GzipFile(os.path.join(HERE, "smoothed.json.gz"), "wb", mtime=0) as out:
        out.write(json.dumps(cases).encode())


if __name__ == "__main__":
    main()
