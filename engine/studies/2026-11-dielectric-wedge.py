#!/usr/bin/env python3
"""Edges of other materials against an exact solution: the figures of 2026-11-dielectric-wedge.md.

    PYTHONPATH=build/dev/python engine/studies/2026-11-dielectric-wedge.py

Needs numpy, scipy and the module rayloc. A line source stands beside a long bar of square section. The exact field
is that of two integral equations over its outline (method of moments), that of the tracer the sum of its paths.
Lengths are in wavelengths.
"""

import tempfile
from pathlib import Path

import numpy as np
from scipy.special import hankel2

import rayloc

CARRIER = 5.18e9  # [Hz]
WAVELENGTH = 299792458.0 / CARRIER  # [m]
WAVENUMBER = 2 * np.pi  # [1 / wavelength]
VACUUM = 8.8541878128e-12  # [F/m]
SIDE = 6.0  # of the square, from (0, 0) on
# Relative permittivity and conductivity [S/m]; in all of them nothing comes through the bar.
MATERIALS = {"concrete": (5.24, 0.167), "wet wall": (15.0, 1.2), "soft foam": (1.6, 0.15), "metal": (1.0, 1e7)}
SOURCES = [(-4.0, 2.0), (-3.0, -2.0), (-6.0, 8.0)]
SCENE = """<scene version="2.1.0">
<bsdf type="radio-material" id="bar">
<float name="relative_permittivity" value="{eps}"/><float name="conductivity" value="{sigma}"/>
<float name="thickness" value="2.0"/></bsdf>
<shape type="cube" id="bar-shape"><transform name="to_world"><scale x="{half}" y="{half}" z="60"/>
<translate x="{half}" y="{half}" z="0"/></transform><ref id="bar" name="bsdf"/></shape></scene>"""


class Bar:
    """The exact field about the bar; `te`: the magnetic field is along it, else the electric one."""

    def __init__(self, eps, source, te, per_wavelength=16):
        count = int(SIDE * per_wavelength)
        # Segments are shorter at the corners.
        ends = 0.25 * SIDE * (1 - np.cos(np.pi * np.arange(count + 1) / count)) + 0.5 * np.linspace(0, SIDE, count + 1)
        at, zero = (ends[1:] + ends[:-1]) / 2, np.zeros(count)
        self.x = np.concatenate([at, zero + SIDE, SIDE - at, zero])
        self.y = np.concatenate([zero, at, zero + SIDE, SIDE - at])
        self.width = np.concatenate([np.diff(ends), np.diff(ends), np.diff(ends)[::-1], np.diff(ends)[::-1]])
        self.nx = np.concatenate([zero, zero + 1, zero, zero - 1])
        self.ny = np.concatenate([zero - 1, zero, zero + 1, zero])
        self.source = source
        outside, out_slope = self.operators(WAVENUMBER)
        half = np.eye(len(self.x)) / 2
        lit = self.incident(self.x, self.y)
        if eps is None:  # a conductor: no field, or no slope, on it
            if te:
                self.field, self.slope = np.linalg.solve(half - out_slope, lit), 0 * lit
            else:
                self.field, self.slope = 0 * lit, np.linalg.solve(outside, lit)
            return
        inside, in_slope = self.operators(WAVENUMBER * np.sqrt(eps))
        jump = eps if te else 1.0
        both = np.block([[half - out_slope, outside], [half + in_slope, -jump * inside]])
        found = np.linalg.solve(both, np.concatenate([lit, 0 * lit]))
        self.field, self.slope = np.split(found, 2)

    def incident(self, x, y):
        return hankel2(0, WAVENUMBER * np.hypot(x - self.source[0], y - self.source[1]))

    def operators(self, k):
        """Of a layer of sources and of one of dipoles, by Gauss-Legendre of four points."""
        single = np.zeros((len(self.x), len(self.x)), complex)
        double = single.copy()
        for at, weight in zip(*np.polynomial.legendre.leggauss(4)):
            px = self.x - self.ny * at * self.width / 2
            py = self.y + self.nx * at * self.width / 2
            dx, dy = self.x[:, None] - px, self.y[:, None] - py
            r = np.maximum(np.hypot(dx, dy), 1e-12)
            single += weight / 2 * self.width * hankel2(0, k * r) / 4j
            double += weight / 2 * self.width * k * hankel2(1, k * r) / 4j * (dx * self.nx + dy * self.ny) / r
        small = np.exp(np.euler_gamma) * k * self.width / 4
        np.fill_diagonal(single, self.width / 4j * (1 - 2j / np.pi * (np.log(small) - 1)))
        np.fill_diagonal(double, 0)
        return single, double

    def at(self, x, y):
        """Where the wave alone is exp(-j k r) / sqrt(r) far from its source."""
        dx, dy = x - self.x, y - self.y
        r = np.hypot(dx, dy)
        slope = WAVENUMBER * hankel2(1, WAVENUMBER * r) / 4j * (dx * self.nx + dy * self.ny) / r
        scattered = np.sum(self.width * (self.field * slope - self.slope * hankel2(0, WAVENUMBER * r) / 4j))
        return (self.incident(x, y) + scattered) / (np.sqrt(1 / np.pi / np.pi) * np.exp(0.25j * np.pi))


def traced(scene, source, observer, te, edges):
    """The sum of the paths, each beside a wave of its length as a line source has it."""
    end = dict(polarization="H" if te else "V")
    tx = rayloc.Transmitter([source[0] * WAVELENGTH, source[1] * WAVELENGTH, 0.0], **end)
    rx = rayloc.Receiver([observer[0] * WAVELENGTH, observer[1] * WAVELENGTH, 0.0], **end)
    paths = rayloc.trace(scene, tx, rx, max_depth=max(1, edges), diffraction=edges)
    length = paths.tau * 299792458.0 / WAVELENGTH
    level = length < 200  # not over the ends of the bar
    a = paths.a * (4 * np.pi * length)
    if te:
        a = -a  # the receiver's horizontal axis is seen from the other side: of the magnetic field that is +1
    return np.sum((a / np.sqrt(length) * np.exp(-2j * np.pi * length))[level])


def observers():
    """Two and five wavelengths off the corners and sides, all around."""
    for off in (2.0, 5.0):
        for turn in np.arange(0.0, 360.0, 3.7):
            direction = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
            centre = np.array([SIDE / 2, SIDE / 2])
            reach = SIDE / 2 / np.max(np.abs(direction))
            yield off, centre + (reach + off) * direction


def main():
    print("| material | field along | off | in | paths | one edge | two edges |")
    for name, (relative, sigma) in MATERIALS.items():
        text = SCENE.format(eps=relative, sigma=sigma, half=SIDE / 2 * WAVELENGTH)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "bar.xml").write_text(text)
            scene = rayloc.load_scene(Path(folder) / "bar.xml", CARRIER)
        eps = None if sigma > 1e5 else relative - 1j * sigma / (2 * np.pi * CARRIER * VACUUM)
        for te in (False, True):
            rows = []
            for source in SOURCES:
                bar = Bar(eps, source, te)
                for off, place in observers():
                    exact = bar.at(*place)
                    alone = 1 / np.sqrt(np.hypot(*(place - source)))
                    found = [abs(traced(scene, source, place, te, edges) - exact) / alone for edges in (0, 1, 2)]
                    rows.append([off, abs(exact) / alone, *found])
            rows = np.array(rows)
            for off in (2.0, 5.0):
                for what, dark in (("light", False), ("shadow", True)):
                    here = rows[(rows[:, 0] == off) & ((rows[:, 1] < 0.35) == dark)]
                    values = ["%.3f, %.3f" % tuple(np.quantile(here[:, 2 + i], (0.5, 0.95))) for i in (0, 1, 2)]
                    print("| %s | %s | %g | %s (%d) | %s |" % (name, "magnetic" if te else "electric", off, what,
                                                               len(here), " | ".join(values)))


if __name__ == "__main__":
    main()
