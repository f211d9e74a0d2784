#!/usr/bin/env python3
"""A measured apartment against the tracer: the figures of 2026-11-real-apartment.md.

    PYTHONPATH=build/dev/python engine/studies/2026-11-real-apartment.py DATA OUT build/dev/bin/rayloc

Needs numpy and the module rayloc. DATA is ../shared/realdata/uwb_apartment_cc_by, which is not part of
the project. OUT gets the scenes. The last argument traces edges, which the module does not.
"""
import json
import os
import subprocess
import sys

import numpy as np

import rayloc

DATA, OUT, PROGRAM = sys.argv[1:4]
RANDOM = np.random.default_rng(1)
CARRIER = 3.9936e9  # [Hz] channel 2 of the DW1000
BAND = 499.2e6  # [Hz]
DEPTH = 6  # reflections and crossed faces
HEIGHTS = [(a, t) for a in (1.0, 1.5, 2.0) for t in (1.0, 1.5)]  # [m] anchors, tags: not stated
CEILING, LINTEL = 2.6, 2.05  # [m] not stated: usual ones
# [m] Not stated: usual ones.
FURNITURE_HEIGHT = {"pull_down_bed_25cm_mattress": 2.1, "bookcase": 2.0, "wardrobe_mirrored_doors": 2.3,
                    "wardrobe": 2.3, "cluttered_shelves": 2.0}
# Doorways: gaps of the walls of the plan.
DOORWAYS = [((3.02, 3.38), (3.81, 3.38)), ((7.2, 5.08), (7.2, 5.78)), ((3.2, 5.88), (3.89, 5.88)),
            ((5.62, 5.88), (6.31, 5.88)), ((1.3, 4.8), (1.93, 4.8)), ((1.3, 5.371), (1.3, 5.927))]
OUTLINE = [(0, 0), (4.65, 0), (4.65, 4.8), (9.3, 4.8), (9.3, 9.5), (0, 9.5)]
# Permittivity, conductivity [S/m] of ITU-R P.2040-3 at 4 GHz: concrete, wood, chipboard. Thickness [m].
MATERIALS = {"slab": (5.24, 0.137, 0.2), "outer": (5.24, 0.137, 0.2), "wall": (5.24, 0.137, 0.05),
             "door": (1.99, 0.0208, 0.04), "furniture": (2.58, 0.064, 0.02), "bed": (1.5, 0.02, 0.1)}
FREE = ["sigma.wall", "sigma.furniture", "sigma.door", "eps_r.wall", "eps_r.furniture", "eps_r.door"]
PRIOR = np.array([0.7, 0.7, 0.7, 0.2, 0.2, 0.2])  # of their logarithms
NOISE = 3.0  # [dB] of a level, for the weight of the prior
REFLECTION, TRANSMISSION = 0, 1  # engine/trace/interactions/interaction_kind.h


# --- the scene ----------------------------------------------------------------------------------


def upright(p, q, low, high):
    return [(*p, low), (*q, low), (*q, high), (*p, high)]


def is_outer(wall):
    ends = [(tuple(wall[:2]), tuple(wall[2:])), (tuple(wall[2:]), tuple(wall[:2]))]
    return any(side in ends for side in zip(OUTLINE, OUTLINE[1:] + OUTLINE[:1]))


def objects_of(plan, doors, furniture):
    """(name, material, faces) of everything. Walls are sheets: thickness is the material's."""
    yield "floor", "slab", [[(*p, 0.0) for p in OUTLINE]]
    yield "ceiling", "slab", [[(*p, CEILING) for p in OUTLINE]]
    for k, wall in enumerate(plan["walls"]):
        yield "wall%d" % k, "outer" if is_outer(wall) else "wall", [upright(wall[:2], wall[2:], 0, CEILING)]
    for k, (p, q) in enumerate(DOORWAYS):
        yield "lintel%d" % k, "wall", [upright(p, q, LINTEL, CEILING)]
        if doors:
            yield "door%d" % k, "door", [upright(p, q, 0.01, LINTEL - 0.01)]
    for k, piece in enumerate(plan["furniture"] if furniture else []):
        xy, height = piece["xy"], FURNITURE_HEIGHT[piece["kind"]]
        area = sum(p[0] * q[1] - q[0] * p[1] for p, q in zip(xy, xy[1:] + xy[:1]))
        xy = xy if area > 0 else xy[::-1]
        faces = [upright(p, q, 0.02, height) for p, q in zip(xy, xy[1:] + xy[:1])]
        faces += [[(*p, height) for p in xy], [(*p, 0.02) for p in xy][::-1]]
        yield "furniture%d" % k, "bed" if "bed" in piece["kind"] else "furniture", faces


def write_scene(name, plan, doors=True, furniture=True, values=None):
    """Writes OUT/name/scene.xml and its meshes. `values` has other values: {"sigma.wall": 0.1}."""
    folder = os.path.join(OUT, name)
    os.makedirs(os.path.join(folder, "meshes"), exist_ok=True)
    path = os.path.join(folder, "scene.xml")
    with open(path, "w", encoding="ascii") as scene:
        scene.write('<scene version="2.1.0">\n')
        for material, (eps, sigma, thickness) in MATERIALS.items():
            of = {"relative_permittivity": (values or {}).get("eps_r." + material, eps),
                  "conductivity": (values or {}).get("sigma." + material, sigma), "thickness": thickness}
            scene.write('<bsdf type="radio-material" id="%s">%s</bsdf>\n' % (material, "".join(
                '<float name="%s" value="%.9g"/>' % each for each in of.items())))
        for each, material, faces in objects_of(plan, doors, furniture):
            mesh = "meshes/%s.obj" % each
            with open(os.path.join(folder, mesh), "w", encoding="ascii") as out:
                out.writelines("v %.4f %.4f %.4f\n" % tuple(p) for face in faces for p in face)
                out.writelines("f %d %d %d %d%s\n" % (*range(4 * k + 1, 4 * k + 5), "".join(
                    " %d" % (i + 1) for i in range(4, len(face)))) for k, face in enumerate(faces))
            scene.write('<shape type="obj" id="%s"><string name="filename" value="%s"/><ref id="%s"/></shape>\n'
                        % (each, mesh, material))
        scene.write("</scene>\n")
    return path


# --- what was measured --------------------------------------------------------------------------


def true_level(dbm):
    """The chip reads too low above -88 dBm; arduino-dw1000 (DW1000.cpp) takes the manual's curve so."""
    return np.where(dbm > -88, dbm + (dbm + 88) * 1.1667, dbm)


class Measured:
    def __init__(self):
        with open(os.path.join(DATA, "uwb_geometry.json"), encoding="utf-8") as file:
            self.plan = json.load(file)
        recorded = np.load(os.path.join(DATA, "cirs.npz"))
        self.ids = sorted({int(k.split("_")[0]) for k in recorded.files})
        pairs = [self.plan["pairs"][str(i)] for i in self.ids]
        self.anchor, self.tag = np.array(pairs).T
        self.at_anchor = np.array([self.plan["anchors"][str(a)] for a in self.anchor])
        self.at_tag = np.array([self.plan["tags"][str(t)] for t in self.tag])
        self.distance = np.linalg.norm(self.at_anchor - self.at_tag, axis=1)
        self.received_raw, self.first_raw = (
            np.array([np.nanmedian(recorded["%d_%s" % (i, what)]) for i in self.ids]) for what in ("rsl", "fsl"))
        self.received, self.first = true_level(self.received_raw), true_level(self.first_raw)
        self.profile = np.array([self._profile(recorded, i) for i in self.ids])

    @staticmethod
    def _profile(recorded, i):
        """Mean power a nanosecond from 5 ns before the first path that the receiver found."""
        cir = recorded["%d_cir" % i].astype(float)
        power = (cir ** 2).sum(-1)
        step = 1.0016  # [ns] of a tap
        wanted = np.arange(-5, 61) / step
        rows = [np.interp(start + wanted, np.arange(power.shape[1]), row)
                for start, row in zip(recorded["%d_first_path" % i], power)]
        noise = np.median(power[:, :40])
        return np.maximum(np.mean(rows, axis=0) - noise, 1e-9)

    def counts(self):
        """Walls and pieces of furniture between the ends, in the plan."""
        def crosses(a, b, p, q):
            r, s, ap = b - a, np.subtract(q, p), np.subtract(p, a)
            d = r[0] * s[1] - r[1] * s[0]
            return d != 0 and 0 < (ap[0] * s[1] - ap[1] * s[0]) / d < 1 and 0 < (ap[0] * r[1] - ap[1] * r[0]) / d < 1
        walls, pieces = [], []
        for a, b in zip(self.at_anchor, self.at_tag):
            walls.append(sum(crosses(a, b, w[:2], w[2:]) for w in self.plan["walls"]))
            pieces.append(sum(any(crosses(a, b, p, q) for p, q in zip(f["xy"], f["xy"][1:] + f["xy"][:1]))
                              for f in self.plan["furniture"]))
        return np.array(walls, float), np.array(pieces, float)


# --- what is traced -----------------------------------------------------------------------------


def traced(path, measured, heights, parameters=(), depth=DEPTH):
    """Of each link a dictionary: log amplitude, its slopes, delay [s], reflections, crossed faces."""
    scene = rayloc.load_scene(path, frequency=CARRIER)
    tracer = rayloc.Tracer(scene, depth, True)
    links = [None] * len(measured.ids)
    for anchor in np.unique(measured.anchor):
        here = np.flatnonzero(measured.anchor == anchor)
        receiver = tracer.at(rayloc.Receiver((*measured.at_anchor[here[0]], heights[0]), pattern="dipole"))
        for n in here:
            paths = receiver.trace(rayloc.Transmitter((*measured.at_tag[n], heights[1]), pattern="dipole"))
            a = np.array(paths.a)
            kinds = np.array(paths.interactions)
            slopes = np.zeros((len(a), len(parameters)))
            if parameters:
                derivatives = paths.derivatives(parameters)
                order = [derivatives.names.index(p) for p in parameters]
                slopes = (np.array(derivatives.a)[:, order] / a[:, None]).real
            links[n] = {"log": np.log(np.abs(a)), "slopes": slopes, "tau": np.array(paths.tau),
                        "reflections": (kinds == REFLECTION).sum(0), "crossings": (kinds == TRANSMISSION).sum(0)}
    return links


def traced_with_edges(path, measured, heights):
    """As `traced`, by the program, which also knows edges."""
    links = []
    file = os.path.join(OUT, "paths.npz")
    for a, t in zip(measured.at_anchor, measured.at_tag):
        subprocess.run([PROGRAM, "trace", path, "--frequency", str(CARRIER), "--pattern", "dipole", "--transmission",
                        "--diffraction", "--depth", str(DEPTH), "--rx", "%g,%g,%g" % (*a, heights[0]),
                        "--tx", "%g,%g,%g" % (*t, heights[1]), "--out", file], check=True)
        paths = np.load(file)
        kinds = paths["interactions"]
        links.append({"log": np.log(np.abs(paths["a"]) + 1e-30), "tau": paths["tau"],
                      "reflections": (kinds == ord("R")).sum(0), "crossings": (kinds == ord("T")).sum(0),
                      "edges": (kinds == ord("D")).sum(0)})
    return links


def only(links, wanted):
    """The links with those paths for which wanted(link) is true; None where none is left."""
    result = []
    for link in links:
        keep = wanted(link)
        result.append({k: v[keep] for k, v in link.items()} if keep.any() else None)
    return result


def at_values(links, change):
    """The links with parameters changed, to first order of the logarithm of each path."""
    return [link and {**link, "log": link["log"] + link["slopes"] @ change} for link in links]


def received(links):
    """[dB] Power of all paths: 500 MHz tell them apart."""
    return np.array([10 * np.log10(np.exp(2 * x["log"]).sum()) if x else -130.0 for x in links])


def first(links, below, window):
    """[dB] Power within `window` [s] of the first path that is not more than `below` dB below the strongest."""
    result = []
    for link in links:
        if link is None:
            result.append(-130.0)
            continue
        power = np.exp(2 * link["log"])
        start = link["tau"][power >= power.max() * 10 ** (-below / 10)].min()
        result.append(10 * np.log10(power[(link["tau"] >= start) & (link["tau"] < start + window)].sum()))
    return np.array(result)


# --- held out -----------------------------------------------------------------------------------


def held_out(measured, predict):
    """Each tag's links by predict(training mask), which sees the others' levels only."""
    result = np.zeros(len(measured.tag))
    for tag in np.unique(measured.tag):
        training = measured.tag != tag
        result[~training] = predict(training)[~training]
    return result


def offset_alone(measured, level, prediction):
    return held_out(measured, lambda m: prediction + np.mean((level - prediction)[m]))


def lines(measured, level, *columns):
    x = np.stack([*columns, np.ones(len(level))], 1)
    return held_out(measured, lambda m: x @ np.linalg.lstsq(x[m], level[m], rcond=None)[0])


def fit(links, level, training):
    """Gauss-Newton for FREE and an offset; returns their logarithms' change and the cost."""
    start = np.array([MATERIALS[p.split(".")[1]][p.startswith("sigma")] for p in FREE])
    x = np.zeros(len(FREE))

    def power(x):
        return received(at_values(links, start * (np.exp(x) - 1)))
    for _ in range(6):
        p = power(x)
        slopes = np.stack([(power(x + 1e-3 * e) - p) / 1e-3 for e in np.eye(len(x))], 1)
        rows = np.concatenate([slopes, np.ones((len(p), 1))], 1)[training] / NOISE
        prior = np.concatenate([np.diag(1 / PRIOR), np.zeros((len(x), 1))], 1)
        right = np.concatenate([(level - p)[training] / NOISE, -x / PRIOR])
        step = np.linalg.lstsq(np.concatenate([rows, prior]), right, rcond=None)[0][:-1]
        x = x + np.clip(step, -0.5, 0.5)
    left = (level - power(x))[training]
    cost = np.sum(((left - left.mean()) / NOISE) ** 2) + np.sum((x / PRIOR) ** 2)
    return start * np.exp(x), cost


def stated(level, prediction):
    """Correlation, its interval of 95 % by bootstrap of the links, and the spread of what is left."""
    draws = RANDOM.integers(0, len(level), (2000, len(level)))
    each = [np.corrcoef(level[d], prediction[d])[0, 1] for d in draws]
    return "%.3f (%.2f to %.2f), %.1f dB rms" % (
        np.corrcoef(level, prediction)[0, 1], *np.percentile(each, [2.5, 97.5]),
        np.sqrt(np.mean((level - prediction) ** 2)))


def fitted(measured, by_heights, level):
    """Held out: FREE and heights by the training tags; judged by tracing anew with what was fitted."""
    chosen = {}

    def predict(training):
        tag = measured.tag[~training][0]
        best = min(((*fit(links, level, training), heights) for heights, links in by_heights.items()),
                   key=lambda each: each[1])
        values, _, heights = best
        path = write_scene("fitted", measured.plan, values=dict(zip(FREE, values)))
        prediction = received(traced(path, measured, heights))
        chosen[tag] = (heights, values)
        return prediction + np.mean((level - prediction)[training])
    return held_out(measured, predict), chosen


BELOW = (10, 15, 20, 25, 30, 35)  # [dB]
WINDOW = (1e-9, 2e-9, 3e-9)  # [s] three taps are a first path's level


def first_held_out(measured, links):
    """Held out: the receiver's threshold and window by the training tags, and the offset."""
    table = [first(links, b, w) for b in BELOW for w in WINDOW]

    def predict(training):
        left = [(measured.first - p)[training] for p in table]
        p = table[np.argmin([np.var(x) for x in left])]
        return p + np.mean((measured.first - p)[training])
    return held_out(measured, predict)


# --- echoes -------------------------------------------------------------------------------------


def profile(link):
    """Power a nanosecond from 5 ns before the direct distance's delay, through the receiver's band."""
    t = np.arange(-5, 61) * 1e-9
    power = np.exp(2 * link["log"])
    start = link["tau"][power >= power.max() * 10 ** -2.5].min()
    x = (t[:, None] - (link["tau"] - start)) * BAND
    # The pulse of a Hann window over the band.
    pulse = np.sinc(x) / np.where(np.abs(np.abs(x) - 1) < 1e-6, 1e-6, 1 - x ** 2)
    return (power * np.clip(pulse, -1, 1) ** 2).sum(1)


def echoes(measured, links):
    """How often a measured response is most like the profile traced for its own link."""
    def shape(profiles):
        db = 10 * np.log10(np.maximum(profiles / profiles.max(1, keepdims=True), 10 ** -2.5))
        return db - db.mean(0)  # less what all links have in common: decay
    heard, told = shape(measured.profile)[:, 5:50], shape(np.array([profile(x) for x in links]))
    like = np.full((len(heard), len(told)), -1.0)
    for shift in range(-4, 5):  # the receiver's first path may be another
        moved = told[:, 5 + shift:50 + shift]
        a = heard - heard.mean(1, keepdims=True)
        b = moved - moved.mean(1, keepdims=True)
        like = np.maximum(like, a @ b.T / np.outer(np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)))
    own = np.diag(like)
    rank = (like > own[:, None]).mean(1)
    ranks = [np.mean([(like[i] > like[i, j]).mean() for i, j in enumerate(RANDOM.permutation(len(own)))])
             for _ in range(2000)]
    return own.mean(), like.mean(), rank.mean(), np.mean(np.array(ranks) <= rank.mean())


def spread(profiles):
    """[ns] rms delay spread of profiles, of what is within 20 dB of the strongest."""
    p = np.where(profiles >= profiles.max(1, keepdims=True) * 1e-2, profiles, 0.0)
    t = np.arange(p.shape[1])
    mean = (p * t).sum(1) / p.sum(1)
    return np.sqrt((p * (t - mean[:, None]) ** 2).sum(1) / p.sum(1))


def main():
    m = Measured()
    free_space = -20 * np.log10(m.distance)
    walls, pieces = m.counts()
    print("%d links, %d tags; level as read by the chip: free space %.3f, walls counted %.3f (in sample)" % (
        len(m.ids), len(np.unique(m.tag)), np.corrcoef(m.received_raw, free_space)[0, 1],
        np.corrcoef(m.received_raw, free_space - 6 * walls)[0, 1]))
    for name, columns in (("free space", [free_space]), ("walls counted", [free_space, walls]),
                          ("walls and furniture counted", [free_space, walls, pieces])):
        print("%s: received %s; as read %s; first path %s" % (
            name, stated(m.received, lines(m, m.received, *columns)),
            stated(m.received_raw, lines(m, m.received_raw, *columns)), stated(m.first, lines(m, m.first, *columns))))

    path = write_scene("apartment", m.plan)
    by_heights = {h: traced(path, m, h, FREE) for h in HEIGHTS}
    middle = (1.5, 1.0)
    links = by_heights[middle]
    no_edges = [("depth %d" % d, traced(path, m, middle, depth=d)) for d in (3, 4, 5)]
    rooms = [("doors open", write_scene("open", m.plan, doors=False)),
             ("without furniture", write_scene("bare", m.plan, furniture=False))]
    rows = [("through walls, no reflection", only(links, lambda x: x["reflections"] == 0)),
            ("up to 1 reflection", only(links, lambda x: x["reflections"] <= 1)),
            ("up to 2", only(links, lambda x: x["reflections"] <= 2)),
            ("up to 3", only(links, lambda x: x["reflections"] <= 3)),
            ("up to 4", only(links, lambda x: x["reflections"] <= 4)),
            ("all", links),
            ("reflections, nothing through walls", only(links, lambda x: x["crossings"] == 0)),
            ("with edges", traced_with_edges(path, m, middle)), *no_edges,
            *((name, traced(p, m, middle)) for name, p in rooms)]
    for name, some in rows:
        heard = np.array([x is not None and len(x["log"]) > 0 for x in some])
        some = [x if ok else None for x, ok in zip(some, heard)]
        power = received(some)
        print("%s: %d links; received %s; as read %.3f; first path %s" % (
            name, heard.sum(), stated(m.received, offset_alone(m, m.received, power)),
            np.corrcoef(m.received_raw, offset_alone(m, m.received_raw, power))[0, 1],
            stated(m.first, first_held_out(m, some))))
    for h, some in by_heights.items():
        print("heights %s: received %s" % (h, stated(m.received, offset_alone(m, m.received, received(some)))))
    shuffled = [np.corrcoef(m.received, received(links)[RANDOM.permutation(len(m.ids))])[0, 1] for _ in range(2000)]
    print("shuffled links as good: %d of 2000" % np.sum(np.array(shuffled) >= np.corrcoef(m.received, received(links))[0, 1]))

    prediction, chosen = fitted(m, by_heights, m.received)
    print("fitted, held out, traced anew: received %s" % stated(m.received, prediction))
    for tag, (h, values) in chosen.items():
        print("  without tag %d: heights %s, %s" % (tag, h, ", ".join("%s %.3g" % x for x in zip(FREE, values))))
    for i, link in enumerate(m.ids):
        print("  link %d: measured %.1f, fitted %.1f" % (link, m.received[i], prediction[i]))

    for name, some in (rows[1], rows[2], rows[5], rows[7]):
        own, other, rank, p = echoes(m, some)
        delays = spread(m.profile), spread(np.array([profile(x) for x in some]))
        print("echoes, %s: own %.3f, others %.3f, share of links that are more alike %.3f, p %.4f; "
              "delay spread %.1f and %.1f ns, correlation %.2f" % (name, own, other, rank, p, *map(np.median, delays),
                                                                  np.corrcoef(*delays)[0, 1]))


main()
