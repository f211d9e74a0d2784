#!/usr/bin/env python3
"""Exact fields of lossy dielectric cylinders, with SciPy's Bessel functions.

usage: generate.py      (needs python3-scipy; writes the four .json.gz beside this script)

Time factor exp(+j w t), outgoing waves are Hankel functions of the second kind. Shares no code and
no formula with engine/em: where that uses closed forms, this solves the boundary conditions.
See README.md for what the files hold.
"""
import gzip
import json
import os

import numpy as np
from scipy.special import hankel2, h2vp, jv, jve

HERE = os.path.dirname(os.path.abspath(__file__))
LIGHT = 299_792_458.0
EPSILON_0 = 8.8541878128e-12
CARRIER = 5.18e9
K = 2 * np.pi * CARRIER / LIGHT
MATERIALS = {  # relative permittivity, conductivity [S/m]
    "skin": (36.0, 4.0),
    "wood": (1.99, 0.0276),
    "weakly_lossy": (4.0, 0.002),
}


def permittivity(eps_r, sigma):
    return eps_r - 1j * sigma / (2 * np.pi * CARRIER * EPSILON_0)


def interior(n, y):
    """J_n(y) and J_n'(y), both times the same factor (they overflow in a lossy body)."""
    return jve(n, y), 0.5 * (jve(n - 1, y) - jve(n + 1, y))


def modes(order, radius, eps, sin_elevation):
    """2 x 2 scattering matrices (E_z, eta H_z) of the orders n >= 0 at oblique incidence.

    Fields ~ exp(-j k sin_elevation z). Unknown per order: scattered E_z and eta H_z, interior E_z and
    eta H_z; equations: continuity of E_z, eta H_z, E_phi, eta H_phi, each for both excitations.
    """
    s = np.asarray(sin_elevation, dtype=complex)[..., None]
    n = np.broadcast_to(np.asarray(order, dtype=float), np.broadcast_shapes(s.shape, np.shape(order)))
    g0 = np.sqrt(1 - s**2)  # transverse wavenumbers over k; Im <= 0 keeps waves outgoing
    g0 = np.where(g0.imag > 0, -g0, g0)
    g1 = np.sqrt(eps - s**2)
    x, y = K * radius * g0, K * radius * g1
    h, dh = hankel2(n, x), h2vp(n, x)
    j, dj = jv(n, x), 0.5 * (jv(n - 1, x) - jv(n + 1, x))
    ji, dji = interior(n, y)
    scale_h, scale_j = 1 / h, 1 / ji  # unknowns near one
    h, dh, ji, dji = h * scale_h, dh * scale_h, ji * scale_j, dji * scale_j
    jn = 1j * n / (K * radius)
    # E_phi = -j/g^2 (s d_phi E - d_rho H), H_phi = -j/g^2 (s d_phi H + eps d_rho E), over k.
    zero = np.zeros_like(h)
    a = np.array([
        [h, zero, -ji, zero],
        [zero, h, zero, -ji],
        [s * jn * h / g0**2, -dh / g0, -s * jn * ji / g1**2, dji / g1],
        [dh / g0, s * jn * h / g0**2, -eps * dji / g1, -s * jn * ji / g1**2],
    ])
    b = -np.array([[j, zero], [zero, j], [s * jn * j / g0**2, -dj / g0], [dj / g0, s * jn * j / g0**2]])
    a, b = np.moveaxis(a, (0, 1), (-2, -1)), np.moveaxis(b, (0, 1), (-2, -1))
    return np.linalg.solve(a, b)[..., :2, :] * scale_h[..., None, None]


def line_source_total(radius, eps, rho_s, rho_o, phi):
    """Fields of a line source H_0(k d), axial electric (TM) and magnetic (TE), body included."""
    x = K * radius
    n = np.arange(0, int(x + 6 * x ** (1 / 3) + 20))
    t = modes(n, radius, eps, 0.0)
    weights = np.where(n == 0, 1, 2) * np.cos(n * phi) * hankel2(n, K * rho_s) * hankel2(n, K * rho_o)
    distance = np.sqrt(rho_s**2 + rho_o**2 - 2 * rho_s * rho_o * np.cos(phi))
    direct = hankel2(0, K * distance)
    return [direct + np.sum(weights * t[..., i, i]) for i in (0, 1)]


def write_line_source():
    angles = [7.0 * i for i in range(1, 25)] + [171, 173, 175, 176, 177, 178, 179, 180]
    cases = []
    for name, (eps_r, sigma) in MATERIALS.items():
        for k_radius in (10.0, 17.3, 30.0):
            for rho_s, rho_o in ((0.5, 0.6), (0.5, 5.0), (2.0, 1.2), (5.0, 4.0)):
                rows = []
                for angle in angles:
                    tm, te = line_source_total(
                        k_radius / K, permittivity(eps_r, sigma), rho_s, rho_o, np.radians(angle))
                    rows.append([angle, tm.real, tm.imag, te.real, te.imag])
                cases.append({"material": name, "eps_r": eps_r, "sigma": sigma, "k_radius": k_radius,
                              "rho_s": rho_s, "rho_o": rho_o, "rows": rows})
    save("line_source.json", {"frequency": CARRIER, "cases": cases})


def write_modes():
    cases = []
    for name, (eps_r, sigma) in MATERIALS.items():
        for k_radius in (10.0, 30.0):
            for elevation in (0.0, 20.0, 45.0, 70.0):
                n = np.arange(0, int(k_radius) + 8)
                t = modes(n, k_radius / K, permittivity(eps_r, sigma), np.sin(np.radians(elevation)))
                rows = [[int(i)] + [v for z in (t[i, 0, 0], t[i, 1, 1], t[i, 0, 1], t[i, 1, 0])
                                    for v in (z.real, z.imag)] for i in range(0, len(n), 3)]
                cases.append({"material": name, "eps_r": eps_r, "sigma": sigma, "k_radius": k_radius,
                              "elevation": elevation, "rows": rows})
    save("oblique_modes.json", {"frequency": CARRIER, "cases": cases})


class VerticalDipoles:
    """Fields of upright point dipoles beside the infinite cylinder, in units of exp(-jkR) / R at
    right angles to them, scattered as an integral over k_z: E_z of an electric dipole, whose field is
    vertical, and by duality eta_0 H_z of a magnetic one, whose electric field is horizontal.

    (1 + d_z^2 / k^2) of exp(-jkR) / R = -j/2 integral (1 - (k_z/k)^2) exp(-j k_z z) H_0(k_t rho) dk_z.
    """

    def __init__(self, radius, eps, samples=4001):
        # k_z / k off the real axis: above it on the right, below on the left, so between the branch
        # points and the guided modes of the cylinder.
        t = np.linspace(-1.6, 1.6, samples)
        self.kz = t + 0.01j * np.tanh(4 * t)
        self.dkz = (1 + 0.04j / np.cosh(4 * t) ** 2) * (t[1] - t[0])
        g0 = np.sqrt(1 - self.kz**2)
        self.g0 = np.where(g0.imag > 0, -g0, g0)[:, None]
        x = K * radius
        self.n = np.arange(0, int(x + 5 * x ** (1 / 3) + 12))
        self.t = modes(self.n, radius, eps, self.kz) * np.where(self.n == 0, 1, 2)[:, None, None]

    def at(self, rho_s, rho_o, rise, angles):
        """For each azimuth from source to observer: direct (the same for both), scattered E_z of E_z,
        eta_0 H_z of eta_0 H_z, and E_z of eta_0 H_z."""
        radial = hankel2(self.n, K * self.g0 * rho_s) * hankel2(self.n, K * self.g0 * rho_o)
        spectrum = (1 - self.kz**2) * np.exp(-1j * K * self.kz * rise) * self.dkz
        by_order = np.einsum("s,sn,snij->nij", spectrum, radial, self.t)
        for phi in np.radians(angles):
            distance = np.sqrt(rho_s**2 + rho_o**2 - 2 * rho_s * rho_o * np.cos(phi) + rise**2)
            sin2 = (rise / distance) ** 2
            kr = K * distance
            near = (1 - sin2) + (3 * sin2 - 1) * (1j / kr + 1 / kr**2)  # a point dipole's, exactly
            direct = near * np.exp(-1j * kr) / distance
            even, odd = np.cos(self.n * phi), 1j * np.sin(self.n * phi)  # of orders n and -n
            scattered = [-0.5j * K * np.dot(by_order[:, row, column], turn)
                         for row, column, turn in ((0, 0, even), (1, 1, even), (0, 1, odd))]
            yield [direct, *scattered]


def write_point_source():
    angles = (20, 50, 80, 110, 125, 140, 155, 165, 170, 173, 176, 178, 180)
    places = ((0.5, 0.5, 0.0), (0.5, 0.5, 0.6), (0.5, 5.0, 1.0), (5.0, 0.5, -2.0), (1.0, 1.0, 1.5),
              (2.0, 1.5, 0.0), (2.0, 1.5, 1.2), (3.0, 0.8, -2.0), (5.0, 5.0, 0.0), (5.0, 4.0, 2.5))
    cases = []
    for name in ("skin", "wood"):
        eps_r, sigma = MATERIALS[name]
        for k_radius in (10.0, 17.3, 30.0):
            dipoles = VerticalDipoles(k_radius / K, permittivity(eps_r, sigma))
            for rho_s, rho_o, rise in places:
                rows = [[angle] + [v for z in fields for v in (z.real, z.imag)]
                        for angle, fields in zip(angles, dipoles.at(rho_s, rho_o, rise, angles))]
                cases.append({"material": name, "eps_r": eps_r, "sigma": sigma, "k_radius": k_radius,
                              "rho_s": rho_s, "rho_o": rho_o, "rise": rise, "rows": rows})
    save("point_source.json", {"frequency": CARRIER, "cases": cases})


class Ellipse:
    """Total field (E_z, eta H_z) beside an elliptic cylinder by the method of fundamental solutions:
    line sources on two curves beside its boundary, least squares on the boundary."""

    def __init__(self, semi_axes, eps, sin_elevation, sources=(170, 420), offsets=(0.028, 0.012)):
        self.s = sin_elevation
        self.g0, self.g1 = np.sqrt(1 - self.s**2), np.sqrt(eps - self.s**2)
        self.eps = eps
        self.points, self.normals = self.curve(semi_axes, 620, 0.0)
        self.outer, _ = self.curve(semi_axes, sources[0], -offsets[0])  # radiate outwards
        inner, _ = self.curve(semi_axes, sources[1], offsets[1])        # radiate inwards
        e, h = self.equations(self.outer, self.g0, 1.0)
        ei, hi = self.equations(inner, self.g1, eps)
        self.matrix = np.concatenate([e, h, -ei, -hi], axis=1)
        self.scale = 1 / np.linalg.norm(self.matrix, axis=0)

    @staticmethod
    def curve(semi_axes, count, offset):
        t = 2 * np.pi * (np.arange(count) + 0.5) / count
        points = np.stack([semi_axes[0] * np.cos(t), semi_axes[1] * np.sin(t)], axis=-1)
        normals = np.stack([np.cos(t) / semi_axes[0], np.sin(t) / semi_axes[1]], axis=-1)
        normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
        return points + offset * normals, normals

    def equations(self, sources, g, eps):
        """Columns: what unit sources of E_z and of eta H_z give for E_z, eta H_z, E_tau, eta H_tau."""
        away = self.points[:, None] - sources[None]
        distance = np.linalg.norm(away, axis=-1)
        u = hankel2(0, K * g * distance)
        slope = -g * hankel2(1, K * g * distance)  # over k
        along = np.einsum("pqi,pi->pq", away, self.normals) / distance * slope
        tangents = np.stack([-self.normals[:, 1], self.normals[:, 0]], axis=-1)
        across = np.einsum("pqi,pi->pq", away, tangents) / distance * slope
        zero = np.zeros_like(u)
        e = np.concatenate([u, zero, self.s * across / g**2, eps * along / g**2])
        h = np.concatenate([zero, u, -along / g**2, self.s * across / g**2])
        return e, h

    def scattered(self, source, observers):
        """[excitation][observer] -> (E_z, eta H_z) per excitation, and the residual of the fit."""
        e, h = self.equations(np.array([source]), self.g0, 1.0)
        rhs = -np.concatenate([e, h], axis=1)
        x = np.linalg.lstsq(self.matrix * self.scale, rhs, rcond=1e-14)[0] * self.scale[:, None]
        residual = np.linalg.norm(self.matrix @ x - rhs) / np.linalg.norm(rhs)
        n = len(self.outer)
        u = hankel2(0, K * self.g0 * np.linalg.norm(observers[:, None] - self.outer[None], axis=-1))
        return np.stack([u @ x[:n], u @ x[n : 2 * n]], axis=-1), residual


def write_ellipse():
    cases = []
    for name, semi_axes in (("skin", (0.22, 0.13)), ("wood", (0.12, 0.2))):
        eps_r, sigma = MATERIALS[name]
        for elevation in (0.0, 40.0):
            ellipse = Ellipse(semi_axes, permittivity(eps_r, sigma), np.sin(np.radians(elevation)))
            for source_angle in (20.0, 75.0):
                angles = source_angle + np.array([15.0, 60.0, 95.0, 130.0, 160.0, 175.0, 180.0, 200.0, 270.0])
                at = [1.7 * f(np.radians(source_angle)) for f in (np.cos, np.sin)]
                observers = 0.9 * np.stack([np.cos(np.radians(angles)), np.sin(np.radians(angles))], axis=-1)
                fields, residual = ellipse.scattered(at, observers)
                assert residual < 1e-6, residual
                # Rows: angle; E_z of E_z, eta H_z of E_z, E_z of eta H_z, eta H_z of eta H_z.
                rows = [[angle] + [v for z in (f[0, 0], f[0, 1], f[1, 0], f[1, 1]) for v in (z.real, z.imag)]
                        for angle, f in zip(angles.tolist(), fields)]
                cases.append({"material": name, "eps_r": eps_r, "sigma": sigma, "semi_axes": semi_axes,
                              "elevation": elevation, "rho_s": 1.7, "phi_s": source_angle, "rho_o": 0.9,
                              "residual": float(f"{residual:.1e}"), "rows": rows})
    save("ellipse.json", {"frequency": CARRIER, "cases": cases})


def rounded(value):
    if isinstance(value, float):
        return float(f"{value:.12g}")
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    return [rounded(v) for v in value] if isinstance(value, (list, tuple)) else value


def save(name, doc):
    text = json.dumps(rounded(doc), separators=(",", ":"))
    text = text.replace('{"material"', '\n{"material"')
    with open(os.path.join(HERE, name + ".gz"), "wb") as fh:
        fh.write(gzip.compress((text + "\n").encode(), mtime=0))


if __name__ == "__main__":
    write_line_source()
    write_modes()
    write_point_source()
    write_ellipse()
