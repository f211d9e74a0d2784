#!/usr/bin/python3
"""Cuts a short recording out of an AX-CSI pcap by the spots of a surveyed csv.

    cut_recording.py RECORDING.pcap SPOTS.csv --out CUT.pcap.gz [--spots-out CUT.csv]
                     [--first N] [--every-spot N] [--every-frame N] [--margin S]

A record is kept when its time lies in one of the kept spots [t_start, t_end], widened by
--margin; of its frames (counter `sn`, AX-CSI bytes 6-7) every N-th is kept. Records are copied
as they are. The gzip header holds no time and no name: the same input gives the same bytes.
"""
import argparse
import gzip
import struct

ETHERNET_IPV4_UDP = 14 + 20 + 8  # bytes before the AX-CSI header; the recordings have no IP options
CLASSIC_MICROSECONDS = 0xA1B2C3D4


def records(data):
    """(time in seconds, sn, whole record) of each datagram; little-endian classic pcap."""
    offset = 24
    while offset < len(data):
        seconds, micros, length, _ = struct.unpack_from("<IIII", data, offset)
        end = offset + 16 + length
        (sn,) = struct.unpack_from("<H", data, offset + 16 + ETHERNET_IPV4_UDP + 6)
        yield seconds + micros * 1e-6, sn, data[offset:end]
        offset = end


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("recording")
    parser.add_argument("spots")
    parser.add_argument("--out", required=True)
    parser.add_argument("--spots-out")
    parser.add_argument("--first", type=int, help="keep the first N spots")
    parser.add_argument("--every-spot", type=int, default=1)
    parser.add_argument("--every-frame", type=int, default=1)
    parser.add_argument("--margin", type=float, default=0.2, help="seconds around a spot")
    args = parser.parse_args()

    with open(args.spots, encoding="ascii") as file:
        header, *rows = file.read().splitlines()
    rows = rows[: args.first : args.every_spot]
    windows = [tuple(float(v) for v in row.split(",")[:2]) for row in rows]

    with open(args.recording, "rb") as file:
        data = file.read()
    if struct.unpack_from("<I", data)[0] != CLASSIC_MICROSECONDS:
        raise SystemExit(f"{args.recording}: not a little-endian classic pcap")

    kept, first_sn = [data[:24]], None
    for time, sn, record in records(data):
        if not any(a - args.margin <= time <= b + args.margin for a, b in windows):
            continue
        first_sn = sn if first_sn is None else first_sn
        if (sn - first_sn) % 65536 % args.every_frame == 0:
            kept.append(record)
    with open(args.out, "wb") as file:
        with gzip.GzipFile("", "wb", 9, file, mtime=0) as zipped:
            zipped.write(b"".join(kept))
    if args.spots_out:
        with open(args.spots_out, "w", encoding="ascii") as file:
            file.write("\n".join([header, *rows]) + "\n")


if __name__ == "__main__":
    main()
