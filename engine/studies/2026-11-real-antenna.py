#!/usr/bin/env python3
"""A moving antenna with millimetre truth: the figures of 2026-11-real-antenna.md.

    PYTHONPATH=build/dev/python engine/studies/2026-11-real-antenna.py DATA OUT build/dev/bin/rayloc

Needs numpy and the module rayloc. DATA is ../shared/realdata/wsr_toolbox_bsd2, which is not part of the
project. OUT gets the scenes. The last argument traces edges, which the module does not.
"""
import json
import os
import subprocess
import sys

import numpy as np

import rayloc

DATA, OUT, PROGRAM = sys.argv[1:4]
CARRIER = 5.54e9  # [Hz] channel 108
SPEED = 299792458.0  # [m/s]
WAVENUMBER = 2 * 2 * np.pi * CARRIER / SPEED  # [rad/m] of the square of the channel
TONES = np.array([*range(-28, 0, 2), -1, *range(1, 28, 2), 28])  # of the card at 20 MHz
CLOCK = -0.025  # [s] of motion capture against the card: most coherent on LOS walks 1, 3, 5 and 8
STEP = 0.0034  # [m] a bin of the path, 1/16 of a wavelength
HEIGHT = 0.2  # [m] of the antenna
LINKS = (2, 3, 4)  # names of the transmitters
WALKS = range(1, 11)
LENGTHS = (40, 60, 100, 160)  # [STEP] of a window: 0.14 to 0.54 m
SCORES = {"sum": lambda v: v.mean(1), "log 1": lambda v: np.log(1 + v).mean(1), "log 3": lambda v: np.log(3 + v).mean(1)}
STARTS = np.stack(np.meshgrid(*[np.arange(-3.5, 3.51, 0.1)] * 2), -1).reshape(-1, 2)  # [m] asked for

with open(os.path.join(DATA, "transmitters.json"), encoding="utf-8") as places:
    PLACES = {s: {k: np.array(of["tx%d" % k]) for k in LINKS} for s, of in json.load(places).items()}
SETS = {"in sight": ("LOS_Set_A", "LOS_Set_B"), "out of sight": ("NLOS_Set_A", "NLOS_Set_B")}


# --- what was measured --------------------------------------------------------------------------


def strongest_delay(h):
    """Each frame's value at the delay where its tones add up best: free of when the card began."""
    turns = np.exp(1j * np.outer(TONES, np.linspace(-np.pi / 4, np.pi / 4, 361)))
    values = h @ turns
    return values[np.arange(len(h)), np.abs(values).argmax(1)]


def walk(recorded, number, link):
    """(phasor, place) a bin of the path. The phasor's phase is that of the squared channel."""
    name = "L%d_tx%d" % (number, link)
    time, capture = recorded[name + "_t"] + CLOCK, recorded["L%d_traj_t" % number]
    xyz = recorded["L%d_traj_xyz" % number].astype(float)
    place = np.stack([np.interp(time, capture, xyz[:, i]) for i in range(3)], 1)
    both = 1.0
    for side in ("_at_rx", "_at_tx"):
        values = recorded[name + side].astype(float)
        both = both * strongest_delay(values[..., 0] + 1j * values[..., 1])
    gone = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(place, axis=0), axis=1))])
    moving = (gone > 0.004) & (gone < gone[-1] - 0.002)
    both, place, gone = both[moving] / np.abs(both[moving]), place[moving], gone[moving]
    index = np.unique(((gone - gone[0]) / STEP).astype(int), return_inverse=True)[1]

    def mean(x):
        return np.bincount(index, x) / np.bincount(index)
    return mean(both.real) + 1j * mean(both.imag), np.stack([mean(place[:, i]) for i in range(3)], 1)


AXIS = np.linspace(-1.02, 1.02, 121)  # components of a direction of arrival
INSIDE = np.hypot(*np.meshgrid(AXIS, AXIS)) <= 1.02


def spectra(phasor, place, length):
    """(power by direction of arrival, mean 1, and the middle) of each window of the path."""
    power, middle = [], []
    for first in range(0, max(1, len(phasor) - length + 1), length // 2):
        p = place[first:first + length, :2]
        window = np.hanning(len(p) + 2)[1:-1]
        at = p - p.mean(0)
        x = np.exp(-1j * WAVENUMBER * np.outer(at[:, 0], AXIS)) * (phasor[first:first + length] * window)[:, None]
        b = np.abs(x.T @ np.exp(-1j * WAVENUMBER * np.outer(at[:, 1], AXIS))) ** 2
        power.append(b / b[INSIDE].mean())
        middle.append(p.mean(0))
    return np.array(power), np.array(middle)


def arriving(power, origin, source):
    """Of one window: its power from `source` [..., 3], were it at `origin` [..., 2]."""
    to = source - np.concatenate([origin, np.full(origin.shape[:-1] + (1,), HEIGHT)], -1)
    to = to[..., :2] / np.maximum(np.linalg.norm(to, axis=-1, keepdims=True), 1e-9)
    i = np.clip(np.round((to + 1.02) / 2.04 * (len(AXIS) - 1)).astype(int), 0, len(AXIS) - 1)
    return power[i[..., 0], i[..., 1]]


# --- the room -----------------------------------------------------------------------------------

# [m] Read off the scan (Dataset-1.png), whose drawn transmitters give its scale to half a metre: x down, y right.
NORTH, SOUTH, WEST, EAST, TOP = -5.5, 4.5, -6.2, 3.5, 3.0
DOOR = (-5.3, -4.3)  # in the west wall, guessed from the scan
MATERIALS = {"slab": (5.24, 0.18, 0.2), "plasterboard": (2.73, 0.042, 0.03), "concrete": (5.24, 0.18, 0.1),
             "metal": (1.0, 1e7, 0.01)}


def write_room(name, wall, furnished, wider):
    """Writes OUT/name/scene.xml: walls of `wall`; furnished: a shelf of metal and a door in the west wall.

    The room's four walls are `wider` [m] further out.
    """
    north, south, west, east = NORTH - wider, SOUTH + wider, WEST - wider, EAST + wider
    sheets = []

    def sheet(material, p, q, low=0.0, high=TOP):
        sheets.append((material, [(*p, low), (*q, low), (*q, high), (*p, high)]))
    for z in (0.0, TOP):
        sheets.append(("slab", [(-8, -11, z), (7, -11, z), (7, 9, z), (-8, 9, z)]))
    if furnished:
        a, b = DOOR
        sheet(wall, (north, west), (a, west))
        sheet(wall, (a, west), (b, west), 2.1)
        sheet(wall, (b, west), (south, west))
        sheet("metal", (b + 0.1, west + 0.3), (1.2, west + 0.3), 0.05, 2.0)
    else:
        sheet(wall, (north, west), (south, west))
    sheet(wall, (north, east), (south, east))
    sheet(wall, (north, west - 4.8), (north, east + 4))
    sheet(wall, (south, west - 4.8), (south, -0.25))
    sheet(wall, (south, -0.25), (south, 0.9), 2.1)
    sheet(wall, (south, 0.9), (south, east + 4))
    sheet(wall, (1.4, west), (1.4, -3.8))
    sheet(wall, (1.4, -3.8), (south, -3.8))
    sheet(wall, (-0.4, west - 4.8), (-0.4, west))
    sheet(wall, (6.6, -11), (6.6, 9))
    os.makedirs(os.path.join(OUT, name), exist_ok=True)
    path = os.path.join(OUT, name, "scene.xml")
    with open(path, "w", encoding="ascii") as scene:
        scene.write('<scene version="2.1.0">\n')
        for each, values in MATERIALS.items():
            scene.write('<bsdf type="radio-material" id="%s">%s</bsdf>\n' % (each, "".join(
                '<float name="%s" value="%g"/>' % x
                for x in zip(("relative_permittivity", "conductivity", "thickness"), values))))
        for i, (material, corners) in enumerate(sheets):
            with open(os.path.join(OUT, name, "%d.obj" % i), "w", encoding="ascii") as mesh:
                mesh.writelines("v %.4f %.4f %.4f\n" % c for c in corners)
                mesh.write("f 1 2 3 4\n")
            scene.write('<shape type="obj" id="sheet%d"><string name="filename" value="%d.obj"/><ref id="%s"/></shape>\n'
                        % (i, i, material))
        scene.write("</scene>\n")
    return path


CELLS = np.arange(-3.75, 3.76, 0.75)  # [m] where the antenna may be, for tracing
MOST = 8  # paths that are kept
DEPTH = 4


def paths_of(path, transmitter, at, edges):
    if not edges:
        p = rayloc.trace(rayloc.load_scene(path, frequency=CARRIER), rayloc.Transmitter(transmitter, pattern="dipole"),
                         [rayloc.Receiver(x, pattern="dipole") for x in at], DEPTH, True)[0]
        for each in p:
            yield (np.array(each.a), np.array(each.tau), np.array(each.theta_r), np.array(each.phi_r), None, None)
        return
    file = os.path.join(OUT, "paths.npz")
    for x in at:
        subprocess.run([PROGRAM, "trace", path, "--frequency", str(CARRIER), "--pattern", "dipole", "--transmission",
                        "--diffraction", "--depth", str(DEPTH), "--tx", "%g,%g,%g" % tuple(transmitter),
                        "--rx", "%g,%g,%g" % tuple(x), "--out", file], check=True, stderr=subprocess.DEVNULL)
        p = np.load(file)
        yield p["a"], p["tau"], p["angles"][:, 2], p["angles"][:, 3], p["interactions"], p["vertices"]


def traced_sources(path, places, edges):
    """{link: (power, place)} of the images, or edges, that each cell hears: [cell, MOST]."""
    at = np.array([(x, y, HEIGHT) for x in CELLS for y in CELLS])
    result = {}
    for link, transmitter in places.items():
        power, place = np.zeros((len(at), MOST)), np.zeros((len(at), MOST, 3))
        for n, (a, tau, theta, phi, kinds, vertices) in enumerate(paths_of(path, transmitter, at, edges)):
            order = np.argsort(-np.abs(a))[:MOST]
            away = SPEED * tau[order]
            for i, m in enumerate(order if edges else []):
                bends = np.flatnonzero(kinds[:, m] == ord("D"))
                if len(bends):  # from an edge on
                    last = np.flatnonzero(kinds[:, m])[-1]
                    way = np.concatenate([vertices[bends[-1]:last + 1, m], at[n][None]])
                    away[i] = np.linalg.norm(np.diff(way, axis=0), axis=1).sum()
            t, f = theta[order], phi[order]
            d = np.stack([np.sin(t) * np.cos(f), np.sin(t) * np.sin(f), np.cos(t)], 1)
            power[n, :len(order)] = np.abs(a[order]) ** 2
            place[n, :len(order)] = at[n] + d * away[:, None]
        result[link] = power / np.maximum(power.sum(1, keepdims=True), 1e-300), place
    return result


# --- sources of other walks ---------------------------------------------------------------------

RANGES = np.array([2, 2.5, 3, 3.5, 4, 4.5, 5, 5.75, 6.5, 7.5, 9, 12, 20])  # [m]
BEARINGS = np.radians(np.arange(0, 360, 3))
SOURCES = np.stack([np.outer(RANGES, np.cos(BEARINGS)).ravel(), np.outer(RANGES, np.sin(BEARINGS)).ravel(),
                    np.full(RANGES.size * BEARINGS.size, 0.8)], 1)


def learned_sources(heard):
    """Up to four places whose waves explain the windows [window, source] best, one after the other."""
    chosen, best, together = [], -np.inf, 0.0
    while len(chosen) < 4:
        gain = np.log(1 + (together + heard) / (len(chosen) + 1)).mean(0)
        if gain.max() <= best + 0.005:
            break
        chosen.append(gain.argmax())
        best, together = gain.max(), together + heard[:, [chosen[-1]]]
    return SOURCES[chosen]


# --- where a walk began -------------------------------------------------------------------------


class Asked:
    """The windows of all walks of a set at one length; answers where each walk began."""

    def __init__(self, bins, name, length):
        self.name, self.places = name, PLACES[name]
        self.windows = {(n, k): spectra(*bins[name, n, k], length) for n in WALKS for k in LINKS}
        self.begin = {(n, k): bins[name, n, k][1][0, :2] for n in WALKS for k in LINKS}

    def explained(self, explain):
        """{walk: {link: [start, window]}} with explain(link, walk, window's power, origins)."""
        result = {}
        for n in WALKS:
            result[n] = {}
            for k in LINKS:
                power, middle = self.windows[n, k]
                result[n][k] = np.stack([explain(k, n, b, STARTS + m - self.begin[n, k])
                                         for b, m in zip(power, middle)], 1)
        return result

    def direct(self, places=None):
        return self.explained(lambda k, n, b, o: arriving(b, o, (places or self.places)[k]))

    def traced(self, sources):
        def explain(k, n, b, o):
            i = np.clip(np.round((o - CELLS[0]) / 0.75).astype(int), 0, len(CELLS) - 1)
            cell = i[:, 0] * len(CELLS) + i[:, 1]
            share, place = sources[k]
            return sum(share[cell, m] * arriving(b, o, place[cell, m]) for m in range(MOST))
        return self.explained(explain)

    def heard_of(self, n, k):
        power, middle = self.windows[n, k]
        return np.stack([arriving(b, np.broadcast_to(m, (len(SOURCES), 2)), SOURCES) for b, m in zip(power, middle)])

    def learned(self):
        heard = {key: self.heard_of(*key) for key in self.windows}
        sources = {(n, k): learned_sources(np.concatenate([heard[o, k] for o in WALKS if o != n]))
                   for n in WALKS for k in LINKS}
        return self.explained(lambda k, n, b, o: np.mean([arriving(b, o, s) for s in sources[n, k]], axis=0))

    def errors(self, explained, score):
        return np.array([np.linalg.norm(STARTS[sum(score(v) for v in explained[n].values()).argmax()] -
                                        self.begin[n, LINKS[0]]) for n in WALKS])


def chosen_elsewhere(errors):
    """Of errors[setting][set, walk]: walks of odd places with the setting best for even ones, and the reverse."""
    result = np.zeros_like(next(iter(errors.values())))
    settings = []
    for half in (0, 1):
        best = min(errors, key=lambda x: np.median(errors[x][:, 1 - half::2]))
        result[:, half::2] = errors[best][:, half::2]
        settings.append(" ".join(map(str, best)))
    return result, settings


def say(name, errors):
    chosen, settings = chosen_elsewhere(errors)
    draws = np.median(chosen.ravel()[np.random.default_rng(1).integers(0, chosen.size, (2000, chosen.size))], axis=1)
    print("%s: %.2f (%.2f to %.2f); A %.2f, B %.2f; 90 %% %.2f; settings %s; all settings %.2f to %.2f" % (
        name, np.median(chosen), *np.percentile(draws, [2.5, 97.5]), *np.median(chosen, axis=1),
        np.percentile(chosen, 90), " and ".join(settings), min(np.median(v) for v in errors.values()),
        max(np.median(v) for v in errors.values())), flush=True)


# --- where a transmitter is ---------------------------------------------------------------------


def transmitters(asked):
    """Errors of a transmitter from one walk each and from ten, windows of one length, no room."""
    grid = np.stack([*np.meshgrid(*[np.arange(-8, 8.01, 0.1)] * 2), np.full((161, 161), 0.8)], -1).reshape(-1, 3)
    one, ten = [], []
    for k in LINKS:
        total = 0.0
        for n in WALKS:
            power, middle = asked.windows[n, k]
            of = np.log(1 + np.stack([arriving(b, np.broadcast_to(m, (len(grid), 2)), grid)
                                      for b, m in zip(power, middle)], 1)).mean(1)
            far = np.linalg.norm(grid[:, :2] - middle.mean(0), axis=1) > 0.8
            one.append(np.linalg.norm(grid[np.where(far, of, -1).argmax(), :2] - asked.places[k][:2]))
            total = total + of
        ten.append(np.linalg.norm(grid[total.argmax(), :2] - asked.places[k][:2]))
    return one, ten


def bearings(asked):
    """Whence the strongest single source of all walks comes, against the truth, from the middle."""
    for k in LINKS:
        heard = np.log(1 + np.concatenate([asked.heard_of(n, k) for n in WALKS])).mean(0)
        source, truth = SOURCES[heard.argmax()], asked.places[k]
        direct = np.log(1 + np.concatenate([[arriving(b, m, truth) for b, m in zip(*asked.windows[n, k])] for n in WALKS]))
        off = np.degrees(np.arctan2(source[1], source[0]) - np.arctan2(truth[1], truth[0]))
        print("  %s tx%d: strongest source at (%.1f, %.1f), truth (%.1f, %.1f): %.0f degrees off; explains %.2f, truth %.2f"
              % (asked.name, k, *source[:2], *truth[:2], (off + 180) % 360 - 180, heard.max(), direct.mean()))


def main():
    bins = {}
    for name in PLACES:
        recorded = np.load(os.path.join(DATA, name + ".npz"))
        bins.update({(name, n, k): walk(recorded, n, k) for n in WALKS for k in LINKS})
    begin = np.array([bins["LOS_Set_A", n, 2][1][0, :2] for n in WALKS])
    print("control, the mean of the other walks: %.2f" % np.median(
        [np.linalg.norm(begin[i] - np.delete(begin, i, 0).mean(0)) for i in range(10)]))
    rooms = {"plasterboard": ("plasterboard", False, 0.0), "concrete": ("concrete", False, 0.0),
             "shelf and door": ("plasterboard", True, 0.0), "shelf and door, 0.3 m wider": ("plasterboard", True, 0.3),
             "shelf and door, 0.3 m narrower": ("plasterboard", True, -0.3)}
    with_edges = ("plasterboard", "shelf and door")
    sources = {}
    for i, (name, room) in enumerate(rooms.items()):
        path = write_room("room%d" % i, *room)
        for s in SETS["out of sight"]:
            sources[name, s] = traced_sources(path, PLACES[s], False)
            if name in with_edges:
                sources[name + ", edges", s] = traced_sources(path, PLACES[s], True)
    for sight, names in SETS.items():
        methods = {}
        for length in LENGTHS:
            for s in names:
                asked = Asked(bins, s, length)
                turned = {k: asked.places[LINKS[(i + 1) % 3]] for i, k in enumerate(LINKS)}
                of = {"straight": asked.direct(), "wrong transmitters": asked.direct(turned), "other walks": asked.learned()}
                if sight == "out of sight":
                    of.update({room: asked.traced(each) for (room, of_set), each in sources.items() if of_set == s})
                for method, explained in of.items():
                    for score, function in SCORES.items():
                        methods.setdefault(method, {}).setdefault((length, score), []).append(asked.errors(explained, function))
                if length == 60:
                    bearings(asked)
                    one, ten = transmitters(asked)
                    print("  %s, transmitter: from one walk %.2f, from ten %s" % (
                        s, np.median(one), ", ".join("%.2f" % x for x in ten)), flush=True)
        for method, errors in methods.items():
            say("%s, %s" % (sight, method), {setting: np.array(of) for setting, of in errors.items()})
        traced = {(room, *setting): np.array(of) for room in {name for name, _ in sources} & methods.keys()
                  for setting, of in methods[room].items()}
        if traced:
            say("%s, the room too chosen by the other walks" % sight, traced)


main()
