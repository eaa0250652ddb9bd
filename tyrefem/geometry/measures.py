"""Lengths, areas and volumes of a section, by Gauss quadrature between the kinks of its geometry."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry.layer import Layered

Array = NDArray[np.float64]
_GAUSS = np.polynomial.legendre.leggauss(16)


def _integral(section: Layered, start: float, end: float, density: Callable[[Array], Array]) -> float:
    stations = np.unique([start, *(s for s in section.breaks if start < s < end), end])
    x, w = _GAUSS
    half = np.diff(stations)[:, None] / 2
    s = stations[:-1, None] + half * (1 + x)
    return float((density(s) * half * w).sum())


def _over_pieces(section: Layered, region: str | None, radius_power: int) -> float:
    """Integral of r^power dA, power 0 or 1; across the layers it is a polynomial in y, integrated in closed form."""
    if region is not None:
        section.require_region(region)
    line, total = section.line, 0.0
    for piece in section.pieces:
        if region is not None and piece.region != region:
            continue

        def density(s: Array, layer: int = piece.layer) -> Array:
            faces = section.interfaces(s)
            a, b, kappa = faces[layer], faces[layer + 1], line.curvature(s)
            zeroth, first, second = b - a, (b**2 - a**2) / 2, (b**3 - a**3) / 3
            if radius_power == 0:
                return np.asarray(zeroth + kappa * first)
            r, n = line.position(s)[..., 0], line.normal(s)[..., 0]
            return np.asarray(r * zeroth + (n + r * kappa) * first + n * kappa * second)

        total += _integral(section, piece.start, piece.end, density)
    return total if section.half else 2 * total


def area(section: Layered, region: str | None = None) -> float:
    """Integral of (1 + kappa y) dy ds [m2]."""
    return _over_pieces(section, region, 0)


def volume(section: Layered, region: str | None = None) -> float:
    """Integral of 2 pi (r + y n_r)(1 + kappa y) dy ds [m3]."""
    return 2 * np.pi * _over_pieces(section, region, 1)


def _inner_face(section: Layered, s: Array) -> tuple[Array, Array, Array]:
    """r of the inner face, dz/ds along it, and dl/ds."""
    line, y, slope = section.line, section.interfaces(s)[0], section.interface_slopes(s)[0]
    normal = line.normal(s)
    stretch = 1 + line.curvature(s) * y
    r = line.position(s)[..., 0] + y * normal[..., 0]
    dz = stretch * normal[..., 0] + slope * normal[..., 1]
    return r, dz, np.hypot(stretch, slope)


def inner_surface_area(section: Layered) -> float:
    """Integral of 2 pi r dl along the inner face [m2]."""

    def density(s: Array) -> Array:
        r, _, dl = _inner_face(section, s)
        return np.asarray(2 * np.pi * r * dl)

    total = _integral(section, 0.0, section.line.length, density)
    return total if section.half else 2 * total


def gas_volume(section: Layered) -> float:
    """Integral of pi (r^2 - r_bead^2) dz along the inner face [m3]."""
    r_bead = float(section.place(section.line.length, 0.0)[0])

    def density(s: Array) -> Array:
        r, dz, _ = _inner_face(section, s)
        return np.asarray(np.pi * (r**2 - r_bead**2) * dz)

    total = _integral(section, 0.0, section.line.length, density)
    return total if section.half else 2 * total


def overall_width(section: Layered) -> float:
    """Twice the largest z of the outer face [m]."""

    def z(s: Array) -> Array:
        y = section.interfaces(s)[-1]
        return np.asarray(section.line.position(s)[..., 1] + y * section.line.normal(s)[..., 1])

    samples = np.unique(np.concatenate([np.linspace(0, section.line.length, 400), section.breaks]))
    for _ in range(6):
        best = int(np.argmax(z(samples)))
        low, high = samples[max(best - 1, 0)], samples[min(best + 1, len(samples) - 1)]
        # The best sample is kept if it is the largest: it may be at a kink of the thickness.
        samples = np.unique(np.concatenate([np.linspace(low, high, 60), samples[[best]]]))
    return 2 * float(z(samples).max())


def summary(section: Layered) -> dict[str, Any]:
    """Sizes, areas and volumes in SI units."""
    bead = section.line.position(section.line.length)
    return {
        "name": section.name,
        "half": section.half,
        "outer_diameter_m": section.outer_diameter,
        "overall_width_m": section.overall_width,
        "crown_thickness_m": float(section.total_thickness(0.0)),
        "meridian_length_m": section.line.length,
        "shoulder_s_m": section.line.shoulder_s,
        "bead_r_m": float(bead[0]),
        "bead_z_m": float(bead[1]),
        "area_m2": {region: section.area(region) for region in section.regions},
        "volume_m3": {region: section.volume(region) for region in section.regions},
        "inner_surface_m2": section.inner_surface_area(),
        "gas_volume_m3": section.gas_volume(),
        "boundaries": list(section.boundaries),
    }
