#!/usr/bin/env python3
"""Writes the seeds of the decoders' and the assembler's fuzz targets from tests/data/captures.

    tests/fuzz/make_corpus.py            run in the root of the checkout

Seeds are cut to what teaches the fuzzer something: a few datagrams of each recording.
"""
import gzip
import pathlib
import struct

ROOT = pathlib.Path(__file__).parent
CAPTURES = ROOT.parent / "data" / "captures"


def payloads(name):
    data = (CAPTURES / name).read_bytes()
    if name.endswith(".gz"):
        data = gzip.decompress(data)
    at = 24
    while at < len(data):
        length = struct.unpack_from("<I", data, at + 8)[0]
        yield data[at + 16 + 42 : at + 16 + length]
        at += 16 + length


def write(target, name, data):
    folder = ROOT / "corpus" / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)


def records(datagrams):
    return b"".join(struct.pack("<hH", 1, len(d)) + d for d in datagrams)


AXCSI = ["axcsi-rt-ax86u/AllData.pcap", "axcsi-rt-ax86u/extreme.pcap", "axcsi-rt-ax86u/middle.pcap.gz"]
NEXMON = ["nexmon-csikit/" + n for n in
          ("example_4339.pcap.gz", "example_4358.pcap", "example_4366c0.pcap.gz", "example_43455c0.pcap.gz")]
UBILOCATE = ["ubilocate-rt-ac86u/test_ch_bw_trace4.pcap.gz"]

for target, recordings in (("axcsi", AXCSI), ("nexmon", NEXMON), ("ubilocate", UBILOCATE)):
    for recording in recordings:
        all_payloads = list(payloads(recording))
        stem = recording.split("/")[1].split(".")[0]
        write(target, stem, all_payloads[0])
        write(target, stem + "_cut", all_payloads[1][:40])
        count = 20 if target == "axcsi" else 4
        write("assembler", stem, b"\x20" + records(all_payloads[:count]))
        reordered = all_payloads[:4][::-1] + all_payloads[:2]
        write("assembler", stem + "_reordered", b"\x03" + records(reordered))

# HE, 512 tones in two datagrams: only the header matters.
header = bytearray(next(payloads(AXCSI[0]))[:54])
header[23] = 3
for first in (0, 256):
    struct.pack_into("<HHH", header, 12, first, first + 255, 512)
    write("axcsi", f"he40_from_{first}", bytes(header) + bytes(4 * 256))

# Headers of the relay (capture/relayed_datagram.h): a datagram, a tick, and what must be refused.
NOW = 1_800_000_000_000_000_000


def relayed(kind, time, payload=b"", magic=b"RLC1"):
    return struct.pack("<4sI6Q2I2H", magic, kind, 7, 41, time, time - 10, 3, 2, 0x0A0A0A02, 0x0A0A0A01, 5500, 5501) + payload


write("relay", "datagram", relayed(0, NOW, next(payloads(AXCSI[0]))))
write("relay", "tick", relayed(1, NOW))
write("relay", "other_kind", relayed(2, NOW))
write("relay", "other_magic", relayed(0, NOW, magic=b"RLC2"))
write("relay", "cut", relayed(0, NOW)[:67])
write("relay", "of_2200", relayed(1, 7_258_118_400_000_000_000))
write("relay", "after_2200", relayed(1, 7_258_118_400_000_000_011))
