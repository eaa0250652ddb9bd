"""Position of the layers relative to the meridian, across the thickness.

Also the course of a ply around the bead: down inside it, across the layers below it, up again as the turn-up.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.geometry.layer import Layer, Layered

Array = NDArray[np.float64]


#: Positions of the meridian other than a layer's midline.
READINGS = ("total", "inner", "outer")


@dataclass(frozen=True)
class Layup:
    """Layers from the inside to the outside, and the position of the meridian among them.

    Parameters
    ----------
    layers : from the inside to the outside, with different names.
    reference : the layer whose midline is the meridian; ``"total"`` for the middle of the whole thickness;
        ``"inner"`` or ``"outer"`` for a face.
    as_built : if worn, the layers before wear, which place the meridian; None: ``layers``.

    Raises
    ------
    InputError : no layers, a name used twice or reserved, an unknown reference.

    >>> from tyrefem.geometry import Division, Profile
    >>> thin, thick = Profile((0.0,), (0.002,)), Profile((0.0,), (0.006,))
    >>> whole = Division(("rubber",), (0.1,))
    >>> layers = (Layer("ply", thin, whole), Layer("cover", thick, whole))
    >>> Layup(layers, "ply").faces(0.05).round(9).tolist()
    [-0.001, 0.001, 0.007]
    >>> Layup(layers, "total").faces(0.05).round(9).tolist()
    [-0.004, -0.002, 0.004]
    """

    layers: tuple[Layer, ...]
    reference: str
    as_built: tuple[Layer, ...] | None = None

    def __post_init__(self) -> None:
        names = [layer.name for layer in self.layers]
        if not names:
            raise InputError("a section needs one layer or more", field="layers")
        taken = [name for name in names if names.count(name) > 1 or name in READINGS]
        if taken:
            raise InputError(f"layer name '{taken[0]}' is taken", field="layers")
        if self.reference not in (*names, *READINGS):
            hint = nearest(self.reference, (*names, *READINGS))
            raise InputError(f"no layer '{self.reference}'{hint}", field="line.reference")

    @property
    def carcass(self) -> int | None:
        """Index of the layer with the region ``carcass``."""
        return next((i for i, layer in enumerate(self.layers) if "carcass" in layer.regions.names), None)

    def faces(self, s: ArrayLike) -> Array:
        """Distance from the meridian to the inner face and to each layer's outer face: (n_layers + 1, ...) [m]."""
        s = np.asarray(s, dtype=float)
        return self._stacked(*[[layer.thickness(s) for layer in layers] for layers in self._worn_and_built])

    def slopes(self, s: ArrayLike) -> Array:
        """d/ds of `faces`, same shape."""
        s = np.asarray(s, dtype=float)
        return self._stacked(*[[layer.thickness.slope(s) for layer in layers] for layers in self._worn_and_built])

    @property
    def _worn_and_built(self) -> list[tuple[Layer, ...]]:
        return [self.layers] if self.as_built is None else [self.layers, self.as_built]

    def _stacked(self, rises: list[Array], built: list[Array] | None = None) -> Array:
        heights = _heights(rises)
        return np.asarray(heights - self._meridian(heights if built is None else _heights(built)))

    def _meridian(self, heights: Array) -> Array:
        """Height of the meridian above the inner face."""
        if self.reference == "inner":
            return np.asarray(heights[0])
        if self.reference == "outer":
            return np.asarray(heights[-1])
        if self.reference == "total":
            return np.asarray(heights[-1] / 2)
        index = [layer.name for layer in self.layers].index(self.reference)
        return np.asarray((heights[index] + heights[index + 1]) / 2)


def _heights(rises: list[Array]) -> Array:
    """Heights of the faces above the inner face, from the thicknesses of the layers."""
    heights = np.zeros((len(rises) + 1, *rises[0].shape))
    for layer, rise in enumerate(rises):
        heights[layer + 1] = heights[layer] + rise
    return heights


@dataclass(frozen=True, eq=False)
class Wrap:
    """The strip of a section in which cords turn from along the meridian to across it and back.

    The strip is one interval of the meridian in neighbouring layers. In the innermost and the outermost of them the
    cords follow circles about the strip's inner corners; in the layers between they run straight across:

        d = (|dy|, ds) / hypot(ds, dy)    along the meridian and outwards

    ds is the distance from the strip's start, along a line parallel to the meridian; dy the distance from the nearest
    of the layers between, 0 inside these.

    Raises
    ------
    InputError : no such region, or its parts are not neighbours.

    >>> from tyrefem.geometry import load
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
        """Indices of the layers that the strip crosses."""
        return tuple(piece.layer for piece in self.section.pieces if piece.region == self.region)

    @property
    def thickness(self) -> float:
        """Thickness of the ply below the bead, m."""
        start, end = self._stretch
        return end - start

    def direction(self, s: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Unit vector of the cords at positions (s, y), y from the meridian: components along the meridian (towards
        larger s) and along its normal. Outside the strip it is along the meridian."""
        s, y = np.broadcast_arrays(np.asarray(s, dtype=float), np.asarray(y, dtype=float))
        start, end = self._stretch
        x = np.abs(s)
        faces = self.section.interfaces(x)
        first, last = self.layers[0], self.layers[-1]
        inner, outer = (faces[first + 1], faces[last]) if last > first else (faces[first], faces[last + 1])
        in_strip = (x >= start) & (x <= end + 1e-9) & (y >= faces[first]) & (y <= faces[last + 1])
        offset = y - np.clip(y, inner, outer)
        below = (x - start) * (1 + self.section.line.curvature(s) * y)
        length = np.maximum(np.hypot(offset, below), 1e-12)
        # Down on the inside, up on the outside: the direction along the meridian is reversed.
        forward = np.where(in_strip, -offset / length, 1.0) * np.where(s < 0, -1.0, 1.0)
        return forward, np.where(in_strip, below / length, 0.0)
