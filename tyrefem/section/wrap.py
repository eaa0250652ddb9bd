"""A ply that runs round the bead: down inside it, across the layers below it, up again as the turn-up."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.errors import InputError
from tyrefem.section.layer import Layered

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Wrap:
    """The strip of a section in which cords turn from along the meridian to across it and back.

    The strip is one stretch of the meridian in layers that lie on each other. In the innermost and the outermost of
    them the cords run on circles about the strip's inner corners, between these straight across:

        d = (|dy|, ds) / hypot(ds, dy)    along the meridian and outwards

    ds from the strip's beginning, along a line parallel to the meridian; dy from the nearest of the layers between,
    0 in these.

    Raises
    ------
    InputError : no such region, or its parts do not lie on each other.

    >>> from tyrefem.section import load
    >>> wrap = load("passenger-205-55r16").wrapping
    >>> round(wrap.thickness * 1e3, 3), wrap.layers
    (1.1, (1, 2, 3))
    """

    section: Layered
    region: str

    def __post_init__(self) -> None:
        self.section.require_region(self.region)
        pieces = [piece for piece in self.section.pieces if piece.region == self.region]
        layers = [piece.layer for piece in pieces]
        spans = np.array([(piece.start, piece.end) for piece in pieces])
        if layers != list(range(layers[0], layers[0] + len(layers))) or np.ptp(spans, axis=0).max() > 1e-9:
            raise InputError(
                f"the parts of '{self.region}' must lie on each other: the same stretch of neighbouring layers",
                field="wrap.region",
            )

    @cached_property
    def _stretch(self) -> tuple[float, float]:
        piece = next(piece for piece in self.section.pieces if piece.region == self.region)
        return piece.start, piece.end

    @cached_property
    def layers(self) -> tuple[int, ...]:
        """Numbers of the layers that it crosses."""
        return tuple(piece.layer for piece in self.section.pieces if piece.region == self.region)

    @property
    def thickness(self) -> float:
        """Of the ply below the bead, m."""
        start, end = self._stretch
        return end - start

    def direction(self, s: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Parts along the meridian (towards larger s) and along its normal of the cords' unit vector at places
        (s, y), y from the meridian; along the meridian outside the strip."""
        s, y = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(y, dtype=float))
        start, end = self._stretch
        x = np.abs(s)
        faces = self.section.interfaces(x)
        first, last = self.layers[0], self.layers[-1]
        inner, outer = (faces[first + 1], faces[last]) if last > first else (faces[first], faces[last + 1])
        here = (x >= start) & (x <= end + 1e-9) & (y >= faces[first]) & (y <= faces[last + 1])
        aside = y - np.clip(y, inner, outer)
        below = (x - start) * (1 + self.section.line.curvature(s) * y)
        length = np.maximum(np.hypot(aside, below), 1e-12)
        # Down inside, up outside: what is along the meridian inside runs back outside.
        forward = np.where(here, -aside / length, 1.0) * np.where(s < 0, -1.0, 1.0)
        return forward, np.where(here, below / length, 0.0)
