#!/usr/bin/env python3
"""What real recordings show: the figures of 2026-11-real-recordings.md.

    rayloc frames --json --values --quiet DATA/lgtm_intel5300_mit/*.dat --out FRAMES/lgtm.jsonl
    rayloc frames --json --values --quiet DATA/ivanet_polyu_mit/*.dat --out FRAMES/ivanet.jsonl
    rayloc frames --json --values --quiet DATA/epic_csu_nexmon_bsd3/*/*.pcap --out FRAMES/epic.jsonl
    engine/studies/2026-11-real-recordings.py DATA FRAMES

Needs numpy. DATA is ../shared/realdata, which is not part of the project.
"""
import collections
import json
import os
import re
import sys
import xml.etree.ElementTree as ElementTree
import zipfile

import numpy as np

DATA, FRAMES = sys.argv[1:3]
RANDOM = np.random.default_rng(1)


def recordings(name):
    """{file: (tones, h[frame, antenna, tone], level[frame, antenna])}, the first stream of each."""
    frames = collections.defaultdict(list)
    with open(os.path.join(FRAMES, name + ".jsonl"), encoding="utf-8") as lines:
        for line in lines:
            frame = json.loads(line)
            if "csi" in frame:
                frames[os.path.basename(frame["ap"])].append(frame)
    result = {}
    for file, of_file in frames.items():
        tones = of_file[0]["tone_index"]
        kept = [f for f in of_file if f["tone_index"] == tones and len(f["csi"]) == len(of_file[0]["csi"])]
        values = np.array([[antenna[0] for antenna in f["csi"]] for f in kept], float)
        level = np.array([[np.nan if p is None else p for p in f["power_dbm"]] for f in kept], float)
        result[file] = np.array(tones), values[..., 0] + 1j * values[..., 1], level
    return result


def interval(errors):
    """Median, and its interval of 95 % by bootstrap."""
    errors = np.asarray(errors)
    draws = np.median(errors[RANDOM.integers(0, len(errors), (2000, len(errors)))], axis=1)
    return "%.2f (%.2f to %.2f)" % (np.median(errors), *np.percentile(draws, [2.5, 97.5]))


# --- lgtm: bearings -----------------------------------------------------------------------------


def even_tones(tones, h):
    """At 20 MHz an Intel 5300 has even tones below the centre and odd ones above: made even."""
    wanted = np.arange(-28, 29, 2)
    real = np.apply_along_axis(lambda y: np.interp(wanted, tones, y), -1, h.real)
    return real + 1j * np.apply_along_axis(lambda y: np.interp(wanted, tones, y), -1, h.imag)


def sanitised(h):
    """Takes off the slope and the offset over the tones that all antennas share."""
    k = np.arange(h.shape[1])
    phase = np.unwrap(np.angle(h), axis=1)
    phase -= 2 * np.pi * np.round((phase[:, :1] - phase[0, 0]) / (2 * np.pi))
    slope, offset = np.polyfit(np.tile(k, len(h)), phase.ravel(), 1)
    return h * np.exp(-1j * (slope * k + offset))


def music(h):
    """Paths of one frame as SpotFi has them: (phase from antenna to antenna, delay [steps], power).

    Windows of two antennas and half of the tones; noise subspace; two to five paths.
    """
    antennas, tones = h.shape
    half = tones // 2
    columns = []
    for a in range(antennas - 1):
        for k in range(tones - half + 1):
            columns.append(h[a:a + 2, k:k + half].ravel())
    x = np.array(columns).T
    value, vector = np.linalg.eigh(x @ x.conj().T)
    value, vector = value[::-1], vector[:, ::-1]
    count = 2
    for i in range(1, 5):
        if value[i - 1] > 0.03 * value[0] and value[i - 1] / value[i] >= 1.58:
            count = max(2, i)
    signal = vector[:, :count]
    psi = np.linspace(-np.pi, np.pi, 90, endpoint=False)
    turn = np.linspace(-0.7, 0.7, 57)  # [rad] a tone step: +- 180 ns
    row = np.exp(-1j * np.outer(turn, np.arange(half)))
    projected = np.zeros((len(psi), len(turn)))
    for i, p in enumerate(psi):
        steering = np.concatenate([row, np.exp(1j * p) * row], axis=1) / np.sqrt(2 * half)
        projected[i] = np.sum(np.abs(steering.conj() @ signal) ** 2, axis=1)
    spectrum = 1 / (1 - projected + 1e-9)
    peaks = []
    for i in range(len(psi)):
        for j in range(1, len(turn) - 1):
            around = spectrum[np.ix_([i - 1, i, (i + 1) % len(psi)], [j - 1, j, j + 1])]
            if spectrum[i, j] == around.max():
                peaks.append((spectrum[i, j], psi[i], turn[j]))
    peaks.sort(reverse=True)
    return [(p, t, s) for s, p, t in peaks[:count]]


def direct_path(frames):
    """The phase of the cluster that is heaviest, tightest and soonest."""
    paths = [path for h in frames for path in music(sanitised(h))]
    if not paths:
        return np.nan
    psi = np.array([p[0] for p in paths])
    turn = np.array([p[1] for p in paths])
    point = np.stack([np.cos(psi), np.sin(psi), turn / 0.2], 1)
    centre = point[np.argmax([p[2] for p in paths])][None]
    while len(centre) < min(5, len(point)):  # the farthest point, five times
        distance = np.min(np.linalg.norm(point[:, None] - centre, axis=2), axis=1)
        centre = np.concatenate([centre, point[[np.argmax(distance)]]])
    for _ in range(20):
        of = np.argmin(np.linalg.norm(point[:, None] - centre, axis=2), axis=1)
        centre = np.array([point[of == c].mean(0) if np.any(of == c) else centre[c]
                           for c in range(len(centre))])
    best, chosen = -np.inf, np.nan
    for c in range(len(centre)):
        mine = of == c
        if not mine.any():
            continue
        mean = np.angle(np.mean(np.exp(1j * psi[mine])))
        spread = np.std(np.angle(np.exp(1j * (psi[mine] - mean)))) / np.pi
        score = mine.mean() - 10 * spread - 10 * np.std(turn[mine]) - np.mean(turn[mine])
        if score > best:
            best, chosen = score, mean
    return chosen


def half_turn(phase):
    """To within a quarter of a turn: a chain of this card is known but for half a turn."""
    return (phase + np.pi / 2) % np.pi - np.pi / 2


def rms_off(measured, expected):
    """What is left of the phases once the constant of the chains is taken off, left out in turn."""
    left = half_turn(measured - expected)
    off = []
    for i in range(len(left)):
        others = np.delete(left, i)
        constant = np.angle(np.mean(np.exp(2j * others))) / 2
        off.append(half_turn(left[i] - constant))
    return np.degrees(np.sqrt(np.mean(np.square(off))))


def chance(measured, expected):
    """Share of shuffles of the settings, with the better sign of the two, that are as good."""
    best = min(rms_off(measured, s * expected) for s in (1, -1))
    count = 500
    hits = sum(min(rms_off(measured, s * RANDOM.permutation(expected)) for s in (1, -1)) <= best
               for _ in range(count))
    return best, (hits + 1) / (count + 1)


def lgtm():
    print("lgtm: 0.10 m between antennas at 5.32 GHz, bearings of -20 to 20 degrees, 1 to 3 m")
    settings = collections.defaultdict(list)
    for file, (tones, h, _) in sorted(recordings("lgtm").items()):
        found = re.match(r"(\d)m_([mp])(\d+)deg_laptop(\d)_test(\d)", file)
        metres, sign, degrees, laptop, _ = found.groups()
        angle = int(degrees) * (-1 if sign == "m" else 1)
        if angle != 90:
            settings[int(laptop), int(metres), angle].append(even_tones(tones, h))
    wavelength = 299792458 / 5.32e9
    for laptop in (1, 2):
        mine = {k: v for k, v in settings.items() if k[0] == laptop}
        angles = np.array([k[2] for k in mine])
        expected = 2 * np.pi * 0.10 * np.sin(np.radians(angles)) / wavelength
        for first, second in ((0, 1), (1, 2)):
            phase, repeat = [], []
            for tests in mine.values():
                of_test = [np.angle(np.sum(h[:, second] * h[:, first].conj())) for h in tests]
                phase.append(0.5 * np.angle(np.mean(np.exp(2j * np.array(of_test)))))
                repeat.append(half_turn(np.array(of_test) - phase[-1]))
            off, p = chance(np.array(phase), expected)
            print("  laptop %d, antennas %d and %d, phase of the mean: %.0f degrees rms, p %.3f; "
                  "from test to test %.1f degrees; level %s dB" %
                  (laptop, first, second, off, p, np.degrees(np.sqrt(np.mean(np.concatenate(repeat) ** 2))),
                   [int(round(10 * np.log10(np.mean([np.mean(np.abs(h[:, a]) ** 2)
                                                      for t in mine.values() for h in t]))))
                    for a in (first, second)]))
        for antennas, name in (((0, 1, 2), "three antennas"), ((1, 2), "antennas 1 and 2")):
            phase = np.array([direct_path([h[i, list(antennas)] for h in tests for i in (20, 60, 100, 140)])
                              for tests in mine.values()])
            off, p = chance(phase, expected)
            print("  laptop %d, SpotFi's MUSIC of %s: %.0f degrees rms, p %.3f (%d settings)" %
                  (laptop, name, off, p, len(phase)))
    print("  no relation: 52 degrees rms")


# --- EPIC: places of corridors ------------------------------------------------------------------


def workbook(path):
    """{sheet: rows of texts} of an .xlsx."""
    space = {"m": "http://schemas.openxmlformats.org/spreadsheetml/2006/main"}
    number = "{http://schemas.openxmlformats.org/officeDocument/2006/relationships}id"
    book = zipfile.ZipFile(path)
    texts = ["".join(t.text or "" for t in s.iter("{%s}t" % space["m"]))
             for s in ElementTree.fromstring(book.read("xl/sharedStrings.xml"))]
    target = {r.get("Id"): r.get("Target")
              for r in ElementTree.fromstring(book.read("xl/_rels/workbook.xml.rels"))}
    sheets = {}
    for sheet in ElementTree.fromstring(book.read("xl/workbook.xml")).find("m:sheets", space):
        rows = []
        for row in ElementTree.fromstring(book.read("xl/" + target[sheet.get(number)])).iter(
                "{%s}row" % space["m"]):
            cells = [(c.get("t"), c.find("m:v", space)) for c in row.iter("{%s}c" % space["m"])]
            rows.append([texts[int(v.text)] if t == "s" else v.text for t, v in cells if v is not None])
        sheets[sheet.get("name")] = rows
    return sheets


def amplitudes(h):
    """Mean amplitude a tone of frames of one antenna, of mean square 1 each."""
    size = np.abs(h[:, 0])
    return np.mean(size / np.sqrt(np.mean(size ** 2, axis=1, keepdims=True)), axis=0)


def epic():
    folder = os.path.join(DATA, "epic_csu_nexmon_bsd3")
    coordinates = workbook(os.path.join(folder, "location_coords.xlsx"))
    heard = workbook(os.path.join(folder, "location_info.xlsx"))
    csi = recordings("epic")
    print("EPIC: corridors, a place of a test to the nearest reference that sounds alike [m]")
    all_errors = collections.defaultdict(list)
    for path in range(1, 6):
        place = {}
        for kind in ("ref", "test"):
            xy = {r[0]: np.array(r[1:3], float)
                  for r in coordinates["%s_coord_path%d" % (kind, path)][1:] if len(r) > 2}
            level = {r[0]: (r[1], float(r[2]))
                     for r in heard["%s_path%d" % (kind, path)][1:] if len(r) > 3}
            files = {f[len(kind) + 1:].rsplit("_", 1)[0]: f for f in csi if f.startswith(kind + "_")}
            place[kind] = [(xy[n], level[n], csi[files[n]]) for n in sorted(xy.keys() & level.keys() & files.keys())]
        errors = collections.defaultdict(list)
        middle = np.mean([r[0] for r in place["ref"]], axis=0)
        for at, (mac, dbm), (tones, h, _) in place["test"]:
            fair = [r for r in place["ref"] if r[1][0] == mac and len(r[2][0]) == len(tones)]
            if not fair:
                continue
            away = np.array([np.linalg.norm(r[0] - at) for r in fair])
            level = np.array([abs(r[1][1] - dbm) for r in fair])
            shape = np.array([np.linalg.norm(amplitudes(r[2][1]) - amplitudes(h)) for r in fair])
            errors["level"].append(np.mean(away[level == level.min()]))
            errors["CSI"].append(away[np.argmin(shape)])
            near = level <= level.min() + 2
            errors["CSI among levels within 2 dB"].append(away[near][np.argmin(shape[near])])
            errors["middle"].append(np.linalg.norm(middle - at))
            errors["random reference"].append(np.mean(away))
            errors["nearest possible"].append(away.min())
        for name, values in errors.items():
            all_errors[name] += values
        print("  path %d, %d tests, %d references:" % (path, len(errors["level"]), len(place["ref"])),
              ", ".join("%s %.1f" % (n, np.median(v)) for n, v in errors.items()))
    for name, values in all_errors.items():
        print("  all %d, %s: %s" % (len(values), name, interval(values)))


# --- iVANET: months -----------------------------------------------------------------------------


def nearest(known, asked):
    """Share of the places that are told by the nearest of what is known."""
    hits = [min(known, key=lambda k: np.linalg.norm(k[1] - x))[0] == label for label, x in asked]
    return 100 * np.mean(hits), len(hits)


def ivanet():
    print("iVANET: eight places, three days; places told by the nearest of what is known [%]; chance 12.5")
    of = {}
    for file, (tones, h, level) in recordings("ivanet").items():
        found = re.match(r"d(\d+)_p(\d+)_l(\d+)", file)
        day, period, label = map(int, found.groups())
        if h.shape[1] != 3:
            continue
        shape = np.concatenate([amplitudes(h[:, [a]]) for a in range(3)])
        turn = np.array([np.mean(h[:, a + 1] * h[:, a].conj(), axis=0) for a in (0, 1)])
        turn = (turn / np.abs(turn)).ravel()
        of[day, period, label] = {"level": np.mean(level, axis=0), "amplitudes": shape,
                                  "phases": np.concatenate([turn.real, turn.imag])}
    days = sorted({k[0] for k in of})
    for what in ("level", "amplitudes", "phases"):
        for known_day in days:
            row = []
            for day in days:
                shares, count = [], 0
                for period in sorted({k[1] for k in of if k[0] == day}):
                    known = [(k[2], v[what]) for k, v in of.items()
                             if k[0] == known_day and (known_day != day or k[1] != period)]
                    asked = [(k[2], v[what]) for k, v in of.items() if k[0] == day and k[1] == period]
                    share, n = nearest(known, asked)
                    shares.append(share * n)
                    count += n
                row.append("day %02d %.0f (%d)" % (day, sum(shares) / count, count))
            print("  %s, known of day %02d:" % (what, known_day), ", ".join(row))
    for label in range(1, 9):
        print("  level of place %d by day [dBm]:" % label, ", ".join(
            "%02d: %s" % (day, np.round(np.mean([v["level"] for k, v in of.items()
                                                 if k[0] == day and k[2] == label], axis=0)))
            for day in days))


lgtm()
epic()
ivanet()
