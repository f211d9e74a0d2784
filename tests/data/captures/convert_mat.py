#!/usr/bin/env python3
"""Converts the CSI of CSIKit's .mat files to the .values.gz files beside this script.

    convert_mat.py example_4366c0.mat nexmon-csikit/example_4366c0.values.gz [FRAMES]

The .mat holds the output of nexmon's own MATLAB reader: one row a datagram, whole numbers, in the
order of the wire. Output: per value two little-endian int16 (real, imaginary), row by row, gzip.
Needs python3-scipy; the tests read only its output.
"""
import gzip
import struct
import sys

import scipy.io

values = scipy.io.loadmat(sys.argv[1])["csi_buff"]
frames = int(sys.argv[3]) if len(sys.argv) > 3 else len(values)
data = bytearray()
for row in values[:frames]:
    for value in row:
        assert value.real == int(value.real) and value.imag == int(value.imag)
        data += struct.pack("<hh", int(value.real), int(value.imag))
with open(sys.argv[2], "wb") as raw:
    with gzip.GzipFile(fileobj=raw, mode="wb", mtime=0, filename="") as out:
        out.write(data)
