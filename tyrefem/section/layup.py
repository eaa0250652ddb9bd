"""How the layers lie on the meridian: where it runs across their thickness."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tyrefem.errors import InputError, nearest
from tyrefem.section.layer import Layer

Array = NDArray[np.float64]
#: Readings of the meridian that are not the midline of a layer.
READINGS = ("total", "inner", "outer")


@dataclass(frozen=True)
class Layup:
    """Layers from the inside to the outside, and the reading of the meridian.

    Parameters
    ----------
    layers : from the inside to the outside, names all different.
    reference : the layer whose midline the meridian is, ``"total"`` for the middle of the whole thickness,
        ``"inner"`` or ``"outer"`` for a face.
    as_built : the layers that the meridian was drawn for, where they have become thinner; None: ``layers``.

    Raises
    ------
    InputError : no layers, a name used twice or reserved, an unknown reference.

    >>> from tyrefem.section import Division, Profile
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
        """Distance from the meridian to the inner face, then each layer's outer face: (n_layers + 1, ...) [m]."""
        s = np.asarray(s, dtype=float)
        return self._stacked(*[np.stack([one.thickness(s) for one in layers]) for layers in self._now_and_built])

    def slopes(self, s: ArrayLike) -> Array:
        """d/ds of `faces`, same shape."""
        s = np.asarray(s, dtype=float)
        return self._stacked(*[np.stack([one.thickness.slope(s) for one in layers]) for layers in self._now_and_built])

    @property
    def _now_and_built(self) -> list[tuple[Layer, ...]]:
        return [self.layers] if self.as_built is None else [self.layers, self.as_built]

    def _stacked(self, rises: Array, built: Array | None = None) -> Array:
        heights, first = _heights(rises), _heights(rises if built is None else built)
        return np.asarray(heights - self._meridian(first))

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


def _heights(rises: Array) -> Array:
    """Heights above the inner face from the thicknesses of the layers."""
    return np.concatenate([np.zeros((1, *rises.shape[1:])), np.cumsum(rises, axis=0)])
