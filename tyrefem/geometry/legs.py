"""Legs of a region: the neighbouring layers that it takes, apart from others of it with other regions between them.

A fabric round the bead has two legs, an inner and an outer one; a ply of one layer or of neighbouring layers has one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tyrefem.errors import InputError
from tyrefem.geometry.layer import Layered

Array = NDArray[np.float64]
#: A point lies at most this far beyond the end of its region, m: those near the end of a curved layer may.
BEYOND = 2e-3


def leg_thickness(section: Layered, region: str, s: Array, depth: Array) -> Array:
    """Thickness of a region's leg at positions of the region, h [m], same shape.

    Parameters
    ----------
    s, depth : |s| along the meridian and depth from the inner surface [m].

    Raises
    ------
    InputError : a position further than `BEYOND` from the region along the meridian.

    >>> from tyrefem.geometry import load
    >>> section = load("truck-295-80r22.5")
    >>> s = np.full(2, section.line.length - 0.02)
    >>> leg_thickness(section, "chafer-fabric", s, np.array([0.001, section.total_thickness(s)[1] - 0.001])).round(4)
    array([0.0024, 0.0035])
    """
    shape = (len(section.layers), *s.shape)
    thickness, beyond = np.zeros(shape), np.full(shape, np.inf)
    for piece in section.pieces:
        if piece.region == region:
            layer, inside = piece.layer, np.clip(s, piece.start, piece.end)
            nearer = np.abs(inside - s) < beyond[layer]
            thickness[layer] = np.where(nearer, section.layers[layer].thickness(inside), thickness[layer])
            beyond[layer] = np.where(nearer, np.abs(inside - s), beyond[layer])
    faces = section.interfaces(s)
    height = faces[0] + depth
    across = np.maximum(np.maximum(faces[:-1] - height, height - faces[1:]), 0.0)
    holding = (beyond + across).argmin(axis=0)[None]
    past = np.take_along_axis(beyond, holding, axis=0)
    if (missing := past[0] >= BEYOND).any():
        raise InputError(f"region '{region}' has no thickness at s = {float(s[missing][0]) * 1e3:.1f} mm")
    taken = beyond <= past + 1e-6
    gaps = np.cumsum(~taken, axis=0)
    leg = taken & (gaps == np.take_along_axis(gaps, holding, axis=0))
    return np.asarray(np.where(leg, thickness, 0.0).sum(axis=0))
