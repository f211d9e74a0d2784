#!/usr/bin/env python3
"""The nearest surveyed point on CiFi's and DSCP's own input (2026-11-baselines.md).

    engine/studies/2026-11-baselines-nearest.py ROOM_FOLDER RAYLOC

Needs numpy. ROOM_FOLDER is one of ../shared/datasets, which are not part of the project; only the answers
are read to compare. Chain gains matter to neither distance: phases are off by a constant of each tone at
every place alike, and amplitudes are divided by their mean over the survey.
"""
import csv
import datetime
import json
import os
import subprocess
import sys

import numpy as np

ROOM, RAYLOC = sys.argv[1:3]
TRANSMITTER = {"cifi": "02:52:4c:00:00:01", "dscp": "02:52:4c:00:00:02"}
SHAPE = (3, 114, 2)  # antennas, tones, real and imaginary


def frames(access_point, name, transmitter):
    folder = ROOM if access_point == 1 else os.path.join(ROOM, "ap%d" % access_point)
    file = "ap%d=%s" % (access_point, os.path.join(folder, name + ".pcap"))
    time, h = [], []
    with subprocess.Popen([RAYLOC, "frames", "--json", "--values", "--quiet", file],
                          stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            frame = json.loads(line)
            if frame.get("transmitter") != transmitter or "csi" not in frame:
                continue
            value = np.array([antenna[0] for antenna in frame["csi"]])
            if value.shape != SHAPE:
                continue
            stamp = datetime.datetime.strptime(frame["time"].rstrip("Z")[:26], "%Y-%m-%dT%H:%M:%S.%f")
            time.append(stamp.replace(tzinfo=datetime.timezone.utc).timestamp())
            h.append((value[..., 0] + 1j * value[..., 1])[np.argsort(frame["cores"])])
    return np.array(time), np.array(h)


def points(file):
    for folder in ("", "answers"):
        path = os.path.join(ROOM, folder, file)
        if os.path.exists(path):
            with open(path, encoding="utf-8") as rows:
                return [tuple(float(row[key]) for key in ("t_start", "t_end", "x", "y"))
                        for row in csv.DictReader(rows)]
    raise FileNotFoundError(file)


def phases(h):
    """Mean over the frames of what the phase from each antenna to the next is as a complex number."""
    turn = h[:, 1:] * h[:, :-1].conj()
    return np.mean(turn / (np.abs(turn) + 1e-12), axis=0).ravel()


def amplitudes(h):
    size = np.abs(h)
    return np.mean(size / np.sqrt(np.mean(size ** 2, axis=(1, 2), keepdims=True)), axis=0)


def images(heard, places, draw):
    """One a place; None where nothing was heard."""
    time, h = heard
    within = [(time >= p[0] - 0.05) & (time <= p[1] + 0.05) for p in places]
    return [draw(h[w]) if w.any() else None for w in within]


def differences(survey, asked):
    """Of amplitudes between the three pairs of antennas, over the deviation of the survey."""
    mean = np.mean([v for v in survey if v is not None], axis=0)

    def planes(value):
        value = value / mean
        return np.concatenate([value[a] - value[b] for a, b in ((0, 1), (0, 2), (1, 2))])

    drawn = [[None if v is None else planes(v) for v in values] for values in (survey, asked)]
    deviation = np.std([v for v in drawn[0] if v is not None])
    return [[None if v is None else v / deviation for v in values] for values in drawn]


def nearest(method, survey_name, asked_name, access_points):
    survey, asked = points(survey_name + ".csv"), points(asked_name + ".csv")
    known, seen = [[] for _ in survey], [[] for _ in asked]
    for access_point in access_points:
        draw = phases if method == "cifi" else amplitudes
        both = [images(frames(access_point, name, TRANSMITTER[method]), places, draw)
                for name, places in ((survey_name, survey), (asked_name, asked))]
        if method == "dscp":
            both = differences(*both)
        silence = np.zeros_like(next(v for v in both[0] if v is not None))
        for target, values in zip((known, seen), both):
            for place, value in zip(target, values):
                place.append(silence if value is None else value)
    known = np.array([np.concatenate(v) for v in known])
    place = np.array([p[2:] for p in survey])
    error = []
    for value, truth in zip(seen, asked):
        best = np.argmin(np.sum(np.abs(known - np.concatenate(value)) ** 2, axis=1))
        error.append(np.hypot(*(place[best] - truth[2:])))
    error = np.array(error)
    draws = np.median(error[np.random.default_rng(1).integers(0, len(error), (2000, len(error)))], axis=1)
    print("%s, %s, access points %s: %d known, %d asked, median %.2f (%.2f to %.2f)" %
          (ROOM, method, access_points, len(survey), len(asked), np.median(error),
           *np.percentile(draws, [2.5, 97.5])), flush=True)


for few in ((1,), (1, 2, 3)):
    nearest("cifi", "calibration", "device_los", few)
for few in ((1,), (1, 2, 3)):
    nearest("dscp", "free_cal", "free", few)
