"""Polygons of regions and polylines of boundaries, for pictures and meshes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from tyrefem.geometry.layer import Layered

Array = NDArray[np.float64]
_MIRROR = np.array([1.0, -1.0])


def stations(section: Layered, start: float, end: float, spacing: float) -> Array:
    """Stations from start to end at most ``spacing`` apart, with all kinks of the geometry."""
    knots = np.unique([start, *(s for s in section.breaks if start + 1e-9 < s < end - 1e-9), end])
    runs = [np.linspace(a, b, max(2, int(np.ceil((b - a) / spacing - 1e-9)) + 1))[:-1] for a, b in pairwise(knots)]
    return np.concatenate([*runs, knots[-1:]])


def face(section: Layered, index: int, s: Array) -> Array:
    """Points of the inner face (index 0) or of a layer's outer face (index 1, 2, ...), shape (n, 2)."""
    y = section.interfaces(s)[index]
    return np.asarray(section.line.position(s) + y[..., None] * section.line.normal(s))


def region_outlines(section: Layered, region: str, spacing: float) -> list[Array]:
    """Closed polygons of a region, one per connected piece of a layer."""
    polygons = []
    for piece in section.pieces:
        if piece.region != region:
            continue
        spans = [(piece.start, piece.end)]
        if not section.half:
            spans = [(-piece.end, piece.end)] if piece.start == 0 else [*spans, (-piece.end, -piece.start)]
        for start, end in spans:
            s = _signed_stations(section, start, end, spacing)
            inner, outer = face(section, piece.layer, s), face(section, piece.layer + 1, s)
            polygons.append(np.concatenate([outer, inner[::-1], outer[:1]]))
    return polygons


def label_place(section: Layered, region: str) -> Array:
    """Point (r, z), m, for the name of a region: half through its longest piece, at the middle of its length or, not
    to lie on the name of a neighbour in another layer, beyond it."""
    piece = max((p for p in section.pieces if p.region == region), key=lambda p: p.end - p.start)
    s = piece.start + (0.62 if piece.layer else 0.5) * (piece.end - piece.start)
    faces = section.interfaces(s)
    depth = float((faces[piece.layer] + faces[piece.layer + 1]) / 2 - faces[0])
    return np.ravel(section.place(s, depth))


def boundary_lines(section: Layered, name: str, spacing: float) -> list[Array]:
    """Open polylines of a boundary."""
    length, n = section.line.length, len(section.layers)
    end_face = section.place(length, section.interfaces(length) - section.interfaces(length)[0])
    if name == "symmetry":
        rubber = n if section.grooves and section.grooves[0][0] == 0 else n + 1
        return [section.place(0.0, section.interfaces(0.0)[:rubber] - section.interfaces(0.0)[0])]
    if name == "contained_air":
        start = 0.0 if section.half else -length
        return [face(section, 0, _signed_stations(section, start, length, spacing))]
    lines = []
    for part, start, end in section.outer.parts():
        if part != name:
            continue
        for low, high in _ribs(section, start, end):
            line = face(section, n, stations(section, low, high, spacing))
            if high == section.outer.ends[-1]:
                line = np.concatenate([line, end_face[-2::-1]])
            if not section.half and low == 0:
                lines.append(np.concatenate([line[:0:-1] * _MIRROR, line]))
                continue
            lines.append(line)
            if not section.half:
                lines.append(line * _MIRROR)
    for low, high in section.grooves if name == section.groove_boundary else ():
        bottom = face(section, n - 1, stations(section, low, high, spacing))
        top = face(section, n, np.array([low, high]))
        line = np.concatenate([top[:1] if low > 0 else bottom[:0], bottom, top[1:]])
        lines += [line] if section.half else [line, line * _MIRROR]
    return lines


def _ribs(section: Layered, start: float, end: float) -> list[tuple[float, float]]:
    """Intervals of the outer face between grooves."""
    ribs, begin = [], start
    for low, high in section.grooves:
        if start <= low < end:
            if low > begin:
                ribs.append((begin, low))
            begin = high
    return [*ribs, (begin, end)]


def _signed_stations(section: Layered, start: float, end: float, spacing: float) -> Array:
    if start >= 0:
        return stations(section, start, end, spacing)
    if end <= 0:
        return -stations(section, -end, -start, spacing)[::-1]
    left = -stations(section, 0.0, -start, spacing)[::-1]
    return np.concatenate([left[:-1], stations(section, 0.0, end, spacing)])
